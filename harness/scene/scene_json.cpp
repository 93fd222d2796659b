// Reads and validates the scene format (docs/scene_format.md).
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/json_reader.h"
#include "harness/mesh/generate.h"
#include "harness/scene/inline_mesh.h"
#include "harness/scene/instances.h"
#include "harness/scene/json_lines.h"
#include "harness/scene/material_kind.h"
#include "harness/scene/scene.h"
#include "harness/scene/scene_mesh.h"
#include "harness/scene/scene_texture.h"
#include "harness/text_file.h"
#include "variants/fnv1a.h"

namespace pt {

namespace {

// Longest and shortest lengths allowed in a scene: squares of lengths beyond them would leave the range of float.
constexpr double largest_length = 1e18;
constexpr double smallest_length = 1e-18;

Vec3d point(const JsonValue& value) {
    return read_vector(value, -largest_length, largest_length, "a number from -1e18 to 1e18");
}

void read_shutter(const JsonValue& value, SceneCamera& camera) {
    const JsonObject shutter(value, {"open", "close", "density"});
    const auto time = [](const JsonValue& v) { return v.number(-1e9, 1e9, "a time from -1e9 to 1e9 seconds"); };
    camera.shutter_open = shutter.has("open") ? time(shutter.at("open")) : 0;
    camera.shutter_close = shutter.has("close") ? time(shutter.at("close")) : camera.shutter_open;
    if (camera.shutter_close < camera.shutter_open) {
        shutter.at("close").fail(fmt::format("no less than shutter.open, {}", camera.shutter_open));
    }
    if (shutter.has("density")) {
        camera.shutter_late = shutter.at("density").one_of({"uniform", "late"}) == "late";
    }
}

// Checks that an object's centre is in range when the shutter opens and when it closes; in between it moves straight.
void check_motion(const Scene& scene, const SceneObject& object, std::size_t index, const std::string& file) {
    for (const double time : {scene.camera.shutter_open, scene.camera.shutter_close}) {
        const Vec3d centre = object.translate + object.velocity * time;
        if (!(std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)}) <= largest_length)) {
            throw InputError(file, fmt::format("$.objects[{}].velocity", index),
                             fmt::format("a place beyond 1e18 at time {}", time),
                             "a velocity that keeps the object within -1e18 to 1e18 while the shutter is open");
        }
    }
}

SceneCamera read_camera(const JsonValue& value) {
    const JsonObject object(value, {"eye", "look_at", "up", "vertical_fov_degrees", "resolution", "jitter",
                                    "aperture_radius", "focus_distance", "shutter"});
    SceneCamera camera;
    camera.eye = point(object.required("eye"));
    camera.look_at = point(object.required("look_at"));
    camera.up = point(object.required("up"));
    const Vec3d forward = camera.look_at - camera.eye;
    constexpr double least_square = smallest_length * smallest_length;
    if (!(dot(forward, forward) >= least_square)) {
        object.at("look_at").fail("a point other than camera.eye, at least 1e-18 away");
    }
    // A camera's `up` shorter than the shortest length in a scene is refused as if it were 0.
    if (!(dot(camera.up, camera.up) >= least_square)) {
        object.at("up").fail("a direction that is not 0: a vector of length 1e-18 or more");
    }
    const Vec3d right = cross(forward, camera.up);
    if (!(dot(right, right) > 1e-12 * dot(forward, forward) * dot(camera.up, camera.up))) {
        object.at("up").fail("a direction that is not 0 and not parallel to look_at - eye");
    }
    camera.vertical_fov_degrees =
        object.required("vertical_fov_degrees").number(1e-6, 179.999, "an angle from 1e-6 to 179.999 degrees");
    const JsonValue resolution = object.required("resolution");
    if (!resolution.json().is_array() || resolution.json().size() != 2) {
        resolution.fail("an array of 2 whole numbers, [width, height]");
    }
    const std::vector<JsonValue> sides = resolution.elements();
    camera.width = static_cast<std::uint32_t>(sides[0].whole(1, 65536, "a whole number from 1 to 65536"));
    camera.height = static_cast<std::uint32_t>(sides[1].whole(1, 65536, "a whole number from 1 to 65536"));
    if (std::uint64_t{camera.width} * camera.height > (1u << 26)) {
        resolution.fail("at most 2^26 pixels");
    }
    camera.jitter = !object.has("jitter") || object.at("jitter").boolean();
    if (object.has("aperture_radius")) {
        camera.aperture_radius = object.at("aperture_radius").number(0, largest_length, "a number from 0 to 1e18");
    }
    if (object.has("focus_distance")) {
        camera.focus_distance =
            object.at("focus_distance").number(smallest_length, largest_length, "a number from 1e-18 to 1e18");
    }
    if (object.has("shutter")) {
        read_shutter(object.at("shutter"), camera);
    }
    return camera;
}

Vec3d read_scale(const JsonValue& value) {
    const std::string allowed = "a number from 1e-18 to 1e18";
    if (value.json().is_array()) {
        return read_vector(value, smallest_length, largest_length, allowed);
    }
    return Vec3d(value.number(smallest_length, largest_length, allowed + ", or an array of 3"));
}

// An ellipsoid is intersected in the space where it is the unit sphere. With axes of a larger ratio, squares in that
// space leave the range of float.
void check_ellipsoid(const SceneObject& object, const JsonValue& scale) {
    constexpr double largest_ratio = 1e12;
    const auto [least, greatest] = std::minmax({object.scale.x, object.scale.y, object.scale.z});
    if (object.shape == Shape::sphere && greatest > largest_ratio * least) {
        scale.fail("of a sphere, axes that differ by no more than a factor of 1e12");
    }
}

// Lists the names of a scene's materials for an error message, up to 20 of them.
std::string names_of(const std::vector<SceneMaterial>& materials) {
    constexpr std::size_t most = 20;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min(most, materials.size()); ++i) {
        names.push_back(materials[i].name);
    }
    return fmt::format("{}{}", fmt::join(names, ", "),
                       materials.size() > most ? fmt::format(" and {} more", materials.size() - most) : "");
}

// Checks of an object that need the whole scene; `index` is the object's number in the file's list of objects.
void check_object(const Scene& scene, const SceneObject& object, std::size_t index, const std::string& file) {
    check_motion(scene, object, index, file);
    const bool is_body = has_trait(scene.materials[object.material].type, material_trait::has_walks);
    if (is_body && contains_point(scene, object, scene.camera.eye)) {
        throw InputError(file, "$.camera.eye", fmt::format("a point inside $.objects[{}], a subsurface body", index),
                         "a point outside of subsurface bodies");
    }
}

// Generates the mesh of {"mesh": NAME, "size": N} in a scene file.
std::shared_ptr<const SceneMesh> read_recipe(const JsonValue& value, bool with_normals) {
    const JsonObject recipe(value, {"mesh", "size"});
    std::vector<std::string> names;
    for (const Generator& generator : generators()) {
        names.emplace_back(generator.name);
    }
    const std::string name = recipe.required("mesh").one_of(names);
    const Generator& generator = *find_generator(name);
    const long long size = recipe.required("size").whole(
        generator.least_size, generator.most_size,
        fmt::format("a whole number from {} to {} ({})", generator.least_size, generator.most_size, generator.size));
    return mesh_from_generator(name, static_cast<std::uint32_t>(size), with_normals);
}

// Reads an object's mesh from its key "file" (a path relative to the scene file), "generate" or "vertices".
std::shared_ptr<const SceneMesh> read_mesh_of(const JsonObject& object, const JsonValue& value, bool with_normals) {
    std::vector<std::string> sources;
    for (const char* key : {"file", "generate", "vertices"}) {
        if (object.has(key)) {
            sources.push_back(fmt::format("\"{}\"", key));
        }
    }
    if (sources.size() != 1) {
        throw InputError(value.file(), value.path(),
                         sources.empty() ? "none of \"file\", \"generate\" and \"vertices\""
                                         : fmt::format("{}", fmt::join(sources, " and ")),
                         "one of them, for a mesh");
    }
    if (object.has("triangles") != object.has("vertices")) {
        value.fail("\"vertices\" with \"triangles\", or neither");
    }
    for (const char* key : {"texture_coordinates", "normals"}) {
        if (object.has(key) && !object.has("vertices")) {
            value.fail(fmt::format("\"{}\" with \"vertices\", or neither", key));
        }
    }
    if (object.has("vertices")) {
        return read_inline_mesh(object, with_normals);
    }
    if (object.has("generate")) {
        return read_recipe(object.at("generate"), with_normals);
    }
    return read_named_file(object.at("file"),
                           [&](const std::filesystem::path& file) { return mesh_from_file(file, with_normals); });
}

// Adds a mesh to the scene unless the scene has it already, and returns the mesh's index in Scene::meshes.
std::uint32_t index_of(const std::shared_ptr<const SceneMesh>& mesh, Scene& scene) {
    const auto known = std::find(scene.meshes.begin(), scene.meshes.end(), mesh);
    const auto index = static_cast<std::uint32_t>(known - scene.meshes.begin());
    if (known == scene.meshes.end()) {
        scene.meshes.push_back(mesh);
    }
    return index;
}

// Joins two or more names for a message: "a, b or c".
std::string one_of(std::vector<std::string> names, const char* word) {
    const std::string last = names.back();
    names.pop_back();
    return fmt::format("{} {} {}", fmt::join(names, ", "), word, last);
}

// Lists kinds of materials that are allowed, for an error message: "a, b or c". Kinds that need an inside only with
// some settings come last.
template <class IsAllowed>
std::string materials_for(const IsAllowed& is_allowed, bool with_inside) {
    std::vector<std::string> names, in_part;
    const std::vector<std::string> all = material_type_names();
    for (std::size_t i = 0; i < all.size(); ++i) {
        SceneMaterial plain;
        plain.type = static_cast<MaterialType>(i);
        const bool may_need_inside = has_trait(plain.type, material_trait::has_inside);
        if (!is_allowed(plain)) {
            continue;
        }
        (may_need_inside && !with_inside ? in_part : names).push_back(all[i]);
    }
    names.insert(names.end(), in_part.begin(), in_part.end());
    return one_of(names, "or") + (in_part.empty() ? "" : " without transmission");
}

// Lists the kinds of materials that always need a shape with an inside, for an error message: "a, b and c".
std::string solids() {
    std::vector<std::string> names;
    const std::vector<std::string> all = material_type_names();
    for (std::size_t i = 0; i < all.size(); ++i) {
        SceneMaterial plain;
        plain.type = static_cast<MaterialType>(i);
        if (kind_of(plain).needs_inside(plain)) {
            names.push_back(all[i]);
        }
    }
    return one_of(names, "and");
}

// Checks that a shape suits its material: dielectrics need an inside, and subsurface walks a convex shape, whose
// surface a ray leaves only once.
void check_material(const JsonValue& value, const SceneMaterial& material, const SceneObject& object,
                    const Scene& scene) {
    const bool is_mesh = object.mesh != SceneObject::no_mesh;
    const auto has_walks = [](const SceneMaterial& m) { return has_trait(m.type, material_trait::has_walks); };
    const auto is_surface = [](const SceneMaterial& m) { return !kind_of(m).needs_inside(m); };
    if (is_mesh && has_walks(material)) {
        value.fail(fmt::format("on a mesh: {} ({} needs a convex shape)",
                               materials_for([&](const SceneMaterial& m) { return !has_walks(m); }, true),
                               material_type_names()[static_cast<std::size_t>(material.type)]));
    }
    if (is_surface(material)) {
        return;
    }
    if (is_mesh && !scene.meshes[object.mesh]->is_closed) {
        value.fail(fmt::format("on the mesh {}, which is not closed: {} ({} need a shape with an inside)",
                               scene.meshes[object.mesh]->source, materials_for(is_surface, false), solids()));
    }
    if (!is_mesh && is_flat(object)) {
        value.fail(fmt::format("on a {}: {} ({} need a shape with an inside)", name_of(object.shape),
                               materials_for(is_surface, false), solids()));
    }
}

// Checks that a mesh placed by its object stays within 1e18, since the mesh has coordinates of its own.
void check_reach(const JsonValue& value, const SceneObject& object, const Scene& scene) {
    if (object.mesh == SceneObject::no_mesh) {
        return;
    }
    const SceneMesh& mesh = *scene.meshes[object.mesh];
    const Box box = box_round(mesh, placement_of(object, Vec3d(0.0)));
    for (int axis = 0; axis < 3; ++axis) {
        if (!(box.low[axis] >= -largest_length && box.high[axis] <= largest_length)) {
            throw InputError(value.file(), value.path(), fmt::format("the mesh {} reaching beyond 1e18", mesh.source),
                             "a mesh, a place and a scale that keep it within -1e18 to 1e18");
        }
    }
}

SceneObject read_object(const JsonValue& value, Scene& scene) {
    const std::vector<SceneMaterial>& materials = scene.materials;
    std::vector<std::string> keys{"shape", "material", "translate", "rotate_degrees", "scale", "velocity"};
    const bool is_mesh = value.json().is_object() && value.json().value("shape", Json()) == name_of(Shape::mesh);
    if (is_mesh) {
        keys.insert(keys.end(), {"file", "generate", "vertices", "triangles", "texture_coordinates", "normals",
                                 "shading_normals", "instances"});
    }
    const JsonObject object(value, keys);
    SceneObject result;
    result.shape = shape_named(object.required("shape").one_of(shape_names()));
    if (is_mesh) {
        result.shading_normals = object.has("shading_normals") && object.at("shading_normals").boolean();
        const std::shared_ptr<const SceneMesh> mesh = read_mesh_of(object, value, result.shading_normals);
        if (result.shading_normals && mesh->normals.empty()) {
            object.at("shading_normals").fail("false: " + mesh->normals_fault);
        }
        result.mesh = index_of(mesh, scene);
    }
    const JsonValue material_value = object.required("material");
    const std::string name = material_value.text();
    const auto material =
        std::lower_bound(materials.begin(), materials.end(), name,
                         [](const SceneMaterial& m, const std::string& wanted) { return m.name < wanted; });
    if (material == materials.end() || material->name != name) {
        material_value.fail("a name in $.materials: " + names_of(materials));
    }
    result.material = static_cast<std::uint32_t>(material - materials.begin());
    check_material(material_value, *material, result, scene);
    check_texture(material_value, *material, result, scene);
    result.translate = object.has("translate") ? point(object.at("translate")) : Vec3d(0.0);
    if (object.has("rotate_degrees")) {
        result.rotate_degrees =
            read_vector(object.at("rotate_degrees"), -1e6, 1e6, "an angle from -1e6 to 1e6 degrees");
    }
    if (object.has("scale")) {
        result.scale = read_scale(object.at("scale"));
        check_ellipsoid(result, object.at("scale"));
    }
    result.velocity = object.has("velocity") ? point(object.at("velocity")) : Vec3d(0.0);
    check_reach(value, result, scene);
    return result;
}

// Reads an object of the scene file, or all its copies if it has the key "instances".
std::vector<SceneObject> read_objects(const JsonValue& value, Scene& scene) {
    const SceneObject object = read_object(value, scene);
    const bool is_mesh = object.mesh != SceneObject::no_mesh;
    if (!is_mesh || !value.json().contains("instances")) {
        return {object};
    }
    if (object.scale.x != object.scale.y || object.scale.x != object.scale.z) {
        JsonValue(value.json().at("scale"), value.file(), value.path() + ".scale").fail("one number, with instances");
    }
    const JsonValue rule(value.json().at("instances"), value.file(), value.path() + ".instances");
    std::vector<SceneObject> objects;
    for (const Copy& copy : read_instances(rule, object.scale.x)) {
        objects.push_back(copied(object, copy));
        check_reach(rule, objects.back(), scene);
        if (!(objects.back().scale.x >= smallest_length)) {
            rule.fail("no copy smaller than 1e-18");
        }
    }
    return objects;
}

// Text of an object's generated copies, for the scene's hash: copies belong to the scene's content, as meshes do.
std::string text_of(const std::vector<SceneObject>& copies) {
    std::string text;
    for (const SceneObject& copy : copies) {
        for (const Vec3d& v : {copy.translate, copy.rotate_degrees, copy.scale}) {
            text.append(reinterpret_cast<const char*>(&v), sizeof v);
        }
    }
    return text;
}

std::shared_ptr<const SceneEnvironment> environment_of(EnvironmentImage image, double scale, const JsonValue& value) {
    auto environment = std::make_shared<SceneEnvironment>();
    for (Vec3<float>& texel : image.texels) {
        for (int channel = 0; channel < 3; ++channel) {
            const double scaled = static_cast<double>(texel[channel]) * scale;
            if (!(scaled <= largest_radiance)) {
                value.fail(fmt::format("a scale that leaves every texel at 1e30 or below (one would be {})", scaled));
            }
            texel[channel] = static_cast<float>(scaled);
        }
    }
    // The hash of an environment image includes its width unless the image is one texel or twice as wide as high, since
    // the same texels in another shape are another environment.
    std::uint64_t hash = fnv1a_of_bytes(image.texels.data(), image.texels.size() * sizeof(Vec3<float>));
    hash = image.texels.size() == 1 || image.width == 2 * image.height
               ? hash
               : fnv1a_of_bytes(&image.width, sizeof image.width, hash);
    environment->hash = fmt::format("{:016x}", hash);
    environment->image = std::move(image);
    return environment;
}

// Reads an environment light: {"radiance": [r, g, b]}, or {"file": NAME, "scale": s, "rotation": degrees} with a path
// relative to the scene file.
std::shared_ptr<const SceneEnvironment> read_environment(const JsonValue& value) {
    if (value.json().contains("radiance")) {
        const JsonObject object(value, {"radiance"});
        return environment_of({1, 1, {Vec3<float>(read_radiance(object.at("radiance")))}}, 1, value);
    }
    const JsonObject object(value, {"file", "scale", "rotation"});
    if (!object.has("file")) {
        value.fail(R"({"radiance": [R, G, B]} or {"file": NAME, ..})");
    }
    const JsonValue named = object.at("file");
    const double scale = object.has("scale") ? object.at("scale").number(0, 1e30, "a number from 0 to 1e30") : 1;
    EnvironmentImage image = read_named_file(
        named, [](const std::filesystem::path& image_file) { return read_environment_image(image_file); });
    auto environment = std::make_shared<SceneEnvironment>(
        *environment_of(std::move(image), scale, object.has("scale") ? object.at("scale") : value));
    environment->file = named.text();
    if (object.has("rotation")) {
        environment->rotation_degrees = object.at("rotation").number(-1e6, 1e6, "an angle from -1e6 to 1e6 degrees");
    }
    return environment;
}

}  // namespace

Scene parse_scene(const std::string& text, const std::string& file) {
    const Json json = parse_json(text, file);
    const JsonObject root(JsonValue(json, file, "$"),
                          {"name", "description", "max_depth", "environment", "camera", "materials", "objects"});
    Scene scene;
    scene.name = root.required("name").plain_name();
    scene.description = root.has("description") ? root.at("description").text() : "";
    scene.max_depth =
        static_cast<std::uint32_t>(root.required("max_depth").whole(1, 1000000, "a whole number from 1 to 1000000"));
    if (root.has("environment") && root.at("environment").json().is_object()) {
        scene.environment_map = read_environment(root.at("environment"));
    } else if (root.has("environment")) {
        if (!root.at("environment").json().is_array()) {
            root.at("environment").fail(R"(an array of 3 numbers, {"radiance": [R, G, B]} or {"file": NAME, ..})");
        }
        scene.environment = read_radiance(root.at("environment"));
    }
    scene.camera = read_camera(root.required("camera"));
    const JsonValue materials = root.required("materials");
    if (!materials.json().is_object()) {
        materials.fail("an object of named materials");
    }
    for (const auto& [name, member] : materials.json().items()) {
        SceneMaterial material = read_material(JsonValue(member, file, "$.materials." + name));
        material.name = name;
        scene.materials.push_back(std::move(material));
    }
    check_texels(scene, file);
    std::string of_rules;
    const std::vector<JsonValue> objects = root.required("objects").elements();
    for (std::size_t i = 0; i < objects.size(); ++i) {
        std::vector<SceneObject> read = read_objects(objects[i], scene);
        for (SceneObject& object : read) {
            object.index_in_file = static_cast<std::uint32_t>(i);
            check_object(scene, object, i, file);
        }
        of_rules += read.size() > 1 ? text_of(read) : "";
        scene.objects.insert(scene.objects.end(), read.begin(), read.end());
    }
    std::string canonical = json.dump();
    for (const auto& mesh : scene.meshes) {
        canonical += mesh->hash;
    }
    canonical += of_rules + (scene.environment_map != nullptr ? scene.environment_map->hash : "");
    canonical += text_of_textures(scene);
    scene.hash = fmt::format("{:016x}", fnv1a_of_bytes(canonical.data(), canonical.size()));
    return scene;
}

Scene load_scene(const std::string& file) {
    Scene scene = parse_scene(read_text_file(file), file);
    scene.file = std::filesystem::absolute(file).string();
    return scene;
}

}  // namespace pt
