// Replaces gpu_batch.cu in a build without a CUDA toolkit: every call that needs a GPU throws MachineError.
#include "harness/cuda/backend.h"
#include "harness/failure.h"
#include "harness/rays/gpu_batch.h"

namespace pt::rays {

std::vector<std::string> gpu_accelerators() { return {}; }
std::unique_ptr<BatchTracer> make_gpu_tracer(const MeshView&, const std::string&) {
    throw MachineError(cuda::not_available());
}
std::vector<Hit> brute_force_on_gpu(std::span<const Triangle<float>>, const std::vector<Ray>&) {
    throw MachineError(cuda::not_available());
}
bool has_encoder_on_gpu(const std::string&) { return false; }
DeviceBuild time_device_build(const std::string&, std::span<const Triangle<float>>, int) { return {}; }

}  // namespace pt::rays
