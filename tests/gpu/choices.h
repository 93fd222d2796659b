// The CUDA choices for tests that nvcc compiles: the registry's own header pulls in the CPU side's Thrust, which must
// not meet the CUDA side's in one translation unit.
#pragma once

#include "variants/cuda/stages.h"
#include "variants/descriptor.h"

namespace pt::test {

// Both throw std::runtime_error if the backend has no such choice.
const Descriptor& cuda_descriptor(std::string_view axis, std::string_view name);
const cuda::Hooks& cuda_hooks(std::string_view axis, std::string_view name);

}  // namespace pt::test
