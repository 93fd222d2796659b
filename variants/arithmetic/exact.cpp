// Exact arithmetic: every rounding as the source says, by IEEE division and square root and no contraction. Kernels
// that call the same stages agree bit for bit, on a GPU and on a CPU.
#include "variants/registry.h"

namespace pt::arithmetic::exact {
namespace {

const Registration registration(
    {
        .axis = "arithmetic",
        .name = "exact",
        .summary = "IEEE, no contraction (--fmad=false, -ffp-contract=off)",
        .origin = "IEEE 754",
        .baseline = on_cpu,
        .reference = on_every_backend,
        .backends = on_every_backend,
    },
    {.cuda = {.options = {"--fmad=false"}}});

}  // namespace
}  // namespace pt::arithmetic::exact
