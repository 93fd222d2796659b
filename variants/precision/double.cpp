// Double precision throughout; random numbers have 32 bits instead of 24.
#include "variants/registry.h"

namespace pt {
namespace {

const Registration registration(
    {
        .axis = "precision",
        .name = "double",
        .summary = "double precision throughout",
        .origin = "the usual check on single precision",
        .claim = Claim::statistical,
        .claim_note = "same expectation as precision=float, up to rounding",
        .mean_of = "float",
        .backends = on_cuda,
    },
    {.cuda = {.real = "double", .real_bytes = 8}});

}  // namespace
}  // namespace pt
