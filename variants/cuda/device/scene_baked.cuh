// The scene as constants in a kernel's own text, which the host writes in front of it (namespace baked); resolution,
// depth and seed stay parameters.
#pragma once

namespace pt::cuda {

inline constexpr bool bakes_scene = true;

// Points the view of a scene's array at words baked into the program. Meshes, whose arrays have addresses, do not.
template <class T>
__device__ inline void bake_array(View<T>& view, const unsigned* words) {
    view.data = reinterpret_cast<const T*>(words);
}
__device__ inline void bake_array(View<MeshInstance<Real>>&, const unsigned*) {}

template <class Scene>
__device__ inline void bake(Scene& scene) {
#define PT_BAKE(name, kind, word) bake_array(scene.name, baked::name);
#define PT_BAKE_ALL(name, kind, word) \
    scene.name = {reinterpret_cast<decltype(scene.name.data)>(baked::name), baked::word##_count};
    PT_OBJECT_ARRAYS(PT_BAKE)
    PT_TRACED_ARRAYS(PT_BAKE)
    PT_SHADING_ARRAYS(PT_BAKE)
    PT_SHARED_ARRAYS(PT_BAKE_ALL)
#undef PT_BAKE
#undef PT_BAKE_ALL
    scene.environment = *reinterpret_cast<const Vec3<Real>*>(baked::environment);
    scene.enclosure = *reinterpret_cast<const AxisAlignedEnclosure<Real>*>(baked::enclosure);
    const auto& camera = *reinterpret_cast<const Camera<Real>*>(baked::camera);
    scene.camera.right = camera.right;
    scene.camera.up = camera.up;
    scene.camera.forward = camera.forward;
    scene.camera.aperture_radius = camera.aperture_radius;
    scene.camera.focus_distance = camera.focus_distance;
    scene.camera.shutter_open = camera.shutter_open;
    scene.camera.shutter_length = camera.shutter_length;
    scene.camera.shutter_late = camera.shutter_late;
    scene.camera.jitter = camera.jitter;
    scene.camera.initial_medium = camera.initial_medium;
}
template <class Scene>
__device__ inline void place_traced_arrays(Scene&) {}

}  // namespace pt::cuda
