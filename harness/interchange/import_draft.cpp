#include "harness/interchange/import_draft.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/mesh/check_mesh.h"
#include "harness/mesh/read_mesh.h"
#include "harness/scene/scene_mesh.h"
#include "harness/scene/texture_image.h"

namespace pt {

namespace {

namespace fs = std::filesystem;

// Cosines between an affine map's columns up to which shear is imprecision of the source, and up to which rounding.
constexpr double slight_shear = 1e-6, shear_of_rounding = 1e-12;

// Transforms vertex normals by an affine map's cofactor matrix, so that they stay perpendicular and outward.
std::vector<std::array<float, 3>> normals_placed_by(const std::vector<std::array<float, 3>>& normals,
                                                    const Affine& map) {
    const auto& [x, y, z] = map.column;
    const double side = determinant(map) < 0 ? -1 : 1;
    std::vector<std::array<float, 3>> placed;
    for (const auto& n : normals) {
        const Vec3d turned =
            (cross(y, z) * double{n[0]} + cross(z, x) * double{n[1]} + cross(x, y) * double{n[2]}) * side;
        const Vec3<float> unit(turned * (1 / std::sqrt(dot(turned, turned))));
        placed.push_back({unit.x, unit.y, unit.z});
    }
    return placed;
}

// A mesh transformed by an affine map. If the map mirrors, the winding is reversed, so that the outside stays outside.
Mesh mesh_placed_by(const Mesh& mesh, const Affine& map) {
    Mesh made;
    for (const auto& vertex : mesh.vertices) {
        const Vec3d p = map.point({vertex[0], vertex[1], vertex[2]});
        made.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    made.triangles = mesh.triangles;
    made.coordinates = mesh.coordinates;
    made.normals = normals_placed_by(mesh.normals, map);
    if (determinant(map) < 0) {
        for (auto& triangle : made.triangles) {
            std::swap(triangle[1], triangle[2]);
        }
        for (auto& corners : made.coordinates) {
            std::swap(corners[1], corners[2]);
        }
    }
    return made;
}

bool flattens(const Affine& map) {
    return std::any_of(std::begin(map.column), std::end(map.column),
                       [](const Vec3d& v) { return !(dot(v, v) >= 1e-36); });
}

std::string folder_of_file(const std::string& file) { return fs::path(file).parent_path().string(); }

}  // namespace

const Cis565Line* ImportDraft::place(std::size_t line, const std::string& text) {
    places_.push_back({.number = line, .words = {text}});
    return &places_.back();
}

void ImportDraft::refuse(const Cis565Line& place, const std::string& allowed) {
    problems().add(place.number, fmt::format("found {}, allowed: {}", place.text(), allowed));
}

void ImportDraft::begin(const std::string& wanted, const Cis565Line* head) {
    const std::string name = plain_part_of(wanted);
    parts.root = {.place = "$", .head = head, .members = {}};
    parts.root.add("name", json_of(!source_.name.empty() ? source_.name : name.empty() ? "imported" : name), nullptr);
    parts.root.add("description", json_of("Imported from " + fs::path(source_.file).filename().string() + "."),
                   nullptr);
    parts.camera = {.place = "$.camera", .head = head, .members = {}};
}

void ImportDraft::add_view(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up, const Cis565Line* at) {
    const auto add = [&](const char* key, const Vec3d& value, const char* stand_in) {
        parts.camera.members.push_back(
            {.key = key, .value = json_of(value), .line = at, .stand_in = stand_in, .is_of_view = true});
    };
    add("eye", eye, "[0, 0, 1]");
    add("look_at", look_at, "[0, 0, 0]");
    add("up", up, "[0, 1, 0]");
}

std::size_t ImportDraft::add_material(ScenePart part, const std::string& name) {
    const std::string start = name.empty() ? "material" : name;
    part.name = start;
    while (!names_.try_emplace(part.name, 2).second) {
        part.name = fmt::format("{}_{}", start, names_[start]++);
    }
    part.place = "$.materials." + part.name;
    parts.materials.push_back(std::move(part));
    return parts.materials.size() - 1;
}

ScenePart ImportDraft::object(const std::string& shape, std::size_t material, const Cis565Line* at) const {
    ScenePart object{.place = fmt::format("$.objects[{}]", parts.objects.size()), .head = at, .members = {}};
    object.add("shape", json_of(shape), nullptr);
    object.add("material", json_of(material_name_of(material)), at);
    return object;
}

void ImportDraft::add_placement(ScenePart& object, const TranslateRotateScale& placement, const Cis565Line* at) {
    if (placement.is_straightened) {
        notes().add(at->number,
                    fmt::format("{} is turned to the nearest quarter turns, [{}, {}, {}] degrees, less than "
                                "1e-5 degrees away",
                                at->text(), placement.rotate_degrees.x, placement.rotate_degrees.y,
                                placement.rotate_degrees.z));
    }
    const auto add = [&](const char* key, const Vec3d& value, double neutral, const char* stand_in) {
        if (value != Vec3d(neutral)) {
            const bool is_uniform = neutral == 1 && value.x == value.y && value.y == value.z;
            object.add(key, is_uniform ? json_of(value.x) : json_of(value), at, stand_in);
        }
    };
    add("translate", placement.translate, 0, "[0, 0, 0]");
    add("rotate_degrees", placement.rotate_degrees, 0, "[0, 0, 0]");
    add("scale", placement.scale, 1, "1");
}

bool ImportDraft::add_shape(const std::string& shape, const Affine& map, std::size_t material, const Cis565Line* at) {
    if (!is_finite(map) || flattens(map)) {
        refuse(*at, "a placement by finite numbers that scales no axis below 1e-18");
        return false;
    }
    const double shear = shear_of(map);
    if (shear > slight_shear) {
        refuse(*at,
               fmt::format("for a {}, a placement that shears nothing: its axes must meet at right angles", shape));
        return false;
    }
    if (shear > shear_of_rounding) {
        notes().add(at->number, fmt::format("{} is sheared by {:.2g} and read as if it were not", at->text(), shear));
    }
    ScenePart made = object(shape, material, at);
    add_placement(made, take_apart(map), at);
    parts.objects.push_back(std::move(made));
    return true;
}

bool ImportDraft::add_mesh(const std::string& file, const Affine& map, std::size_t material, const Cis565Line* at,
                           bool has_normals) {
    if (!is_finite(map)) {
        refuse(*at, "a placement by finite numbers");
        return false;
    }
    const bool is_flat = flattens(map);
    std::string name = name_in_scene(file);
    TranslateRotateScale placement;
    if (is_flat || shear_of(map) > shear_of_rounding || determinant(map) < 0) {
        const std::optional<std::string> anew = keep_placed(file, map, has_normals && !is_flat, at);
        if (!anew) {
            return false;
        }
        name = *anew;
        placement.translate = map.origin;
    } else {
        placement = take_apart(map);
    }
    ScenePart made = object("mesh", material, at);
    made.add("file", json_of(name), at);
    if (has_normals && !is_flat) {
        made.add("shading_normals", "true", at);
    }
    add_placement(made, placement, at);
    parts.objects.push_back(std::move(made));
    return true;
}

// Keeps a mesh transformed by an affine map without its translation: far from 0, vertices lose digits in float.
std::optional<std::string> ImportDraft::keep_placed(const std::string& file, const Affine& map, bool has_normals,
                                                    const Cis565Line* at) {
    try {
        if (!read_.contains(file)) {
            read_[file] = read_mesh(file);
        }
        Affine unmoved = map;
        unmoved.origin = Vec3d(0.0);
        Mesh anew = read_[file];
        if (!has_normals) {
            anew.normals.clear();
        }
        anew = mesh_placed_by(anew, unmoved);
        leave_out_degenerate(anew);
        if (anew.triangles.empty()) {
            notes().add(at->number, at->text() + " is left out: its mesh has no area where it stands");
            return std::nullopt;
        }
        check_mesh(anew, at->text());
        const std::string name = name_in_scene(keep_mesh(anew));
        notes().add(at->number, fmt::format("{} is sheared, flattened or mirrored: its mesh, so placed, is written as "
                                            "{}",
                                            at->text(), name));
        return name;
    } catch (const InputError& error) {
        problems().add(at->number, error.what());
        return std::nullopt;
    }
}

std::string ImportDraft::keep_mesh(const Mesh& mesh) {
    const fs::path out(source_.out.empty() ? source_.file : source_.out);
    const std::string name = add_imported_mesh(*result_, source_, mesh);
    const std::string path = (out.parent_path() / name).string();
    read_[path] = mesh;
    return path;
}

std::string ImportDraft::keep_image(const std::string& content, const std::string& ending) {
    const std::string stem = fs::path(source_.out.empty() ? source_.file : source_.out).stem().string();
    const std::string name = result_->files.add(
        [&](std::size_t n) { return fmt::format("{}_image_{}{}", stem, n, ending); }, result_->images.size(), content);
    result_->images.push_back({.file = name, .content = content});
    return name;
}

bool ImportDraft::shows_image(std::size_t material) const {
    const std::vector<SceneMember>& members = parts.materials[material].members;
    return std::any_of(members.begin(), members.end(),
                       [](const SceneMember& member) { return is_image_in_scene(member.value); });
}

std::string ImportDraft::path_of(const std::string& named) const {
    const fs::path path(named);
    return (path.is_absolute() ? path : fs::path(folder_of_file(source_.file)) / path).string();
}

std::string ImportDraft::name_in_scene(const std::string& path) const {
    const std::string folder = folder_of_file(source_.out.empty() ? source_.file : source_.out);
    if (fs::path(path).is_absolute() && folder.empty()) {
        return path;
    }
    std::error_code error;
    const fs::path near =
        fs::proximate(fs::absolute(path, error), fs::absolute(folder.empty() ? "." : folder, error), error);
    return error ? path : near.generic_string();
}

std::optional<Scene> ImportDraft::checked() {
    const std::string file = source_.out.empty() ? source_.file : source_.out;
    const MeshesToBe to_be(imported_meshes(*result_, file));
    ImagesToBe::Contents images;
    for (const ImportedImage& imported : result_->images) {
        images[(fs::path(file).parent_path() / imported.file).string()] = imported.content;
    }
    const ImagesToBe images_to_be(std::move(images));
    check_parts(parts, file, problems());
    return problems().count() == 0 ? std::optional(parse_scene(parts.json(), file)) : std::nullopt;
}

void ImportDraft::finish() {
    result_->objects = parts.objects.size();
    result_->materials = parts.materials.size();
    if (problems().count() == 0) {
        result_->json = parts.json();
    }
}

}  // namespace pt
