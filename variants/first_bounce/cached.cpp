// The choice first_bounce=cached keeps camera rays' hits from the first sample on: right only where every sample of a
// pixel has the same camera ray. A scene with jitter, a lens or motion would converge to another image, so the choice
// does not apply to it; jitter is a setting of the scene and is never switched off on the choice's behalf.
#include "variants/registry.h"

namespace pt::first_bounce::cached {
namespace {

const Registration registration(
    {
        .axis = "first_bounce",
        .name = "cached",
        .summary = "the camera rays' hits are computed once and reused by every later sample",
        .origin = "cis565 (CIS 565 project 3, both programs)",
        .backends = on_every_backend,
        .unsupported_reason = [](FeatureSet scene, const VariantTraits&) -> Reason {
            if (contains(scene, Feature::jitter)) {
                return {"needs_no_jitter", "needs jitter off (camera.jitter is true in the scene)"};
            }
            if (contains(scene, Feature::lens)) {
                return {"needs_pinhole", "needs a pinhole camera (camera.aperture_radius is not 0)"};
            }
            if (contains(scene, Feature::motion)) {
                return {"needs_no_motion", "needs still objects (the scene has moving ones and an open shutter)"};
            }
            return {};
        },
        .check_counters = [](const WorkCounters& work, std::uint64_t samples) -> std::string {
            if (work.cache_fills * samples != work.paths) {
                return std::to_string(work.cache_fills) + " cache fills for " + std::to_string(work.paths) + " paths";
            }
            return work.cache_fills + work.cache_hits == work.paths ? "" : "not every camera ray came from the cache";
        },
    },
    {.first_bounce = [](const Variant&, Backend) { return 1u; }});

}  // namespace
}  // namespace pt::first_bounce::cached
