// How a choice compiled by nvcc registers itself: the registry's own header pulls in the CPU side's Thrust, which must
// not meet the CUDA side's in one translation unit.
#pragma once

#include "variants/cuda/stages.h"
#include "variants/descriptor.h"

namespace pt::cuda {

struct Registration {
    Registration(const Descriptor& descriptor, const Hooks& hooks);
};

}  // namespace pt::cuda
