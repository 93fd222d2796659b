// Precise arithmetic, nvcc's default: IEEE division and square root, but where random directions are drawn and spheres
// are intersected. The compiler contracts multiplications and additions as it likes, so two kernels of one formula may
// differ in the last bit, and a path that grazes an edge may go elsewhere. The triangle test and what takes rays to it,
// on which closed meshes rest, round alike in every arithmetic (rounded_product in kernels/math.h).
#include "variants/registry.h"

namespace pt::arithmetic::precise {
namespace {

const Registration registration(
    {
        .axis = "arithmetic",
        .name = "precise",
        .summary = "nvcc's default: IEEE but for contraction to fused multiply-adds; drawn directions and spheres "
                   "approximately",
        .origin = "nvcc",
        .baseline = on_cuda,
        .claim = Claim::statistical,
        .claim_note = "same expectation as arithmetic=exact; its twin in exact arithmetic is compared bit for bit",
        .mean_of = "exact",
        .fp_relaxed = true,
        .backends = on_cuda,
    },
    // PT_APPROXIMATE has kernels approximate where an error of a few units in the last place moves a sample, or a point
    // along its ray, and nothing else (kernels/in_range.h).
    {.cuda = {.options = {"-DPT_APPROXIMATE=1"}}});

}  // namespace
}  // namespace pt::arithmetic::precise
