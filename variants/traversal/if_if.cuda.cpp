#include "variants/acceleration/reasons.h"
#include "variants/registry.h"

namespace pt::traversal::if_if {
namespace {

const Registration registration(
    {
        .axis = "traversal",
        .name = "if_if",
        .summary = "one loop, each turn a step through a node and a test of a triangle at most",
        .origin = "Aila and Laine 2009",
        .backends = on_cuda,
        .unsupported_reason = needs_steps,
    },
    {});

}  // namespace
}  // namespace pt::traversal::if_if
