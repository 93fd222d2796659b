// Scenes for tests, in C++ or as the text of a scene file.
#pragma once

#include <string>

#include "harness/scene/scene.h"

namespace pt::test {

// A scene with a pinhole camera at the origin that looks along +z (y up, x to the left of the image: the camera's right
// is -x), one pixel of 90 degrees, no jitter, depth 1. Members are set directly; materials and objects are added.
struct SceneBuilder {
    Scene scene;

    SceneBuilder();

    SceneBuilder& camera(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up = {0, 1, 0});
    SceneBuilder& image(std::uint32_t width, std::uint32_t height, double fov_degrees, bool jitter);
    SceneBuilder& depth(std::uint32_t segments);
    SceneBuilder& environment(double radiance);
    // Sets an environment map of these texels, row by row from the top.
    SceneBuilder& environment_map(std::uint32_t width, std::uint32_t height, const std::vector<Vec3d>& texels,
                                  double rotation_degrees = 0);

    // These functions add a material each and return its index.
    std::uint32_t diffuse(const Vec3d& albedo, const Vec3d& emission = Vec3d(0.0));
    std::uint32_t mirror(const Vec3d& reflectance, const Vec3d& emission = Vec3d(0.0));
    std::uint32_t mix(const Vec3d& albedo, const Vec3d& reflectance, double mirror_probability,
                      const Vec3d& emission = Vec3d(0.0));
    std::uint32_t rough_conductor(const Vec3d& reflectance, double roughness, const Vec3d& emission = Vec3d(0.0),
                                  bool multiple_scattering = false);
    std::uint32_t principled(const Vec3d& base_colour, double metallic, double roughness, double transmission = 0,
                             double ior = 1.5, const Vec3d& emission = Vec3d(0.0));
    std::uint32_t emitter(const Vec3d& radiance);
    // Has the material show an image in place of its colour: texels from the bottom, row by row.
    void texture(std::uint32_t material, std::uint32_t width, std::uint32_t height, const std::vector<Vec3d>& texels);
    // Gives a material an image in place of its roughness.
    void roughness_texture(std::uint32_t material, std::uint32_t width, std::uint32_t height,
                           const std::vector<double>& texels);
    // Gives a material an image of normals in tangent space.
    void normal_map(std::uint32_t material, std::uint32_t width, std::uint32_t height, const std::vector<Vec3d>& texels,
                    double scale = 1);
    std::uint32_t dielectric(double ior, const Vec3d& sigma_a = Vec3d(0.0), const Vec3d& tint = Vec3d(1.0));
    std::uint32_t rough_dielectric(double ior, double roughness, const Vec3d& sigma_a = Vec3d(0.0),
                                   const Vec3d& tint = Vec3d(1.0));
    std::uint32_t subsurface(const Vec3d& sigma_s, const Vec3d& sigma_a = Vec3d(0.0), double g = 0, double ior = 1);

    // Each returns the object, which may be changed further until the next one is added.
    SceneObject& sphere(std::uint32_t material, const Vec3d& centre, double diameter);
    SceneObject& ellipsoid(std::uint32_t material, const Vec3d& centre, const Vec3d& scale,
                           const Vec3d& rotate_degrees = Vec3d(0.0));
    SceneObject& box(std::uint32_t material, const Vec3d& centre, const Vec3d& scale,
                     const Vec3d& rotate_degrees = Vec3d(0.0));
    SceneObject& quad(std::uint32_t material, const Vec3d& centre, double scale_x, double scale_z,
                      const Vec3d& rotate_degrees = Vec3d(0.0));
    SceneObject& mesh(std::uint32_t material, const std::shared_ptr<const SceneMesh>& mesh, const Vec3d& centre,
                      double scale, const Vec3d& rotate_degrees = Vec3d(0.0));
    SceneObject& mesh(std::uint32_t material, const std::string& generator, std::uint32_t size, const Vec3d& centre,
                      double scale, const Vec3d& rotate_degrees = Vec3d(0.0));
    // The six walls of the box [centre - half, centre + half], facing inwards.
    SceneBuilder& room(std::uint32_t material, const Vec3d& centre, const Vec3d& half);

private:
    std::uint32_t add(SceneMaterial material);
    SceneObject& add(Shape shape, std::uint32_t material, const Vec3d& translate, const Vec3d& scale,
                     const Vec3d& rotate_degrees);
};

// An upright square of two triangles, [-1/2, 1/2]^2 in the plane z = 0, facing +z, with coordinates from 0 to `most`.
std::shared_ptr<const SceneMesh> square_mesh(float most = 1);

// The scene with every length times `factor` (a power of two for bitwise comparisons), every coefficient per length
// divided by it.
Scene scaled(Scene scene, double factor);
// The scene with every emitted radiance times `factor`.
Scene brightened(Scene scene, double factor);

}  // namespace pt::test
