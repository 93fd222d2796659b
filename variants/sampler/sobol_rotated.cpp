// The sampler sobol_rotated: Sobol' points shifted by an offset a pixel. Against sobol_owen it tells what Owen's
// scrambling is worth (kernels/samplers/sobol_rotated.h).
#include "variants/registry.h"

namespace pt::sampler::sobol_rotated {
namespace {

const Registration registration(
    {
        .axis = "sampler",
        .name = "sobol_rotated",
        .summary = "Sobol' points under a Cranley-Patterson rotation, four dimensions at a time",
        .origin = "Cranley and Patterson 1976",
        .claim = Claim::statistical,
        .claim_note = "same expectation as sampler=pcg4d, from points that fill their cube evenly",
        .mean_of = "pcg4d",
        .has_independent_samples = false,
        .backends = on_every_backend,
    },
    {.features = [] { return no_features | Feature::sobol_rotated; }});

}  // namespace
}  // namespace pt::sampler::sobol_rotated
