// The sampler pmj02: a pixel's samples fill the unit square evenly, two dimensions at a time (samplers/pmj02.h).
#include "variants/registry.h"

namespace pt::sampler::pmj02 {
namespace {

const Registration registration(
    {
        .axis = "sampler",
        .name = "pmj02",
        .summary = "progressive multi-jittered (0, 2) points, two dimensions at a time, shuffled between them",
        .origin = "Christensen, Kensler and Kilpatrick 2018",
        .claim = Claim::statistical,
        .claim_note = "same expectation as sampler=pcg4d, from points that fill their squares evenly",
        .mean_of = "pcg4d",
        .has_independent_samples = false,
        .backends = on_every_backend,
    },
    {.features = [] { return no_features | Feature::pmj02; }});

}  // namespace
}  // namespace pt::sampler::pmj02
