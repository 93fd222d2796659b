// Builds the content of scene files for stability cases, so that cases go through the parser of users' scene files and
// can be written to disk (`ptbench stability --write-scenes`).
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "harness/mesh/mesh.h"
#include "harness/scene/scene.h"

namespace pt::stability {

using Json = nlohmann::ordered_json;

inline Json list(const Vec3d& v) { return {v.x, v.y, v.z}; }

// A scene builder. The initial scene has one pixel of 90 degrees at the origin that looks along +z without jitter,
// depth 1 and a black environment.
class SceneText {
public:
    explicit SceneText(const std::string& name, const std::string& description = "");

    SceneText& camera(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up = {0, 1, 0});
    SceneText& image(std::uint32_t width, std::uint32_t height, double vertical_fov_degrees, bool jitter);
    SceneText& depth(std::uint32_t segments);
    SceneText& environment(double radiance);
    SceneText& drawn_environment(double radiance);  // an environment that next-event estimation samples
    SceneText& lens(double aperture_radius, double focus_distance);
    SceneText& shutter(double open, double close, bool late);

    // Functions that add a material of their name to the scene and return the new material's name.
    std::string diffuse(const Vec3d& albedo, const Vec3d& emission = Vec3d(0.0));
    std::string mirror(const Vec3d& reflectance, const Vec3d& emission = Vec3d(0.0));
    std::string mix(const Vec3d& albedo, const Vec3d& reflectance, double mirror_probability,
                    const Vec3d& emission = Vec3d(0.0));
    std::string emitter(const Vec3d& radiance);
    std::string dielectric(double ior, const Vec3d& sigma_a = Vec3d(0.0), const Vec3d& tint = Vec3d(1.0));
    std::string subsurface(const Vec3d& sigma_s, const Vec3d& sigma_a = Vec3d(0.0), double g = 0, double ior = 1,
                           std::uint32_t max_scatterings = 1000000);
    std::string rough_conductor(const Vec3d& reflectance, double roughness, bool multiple_scattering);
    std::string principled_metal(const Vec3d& base_colour, double roughness);

    // Functions that add an object of their name to the scene.
    SceneText& sphere(const std::string& material, const Vec3d& centre, double diameter);
    SceneText& ellipsoid(const std::string& material, const Vec3d& centre, const Vec3d& scale,
                         const Vec3d& rotate_degrees = Vec3d(0.0));
    SceneText& box(const std::string& material, const Vec3d& centre, const Vec3d& scale,
                   const Vec3d& rotate_degrees = Vec3d(0.0));
    SceneText& quad(const std::string& material, const Vec3d& centre, double scale_x, double scale_z,
                    const Vec3d& rotate_degrees = Vec3d(0.0));
    // Adds the six walls of the box [centre - half, centre + half], as quads that face inwards.
    SceneText& room(const std::string& material, const Vec3d& centre, const Vec3d& half);
    SceneText& mesh(const std::string& material, const Mesh& mesh, const Vec3d& translate = Vec3d(0.0),
                    const Vec3d& scale = Vec3d(1.0), const Vec3d& rotate_degrees = Vec3d(0.0));
    // Sets the velocity, in scene units per second, of the object added last.
    SceneText& velocity(const Vec3d& velocity);

    const Json& json() const { return json_; }

private:
    std::string add_material(Json material);
    SceneText& add_object(const std::string& shape, const std::string& material, const Vec3d& translate,
                          const Json& scale, const Vec3d& rotate_degrees);

    Json json_;
};

// Returns the scene with all lengths multiplied by `factor` and all coefficients per length divided by it.
Json scaled(Json scene, double factor);
// Returns the scene with all radiances multiplied by `factor`.
Json brightened(Json scene, double factor);
// Returns the scene with camera and objects moved by `offset`.
Json moved(Json scene, const Vec3d& offset);

}  // namespace pt::stability
