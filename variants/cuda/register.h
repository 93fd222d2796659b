// How a choice compiled by nvcc registers itself: the registry's own header pulls in the CPU side's Thrust, which must
// not meet the CUDA side's in one translation unit.
#pragma once

#include "variants/cuda/stages.h"
#include "variants/descriptor.h"

namespace pt::cuda {

struct Registration {
    Registration(const Descriptor& descriptor, const Hooks& hooks);
};

// Whether the variant's compaction leaves the paths in play in slots 0 to count - 1.
bool keeps_payload_contiguous(const Variant& variant);

}  // namespace pt::cuda
