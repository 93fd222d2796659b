#include "harness/stability/scene_text.h"

#include <utility>

namespace pt::stability {

namespace {

void add_emission(Json& material, const Vec3d& emission) {
    if (!is_black(emission)) {
        material["emission"] = list(emission);
    }
}

void multiply(Json& value, double factor) {
    if (value.is_array()) {
        for (Json& entry : value) {
            multiply(entry, factor);
        }
    } else {
        value = value.get<double>() * factor;
    }
}

void multiply_member(Json& object, const char* key, double factor) {
    if (object.contains(key)) {
        multiply(object[key], factor);
    }
}

void shift(Json& point, const Vec3d& offset) {
    for (int i = 0; i < 3; ++i) {
        point[static_cast<std::size_t>(i)] = point[static_cast<std::size_t>(i)].get<double>() + offset[i];
    }
}

}  // namespace

SceneText::SceneText(const std::string& name, const std::string& description) {
    json_["name"] = name;
    if (!description.empty()) {
        json_["description"] = description;
    }
    json_["max_depth"] = 1;
    json_["camera"] = {{"eye", list({0, 0, 0})},       {"look_at", list({0, 0, 1})}, {"up", list({0, 1, 0})},
                       {"vertical_fov_degrees", 90.0}, {"resolution", {1, 1}},       {"jitter", false}};
    json_["materials"] = Json::object();
    json_["objects"] = Json::array();
}

SceneText& SceneText::camera(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up) {
    json_["camera"]["eye"] = list(eye);
    json_["camera"]["look_at"] = list(look_at);
    json_["camera"]["up"] = list(up);
    return *this;
}

SceneText& SceneText::image(std::uint32_t width, std::uint32_t height, double vertical_fov_degrees, bool jitter) {
    json_["camera"]["resolution"] = {width, height};
    json_["camera"]["vertical_fov_degrees"] = vertical_fov_degrees;
    json_["camera"]["jitter"] = jitter;
    return *this;
}

SceneText& SceneText::depth(std::uint32_t segments) {
    json_["max_depth"] = segments;
    return *this;
}

SceneText& SceneText::environment(double radiance) {
    json_["environment"] = list(Vec3d(radiance));
    return *this;
}

SceneText& SceneText::drawn_environment(double radiance) {
    json_["environment"] = {{"radiance", list(Vec3d(radiance))}};
    return *this;
}

SceneText& SceneText::lens(double aperture_radius, double focus_distance) {
    json_["camera"]["aperture_radius"] = aperture_radius;
    json_["camera"]["focus_distance"] = focus_distance;
    return *this;
}

SceneText& SceneText::shutter(double open, double close, bool late) {
    json_["camera"]["shutter"] = {{"open", open}, {"close", close}, {"density", late ? "late" : "uniform"}};
    return *this;
}

std::string SceneText::add_material(Json material) {
    auto& materials = json_["materials"].get_ref<Json::object_t&>();
    std::string name = material["type"].get<std::string>() + "_" + std::to_string(materials.size());
    // A material's name is new, so the material is appended to the vector that underlies the JSON object: a look-up of
    // each of 10^5 names would take seconds in all.
    static_cast<Json::object_t::Container&>(materials).emplace_back(name, std::move(material));
    return name;
}

std::string SceneText::diffuse(const Vec3d& albedo, const Vec3d& emission) {
    Json material{{"type", "diffuse"}, {"albedo", list(albedo)}};
    add_emission(material, emission);
    return add_material(std::move(material));
}

std::string SceneText::mirror(const Vec3d& reflectance, const Vec3d& emission) {
    Json material{{"type", "mirror"}, {"reflectance", list(reflectance)}};
    add_emission(material, emission);
    return add_material(std::move(material));
}

std::string SceneText::mix(const Vec3d& albedo, const Vec3d& reflectance, double mirror_probability,
                           const Vec3d& emission) {
    Json material{{"type", "mix"},
                  {"albedo", list(albedo)},
                  {"reflectance", list(reflectance)},
                  {"mirror_probability", mirror_probability}};
    add_emission(material, emission);
    return add_material(std::move(material));
}

std::string SceneText::emitter(const Vec3d& radiance) {
    return add_material({{"type", "emitter"}, {"radiance", list(radiance)}});
}

std::string SceneText::dielectric(double ior, const Vec3d& sigma_a, const Vec3d& tint) {
    return add_material({{"type", "dielectric"}, {"ior", ior}, {"tint", list(tint)}, {"sigma_a", list(sigma_a)}});
}

std::string SceneText::rough_conductor(const Vec3d& reflectance, double roughness, bool multiple_scattering) {
    return add_material({{"type", "rough_conductor"},
                         {"reflectance", list(reflectance)},
                         {"roughness", roughness},
                         {"multiple_scattering", multiple_scattering}});
}

std::string SceneText::principled_metal(const Vec3d& base_colour, double roughness) {
    return add_material(
        {{"type", "principled"}, {"base_colour", list(base_colour)}, {"metallic", 1.0}, {"roughness", roughness}});
}

std::string SceneText::subsurface(const Vec3d& sigma_s, const Vec3d& sigma_a, double g, double ior,
                                  std::uint32_t max_scatterings) {
    return add_material({{"type", "subsurface"},
                         {"ior", ior},
                         {"sigma_a", list(sigma_a)},
                         {"sigma_s", list(sigma_s)},
                         {"g", g},
                         {"max_scatterings", max_scatterings}});
}

SceneText& SceneText::add_object(const std::string& shape, const std::string& material, const Vec3d& translate,
                                 const Json& scale, const Vec3d& rotate_degrees) {
    Json object{{"shape", shape}, {"material", material}, {"translate", list(translate)}, {"scale", scale}};
    if (!is_black(rotate_degrees)) {
        object["rotate_degrees"] = list(rotate_degrees);
    }
    json_["objects"].push_back(std::move(object));
    return *this;
}

SceneText& SceneText::sphere(const std::string& material, const Vec3d& centre, double diameter) {
    return add_object("sphere", material, centre, diameter, Vec3d(0.0));
}

SceneText& SceneText::ellipsoid(const std::string& material, const Vec3d& centre, const Vec3d& scale,
                                const Vec3d& rotate_degrees) {
    return add_object("sphere", material, centre, list(scale), rotate_degrees);
}

SceneText& SceneText::box(const std::string& material, const Vec3d& centre, const Vec3d& scale,
                          const Vec3d& rotate_degrees) {
    return add_object("box", material, centre, list(scale), rotate_degrees);
}

SceneText& SceneText::quad(const std::string& material, const Vec3d& centre, double scale_x, double scale_z,
                           const Vec3d& rotate_degrees) {
    return add_object("quad", material, centre, list({scale_x, 1, scale_z}), rotate_degrees);
}

SceneText& SceneText::room(const std::string& material, const Vec3d& centre, const Vec3d& half) {
    quad(material, centre - Vec3d(0, half.y, 0), 2 * half.x, 2 * half.z);
    quad(material, centre + Vec3d(0, half.y, 0), 2 * half.x, 2 * half.z, {180, 0, 0});
    quad(material, centre - Vec3d(0, 0, half.z), 2 * half.x, 2 * half.y, {90, 0, 0});
    quad(material, centre + Vec3d(0, 0, half.z), 2 * half.x, 2 * half.y, {270, 0, 0});
    quad(material, centre - Vec3d(half.x, 0, 0), 2 * half.y, 2 * half.z, {0, 0, 270});
    return quad(material, centre + Vec3d(half.x, 0, 0), 2 * half.y, 2 * half.z, {0, 0, 90});
}

SceneText& SceneText::mesh(const std::string& material, const Mesh& mesh, const Vec3d& translate, const Vec3d& scale,
                           const Vec3d& rotate_degrees) {
    add_object("mesh", material, translate, list(scale), rotate_degrees);
    Json& object = json_["objects"].back();
    object["vertices"] = mesh.vertices;
    object["triangles"] = mesh.triangles;
    return *this;
}

SceneText& SceneText::velocity(const Vec3d& velocity) {
    json_["objects"].back()["velocity"] = list(velocity);
    return *this;
}

Json scaled(Json scene, double factor) {
    Json& camera = scene["camera"];
    for (const char* key : {"eye", "look_at", "aperture_radius", "focus_distance"}) {
        multiply_member(camera, key, factor);
    }
    for (Json& object : scene["objects"]) {
        for (const char* key : {"translate", "scale", "velocity"}) {
            multiply_member(object, key, factor);
        }
    }
    for (Json& material : scene["materials"]) {
        multiply_member(material, "sigma_a", 1 / factor);
        multiply_member(material, "sigma_s", 1 / factor);
    }
    return scene;
}

Json brightened(Json scene, double factor) {
    multiply_member(scene, "environment", factor);
    for (Json& material : scene["materials"]) {
        multiply_member(material, "emission", factor);
        multiply_member(material, "radiance", factor);
    }
    return scene;
}

Json moved(Json scene, const Vec3d& offset) {
    shift(scene["camera"]["eye"], offset);
    shift(scene["camera"]["look_at"], offset);
    for (Json& object : scene["objects"]) {
        if (!object.contains("translate")) {
            object["translate"] = list(Vec3d(0.0));
        }
        shift(object["translate"], offset);
    }
    return scene;
}

}  // namespace pt::stability
