// The sampler pcg4d: a cheap hash of pixel, sample, bounce and dimension for every four numbers, good for all tests.
#include "variants/registry.h"

namespace pt::sampler::pcg4d {
namespace {

const Registration registration(
    {
        .axis = "sampler",
        .name = "pcg4d",
        .summary = "numbers by one hash of pixel, sample, bounce and dimension",
        .origin = "Jarzynski and Olano 2020",
        .baseline = on_every_backend,
        .traits = SamplerTraits{.is_in_every_kernel = true},
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::sampler::pcg4d
