#include "variants/accelerator/bvh2.h"

#include "variants/bvh/binary_nodes.h"
#include "variants/bvh/encoding.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::accelerator::bvh2 {

EncodedTree encode(const BinaryTree& tree) {
    require_encodable(tree, stack_size);
    const auto link_of = [](const BinaryTree::Node& leaf) { return leaf_link(leaf.first, leaf.count); };
    return encoded(binary_nodes<Node>(tree, link_of), tree.references);
}

namespace {

const Registration registration(
    {
        .axis = "accelerator",
        .name = "bvh2",
        .summary = "binary tree, 64-byte nodes with both children's boxes",
        .origin = "Aila and Laine 2009",
        .traits = AcceleratorTraits{.checks_large_scenes = true, .has_steps = true},
        .backends = on_every_backend,
        .unsupported_reason = needs_meshes,
    },
    {.accelerator = accelerator_hook<Traversal>(encode)});

}  // namespace

}  // namespace pt::accelerator::bvh2
