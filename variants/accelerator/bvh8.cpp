#include "variants/accelerator/bvh8.h"

#include "variants/bvh/wide_packets.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::accelerator::bvh8 {
namespace {

const Registration registration(
    {
        .axis = "accelerator",
        .name = "bvh8",
        .summary = "tree of eight children a node, 256-byte nodes, the nearest child first",
        .origin = "Wald, Boulos and Benthin 2008",
        .traits = AcceleratorTraits{.has_steps = true},
        .backends = on_every_backend,
        .unsupported_reason = needs_meshes,
    },
    {.accelerator = lanes::accelerator_hook<8, Traversal>(encode)});

}  // namespace
}  // namespace pt::accelerator::bvh8
