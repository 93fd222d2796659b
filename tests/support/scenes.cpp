#include "tests/support/scenes.h"

#include <algorithm>

#include "harness/scene/scene_mesh.h"

namespace pt::test {

SceneBuilder::SceneBuilder() {
    scene.name = "test";
    camera({0, 0, 0}, {0, 0, 1});
    image(1, 1, 90, false);
}

SceneBuilder& SceneBuilder::camera(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up) {
    scene.camera.eye = eye;
    scene.camera.look_at = look_at;
    scene.camera.up = up;
    return *this;
}

SceneBuilder& SceneBuilder::image(std::uint32_t width, std::uint32_t height, double fov_degrees, bool jitter) {
    scene.camera.width = width;
    scene.camera.height = height;
    scene.camera.vertical_fov_degrees = fov_degrees;
    scene.camera.jitter = jitter;
    return *this;
}

SceneBuilder& SceneBuilder::depth(std::uint32_t segments) {
    scene.max_depth = segments;
    return *this;
}

SceneBuilder& SceneBuilder::environment(double radiance) {
    scene.environment = Vec3d(radiance);
    return *this;
}

SceneBuilder& SceneBuilder::environment_map(std::uint32_t width, std::uint32_t height, const std::vector<Vec3d>& texels,
                                            double rotation_degrees) {
    auto environment = std::make_shared<SceneEnvironment>();
    environment->image = {width, height, {texels.begin(), texels.end()}};
    environment->rotation_degrees = rotation_degrees;
    scene.environment_map = std::move(environment);
    return *this;
}

std::uint32_t SceneBuilder::add(SceneMaterial material) {
    material.name = "m" + std::to_string(scene.materials.size());
    scene.materials.push_back(material);
    return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

std::uint32_t SceneBuilder::diffuse(const Vec3d& albedo, const Vec3d& emission) {
    SceneMaterial material;
    material.type = MaterialType::diffuse;
    material.albedo = albedo;
    material.emission = emission;
    return add(material);
}

std::uint32_t SceneBuilder::mirror(const Vec3d& reflectance, const Vec3d& emission) {
    SceneMaterial material;
    material.type = MaterialType::mirror;
    material.reflectance = reflectance;
    material.emission = emission;
    return add(material);
}

std::uint32_t SceneBuilder::mix(const Vec3d& albedo, const Vec3d& reflectance, double mirror_probability,
                                const Vec3d& emission) {
    SceneMaterial material;
    material.type = MaterialType::mix;
    material.albedo = albedo;
    material.reflectance = reflectance;
    material.mirror_probability = mirror_probability;
    material.emission = emission;
    return add(material);
}

std::uint32_t SceneBuilder::rough_conductor(const Vec3d& reflectance, double roughness, const Vec3d& emission,
                                            bool multiple_scattering) {
    SceneMaterial material;
    material.type = MaterialType::rough_conductor;
    material.reflectance = reflectance;
    material.roughness = roughness;
    material.multiple_scattering = multiple_scattering;
    material.emission = emission;
    return add(material);
}

std::uint32_t SceneBuilder::principled(const Vec3d& base_colour, double metallic, double roughness, double transmission,
                                       double ior, const Vec3d& emission) {
    SceneMaterial material;
    material.type = MaterialType::principled;
    material.albedo = base_colour;
    material.metallic = metallic;
    material.roughness = roughness;
    material.transmission = transmission;
    material.ior = ior;
    material.emission = emission;
    return add(material);
}

void SceneBuilder::texture(std::uint32_t index, std::uint32_t width, std::uint32_t height,
                           const std::vector<Vec3d>& texels) {
    SceneMaterial& material = scene.materials.at(index);
    auto texture = std::make_shared<SceneTexture>();
    texture->image = {width, height, {texels.begin(), texels.end()}};
    material.texture = texture;
    const bool is_metal = material.type == MaterialType::mirror || material.type == MaterialType::rough_conductor;
    Vec3d& most = is_metal ? material.reflectance : material.albedo;
    most = Vec3d(0.0);
    for (const Vec3d& texel : texels) {
        most = {std::max(most.x, texel.x), std::max(most.y, texel.y), std::max(most.z, texel.z)};
    }
}

void SceneBuilder::roughness_texture(std::uint32_t index, std::uint32_t width, std::uint32_t height,
                                     const std::vector<double>& texels) {
    SceneMaterial& material = scene.materials.at(index);
    auto texture = std::make_shared<SceneTexture>();
    texture->image = {width, height, {}};
    material.roughness = 0;
    for (const double texel : texels) {
        texture->image.texels.emplace_back(static_cast<float>(texel));
        material.roughness = std::max(material.roughness, texel);
    }
    material.roughness_texture = texture;
}

void SceneBuilder::normal_map(std::uint32_t index, std::uint32_t width, std::uint32_t height,
                              const std::vector<Vec3d>& texels, double scale) {
    auto texture = std::make_shared<SceneTexture>();
    texture->image = {width, height, {}};
    for (const Vec3d& texel : texels) {
        texture->image.texels.emplace_back(texel);
    }
    scene.materials.at(index).normal_texture = texture;
    scene.materials.at(index).normal_scale = scale;
}

std::uint32_t SceneBuilder::emitter(const Vec3d& radiance) {
    SceneMaterial material;
    material.type = MaterialType::emitter;
    material.emission = radiance;
    return add(material);
}

std::uint32_t SceneBuilder::dielectric(double ior, const Vec3d& sigma_a, const Vec3d& tint) {
    SceneMaterial material;
    material.type = MaterialType::dielectric;
    material.ior = ior;
    material.sigma_a = sigma_a;
    material.tint = tint;
    return add(material);
}

std::uint32_t SceneBuilder::rough_dielectric(double ior, double roughness, const Vec3d& sigma_a, const Vec3d& tint) {
    SceneMaterial material;
    material.type = MaterialType::rough_dielectric;
    material.ior = ior;
    material.roughness = roughness;
    material.sigma_a = sigma_a;
    material.tint = tint;
    return add(material);
}

std::uint32_t SceneBuilder::subsurface(const Vec3d& sigma_s, const Vec3d& sigma_a, double g, double ior) {
    SceneMaterial material;
    material.type = MaterialType::subsurface;
    material.ior = ior;
    material.sigma_s = sigma_s;
    material.sigma_a = sigma_a;
    material.g = g;
    return add(material);
}

SceneObject& SceneBuilder::add(Shape shape, std::uint32_t material, const Vec3d& translate, const Vec3d& scale,
                               const Vec3d& rotate_degrees) {
    SceneObject object;
    object.shape = shape;
    object.material = material;
    object.translate = translate;
    object.scale = scale;
    object.rotate_degrees = rotate_degrees;
    scene.objects.push_back(object);
    return scene.objects.back();
}

SceneObject& SceneBuilder::sphere(std::uint32_t material, const Vec3d& centre, double diameter) {
    return add(Shape::sphere, material, centre, Vec3d(diameter), Vec3d(0.0));
}

SceneObject& SceneBuilder::ellipsoid(std::uint32_t material, const Vec3d& centre, const Vec3d& scale,
                                     const Vec3d& rotate_degrees) {
    return add(Shape::sphere, material, centre, scale, rotate_degrees);
}

SceneObject& SceneBuilder::box(std::uint32_t material, const Vec3d& centre, const Vec3d& scale,
                               const Vec3d& rotate_degrees) {
    return add(Shape::box, material, centre, scale, rotate_degrees);
}

SceneObject& SceneBuilder::quad(std::uint32_t material, const Vec3d& centre, double scale_x, double scale_z,
                                const Vec3d& rotate_degrees) {
    return add(Shape::quad, material, centre, {scale_x, 1, scale_z}, rotate_degrees);
}

SceneObject& SceneBuilder::mesh(std::uint32_t material, const std::shared_ptr<const SceneMesh>& mesh,
                                const Vec3d& centre, double scale, const Vec3d& rotate_degrees) {
    SceneObject& object = add(Shape::mesh, material, centre, Vec3d(scale), rotate_degrees);
    const auto known = std::find(scene.meshes.begin(), scene.meshes.end(), mesh);
    object.mesh = static_cast<std::uint32_t>(known - scene.meshes.begin());
    if (known == scene.meshes.end()) {
        scene.meshes.push_back(mesh);
    }
    return object;
}

SceneObject& SceneBuilder::mesh(std::uint32_t material, const std::string& generator, std::uint32_t size,
                                const Vec3d& centre, double scale, const Vec3d& rotate_degrees) {
    return mesh(material, mesh_from_generator(generator, size), centre, scale, rotate_degrees);
}

SceneBuilder& SceneBuilder::room(std::uint32_t material, const Vec3d& centre, const Vec3d& half) {
    const Vec3d size = half * 2.0;
    quad(material, centre + Vec3d(0, -half.y, 0), size.x, size.z);               // faces +y
    quad(material, centre + Vec3d(0, half.y, 0), size.x, size.z, {180, 0, 0});   // faces -y
    quad(material, centre + Vec3d(0, 0, -half.z), size.x, size.y, {90, 0, 0});   // faces +z
    quad(material, centre + Vec3d(0, 0, half.z), size.x, size.y, {-90, 0, 0});   // faces -z
    quad(material, centre + Vec3d(-half.x, 0, 0), size.y, size.z, {0, 0, -90});  // faces +x
    quad(material, centre + Vec3d(half.x, 0, 0), size.y, size.z, {0, 0, 90});    // faces -x
    return *this;
}

std::shared_ptr<const SceneMesh> square_mesh(float most) {
    Mesh mesh;
    mesh.vertices = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.coordinates = {{{{0, 0}, {most, 0}, {most, most}}}, {{{0, 0}, {most, most}, {0, most}}}};
    return make_scene_mesh(mesh, "square");
}

Scene scaled(Scene scene, double factor) {
    scene.camera.eye *= factor;
    scene.camera.look_at *= factor;
    scene.camera.aperture_radius *= factor;
    scene.camera.focus_distance *= factor;
    for (SceneObject& object : scene.objects) {
        object.translate *= factor;
        object.scale *= factor;
        object.velocity *= factor;
    }
    for (SceneMaterial& material : scene.materials) {
        material.sigma_a /= factor;
        material.sigma_s /= factor;
    }
    return scene;
}

Scene brightened(Scene scene, double factor) {
    scene.environment *= factor;
    if (scene.environment_map != nullptr) {
        auto environment = std::make_shared<SceneEnvironment>(*scene.environment_map);
        for (Vec3<float>& texel : environment->image.texels) {
            texel *= static_cast<float>(factor);
        }
        scene.environment_map = std::move(environment);
    }
    for (SceneMaterial& material : scene.materials) {
        material.emission *= factor;
    }
    return scene;
}

}  // namespace pt::test
