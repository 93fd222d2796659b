// The sampler minstd_by_position, the random numbers of cis565: a short generator seeded by sample, bounce and the
// path's position in the queue (kernels/samplers/minstd.h). An exhibit: its streams overlap and are correlated, and a
// compaction changes which path gets which numbers.
#include "variants/registry.h"

namespace pt::sampler::minstd_by_position {
namespace {

// Why the sampler minstd_by_position cannot run: positions in the queue must be the same in every run, and are not
// where threads race for them. Empty: it can.
Reason unsupported_reason(FeatureSet, const VariantTraits& variant) {
    if (!variant.integrator.seeds_by_position) {
        return {"needs_queue", "is seeded by positions in a queue: needs integrator=wavefront"};
    }
    if (!variant.compaction.reproducible_order) {
        return {"needs_reproducible_order",
                "needs a compaction that gives a path the same position in every run, not " +
                    std::string(variant.compaction.name)};
    }
    if (!variant.sorting.reproducible_order) {
        return {"needs_reproducible_order", "needs a sort that gives a path the same position in every run, not " +
                                                std::string(variant.sorting.name)};
    }
    return {};
}

const Registration registration(
    {
        .axis = "sampler",
        .name = "minstd_by_position",
        .summary = "the minstd of cis565, seeded by the path's position in the queue",
        .origin = "cis565 (two CIS 565 path tracers)",
        .claim = Claim::biased,
        .claim_note = "streams of one short generator overlap between pixels, samples and bounces; the film depends on "
                      "the order of the queue",
        .depends_on_order = true,
        .has_independent_samples = false,
        .traits = SamplerTraits{.is_by_position = true},
        .backends = on_every_backend,
        .unsupported_reason = unsupported_reason,
    },
    {.features = [] { return no_features | Feature::minstd; }});

}  // namespace
}  // namespace pt::sampler::minstd_by_position
