// The sampler philox: ten rounds of a block cipher without secrets. References are made with it
// (kernels/samplers/philox.h).
#include "variants/registry.h"

namespace pt::sampler::philox {
namespace {

const Registration registration(
    {
        .axis = "sampler",
        .name = "philox",
        .summary = "Philox4x32-10, keyed by pixel, sample, bounce and dimension",
        .origin = "Salmon, Moraes, Dror and Shaw 2011",
        .claim = Claim::statistical,
        .claim_note = "same expectation as sampler=pcg4d, from other numbers",
        .mean_of = "pcg4d",
        .backends = on_every_backend,
    },
    {.features = [] { return no_features | Feature::philox; }});

}  // namespace
}  // namespace pt::sampler::philox
