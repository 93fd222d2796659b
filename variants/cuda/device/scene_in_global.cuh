// The scene's arrays in global memory, all of them where the parameter says.
#pragma once

namespace pt::cuda {

inline constexpr bool bakes_scene = false;

template <class Scene>
__device__ inline void bake(Scene&) {}
template <class Scene>
__device__ inline void place_traced_arrays(Scene&) {}

}  // namespace pt::cuda
