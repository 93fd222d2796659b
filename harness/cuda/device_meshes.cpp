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

}  // namespace pt::cuda
