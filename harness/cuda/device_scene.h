// A scene on the device: its arrays in global memory, those that every ray reads once more in constant memory, and what
// the text of its kernels holds of it.
#pragma once

#include "harness/cuda/device_meshes.h"
#include "kernels/adjoint.h"
#include "kernels/environment_map.h"
#include "kernels/scene_arrays.h"
#include "variants/cuda/runtime/arena.h"
#include "variants/cuda/runtime/module.h"

namespace pt::cuda {

// Most bytes of a scene in constant memory, of the 64 KiB that a module may have; larger scenes stay in global memory.
inline constexpr std::uint32_t constant_bytes = 32768;
inline constexpr const char* scene_in_constant = "in_constant";

// The name of the file variants/cuda/scene_*.cuh by which a kernel with these features finds the scene's arrays.
template <class Real>
std::string scene_place(const SceneView<Real>& scene, FeatureSet features, bool is_baked);
// The scene's numbers of objects and which of them are a room's walls, as constants where the kernel has the scene's
// features only.
template <class Real>
void fix_counts(const SceneView<Real>& scene, KernelConfig& config);
// The text of the arrays of words under which scene_baked.cuh finds the scene's numbers: constants that the compiler
// sees through.
template <class Real>
std::string baked_text(const SceneView<Real>& scene);

template <class Real>
class DeviceScene {
public:
    // `host` lives as long as this; `meshes`: of its objects, by number of the objects that show one; `features`: of
    // the kernels; `tree`: of all meshes together, or null.
    DeviceScene(const SceneView<Real>& host, const std::vector<MeshGeometry>& meshes,
                const std::shared_ptr<const SceneTree>& tree, FeatureSet features, bool is_baked);
    void reserve(Arena& arena);
    // Copies the scene to the device, and waits for it.
    void upload(const Module& module, cudaStream_t stream) const;
    // The scene with pointers to the device's memory.
    const SceneView<Real>& view() const { return view_; }
    // Bytes of meshes and of the trees over them, which are outside of the arena.
    std::size_t mesh_bytes() const;

private:
    bool has_normals() const { return contains(features_, Feature::shading_normals); }

    const SceneView<Real>& host_;
    FeatureSet features_;
    bool is_baked_;
    SceneView<Real> view_ = {};
    std::vector<std::shared_ptr<const DeviceMesh>> device_meshes_;
    std::shared_ptr<const DeviceTree> tree_;
    MeshSearch<Real> search_;                    // with pointers of the device
    EnvironmentMap<Real> environment_map_ = {};  // likewise
    AdjointCache<Real> adjoint_ = {};            // likewise
    std::vector<MeshInstance<Real>> instances_;  // with pointers of the device
};

}  // namespace pt::cuda
