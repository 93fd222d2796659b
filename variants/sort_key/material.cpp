#include "variants/registry.h"

namespace pt::sort_key::material {
namespace {

const Registration registration(
    {
        .axis = "sort_key",
        .name = "material",
        .summary = "the material that was hit; paths that left the scene last",
        .origin = "cis565",
        .baseline = on_every_backend,
        .traits = SortKeyTraits{.bits = 0, .has_material = true},
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::sort_key::material
