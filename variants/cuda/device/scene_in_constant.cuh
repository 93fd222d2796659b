// The scene's arrays in constant memory, if every ray reads them, and the others in global memory. All lanes of a warp
// read one element of the former at a time, and an instruction takes its operand from constant memory without a load.
#pragma once

extern "C" {
__constant__ alignas(16) unsigned char pt_scene[kernel_config.constant_scene_bytes];
}

namespace pt::cuda {

inline constexpr bool bakes_scene = false;

template <class Scene>
__device__ inline void bake(Scene&) {}

// Places an array where the host put it in constant memory (constant_scene): arrays begin at multiples of 16 bytes.
template <class T>
__device__ inline void place_array(View<T>& view, std::uint32_t& offset) {
    view.data = reinterpret_cast<const T*>(pt_scene + offset);
    offset += (static_cast<std::uint32_t>(sizeof(T)) * view.size + 15u) / 16u * 16u;
}

template <class Scene>
__device__ inline void place_traced_arrays(Scene& scene) {
    std::uint32_t offset = 0;
// The list of the scene's arrays expands to statements: with a visitor NVRTC gives some kernels other registers.
#define PT_PLACE(name, kind, word)                                                        \
    if constexpr (SceneArray{#name, ArrayKind::kind}.is_traced(kernel_config.features)) { \
        place_array(scene.name, offset);                                                  \
    }
    PT_SCENE_ARRAYS(PT_PLACE)
#undef PT_PLACE
}

}  // namespace pt::cuda
