#include "variants/acceleration/reasons.h"
#include "variants/registry.h"

namespace pt::traversal::speculative {
namespace {

const Registration registration(
    {
        .axis = "traversal",
        .name = "speculative",
        .summary = "a leaf is put off while lanes of the warp have none yet",
        .origin = "Aila and Laine 2009",
        .backends = on_cuda,
        .unsupported_reason = needs_steps,
    },
    {});

}  // namespace
}  // namespace pt::traversal::speculative
