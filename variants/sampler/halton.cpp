// The Halton sampler: one sequence for all dimensions of a path, a prime a dimension (kernels/samplers/halton.h).
#include "variants/registry.h"

namespace pt::sampler::halton {
namespace {

const Registration registration(
    {
        .axis = "sampler",
        .name = "halton",
        .summary = "Halton points with random linear digit scrambling, a prime a dimension up to the 15th surface hit",
        .origin = "Halton 1960; Matousek 1998",
        .claim = Claim::statistical,
        .claim_note = "same expectation as sampler=pcg4d, from points that fill every dimension evenly",
        .mean_of = "pcg4d",
        .has_independent_samples = false,
        .backends = on_every_backend,
    },
    {.features = [] { return no_features | Feature::halton; }});

}  // namespace
}  // namespace pt::sampler::halton
