#include "harness/interchange/mitsuba_limits.h"

#include "harness/exr.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/scene/material_kind.h"
#include "harness/scene/scene_mesh.h"

namespace pt {

namespace {

bool bends_or_absorbs(const SceneMaterial& material) {
    return is_glass(material) && (material.ior != 1 || !is_black(material.sigma_a));
}

bool moves(const Scene& scene, const SceneObject& object) {
    return !is_black(object.velocity) && scene.camera.shutter_close > scene.camera.shutter_open;
}

// Problems of an export, each listed once even if many copies of an object share it.
class Problems {
public:
    explicit Problems(std::string file) : file_(std::move(file)) {}

    void add(const std::string& place, const std::string& found, const std::string& allowed) {
        const std::string message = InputError(file_, place, found, allowed).what();
        if (std::find(messages_.begin(), messages_.end(), message) == messages_.end()) {
            messages_.push_back(message);
        }
    }
    std::vector<std::string> take() { return std::move(messages_); }

private:
    std::string file_;
    std::vector<std::string> messages_;
};

std::string place_in_file(const SceneObject& object) { return fmt::format("$.objects[{}]", object.index_in_file); }

void check_camera(const Scene& scene, Problems& problems) {
    if (!scene.camera.jitter) {
        problems.add("$.camera.jitter", "false", "true: Mitsuba draws a place in the pixel for every sample");
    }
}

void check_material(const SceneMaterial& material, std::uint32_t depth, Problems& problems) {
    const std::string place = "$.materials." + material.name;
    if (material.roughness_texture != nullptr) {
        problems.add(place + ".roughness", "the image " + material.roughness_texture->file,
                     "one number: roughness maps are not exported");
    }
    if (material.normal_texture != nullptr) {
        problems.add(place + ".normal", "the image " + material.normal_texture->file,
                     "none: normal maps are not exported");
    }
    for (const BeyondMitsuba& beyond : kind_of(material).beyond_mitsuba(material, depth)) {
        problems.add(beyond.key.empty() ? place : place + "." + beyond.key, beyond.found, beyond.allowed);
    }
}

void check_shape(const Scene& scene, const SceneObject& object, Problems& problems) {
    const std::string place = place_in_file(object);
    const std::string name = name_of(object.shape);
    if (moves(scene, object)) {
        problems.add(place + ".velocity",
                     fmt::format("[{}, {}, {}]", object.velocity.x, object.velocity.y, object.velocity.z),
                     "0 while the shutter is open: Mitsuba 3 has no motion blur");
    }
    if (object.shading_normals) {
        problems.add(place + ".shading_normals", "true",
                     "false: where a viewer stands behind the normals of vertices, Mitsuba's twosided shades the "
                     "surface's back, and ptbench nothing");
    }
    if (name != "sphere" && name != "box" && name != "quad" && name != "mesh") {
        problems.add(place + ".shape", name, "sphere, box, quad or mesh");
    }
    const Vec3d& scale = object.scale;
    if (name == "sphere" && (scale.x != scale.y || scale.x != scale.z)) {
        problems.add(place + ".scale", fmt::format("[{}, {}, {}]", scale.x, scale.y, scale.z),
                     "one number for a sphere: Mitsuba's sphere cannot be stretched");
    }
}

// Checks that each point of a textured shape has the same texel in Mitsuba.
void check_image(const SceneMaterial& material, const SceneObject& object, Problems& problems) {
    const std::string found = fmt::format("a {} with the image {}", name_of(object.shape), material.texture->file);
    if (object.shape == Shape::box) {
        problems.add(place_in_file(object), found,
                     "a quad, a sphere or a mesh: Mitsuba lays images on a box's sides in another way");
    }
    if (object.shape == Shape::quad && is_emissive(material)) {
        problems.add(place_in_file(object), found + ", which emits",
                     "one of both: it would be two in Mitsuba, and on one the image the wrong way up");
    }
}

// Checks that an emitting mesh is closed. Mitsuba's emitters are one-sided, which is enough for a closed shape.
void check_lamp(const Scene& scene, const SceneObject& object, Problems& problems) {
    const bool is_mesh = object.mesh != SceneObject::no_mesh;
    if (is_mesh && !scene.meshes[object.mesh]->is_closed) {
        problems.add(place_in_file(object),
                     fmt::format("the mesh {}, which emits and is not closed", scene.meshes[object.mesh]->source),
                     "a closed mesh: Mitsuba's lamps emit on one side only");
    }
}

bool overlap(const Extent& a, const Extent& b) {
    return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
           a.low.z <= b.high.z && b.low.z <= a.high.z;
}

bool sphere_meets(const Scene& scene, const SceneObject& sphere, const Extent& box) {
    const Vec3d centre = place_of(scene, sphere);
    const Vec3d nearest{std::clamp(centre.x, box.low.x, box.high.x), std::clamp(centre.y, box.low.y, box.high.y),
                        std::clamp(centre.z, box.low.z, box.high.z)};
    const Vec3d offset = nearest - centre;
    return 4 * dot(offset, offset) <= sphere.scale.x * sphere.scale.x;
}

// Whether two objects may overlap: conservative, by bounding boxes, so it may be true for objects that do not.
bool may_meet(const Scene& scene, const SceneObject& a, const SceneObject& b) {
    const Extent box_a = extent_of(scene, a), box_b = extent_of(scene, b);
    return overlap(box_a, box_b) && (name_of(a.shape) != "sphere" || sphere_meets(scene, a, box_b)) &&
           (name_of(b.shape) != "sphere" || sphere_meets(scene, b, box_a));
}

// Whether a body contains the bounding box of another object; never true for mesh bodies, which need not be convex.
bool holds(const Scene& scene, const SceneObject& body, const SceneObject& other) {
    const Extent box = extent_of(scene, other);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d point{corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                          corner & 4 ? box.high.z : box.low.z};
        if (body.mesh != SceneObject::no_mesh || !contains_as_it_stands(scene, body, point)) {
            return false;
        }
    }
    return true;
}

// Checks glass. Mitsuba divides radiance by n^2 across a boundary and ptbench does not, which cancels only for paths
// that enter and leave; and where absorbing bodies overlap, paths leave them at different places.
void check_glass(const Scene& scene, const SceneObject& glass, Problems& problems) {
    const SceneMaterial& material = scene.materials[glass.material];
    const std::string place = place_in_file(glass);
    if (contains_as_it_stands(scene, glass, scene.camera.eye)) {
        problems.add(place, "a dielectric with the eye inside",
                     "an eye outside: Mitsuba divides radiance by n^2 across a boundary, and ptbench does not");
    }
    for (const SceneObject& other : scene.objects) {
        const SceneMaterial& its = scene.materials[other.material];
        const bool is_lamp = is_emissive(its) && material.ior != 1;
        const bool absorbs = bends_or_absorbs(its) && !(is_black(material.sigma_a) && is_black(its.sigma_a));
        if (&other == &glass || (!is_lamp && !absorbs) || !may_meet(scene, glass, other)) {
            continue;
        }
        const std::string found = fmt::format("a dielectric whose box meets that of {}", place_in_file(other));
        if (is_lamp && !holds(scene, glass, other) && !holds(scene, other, glass)) {
            problems.add(place, found + ", a lamp",
                         "lamps outside, or whole inside a sphere or box: Mitsuba divides radiance by n^2 across a "
                         "boundary, and ptbench does not");
        }
        if (absorbs) {
            problems.add(place, found + ", a dielectric, and one of them absorbs",
                         "dielectrics apart: where media overlap, Mitsuba has another rule for which one absorbs");
        }
    }
}

// Checks a subsurface body. A random walk in ptbench sees only its own body; in Mitsuba it hits whatever is inside.
void check_body(const Scene& scene, const SceneObject& body, Problems& problems) {
    const std::string place = place_in_file(body);
    if (contains_as_it_stands(scene, body, scene.camera.eye)) {
        problems.add(place, "a subsurface body with the eye inside", "an eye outside");
    }
    for (const SceneObject& other : scene.objects) {
        if (&other != &body && may_meet(scene, body, other)) {
            problems.add(place, fmt::format("a subsurface body whose box meets that of {}", place_in_file(other)),
                         "bodies apart: a walk inside meets nothing here, and what is there in Mitsuba");
        }
    }
}

}  // namespace

const SceneTexture* mitsuba_image(const SceneMaterial& material) {
    return kind_of(material).in_mitsuba(material).image;
}

bool is_glass(const SceneMaterial& material) {
    return kind_of(material).in_mitsuba(material).type == MitsubaBsdf::Type::dielectric &&
           !has_trait(material.type, material_trait::has_walks);
}

bool is_emissive(const SceneMaterial& material) { return !is_black(material.emission); }

Vec3d place_of(const Scene& scene, const SceneObject& object) {
    return object.translate + object.velocity * scene.camera.shutter_open;
}

bool contains_as_it_stands(const Scene& scene, const SceneObject& object, const Vec3d& point) {
    SceneObject standing = object;
    standing.translate = place_of(scene, object);
    return contains_point(scene, standing, point);
}

double radiance_factor(const Scene& scene, const SceneObject& lamp) {
    double factor = 1;
    for (const SceneObject& object : scene.objects) {
        const SceneMaterial& material = scene.materials[object.material];
        if (is_glass(material) && holds(scene, object, lamp)) {
            factor *= material.ior * material.ior;
        }
    }
    return factor;
}

Extent extent_of(const Scene& scene, const SceneObject& object) {
    const Rotation rotation = rotation_of(object.rotate_degrees);
    const bool is_sphere = name_of(object.shape) == "sphere";
    Extent extent{place_of(scene, object), place_of(scene, object)};
    for (int axis = 0; axis < 3; ++axis) {
        for (int i = 0; i < 3; ++i) {
            const bool is_thickness = i == 1 && is_flat(object) && object.mesh == SceneObject::no_mesh;
            double own_low = is_thickness ? 0 : -0.5, own_high = is_thickness ? 0 : 0.5;
            if (object.mesh != SceneObject::no_mesh) {
                own_low = scene.meshes[object.mesh]->bounds.low[i];
                own_high = scene.meshes[object.mesh]->bounds.high[i];
            }
            const double entry = (is_sphere ? (i == axis ? 1 : 0) : rotation.column[i][axis]) * object.scale[i];
            extent.low[axis] += std::min(entry * own_low, entry * own_high);
            extent.high[axis] += std::max(entry * own_low, entry * own_high);
        }
    }
    return extent;
}

std::vector<std::string> mitsuba_problems(const Scene& scene, const std::string& file, std::uint32_t depth) {
    Problems problems(file);
    check_camera(scene, problems);
    if (scene.environment_map != nullptr && !scene.environment_map->file.empty() && !has_openexr()) {
        problems.add("$.environment", "an image",
                     "one number: this build cannot write the image's .exr (libopenexr-dev)");
    }
    std::vector<bool> is_shown(scene.materials.size(), false);
    for (const SceneObject& object : scene.objects) {
        is_shown[object.material] = true;
    }
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        if (is_shown[i]) {
            check_material(scene.materials[i], depth, problems);
        }
    }
    for (const SceneObject& object : scene.objects) {
        check_shape(scene, object, problems);
        if (mitsuba_image(scene.materials[object.material]) != nullptr) {
            check_image(scene.materials[object.material], object, problems);
        }
        if (is_emissive(scene.materials[object.material])) {
            check_lamp(scene, object, problems);
        }
        if (bends_or_absorbs(scene.materials[object.material])) {
            check_glass(scene, object, problems);
        }
        if (has_trait(scene.materials[object.material].type, material_trait::has_walks)) {
            check_body(scene, object, problems);
        }
    }
    return problems.take();
}

double mitsuba_offset_by_thickness(const Scene& scene, double scale) {
    const double offset_by_size = std::ldexp(1500, -24);  // RayEpsilon of Mitsuba 3.9, relative to coordinates
    double largest = 0;
    double thinnest = std::numeric_limits<double>::infinity();
    for (const SceneObject& object : scene.objects) {
        const Extent extent = extent_of(scene, object);
        for (int axis = 0; axis < 3; ++axis) {
            largest = std::max({largest, std::abs(extent.low[axis]) * scale, std::abs(extent.high[axis]) * scale});
            if (name_of(object.shape) == "sphere" || name_of(object.shape) == "box") {
                thinnest = std::min(thinnest, object.scale[axis] * scale);
            }
        }
    }
    return offset_by_size * (1 + largest) / thinnest;
}

std::uint64_t roulette_depth(const Scene& scene) {
    constexpr double of_surfaces = 128, least_left = 1e-5, of_reflections = 6, most = 1e6;
    double steps = 0;
    for (const SceneObject& object : scene.objects) {
        const SceneMaterial& material = scene.materials[object.material];
        if (!has_trait(material.type, material_trait::has_walks)) {
            continue;
        }
        const Extent extent = extent_of(scene, object);
        const Vec3d size = extent.high - extent.low;
        for (int channel = 0; channel < 3; ++channel) {
            const double scattering = material.sigma_s[channel];
            const double density = material.sigma_a[channel] + scattering;
            if (scattering > 0) {
                const double turning = 1 - material.g;
                const double slab = std::min({size.x, size.y, size.z}) * density * turning + of_reflections;
                const double lost =
                    turning * pi<double> * pi<double> / (3 * slab * slab) + std::log(density / scattering);
                steps = std::max(steps, -std::log(least_left) / lost);
            }
        }
    }
    return static_cast<std::uint64_t>(std::min(most, of_surfaces + std::ceil(steps)));
}

}  // namespace pt
