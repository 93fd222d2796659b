// A scene on the device: its arrays in global memory, those that every ray reads once more in constant memory, and what
// the text of its kernels holds of it.
#pragma once

#include "kernels/scene_arrays.h"
#include "variants/cuda/arena.h"
#include "variants/cuda/module.h"

namespace pt::cuda {

// The scene's numbers of objects and which of them are a room's walls, as constants where the kernel has the scene's
// features only.
template <class Real>
std::vector<std::string> scene_defines(const SceneView<Real>& scene, FeatureSet features);
// Arrays of words under which device.cuh finds the scene's numbers: constants that the compiler sees through.
template <class Real>
std::string baked_text(const SceneView<Real>& scene);

template <class Real>
class DeviceScene {
public:
    // `host` lives as long as this; `features`: of the kernels.
    DeviceScene(const SceneView<Real>& host, FeatureSet features, bool is_baked)
        : host_(host), features_(features), is_baked_(is_baked) {}
    DeviceScene(const DeviceScene&) = delete;  // who launches holds the address of its view
    DeviceScene& operator=(const DeviceScene&) = delete;

    void reserve(Arena& arena);
    // Waits for the device.
    void upload(const Module& module, cudaStream_t stream) const;
    // A SceneView with pointers of the device.
    ParameterBytes parameter() const { return {&view_}; }

private:
    const SceneView<Real>& host_;
    FeatureSet features_;
    bool is_baked_;
    SceneView<Real> view_ = {};
};

}  // namespace pt::cuda
