// A scene on the device: its arrays in global memory, arrays that every ray reads also in constant memory, and the
// parts compiled into the kernels' source.
#pragma once

#include "harness/cuda/device_meshes.h"
#include "kernels/adjoint.h"
#include "kernels/environment_map.h"
#include "kernels/scene_arrays.h"
#include "variants/cuda/runtime/arena.h"
#include "variants/cuda/runtime/module.h"

namespace pt::cuda {

// Limit on the bytes of a scene in constant memory, of which a module has 64 KiB; larger scenes stay in global memory.
inline constexpr std::uint32_t constant_bytes = 32768;
inline constexpr const char* scene_in_constant = "in_constant";

// Selects the file variants/cuda/scene_*.cuh through which a kernel with these features accesses the scene's arrays:
// the result is the part of the name after "scene_".
template <class Real>
std::string scene_place(const SceneView<Real>& scene, FeatureSet features, bool is_baked);
// Compiles object counts and the planes of a room (an enclosing box of the scene) in, unless the kernel is generic.
template <class Real>
void fix_counts(const SceneView<Real>& scene, KernelConfig& config);
// The source text of constant arrays with the scene's data for scene_baked.cuh, which the compiler can fold.
template <class Real>
std::string baked_text(const SceneView<Real>& scene);

template <class Real>
class DeviceScene {
public:
    // `host`: the scene in host memory, which must outlive this object. `meshes`: by object number, the object's mesh.
    // `features`: those compiled into the kernels. `tree`: the top-level tree over the meshes, or null.
    DeviceScene(const SceneView<Real>& host, const std::vector<MeshGeometry>& meshes,
                const std::shared_ptr<const SceneTree>& tree, FeatureSet features, bool is_baked);
    void reserve(Arena& arena);
    // Copies the scene to the device and waits for the copy.
    void upload(const Module& module, cudaStream_t stream) const;
    // The scene with its pointers leading to device memory, as kernels use it.
    const SceneView<Real>& view() const { return view_; }
    // Bytes of meshes and of the trees over them, which are outside the arena.
    std::size_t mesh_bytes() const;

private:
    bool has_normals() const { return contains(features_, Feature::shading_normals); }

    const SceneView<Real>& host_;
    FeatureSet features_;
    bool is_baked_;
    SceneView<Real> view_ = {};
    std::vector<std::shared_ptr<const DeviceMesh>> device_meshes_;
    std::shared_ptr<const DeviceTree> tree_;
    MeshSearch<Real> search_;                    // search trees of the meshes, by pointers to device memory
    EnvironmentMap<Real> environment_map_ = {};  // the environment map, by pointers to device memory
    AdjointCache<Real> adjoint_ = {};            // radiance estimates for roulette, by device pointers
    std::vector<MeshInstance<Real>> instances_;  // objects that show a mesh, by pointers to device memory
};

}  // namespace pt::cuda
