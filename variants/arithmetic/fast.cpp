// Fast arithmetic: approximate division, square root and reciprocal, denormals flushed to zero, contraction. The
// guarantees for closed bodies and meshes are given up: an edge function that is flushed to zero has no sign, and the
// bounds on rounding that keep a path on its side of a surface do not cover approximate divisions.
#include "variants/registry.h"

namespace pt::arithmetic::fast {
namespace {

const Registration registration(
    {
        .axis = "arithmetic",
        .name = "fast",
        .summary =
            "--use_fast_math: approximate division and square root, denormals flushed to zero; a path may leave a "
            "closed body or mesh",
        .origin = "nvcc",
        .claim = Claim::statistical,
        .claim_note = "same expectation as arithmetic=exact; its twin in exact arithmetic is compared bit for bit",
        .mean_of = "exact",
        .fp_relaxed = true,
        .traits = ArithmeticTraits{.is_approximate = true},
        .backends = on_cuda,
    },
    {.cuda = {.options = {"--use_fast_math", "-DPT_FAST_MATH=1", "-DPT_APPROXIMATE=1"}}});

}  // namespace
}  // namespace pt::arithmetic::fast
