#include "variants/registry.h"

namespace pt::traversal::while_while {
namespace {

const Registration registration(
    {
        .axis = "traversal",
        .name = "while_while",
        .summary =
            "nodes until there is a leaf, then its triangles; with traversal_stack=local the accelerator's own loop",
        .origin = "Aila and Laine 2009",
        .baseline = on_every_backend,
        .traits = TraversalTraits{.is_accelerators_own = true},
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::traversal::while_while
