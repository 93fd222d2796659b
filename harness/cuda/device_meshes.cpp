#include "harness/cuda/device_meshes.h"

#include <algorithm>
#include <list>

#include "variants/cuda/check.h"

namespace pt::cuda {

namespace {

// Calls visit(array of the host, array of the view, bytes) for each array of a mesh.
template <class Visit>
void for_each_array_of(const MeshView& host, MeshView& device, const Visit& visit) {
    visit(host.leaves, device.leaves, host.tree.slot_count * sizeof(LeafTriangle));
    visit(host.triangles, device.triangles, host.triangle_count * sizeof(Triangle<float>));
    visit(host.cumulative_area, device.cumulative_area, host.triangle_count * sizeof(float));
    visit(host.tree.nodes, device.tree.nodes, std::size_t{host.tree.node_count} * host.tree.node_bytes);
}

std::size_t on_border(std::size_t bytes) { return (bytes + 255) / 256 * 256; }

bool is_same(const MeshGeometry& a, const MeshGeometry& b) { return a.placed == b.placed && a.tree == b.tree; }

struct Kept {
    MeshGeometry host;
    std::shared_ptr<const DeviceMesh> mesh;
};

constexpr std::size_t most_trees = 3;

struct KeptTree {
    std::shared_ptr<const SceneTree> host;
    std::shared_ptr<const DeviceTree> tree;
};

std::size_t most_bytes() {
    std::size_t free = 0, total = 0;
    PT_CUDA_CHECK(cudaMemGetInfo(&free, &total));
    return total / 4;
}

}  // namespace

DeviceMesh::DeviceMesh(const MeshGeometry& host) : host_(host), view_(host.view()) {
    const MeshView source = host.view();
    for_each_array_of(source, view_, [&](const void*, const auto*&, std::size_t bytes) { bytes_ += on_border(bytes); });
    void* memory = nullptr;
    PT_CUDA_CHECK(cudaMalloc(&memory, std::max<std::size_t>(1, bytes_)));
    memory_ = static_cast<unsigned char*>(memory);
    std::size_t offset = 0;
    for_each_array_of(source, view_, [&](const void* from, const auto*& to, std::size_t bytes) {
        using Pointer = std::remove_cvref_t<decltype(to)>;
        to = bytes == 0 ? nullptr : reinterpret_cast<Pointer>(memory_ + offset);
        if (bytes != 0) {
            PT_CUDA_CHECK(cudaMemcpy(memory_ + offset, from, bytes, cudaMemcpyHostToDevice));
        }
        offset += on_border(bytes);
    });
}

DeviceMesh::~DeviceMesh() { (void)cudaFree(memory_); }

std::shared_ptr<const DeviceMesh> device_mesh(const MeshGeometry& host) {
    // Never destroyed: the driver may be gone when the process ends.
    static auto& kept = *new std::list<Kept>;
    static std::size_t bytes = 0;
    const auto known =
        std::find_if(kept.begin(), kept.end(), [&](const Kept& entry) { return is_same(entry.host, host); });
    if (known != kept.end()) {
        kept.splice(kept.begin(), kept, known);
        return kept.front().mesh;
    }
    const std::size_t most = most_bytes();
    const std::size_t expected = host.tree->bytes + host.placed->triangles.size() * (sizeof(Triangle<float>) + 4);
    while (!kept.empty() && bytes + expected > most) {
        bytes -= kept.back().mesh->bytes();
        kept.pop_back();
    }
    kept.push_front({host, std::make_shared<DeviceMesh>(host)});
    bytes += kept.front().mesh->bytes();
    return kept.front().mesh;
}

DeviceTree::DeviceTree(const SceneTree& host) : objects_(host.objects_view()), flat_(host.flat_view()) {
    const std::size_t node_bytes = host.nodes.size() * sizeof(ObjectNode);
    const std::size_t flat_bytes = host.flat.nodes.size() * sizeof(NodePiece);
    bytes_ = on_border(node_bytes) + on_border(flat_bytes) + on_border(host.slot_bytes());
    void* memory = nullptr;
    PT_CUDA_CHECK(cudaMalloc(&memory, std::max<std::size_t>(1, bytes_)));
    memory_ = static_cast<unsigned char*>(memory);
    std::size_t offset = 0;
    const auto put = [&](const auto*& array, std::size_t bytes) {
        using Pointer = std::remove_cvref_t<decltype(array)>;
        const void* const from = array;
        array = bytes == 0 ? nullptr : reinterpret_cast<Pointer>(memory_ + offset);
        if (bytes != 0) {
            PT_CUDA_CHECK(cudaMemcpy(memory_ + offset, from, bytes, cudaMemcpyHostToDevice));
        }
        offset += on_border(bytes);
    };
    put(objects_.nodes, node_bytes);
    put(flat_.tree.nodes, flat_bytes);
    put(flat_.slots, host.slot_bytes());
}

DeviceTree::~DeviceTree() { (void)cudaFree(memory_); }

std::shared_ptr<const DeviceTree> device_tree(const std::shared_ptr<const SceneTree>& host) {
    // Never destroyed: the driver may be gone when the process ends.
    static auto& kept = *new std::list<KeptTree>;
    if (host == nullptr) {
        return nullptr;
    }
    const auto known =
        std::find_if(kept.begin(), kept.end(), [&](const KeptTree& entry) { return entry.host == host; });
    if (known != kept.end()) {
        kept.splice(kept.begin(), kept, known);
        return kept.front().tree;
    }
    while (kept.size() >= most_trees) {
        kept.pop_back();
    }
    kept.push_front({host, std::make_shared<DeviceTree>(*host)});
    return kept.front().tree;
}

}  // namespace pt::cuda
