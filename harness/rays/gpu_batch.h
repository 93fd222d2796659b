// Ray batches on a GPU as the harness sees them; kernels in gpu_batch.cu. A build without a CUDA toolkit has these
// functions too (gpu_batch_without_cuda.cpp).
#pragma once

#include <memory>
#include <span>

#include "harness/rays/ray_batch.h"
#include "kernels/mesh_view.h"

namespace pt::rays {

// The accelerators that a GPU's batch kernels are compiled for.
std::vector<std::string> gpu_accelerators();
// Whether the GPU can bring a tree that it has built into this accelerator's format.
bool has_encoder_on_gpu(const std::string& accelerator);

// Copies the mesh and its tree. Throws what PT_CUDA_CHECK does.
std::unique_ptr<BatchTracer> make_gpu_tracer(const MeshView& mesh, const std::string& accelerator);

// The closest hit of each ray, by tests of every triangle on the GPU.
std::vector<Hit> brute_force_on_gpu(std::span<const Triangle<float>> triangles, const std::vector<Ray>& rays);

// Milliseconds by the GPU's events: from triangles in its memory to a binary tree there, and from that to a compressed
// wide one. Empty without triangles, and of builders that the GPU does not have.
struct DeviceBuild {
    std::vector<double> build_ms, encode_ms;
    bool same_every_time = true;  // the tree of the first and of the last build
};
DeviceBuild time_device_build(const std::string& builder, std::span<const Triangle<float>> triangles, int repetitions);

}  // namespace pt::rays
