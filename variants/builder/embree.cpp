// The builder embree: Embree's builder for trees in the caller's format (rtcBuildBVH: binned surface area heuristic, of
// medium quality), two children a node and one primitive a leaf. Wald, Woop, Benthin, Johnson, Ernst, "Embree: A Kernel
// Framework for Efficient CPU Ray Tracing", SIGGRAPH 2014.
#include <new>

#include "variants/accelerator/embree_scene.h"
#include "variants/builder/pairing.h"
#include "variants/registry.h"

namespace pt::builder::embree {

namespace {

// A node as Embree builds it, in Embree's memory; a leaf has no children.
struct Node {
    Node* child[2] = {nullptr, nullptr};
    std::uint32_t primitive = 0;
};

void* make_node(RTCThreadLocalAllocator allocator, unsigned, void*) {
    return new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node;
}
void set_children(void* node, void** children, unsigned count, void*) {
    for (unsigned i = 0; i < count && i < 2; ++i) {
        static_cast<Node*>(node)->child[i] = static_cast<Node*>(children[i]);
    }
}
// Embree's callback with the boxes of a node's children. They are not needed, since `assemble` joins boxes itself.
void ignore_bounds(void*, const RTCBounds**, unsigned, void*) {}
void* make_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t, void*) {
    auto* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node;
    leaf->primitive = primitives[0].primID;
    return leaf;
}

std::vector<RTCBuildPrimitive> primitives_of(const PrimitiveBoxes& boxes) {
    std::vector<RTCBuildPrimitive> primitives(boxes.size());
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        const Box& box = boxes[i];
        primitives[i] = {box.low[0], box.low[1], box.low[2], 0, box.high[0], box.high[1], box.high[2], i};
    }
    return primitives;
}

// Numbers Embree's nodes depth first, so that where Embree's threads have put them does not matter.
class Numbering {
public:
    explicit Numbering(std::size_t primitives) : primitives_(static_cast<std::uint32_t>(primitives)) {}

    Pairing pairing_of(const Node* root) {
        pairing_.root = number_of(root);
        return std::move(pairing_);
    }

private:
    // The number of a leaf node is its place among the leaves; inner nodes are numbered after all leaves.
    std::uint32_t number_of(const Node* node) {
        if (node->child[0] == nullptr) {
            pairing_.leaf.push_back(node->primitive);
            return static_cast<std::uint32_t>(pairing_.leaf.size() - 1);
        }
        const std::uint32_t left = number_of(node->child[0]), right = number_of(node->child[1]);
        pairing_.left.push_back(left);
        pairing_.right.push_back(right);
        return primitives_ + static_cast<std::uint32_t>(pairing_.left.size() - 1);
    }

    std::uint32_t primitives_;
    Pairing pairing_;
};

struct ReleaseTree {
    void operator()(RTCBVH tree) const { rtcReleaseBVH(tree); }
};

BinaryTree build(const PrimitiveBoxes& boxes, std::uint32_t leaf_size = 4) {
    if (boxes.empty()) {
        return {};
    }
    const std::unique_ptr<std::remove_pointer_t<RTCBVH>, ReleaseTree> tree{rtcNewBVH(accelerator::embree::device())};
    std::vector<RTCBuildPrimitive> primitives = primitives_of(boxes);
    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.maxBranchingFactor = 2;
    arguments.maxDepth = 1024;
    arguments.sahBlockSize = 1;
    arguments.minLeafSize = arguments.maxLeafSize = 1;
    arguments.traversalCost = static_cast<float>(SahCosts{}.traversal);
    arguments.intersectionCost = static_cast<float>(SahCosts{}.intersection);
    arguments.bvh = tree.get();
    arguments.primitives = primitives.data();
    arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
    arguments.createNode = make_node;
    arguments.setNodeChildren = set_children;
    arguments.setNodeBounds = ignore_bounds;
    arguments.createLeaf = make_leaf;
    const auto* root = static_cast<const Node*>(rtcBuildBVH(&arguments));
    accelerator::embree::require_no_error("build a tree of boxes");
    return assemble(Numbering(boxes.size()).pairing_of(root), boxes, leaf_size, {});
}

const Registration registration(
    {
        .axis = "builder",
        .name = "embree",
        .summary = "Embree's own builder (rtcBuildBVH), binned surface area heuristic",
        .origin = "Wald et al. 2014",
        .backends = on_every_backend,
        .unsupported_reason = needs_tree,
    },
    {.builder = {[](const PrimitiveBoxes& boxes, std::span<const Triangle<float>>) { return build(boxes); }}});

}  // namespace

}  // namespace pt::builder::embree
