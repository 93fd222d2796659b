// The choice first_bounce=cached_jitters draws K camera rays of a pixel once and keeps their hits; every later sample
// uses one of the K in turn. It may be used with jitter, lens and motion, because it declares its bias: with more than
// K samples the pixel's filter, the lens and the shutter are sampled at K points only.
#include "variants/registry.h"

namespace pt::first_bounce::cached_jitters {
namespace {

constexpr Tunable tunables[] = {{"jitters", 16, 1, 4096, 1, "camera rays of a pixel that are kept (K)", true}};

const Registration registration(
    {
        .axis = "first_bounce",
        .name = "cached_jitters",
        .summary = "the hits of K frozen camera rays a pixel are computed once, and used in turn",
        .origin = "the cache of cis565, made to work with jitter",
        .claim = Claim::biased,
        .claim_note = "pixel, lens and shutter are sampled at K points, however many samples are taken",
        .backends = on_every_backend,
        .tunables = tunables,
        .unsupported_reason = [](FeatureSet scene, const VariantTraits&) -> Reason {
            const FeatureSet varying = (Feature::jitter | Feature::lens) | Feature::motion;
            if ((scene & varying) != 0) {
                return {};
            }
            return {"needs_varying_camera_rays",
                    "needs jitter, a lens or motion; without them first_bounce=cached is it"};
        },
        .check_counters = [](const WorkCounters& work, std::uint64_t samples) -> std::string {
            if (work.cache_fills == 0 || work.cache_fills * samples % work.paths != 0) {
                return std::to_string(work.cache_fills) + " cache fills for " + std::to_string(work.paths) + " paths";
            }
            return work.cache_fills + work.cache_hits == work.paths ? "" : "not every camera ray came from the cache";
        },
    },
    {.first_bounce = [](const Variant& variant, Backend backend) { return tunable(variant, "jitters", backend); }});

}  // namespace
}  // namespace pt::first_bounce::cached_jitters
