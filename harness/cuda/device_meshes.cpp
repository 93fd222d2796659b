#include "harness/cuda/device_meshes.h"

#include <map>

#include "harness/cuda/kept_copies.h"
#include "variants/cuda/runtime/on_device.h"

namespace pt::cuda {

namespace {

constexpr std::size_t most_trees = 3;

std::size_t most_bytes() {
    std::size_t free = 0, total = 0;
    PT_CUDA_CHECK(cudaMemGetInfo(&free, &total));
    return total / 4;
}

}  // namespace

DeviceMesh::DeviceMesh(const MeshGeometry& host)
    : host_(host),
      view_(host.view()),
      arrays_(host_array(view_.leaves, view_.tree.slot_count * sizeof(LeafTriangle)),
              host_array(view_.triangles, view_.triangle_count * sizeof(Triangle<float>)),
              host_array(view_.cumulative_area, view_.triangle_count * sizeof(float)),
              host_array(view_.tree.nodes, std::size_t{view_.tree.node_count} * view_.tree.node_bytes)) {}

std::shared_ptr<const DeviceMesh> device_mesh(const MeshGeometry& host) {
    // The copies of meshes are never destroyed, since the driver may be gone when the process exits.
    static auto& kept_by_device = *new std::map<int, KeptCopies<DeviceMesh>>;
    KeptCopies<DeviceMesh>& kept = kept_by_device[current_device()];
    if (const auto known = kept.find(host)) {
        return known;
    }
    const std::size_t most = most_bytes();
    const std::size_t expected = host.tree->bytes + host.placed->triangles.size() * (sizeof(Triangle<float>) + 4);
    while (kept.size() > 0 && kept.bytes() + expected > most) {
        kept.drop_oldest();
    }
    return kept.make(host);
}

DeviceTree::DeviceTree(const std::shared_ptr<const SceneTree>& host)
    : host_(host),
      objects_(host->objects_view()),
      flat_(host->flat_view()),
      arrays_(host_array(objects_.nodes, host->nodes.size() * sizeof(ObjectNode)),
              host_array(flat_.tree.nodes, host->flat.nodes.size() * sizeof(NodePiece)),
              host_array(flat_.slots, host->slot_bytes())) {}

std::shared_ptr<const DeviceTree> device_tree(const std::shared_ptr<const SceneTree>& host) {
    // The copies of trees are never destroyed, since the driver may be gone when the process exits.
    static auto& kept_by_device = *new std::map<int, KeptCopies<DeviceTree>>;
    KeptCopies<DeviceTree>& kept = kept_by_device[current_device()];
    if (host == nullptr) {
        return nullptr;
    }
    if (const auto known = kept.find(host)) {
        return known;
    }
    while (kept.size() >= most_trees) {
        kept.drop_oldest();
    }
    return kept.make(host);
}

}  // namespace pt::cuda
