// A tree over the objects, whose leaves are the objects' own trees: instances share those, so memory grows with what is
// different, and rays are transformed once an object. Built by sah_binned, whichever builder the objects' trees have.
#include "variants/acceleration/box.h"
#include "variants/acceleration/encoding.h"
#include "variants/acceleration/reasons.h"
#include "variants/builder/sah_binned.h"
#include "variants/registry.h"

namespace pt::levels::two_level {
namespace {

static_assert(ObjectTree::most_levels >= max_tree_depth);

void set_child(ObjectNode& node, int child, const Box& box, std::uint32_t link) {
    node.low_x[child] = box.low[0];
    node.low_y[child] = box.low[1];
    node.low_z[child] = box.low[2];
    node.high_x[child] = box.high[0];
    node.high_y[child] = box.high[1];
    node.high_z[child] = box.high[2];
    node.link[child] = link;
}

// Inner nodes in the binary tree's order, so the root stays first.
std::vector<ObjectNode> build(const PrimitiveBoxes& boxes) {
    const BinaryTree tree = builder::sah_binned::build(boxes, 1);
    std::vector<ObjectNode> nodes;
    if (tree.nodes.empty()) {
        return nodes;
    }
    std::vector<std::uint32_t> links(tree.nodes.size());
    std::uint32_t inner = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const BinaryTree::Node& node = tree.nodes[i];
        require_at_most(node.count, 1, "objects in a leaf");
        links[i] = node.is_leaf() ? ObjectNode::leaf_bit | tree.references[node.first] : inner++;
    }
    for (const BinaryTree::Node& node : tree.nodes) {
        if (!node.is_leaf()) {
            nodes.push_back({});
            for (const std::uint32_t child : {0u, 1u}) {
                set_child(nodes.back(), static_cast<int>(child), tree.nodes[node.first + child].box,
                          links[node.first + child]);
            }
        }
    }
    // One object: the second child's empty box is entered by none but a ray of NaNs, which must come to an end too.
    if (nodes.empty()) {
        nodes.push_back({});
        set_child(nodes[0], 0, tree.nodes[0].box, links[0]);
        set_child(nodes[0], 1, Box{}, links[0]);
    }
    return nodes;
}

template <class Real>
void meet(Hit<Real>& best, const SceneView<Real>& scene, const Ray<Real>& ray) {
    closest_by_object_tree<SearchConfig<RunTimeAccelerator, Real>>(best, scene, scene.meshes, ray);
}

constexpr Descriptor descriptor_on(BackendSet backends) {
    return {
        .axis = "levels",
        .name = "two_level",
        .summary = "a binary tree over the objects, then the object's own",
        .origin = "Rubin and Whitted 1980",
        .backends = backends,
        .unsupported_reason = needs_search,
    };
}

const Registration on_the_cpu(descriptor_on(on_cpu), {.levels = {&build, &meet<float>, &meet<double>, false}});
const Registration on_the_gpu(descriptor_on(on_cuda), {.features = [] { return no_features | Feature::object_tree; },
                                                       .levels = {&build, nullptr, nullptr, false}});

}  // namespace
}  // namespace pt::levels::two_level
