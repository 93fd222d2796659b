#include "harness/scene/import_cis565.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/json_reader.h"
#include "harness/scene/import_parts.h"

namespace pt {

namespace {

constexpr const char* zero_vector = "[0, 0, 0]";

bool is_scene_name(const std::string& word) {
    const Json json(word);
    try {
        (void)JsonValue(json, "", "").plain_name();
        return true;
    } catch (const InputError&) {
        return false;
    }
}

class SceneImporter {
public:
    SceneImporter(const Cis565File& sections, const std::string& file, const std::string& name, ImportResult& result)
        : sections_(&sections), file_(file), name_(name), result_(&result) {}

    SceneParts parts();

private:
    void read_name(Cis565SectionReader& reader, ScenePart& root);
    ScenePart root();
    ScenePart camera();
    void add_view(Cis565SectionReader& reader, ScenePart& camera) const;
    void add_resolution(Cis565SectionReader& reader, ScenePart& camera) const;
    ScenePart object(std::size_t index);
    void add_material(Cis565SectionReader& reader, ScenePart& object);
    void note_samples();
    void note_unused_materials();

    const Cis565File* sections_;
    std::string file_, name_;
    ImportResult* result_;
    const Cis565Line* first_velocity_ = nullptr;  // that is not 0
    std::set<std::size_t> used_materials_;
};

// Where a line cannot be read, a value that is right stands for it, so that the others can be checked.
void SceneImporter::read_name(Cis565SectionReader& reader, ScenePart& root) {
    const Cis565Line* line = reader.line("FILE");
    const bool is_good = line != nullptr && line->words.size() == 2 && is_scene_name(line->words[1]);
    if (!name_.empty()) {
        root.add("name", json_of(name_), nullptr);
        if (line != nullptr && !is_good) {
            result_->warnings.add(line->number,
                                  fmt::format("{} is not used: it is no scene name, {} is", line->text(), name_));
        }
        return;
    }
    if (is_good) {
        root.add("name", json_of(line->words[1]), line);
        return;
    }
    if (line != nullptr) {
        reader.fail(*line, "FILE and a name: 1 to 64 letters, digits, '_' and '-'; or import with --name NAME");
    } else {
        (void)reader.required("FILE", "with it; or import with --name NAME");
    }
    root.add("name", json_of(std::string("unnamed")), nullptr);
}

ScenePart SceneImporter::root() {
    ScenePart root{.place = "$", .head = &sections_->camera->head, .members = {}};
    Cis565SectionReader reader(*sections_->camera, result_->problems);
    read_name(reader, root);
    root.add("description", json_of("Imported from " + std::filesystem::path(file_).filename().string() + "."),
             nullptr);
    const std::string allowed = "DEPTH and 1 whole number";
    std::optional<double> depth;
    if (const Cis565Line* line = reader.required("DEPTH")) {
        if (line->words.size() != 2) {
            reader.fail(*line, allowed);
        } else {
            depth = reader.whole(*line, 1, allowed);
        }
    }
    root.add("max_depth", json_of(depth.value_or(1)), depth ? reader.line("DEPTH") : nullptr, "1");
    root.is_whole = reader.is_whole();
    return root;
}

// Eye, point and direction up are allowed or not together: where one cannot be read, others stand for all three.
void SceneImporter::add_view(Cis565SectionReader& reader, ScenePart& camera) const {
    const std::string view_key = reader.line("VIEW") != nullptr ? "VIEW" : "LOOKAT";
    const std::optional<Vec3d> eye = reader.required_vector("EYE");
    const std::optional<Vec3d> view = reader.required_vector(view_key);
    const std::optional<Vec3d> up = reader.required_vector("UP");
    const bool is_good = eye && view && up;
    const auto add = [&](const std::string& key, const Vec3d& value, const std::string& line, const Vec3d& stand_in) {
        camera.members.push_back({.key = key,
                                  .value = json_of(is_good ? value : stand_in),
                                  .line = is_good ? reader.line(line) : nullptr,
                                  .stand_in = json_of(stand_in),
                                  .is_of_view = true});
    };
    const Vec3d from = eye.value_or(Vec3d(0.0)), to = view.value_or(Vec3d(0.0));
    add("eye", from, "EYE", {0, 0, 1});
    add("look_at", view_key == "VIEW" ? from + to : to, view_key, {0, 0, 0});
    add("up", up.value_or(Vec3d(0.0)), "UP", {0, 1, 0});
}

void SceneImporter::add_resolution(Cis565SectionReader& reader, ScenePart& camera) const {
    const std::string allowed = "RES and 2 whole numbers, width and height";
    std::optional<double> width, height;
    if (const Cis565Line* line = reader.required("RES")) {
        if (line->words.size() != 3) {
            reader.fail(*line, allowed);
        } else if ((width = reader.whole(*line, 1, allowed))) {
            height = reader.whole(*line, 2, allowed);
        }
    }
    const std::string stand_in = "[1, 1]";
    const bool is_good = width && height;
    camera.add("resolution", is_good ? fmt::format("[{}, {}]", json_of(*width), json_of(*height)) : stand_in,
               is_good ? reader.line("RES") : nullptr, stand_in);
}

ScenePart SceneImporter::camera() {
    ScenePart camera{.place = "$.camera", .head = &sections_->camera->head, .members = {}};
    Cis565SectionReader reader(*sections_->camera, result_->problems);
    add_view(reader, camera);
    const std::optional<double> half_angle = reader.required_number("FOVY");
    camera.add("vertical_fov_degrees", json_of(2 * half_angle.value_or(30)), half_angle ? reader.line("FOVY") : nullptr,
               "60");
    add_resolution(reader, camera);
    if (first_velocity_ != nullptr) {
        camera.add("shutter", "{\"open\": 0, \"close\": 1, \"density\": \"late\"}", nullptr);
        result_->warnings.add(first_velocity_->number,
                              fmt::format("{}: the file does not say when the shutter is open; it is open from 0 to 1 "
                                          "with the density \"late\"",
                                          first_velocity_->text()));
    }
    (void)reader.number("ITERATIONS");  // of no use, but it must be a number
    camera.is_whole = reader.is_whole();
    return camera;
}

void SceneImporter::add_material(Cis565SectionReader& reader, ScenePart& object) {
    const Cis565Line* line = reader.required("material");
    if (line == nullptr) {
        return;
    }
    const std::size_t count = sections_->materials.size();
    const std::string allowed = count == 0 ? "no material is there" : fmt::format("material 0 to {}", count - 1);
    if (line->words.size() != 2) {
        reader.fail(*line, allowed);
        return;
    }
    const std::optional<double> index = reader.whole(*line, 1, allowed);
    if (!index || !sections_->has_all_materials) {
        return;
    }
    if (*index >= static_cast<double>(count)) {
        reader.fail(*line, allowed);
        return;
    }
    used_materials_.insert(static_cast<std::size_t>(*index));
    object.add("material", json_of(material_name(static_cast<std::size_t>(*index))), line);
}

ScenePart SceneImporter::object(std::size_t index) {
    const Cis565Section& section = sections_->objects[index];
    ScenePart object{.place = fmt::format("$.objects[{}]", index), .head = &section.head, .members = {}};
    Cis565SectionReader reader(section, result_->problems);
    if (reader.line("cube") == nullptr && reader.line("sphere") == nullptr) {
        reader.fail(section.head, fmt::format("{} without a shape", section.head.text()), "with cube or sphere");
    }
    object.add("shape", reader.line("sphere") != nullptr ? "\"sphere\"" : "\"box\"", nullptr);
    add_material(reader, object);
    const auto add = [&](const std::string& key, const std::optional<Vec3d>& value, double neutral, const char* line) {
        if (value && *value != Vec3d(neutral)) {
            const bool is_uniform = key == "scale" && value->x == value->y && value->y == value->z;
            object.add(key, is_uniform ? json_of(value->x) : json_of(*value), reader.line(line),
                       key == "scale" ? "1" : zero_vector);
        }
    };
    add("translate", reader.required_vector("TRANS"), 0, "TRANS");
    const std::optional<Vec3d> turned = reader.required_vector("ROTAT");
    add("rotate_degrees", turned ? std::optional(rotation_x_first(*turned)) : std::nullopt, 0, "ROTAT");
    add("scale", reader.required_vector("SCALE"), 1, "SCALE");
    const Vec3d velocity = reader.vector("VEL");
    add("velocity", velocity, 0, "VEL");
    if (velocity != Vec3d(0.0) && first_velocity_ == nullptr) {
        first_velocity_ = reader.line("VEL");
    }
    object.is_whole = reader.is_whole();
    return object;
}

void SceneImporter::note_samples() {
    const auto& lines = sections_->camera->lines;
    if (const auto found = lines.find("ITERATIONS"); found != lines.end()) {
        result_->notes.add(found->second.number,
                           fmt::format("{} is left out: how many samples a pixel gets is a run's business (--spp)",
                                       found->second.text()));
    }
}

void SceneImporter::note_unused_materials() {
    constexpr std::size_t most_named = 10;
    std::vector<std::size_t> unused;
    for (std::size_t i = 0; i < sections_->materials.size(); ++i) {
        if (!used_materials_.contains(i)) {
            unused.push_back(i);
        }
    }
    const std::size_t count = unused.size();
    if (count > 0) {
        unused.resize(std::min(most_named, count));
        const std::string more = count > most_named ? fmt::format(" and {} more", count - most_named) : "";
        result_->notes.add(0,
                           fmt::format("kept, though no object has it: material {}{}", fmt::join(unused, ", "), more));
    }
}

SceneParts SceneImporter::parts() {
    SceneParts parts;
    for (std::size_t i = 0; i < sections_->materials.size(); ++i) {
        parts.materials.push_back(import_material(sections_->materials[i], i, result_->problems, result_->warnings));
    }
    for (std::size_t i = 0; i < sections_->objects.size(); ++i) {
        parts.objects.push_back(object(i));
    }
    note_unused_materials();
    if (sections_->camera) {
        parts.root = root();
        parts.camera = camera();
        note_samples();
    }
    return parts;
}

}  // namespace

ImportResult import_cis565_scene(const std::string& text, const std::string& file, const std::string& name) {
    ImportResult result;
    if (text.size() > largest_import) {
        result.problems.add(0, fmt::format("found {} bytes, allowed: at most {}", text.size(), largest_import));
        return result;
    }
    const Cis565File sections = read_cis565_file(text, result.problems);
    const SceneParts parts = SceneImporter(sections, file, name, result).parts();
    check_parts(parts, result.problems);
    result.objects = sections.objects.size();
    result.materials = sections.materials.size();
    if (result.problems.count() == 0) {
        result.json = parts.json();
    }
    return result;
}

Vec3d rotation_x_first(const Vec3d& degrees) {
    const int turned = (degrees.x != 0 ? 1 : 0) + (degrees.y != 0 ? 1 : 0) + (degrees.z != 0 ? 1 : 0);
    if (turned <= 1) {
        return degrees;
    }
    // Rx(a) Ry(b) Rz(c) is the transpose of Rz(-c) Ry(-b) Rx(-a), so the columns of that are its rows.
    const Rotation transpose = rotation_of(-degrees);
    const auto matrix = [&](int row, int column) { return transpose.column[row][column]; };
    const double cosine_y = std::hypot(matrix(0, 0), matrix(1, 0));
    // Where cosine_y is 0, x and z turn about the same axis, and z may as well be 0.
    const double cosine_z = cosine_y > 0 ? matrix(0, 0) / cosine_y : 1;
    const double sine_z = cosine_y > 0 ? matrix(1, 0) / cosine_y : 0;
    // x from what Rz^-1 leaves, not from the third row: that one is noise near cosine_y = 0.
    const double sine_x = sine_z * matrix(0, 2) - cosine_z * matrix(1, 2);
    const double cosine_x = cosine_z * matrix(1, 1) - sine_z * matrix(0, 1);
    const auto angle = [](double sine, double cosine) {
        const double value = std::atan2(sine, cosine) * (180.0 / pi<double>);
        return std::round(value * 1e12) / 1e12;  // 30.000000000000004 is 30
    };
    return {angle(sine_x, cosine_x), angle(-matrix(2, 0), cosine_y), angle(sine_z, cosine_z)};
}

}  // namespace pt
