// Keeps the geometry of meshes on the device from render to render: a study renders a scene hundreds of times, and
// copying a mesh takes longer than rendering it.
#pragma once

#include <utility>

#include "harness/cuda/device_arrays.h"
#include "harness/scene/mesh_search.h"

namespace pt::cuda {

// The arrays of one mesh in device memory, shared and freed with the last owner.
class DeviceMesh {
public:
    explicit DeviceMesh(const MeshGeometry& host);

    using Key = std::pair<const PlacedMesh*, const MeshTree*>;
    static Key key_of(const MeshGeometry& host) { return {host.placed.get(), host.tree.get()}; }
    // The mesh with its pointers leading to device memory, as kernels use it.
    const MeshView& view() const { return view_; }
    std::size_t bytes() const { return arrays_.bytes(); }

private:
    MeshGeometry host_;  // the host's mesh, kept so that its addresses, the cache key, stay unique
    MeshView view_;
    DeviceArrays arrays_;
};

// Returns the current device's copy of a mesh, and makes it, finished on return, if there is none. If all copies would
// exceed a quarter of the device's memory, the least recently used ones are dropped.
std::shared_ptr<const DeviceMesh> device_mesh(const MeshGeometry& host);

// The top-level tree of the axis `levels` over meshes in device memory, kept from render to render.
class DeviceTree {
public:
    explicit DeviceTree(const std::shared_ptr<const SceneTree>& host);

    using Key = const SceneTree*;
    static Key key_of(const std::shared_ptr<const SceneTree>& host) { return host.get(); }
    // The top-level tree with pointers to device memory.
    const ObjectTree& objects() const { return objects_; }
    const FlatTree& flat() const { return flat_; }
    std::size_t bytes() const { return arrays_.bytes(); }

private:
    std::shared_ptr<const SceneTree> host_;  // host's tree, kept so that its address, the cache key, stays unique
    ObjectTree objects_;
    FlatTree flat_;
    DeviceArrays arrays_;
};

// Returns the device's copy of a top-level tree, and makes it, finished on return, if there is none; null for null.
std::shared_ptr<const DeviceTree> device_tree(const std::shared_ptr<const SceneTree>& host);

}  // namespace pt::cuda
