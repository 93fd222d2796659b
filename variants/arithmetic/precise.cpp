// nvcc's default: IEEE division and square root; the compiler contracts a multiplication and an addition where it
// likes, so two kernels of one formula may differ in the last bit, and a path that grazes an edge may go elsewhere.
#include "variants/registry.h"

namespace pt::arithmetic::precise {
namespace {

const Registration registration(
    {
        .axis = "arithmetic",
        .name = "precise",
        .summary = "nvcc's default: IEEE but for contraction to fused multiply-adds",
        .origin = "nvcc",
        .baseline = on_cuda,
        .claim = Claim::statistical,
        .claim_note = "same expectation as arithmetic=exact; its twin in exact arithmetic is compared bit for bit",
        .mean_of = "exact",
        .fp_relaxed = true,
        .backends = on_cuda,
    },
    {});

}  // namespace
}  // namespace pt::arithmetic::precise
