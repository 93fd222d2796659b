// The seeds' numbers: a short generator seeded by sample, bounce and the path's position in the queue
// (kernels/minstd.h). An exhibit: its streams overlap and are correlated, and a compaction changes which path gets
// which numbers.
#include "variants/registry.h"

namespace pt {
namespace {

// Only where positions are what they are in every run: not where threads race for them.
std::string unsupported_reason(FeatureSet, const Variant& variant) {
    if (variant["integrator"] != "wavefront") {
        return "is seeded by positions in a queue: needs integrator=wavefront";
    }
    for (const std::string_view racing : {"atomic_append", "block_scan_append", "gap_fill"}) {
        if (variant["compaction"] == racing) {
            return "needs a compaction that gives a path the same position in every run, not " + std::string(racing);
        }
    }
    return variant["sorting"] == "bucket" || variant["sorting"] == "per_material_queue"
               ? "needs a sort that gives a path the same position in every run, not " + variant["sorting"]
               : "";
}

const Registration registration(
    {
        .axis = "sampler",
        .name = "minstd_by_position",
        .summary = "the seeds' minstd, seeded by the path's position in the queue",
        .origin = "both seeds (CIS 565 path tracers)",
        .claim = Claim::biased,
        .claim_note = "streams of one short generator overlap between pixels, samples and bounces; the film depends on "
                      "the order of the queue",
        .depends_on_order = true,
        .has_independent_samples = false,
        .backends = on_every_backend,
        .unsupported_reason = unsupported_reason,
    },
    {.features = [] { return no_features | Feature::minstd; }});

}  // namespace
}  // namespace pt
