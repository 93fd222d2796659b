#include "variants/registry.h"

namespace pt::traversal_stack::local {
namespace {

const Registration registration(
    {
        .axis = "traversal_stack",
        .name = "local",
        .summary = "in the thread's local memory",
        .origin = "Aila and Laine 2009",
        .baseline = on_every_backend,
        .traits = TraversalStackTraits{.is_in_thread = true},
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::traversal_stack::local
