// The choice russian_roulette=throughput: a path of low throughput is likely to be ended; one that goes on carries more
// instead (kernels/russian_roulette.h).
#include "variants/registry.h"

namespace pt::russian_roulette::throughput {
namespace {

constexpr Tunable tunables[] = {
    {"roulette_start", 3, 1, 1024, 1, "the first segment at whose end a path is put to the choice", true},
};

const Registration registration(
    {
        .axis = "russian_roulette",
        .name = "throughput",
        .summary = "a path goes on with the probability that its largest throughput names",
        .origin = "Arvo and Kirk 1990",
        .claim = Claim::statistical,
        .claim_note = "same expectation as russian_roulette=off: what goes on is divided by its probability",
        .mean_of = "off",
        .backends = on_every_backend,
        .tunables = tunables,
    },
    {.features = [] { return no_features | Feature::russian_roulette; }});

}  // namespace
}  // namespace pt::russian_roulette::throughput
