// A diffuse receiver under lights of known irradiance.
#pragma once

#include "stability/oracles/furnace.h"
#include "stability/oracles/irradiance.h"

namespace pt::stability {

inline constexpr double receiver_albedo = 0.75;

// A scene with a horizontal receiver at the origin, normal +y. The camera looks straight down at the origin from below
// the light, so that rounding errors of the point and the light are relative to their own distances.
inline SceneText receiver(const std::string& name, double camera_height) {
    SceneText scene(name);
    scene.camera({0, camera_height, 0}, {0, 0, 0}, {0, 0, 1}).depth(2);
    scene.quad(scene.diffuse(Vec3d(receiver_albedo)), {0, 0, 0}, 8, 8);
    return scene;
}

// The rendering of a lit receiver with a given number of path segments in all. `relative`: relative errors allowed.
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
