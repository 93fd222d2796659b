// A diffuse receiver under lights whose irradiance is known.
#pragma once

#include "stability/oracles/furnace.h"
#include "stability/oracles/irradiance.h"

namespace pt::stability {

inline constexpr double receiver_albedo = 0.75;

// The receiver's point is the origin, its normal +y. The camera stands straight above the point that it looks at,
// nearer than the light, so that the point and the light are where they should be to a rounding of their own distance.
inline SceneText receiver(const std::string& name, double camera_height) {
    SceneText scene(name);
    scene.camera({0, camera_height, 0}, {0, 0, 0}, {0, 0, 1}).depth(2);
    scene.quad(scene.diffuse(Vec3d(receiver_albedo)), {0, 0, 0}, 8, 8);
    return scene;
}

// The rendering of a lit receiver, by so many segments of paths. `relative`: the relative errors allowed.
inline std::vector<Rendering> lit(const SceneText& scene, double irradiance, const Tolerance& relative,
                                  double quick_segments = 1e6, double full_segments = 6e7) {
    const double exact = receiver_albedo * irradiance / pi<double>;
    return {{.scene = scene.json(),
             .quick_paths = paths_for(quick_segments, 2),
             .full_paths = paths_for(full_segments, 2),
             .quantities = {mean_is("radiance of the receiver", exact,
                                    Tolerance::relative(exact, relative.single, relative.fp64, relative.origin))}}};
}

}  // namespace pt::stability
