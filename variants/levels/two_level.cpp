// The choice levels=two_level: a tree over the objects, whose leaves are the objects' own trees. Instances share those,
// so memory grows with what is different, and rays are transformed once an object. The tree over objects is built by
// sah_binned, whichever builder the objects' trees have.
#include "variants/builder/sah_binned.h"
#include "variants/bvh/binary_nodes.h"
#include "variants/bvh/encoding.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::levels::two_level {
namespace {

static_assert(ObjectTree::most_levels >= max_tree_depth);

std::vector<ObjectNode> build(const PrimitiveBoxes& boxes) {
    const BinaryTree tree = builder::sah_binned::build(boxes, 1);
    return binary_nodes<ObjectNode>(tree, [&](const BinaryTree::Node& leaf) {
        require_at_most(leaf.count, 1, "objects in a leaf");
        return ObjectNode::leaf_bit | tree.references[leaf.first];
    });
}

template <class Real>
void meet(Hit<Real>& best, const SceneView<Real>& scene, const Ray<Real>& ray, Real enough) {
    closest_by_object_tree<SearchConfig<RunTimeAccelerator, Real>>(best, scene, scene.meshes, ray,
                                                                   NearerThan<Real>{enough});
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
