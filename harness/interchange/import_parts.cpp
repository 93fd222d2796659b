#include "harness/interchange/import_parts.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "harness/failure.h"
#include "harness/mesh/write_mesh.h"

namespace pt {

namespace {

// A minimal valid scene, into which each part of an imported scene is put in turn, to be checked alone.
constexpr const char* other_root = "\"name\": \"other\", \"max_depth\": 1";
constexpr const char* other_camera =
    "{\"eye\": [0, 0, 1], \"look_at\": [0, 0, 0], \"up\": [0, 1, 0], \"vertical_fov_degrees\": 60, "
    "\"resolution\": [1, 1], \"shutter\": {\"open\": 0, \"close\": 1}}";
constexpr const char* other_material = "{\"type\": \"diffuse\", \"albedo\": [0, 0, 0]}";

// Number of problems after which objects are no longer checked: nobody reads more, and checking takes time.
constexpr std::size_t most_checked = 1000;

std::string scene_text(const std::string& root, const std::string& camera, const std::string& materials,
                       const std::string& objects) {
    return fmt::format("{{{}, \"camera\": {}, \"materials\": {{{}}}, \"objects\": [{}]}}", root, camera, materials,
                       objects);
}

// An error "PLACE: found FOUND, allowed: ALLOWED" of the scene file reader, split into its parts.
struct SceneError {
    std::string place, found, allowed;
};

std::optional<SceneError> error_of(const std::string& scene, const std::string& file) {
    try {
        parse_scene(scene, file);
        return std::nullopt;
    } catch (const InputError& error) {
        const std::string whole = error.what(), start_of_file = file + ": ";
        const std::string message = whole.starts_with(start_of_file) ? whole.substr(start_of_file.size()) : whole;
        const std::string before_found = ": found ", before_allowed = ", allowed: ";
        const std::size_t found = message.find(before_found);
        const std::size_t allowed = message.rfind(before_allowed);
        if (found == std::string::npos || allowed == std::string::npos || allowed < found + before_found.size()) {
            return SceneError{"$", message, "what scene files hold"};
        }
        const std::size_t start = found + before_found.size();
        return SceneError{message.substr(0, found), message.substr(start, allowed - start),
                          message.substr(allowed + before_allowed.size())};
    }
}

bool is_within(const std::string& place, const std::string& outer) {
    return place.starts_with(outer) &&
           (place.size() == outer.size() || place[outer.size()] == '.' || place[outer.size()] == '[');
}

// Finds the member of a scene part in which a JSON path lies; null if there is none.
SceneMember* member_at(ScenePart& part, const std::string& place) {
    const auto found = std::find_if(part.members.begin(), part.members.end(), [&](const SceneMember& member) {
        return is_within(place, part.place + "." + member.key);
    });
    return found == part.members.end() ? nullptr : &*found;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

using SceneOf = std::function<std::string(const ScenePart&)>;

class PartsChecker {
public:
    PartsChecker(const SceneParts& parts, const std::string& file, ImportFindings& problems)
        : parts_(parts), file_(file), problems_(&problems) {}

    void check_all();

private:
    bool check(const ScenePart& part, const std::string& place, const SceneOf& scene_of);
    bool blame(ScenePart& tried, const ScenePart& part, SceneError error);
    void check_camera();
    void check_material(std::size_t index);
    void check_object(const ScenePart& object);

    SceneParts parts_;
    std::string file_;
    ImportFindings* problems_;
    bool has_camera_ = false;                            // whether the scene has a valid camera
    std::map<std::string, std::string> good_materials_;  // JSON of valid materials by name
};

// Checks a part of the scene file within the minimal scene that `scene_of` makes, where it has the JSON path `place`,
// and reports all problems. Since one faulty member hides the next, each is replaced by its stand-in and the check
// repeated. Returns whether there is no problem.
bool PartsChecker::check(const ScenePart& part, const std::string& place, const SceneOf& scene_of) {
    ScenePart tried = part;
    tried.place = place;
    for (std::size_t attempt = 0; attempt <= part.members.size(); ++attempt) {
        const std::optional<SceneError> error = error_of(scene_of(tried), file_);
        if (!error) {
            return attempt == 0;
        }
        if (!blame(tried, part, *error)) {
            return false;
        }
    }
    return false;
}

// Reports an error of a scene part at the faulty member's source line. Returns whether a stand-in replaced it.
bool PartsChecker::blame(ScenePart& tried, const ScenePart& part, SceneError error) {
    // A subsurface body around the eye is reported as an error of the camera's eye.
    const bool is_elsewhere = !is_within(error.place, tried.place) && is_within(error.place, parts_.camera.place);
    if (is_elsewhere && !has_camera_) {
        return false;
    }
    SceneMember* member = member_at(is_elsewhere ? parts_.camera : tried, error.place);
    const Cis565Line& line = member == nullptr || member->line == nullptr ? *part.head : *member->line;
    problems_->add(line.number, fmt::format("found \"{}\", which makes {} {}, allowed: {}", line.text(),
                                            replaced(error.place, tried.place, part.place),
                                            replaced(error.found, tried.place, part.place), error.allowed));
    if (is_elsewhere || member == nullptr || member->stand_in.empty()) {
        return false;
    }
    if (!member->is_of_view) {
        member->value = member->stand_in;
        return true;
    }
    for (SceneMember& other : tried.members) {
        other.value = other.is_of_view ? other.stand_in : other.value;
    }
    return true;
}

void PartsChecker::check_camera() {
    const bool is_good = check(parts_.camera, parts_.camera.place,
                               [](const ScenePart& camera) { return scene_text(other_root, camera.json(), "", ""); });
    has_camera_ = is_good && parts_.camera.is_whole;
}

// Checks one material. A material with an unreadable line is not checked, since the line could affect the others.
void PartsChecker::check_material(std::size_t index) {
    const ScenePart& material = parts_.materials[index];
    const std::string name = json_of(material.name);
    const bool is_good = material.is_whole && check(material, material.place, [&](const ScenePart& tried) {
                             return scene_text(other_root, other_camera, name + ": " + tried.json(), "");
                         });
    if (is_good) {
        good_materials_.emplace(name, material.json());
    }
}

// Checks one object with the scene's own camera and material if those are valid, since a subsurface body must not
// surround the eye.
void PartsChecker::check_object(const ScenePart& object) {
    const std::string name = "\"other\"";
    ScenePart renamed = object;
    std::string material = other_material;
    if (SceneMember* member = member_at(renamed, object.place + ".material")) {
        const auto good = good_materials_.find(member->value);
        material = good == good_materials_.end() ? material : good->second;
        member->value = name;
    } else {
        renamed.add("material", name, nullptr);
    }
    const std::string camera = has_camera_ ? parts_.camera.json() : other_camera;
    check(renamed, "$.objects[0]",
          [&](const ScenePart& tried) { return scene_text(other_root, camera, name + ": " + material, tried.json()); });
}

void PartsChecker::check_all() {
    const bool has_problems = problems_->count() > 0;
    const std::optional<SceneError> error = has_problems ? std::nullopt : error_of(parts_.json(), file_);
    if (!has_problems && !error) {
        return;
    }
    if (parts_.camera.head != nullptr) {
        check(parts_.root, parts_.root.place,
              [](const ScenePart& root) { return scene_text(root.members_json(", "), other_camera, "", ""); });
        check_camera();
    }
    for (std::size_t i = 0; i < parts_.materials.size() && problems_->count() < most_checked; ++i) {
        check_material(i);
    }
    for (std::size_t i = 0; i < parts_.objects.size() && problems_->count() < most_checked; ++i) {
        check_object(parts_.objects[i]);
    }
    if (problems_->count() == 0) {  // each scene part alone is valid, but not the whole scene
        problems_->add(
            0, fmt::format("as a scene, {}: found {}, allowed: {}", error->place, error->found, error->allowed));
    }
}

}  // namespace

std::string plain_part_of(const std::string& text) {
    std::string plain;
    for (const char c : text.substr(0, 64)) {
        plain += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' ? c : '_';
    }
    return plain;
}

// Writes a number as JSON, -0 as 0. Infinity from an overflowing product becomes the largest double, which the scene
// reader refuses as too large.
std::string json_of(double value) {
    constexpr double largest = std::numeric_limits<double>::max();
    return fmt::format("{}", std::clamp(value, -largest, largest) + 0.0);
}

std::string json_of(const Vec3d& v) { return fmt::format("[{}, {}, {}]", json_of(v.x), json_of(v.y), json_of(v.z)); }

std::string json_of(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

namespace {
constexpr std::string_view begin_of_image = "{\"image\": ";
}

std::string image_in_scene(const std::string& name) { return fmt::format("{}{}}}", begin_of_image, json_of(name)); }

bool is_image_in_scene(const std::string& value) { return value.starts_with(begin_of_image); }

std::string add_imported_mesh(ImportResult& result, const ImportSource& source, Mesh mesh) {
    const std::string stem = std::filesystem::path(source.out.empty() ? source.file : source.out).stem().string();
    const std::string name = result.files.add([&](std::size_t n) { return fmt::format("{}_mesh_{}.ply", stem, n); },
                                              result.meshes.size(), ply_of(mesh));
    result.meshes.push_back({.file = name, .mesh = std::move(mesh)});
    return name;
}

void warn_of_mesh(ImportResult& result, std::size_t line, const std::filesystem::path& file,
                  const std::vector<std::string>& warnings) {
    if (result.meshes_told.insert(file.string()).second) {
        for (const std::string& warning : warnings) {
            result.warnings.add(line, fmt::format("{}: {}", file.filename().string(), warning));
        }
    }
}

MeshesToBe::Meshes imported_meshes(const ImportResult& result, const std::string& scene_file) {
    MeshesToBe::Meshes meshes;
    for (const ImportedMesh& imported : result.meshes) {
        const std::filesystem::path path = std::filesystem::path(scene_file).parent_path() / imported.file;
        meshes[path.string()] = make_scene_mesh(imported.mesh, imported.file, true);
    }
    return meshes;
}

std::string material_name(const Cis565Section& section) {
    return section.name.empty() ? "material_" + section.label : section.name;
}

std::string ScenePart::members_json(const std::string& separator) const {
    std::string json;
    for (const SceneMember& member : members) {
        const bool is_long = member.key == "shutter";  // in a scene file the camera's shutter gets a line of its own
        json += json.empty() ? "" : is_long ? ",\n    " : separator;
        json += json_of(member.key) + ": " + member.value;
    }
    return json;
}

std::string ScenePart::json() const { return fmt::format("{{{}}}", members_json(", ")); }

std::string SceneParts::json() const {
    std::vector<std::string> material_texts, object_texts;
    for (const ScenePart& material : materials) {
        material_texts.push_back(fmt::format("    {}: {}", json_of(material.name), material.json()));
    }
    for (const ScenePart& object : objects) {
        object_texts.push_back("    " + object.json());
    }
    return fmt::format("{{\n  {},\n  \"camera\": {},\n  \"materials\": {{\n{}\n  }},\n  \"objects\": [\n{}\n  ]\n}}\n",
                       root.members_json(",\n  "), camera.json(), fmt::join(material_texts, ",\n"),
                       fmt::join(object_texts, ",\n"));
}

void check_parts(const SceneParts& parts, const std::string& file, ImportFindings& problems) {
    PartsChecker(parts, file, problems).check_all();
}

}  // namespace pt
