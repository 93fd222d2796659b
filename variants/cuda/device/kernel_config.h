// What NVRTC compiles a program for. The host writes a KernelConfig into the program's text, as the constant
// `kernel_config` (text_of), and the kernels read it; shared by both sides.
#pragma once

#include "kernels/config.h"
#include "kernels/scene_arrays.h"

namespace pt::cuda {

inline constexpr std::uint32_t warp_size = 32;

// Numbers of a scene's objects, its walls (AxisAlignedEnclosure) and its one light, in a program that is compiled for
// scenes with the same numbers alone.
struct FixedCounts {
    static constexpr std::uint32_t none = 0xffffffffu;
#define PT_COUNT(name, kind, word) std::uint32_t name = 0;
    PT_OBJECT_ARRAYS(PT_COUNT)
#undef PT_COUNT
    std::uint32_t walls = 0, lamps = 0, open_sides = 0;
    std::uint32_t low_sides[3] = {0, 0, 0}, high_sides[3] = {0, 0, 0};
    std::uint32_t one_light = none;  // object that is the only light; none: no light, or several

    PT_HD constexpr std::uint32_t objects() const {
        std::uint32_t sum = 0;
#define PT_ADD(name, kind, word) sum += name;
        PT_OBJECT_ARRAYS(PT_ADD)
#undef PT_ADD
        return sum;
    }
};

struct KernelConfig {
    FeatureSet features = no_features;
    std::uint32_t block = 256;                // threads of a thread block
    std::uint32_t min_blocks = 0;             // blocks that a multiprocessor must hold at once; 0: no launch bound
    bool keeps_first_hits = false;            // whether there is a first-bounce cache
    std::uint32_t shading_fmas = 0;           // dependent multiply-adds injected as the cost of each material
    std::uint32_t constant_scene_bytes = 16;  // bytes of the scene's arrays in constant memory, if they are there
    bool has_fixed_counts = false;
    FixedCounts counts = {};
};

}  // namespace pt::cuda
