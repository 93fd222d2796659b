// How a choice that nvcc compiles registers itself: the registry's own header includes Thrust for the CPU, which must
// not meet Thrust for CUDA in one translation unit.
#pragma once

#include "variants/cuda/stages.h"
#include "variants/descriptor.h"

namespace pt::cuda {

struct Registration {
    Registration(const Descriptor& descriptor, const Hooks& hooks);
};

}  // namespace pt::cuda
