// Ray batches on a GPU, implemented by gpu_batch.cu or, without a CUDA toolkit, by gpu_batch_without_cuda.cpp.
#pragma once

#include <memory>
#include <span>

#include "harness/rays/ray_batch.h"
#include "kernels/mesh_view.h"

namespace pt::rays {

// Names of the accelerators for which batch kernels are compiled.
std::vector<std::string> gpu_accelerators();
// Whether the GPU can encode a tree that it has built in the node format of this accelerator.
bool has_encoder_on_gpu(const std::string& accelerator);

// Makes a tracer of ray batches on the GPU and copies the mesh and its tree there. Throws what PT_CUDA_CHECK throws.
std::unique_ptr<BatchTracer> make_gpu_tracer(const MeshView& mesh, const std::string& accelerator);

// Finds the closest hit of each ray on the GPU by testing every triangle.
std::vector<Hit> brute_force_on_gpu(std::span<const Triangle<float>> triangles, const std::vector<Ray>& rays);

// GPU build times in milliseconds, from CUDA events: from triangles in device memory to a binary tree, and from the
// binary tree to a compressed wide BVH. Empty without triangles, and for builders without a GPU implementation.
struct DeviceBuild {
    std::vector<double> build_ms, encode_ms;
    bool same_every_time = true;  // whether the tree of the last build equals that of the first build
};
DeviceBuild time_device_build(const std::string& builder, std::span<const Triangle<float>> triangles, int repetitions);

}  // namespace pt::rays
