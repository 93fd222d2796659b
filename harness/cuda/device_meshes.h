// The geometry of meshes on the device, kept from render to render: a study renders one scene hundreds of times, and
// copying a mesh takes longer than rendering it.
#pragma once

#include <utility>

#include "harness/cuda/device_arrays.h"
#include "harness/scene/mesh_search.h"

namespace pt::cuda {

// One mesh's arrays in device memory, freed with the last who holds it.
class DeviceMesh {
public:
    explicit DeviceMesh(const MeshGeometry& host);

    using Key = std::pair<const PlacedMesh*, const MeshTree*>;
    static Key key_of(const MeshGeometry& host) { return {host.placed.get(), host.tree.get()}; }
    // The mesh with pointers to the device's memory.
    const MeshView& view() const { return view_; }
    std::size_t bytes() const { return arrays_.bytes(); }

private:
    MeshGeometry host_;  // kept, so that its addresses mean this mesh as long as the copy lives
    MeshView view_;
    DeviceArrays arrays_;
};

// The current device's copy of a mesh, made if there is none yet. What was used longest ago is let go where all
// together pass a quarter of the device's memory. Returns after the copy has been made.
std::shared_ptr<const DeviceMesh> device_mesh(const MeshGeometry& host);

// The tree of the axis `levels` over meshes in device memory, kept as the meshes are.
class DeviceTree {
public:
    explicit DeviceTree(const std::shared_ptr<const SceneTree>& host);

    using Key = const SceneTree*;
    static Key key_of(const std::shared_ptr<const SceneTree>& host) { return host.get(); }
    // The top-level tree with pointers to the device's memory.
    const ObjectTree& objects() const { return objects_; }
    const FlatTree& flat() const { return flat_; }
    std::size_t bytes() const { return arrays_.bytes(); }

private:
    std::shared_ptr<const SceneTree> host_;  // as a mesh's
    ObjectTree objects_;
    FlatTree flat_;
    DeviceArrays arrays_;
};

// The device's copy of a tree over meshes, made if there is none yet; null for null. Returns after the copy has been
// made.
std::shared_ptr<const DeviceTree> device_tree(const std::shared_ptr<const SceneTree>& host);

}  // namespace pt::cuda
