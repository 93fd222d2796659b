// The sampler sobol_owen: a pixel's samples fill the unit cube evenly, four dimensions at a time
// (kernels/samplers/sobol_owen.h).
#include "variants/registry.h"

namespace pt::sampler::sobol_owen {
namespace {

const Registration registration(
    {
        .axis = "sampler",
        .name = "sobol_owen",
        .summary = "Owen-scrambled Sobol' points, four dimensions at a time, shuffled between them",
        .origin = "Owen 1995; Burley 2020",
        .claim = Claim::statistical,
        .claim_note = "same expectation as sampler=pcg4d, from points that fill their cube evenly",
        .mean_of = "pcg4d",
        .has_independent_samples = false,
        .backends = on_every_backend,
    },
    {.features = [] { return no_features | Feature::sobol_owen; }});

}  // namespace
}  // namespace pt::sampler::sobol_owen
