// The choice precision=float: single precision throughout, but for the film's sums.
#include "variants/registry.h"

namespace pt::precision::float_ {
namespace {

const Registration registration(
    {
        .axis = "precision",
        .name = "float",
        .summary = "single precision; the film sums 64-bit integers",
        .origin = "the usual renderer",
        .baseline = on_every_backend,
        .traits = PrecisionTraits{.real_bytes = sizeof(float)},
        .backends = on_every_backend,
    },
    {.cuda = {.real = "float"}});

}  // namespace
}  // namespace pt::precision::float_
