#include "harness/interchange/import_cis565.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/interchange/course_scene.h"
#include "harness/interchange/course_words.h"
#include "harness/json_reader.h"
#include "harness/scene/scene_mesh.h"
#include "harness/scene/texture_image.h"

namespace pt {

namespace {

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
    SceneImporter(const Cis565File& sections, const ImportSource& source, ImportResult& result)
        : sections_(&sections),
          source_(&source),
          result_(&result),
          import_{.sections = &sections, .source = &source, .result = &result, .files = CourseFileFinder(source.file)} {
    }

    // Converts the sections to parts of the scene file, which point to source lines that live as long as this importer.
    SceneParts parts();

private:
    void read_name(Cis565SectionReader& reader, ScenePart& root);
    ScenePart root();
    void add_environment(ScenePart& root, CourseFileFinder& files);
    void add_background(ScenePart& root);
    void note_samples();
    void note_unused_materials(const std::set<std::size_t>& used);

    const Cis565File* sections_;
    const ImportSource* source_;
    ImportResult* result_;
    CourseImport import_;
};

void SceneImporter::read_name(Cis565SectionReader& reader, ScenePart& root) {
    const Cis565Line* line = reader.line("FILE");
    const bool is_good = line != nullptr && line->words.size() == 2 && is_scene_name(line->words[1]);
    if (!source_->name.empty()) {
        root.add("name", json_of(source_->name), nullptr);
        if (line != nullptr && !is_good) {
            result_->warnings.add(
                line->number, fmt::format("{} is not used: it is no scene name, {} is", line->text(), source_->name));
        }
        return;
    }
    if (is_good) {
        root.add("name", json_of(line->words[1]), line);
        return;
    }
    // FILE names the picture that the course's program writes; without folders and extension it names the scene.
    std::string picture = line != nullptr && line->words.size() == 2 ? line->words[1] : "";
    std::replace(picture.begin(), picture.end(), '\\', '/');
    const std::string stem = std::filesystem::path(picture).stem().string();
    if (is_scene_name(stem)) {
        result_->notes.add(line->number, fmt::format("{}: the scene is called {}", line->text(), stem));
        root.add("name", json_of(stem), line);
        return;
    }
    if (line == nullptr && is_scene_name(sections_->stem)) {
        root.add("name", json_of(sections_->stem), nullptr);
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
    root.add("description", json_of("Imported from " + std::filesystem::path(source_->file).filename().string() + "."),
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

// Adds the environment map named by the camera's ENVIRONMENT line; other values of the line are not used.
void SceneImporter::add_environment(ScenePart& root, CourseFileFinder& files) {
    const auto line = sections_->camera->lines.find("ENVIRONMENT");
    if (line == sections_->camera->lines.end() || is_course_off("ENVIRONMENT", line->second.values())) {
        return;
    }
    Cis565SectionReader reader(*sections_->camera, result_->problems);
    const std::vector<std::string> values = line->second.values();
    const auto name = std::find_if(values.begin(), values.end(), [](const std::string& value) {
        return value.ends_with(".hdr") || value.ends_with(".exr");
    });
    const auto found = name != values.end() ? files.find(*name) : std::nullopt;
    if (!found) {
        reader.fail(line->second, "an image .hdr or .exr that is there, beside this file or in a folder above it");
        return;
    }
    try {
        (void)read_environment_image(*found);
    } catch (const InputError& refusal) {
        reader.fail(line->second, fmt::format("\"{}\", of which is said: {}", line->second.text(), refusal.what()),
                    "an image that can be read");
        return;
    }
    // Most dialects look up environment maps as learnopengl.com's "Diffuse irradiance": u = 1/2 + atan2(z, x) / 2 pi.
    result_->warnings.add(
        line->second.number,
        fmt::format("{} has the direction -x at the image's left edge and +x in its middle{}; formats "
                    "of the course do not say",
                    line->second.text(), values.size() > 1 ? ", its other values are not used" : ""));
    root.add(
        "environment",
        fmt::format("{{\"file\": {}, \"rotation\": 90}}", json_of(name_beside(course_scene_file(*source_), *found))),
        &line->second, "[0, 0, 0]");
}

// Adds BACKGROUND_COLOR, the radiance of rays that hit nothing.
void SceneImporter::add_background(ScenePart& root) {
    const std::optional<Cis565Line>& line = sections_->background;
    if (!line || is_course_off("BACKGROUND_COLOR", line->values())) {
        return;
    }
    Cis565SectionReader reader(*sections_->camera, result_->problems);
    const bool has_other = std::any_of(root.members.begin(), root.members.end(),
                                       [](const SceneMember& member) { return member.key == "environment"; });
    if (has_other) {
        reader.fail(*line, "a colour or an environment map, not both");
    } else if (const std::optional<Vec3d> radiance = reader.vector_of(*line)) {
        root.add("environment", json_of(*radiance), &*line, "[0, 0, 0]");
    }
}

void SceneImporter::note_samples() {
    const auto& lines = sections_->camera->lines;
    if (const auto found = lines.find("ITERATIONS"); found != lines.end()) {
        result_->notes.add(found->second.number,
                           fmt::format("{} is left out: how many samples a pixel gets is a run's business (--spp)",
                                       found->second.text()));
    }
}

void SceneImporter::note_unused_materials(const std::set<std::size_t>& used) {
    constexpr std::size_t most_named = 10;
    std::vector<std::string> unused;
    for (std::size_t i = 0; i < sections_->materials.size(); ++i) {
        if (const Cis565Section& material = sections_->materials[i]; !used.contains(i)) {
            unused.push_back(sections_->is_json ? material.name : material.label);
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
        import_.materials.push_back(import_material(import_, i));
    }
    for (std::size_t i = 0; i < sections_->objects.size(); ++i) {
        import_object(import_, i);
    }
    parts.materials = import_.materials;
    parts.objects = import_.objects;
    note_unused_materials(import_.used_materials);
    if (sections_->camera) {
        parts.root = root();
        add_environment(parts.root, import_.files);
        add_background(parts.root);
        parts.camera = import_camera(import_);
        note_samples();
    }
    return parts;
}

}  // namespace

void import_course(const Cis565File& sections, const ImportSource& source, ImportResult& result) {
    const ImagesToBe each_read_once;
    SceneImporter importer(sections, source, result);
    const SceneParts parts = importer.parts();
    const std::string file = course_scene_file(source);
    const MeshesToBe to_be(imported_meshes(result, file));
    check_parts(parts, file, result.problems);
    result.objects = parts.objects.size();
    result.materials = parts.materials.size();
    if (result.problems.count() == 0) {
        result.json = parts.json();
    }
}

ImportResult import_cis565(const ImportSource& source) {
    ImportResult result(source);
    if (source.text.size() > largest_import) {
        result.problems.add(0, fmt::format("found {} bytes, allowed: at most {}", source.text.size(), largest_import));
        return result;
    }
    import_course(read_cis565_file(source.text, result), source, result);
    return result;
}

ImportResult import_cis565_scene(const std::string& text, const std::string& file, const std::string& name) {
    return import_cis565({.text = text, .file = file, .out = "", .name = name});
}

Vec3d rotation_x_first(const Vec3d& degrees) {
    const int turned = (degrees.x != 0 ? 1 : 0) + (degrees.y != 0 ? 1 : 0) + (degrees.z != 0 ? 1 : 0);
    if (turned <= 1) {
        return degrees;
    }
    // Rx(a) Ry(b) Rz(c) is the transpose of Rz(-c) Ry(-b) Rx(-a): rows of the former are columns of the latter.
    const Rotation transpose = rotation_of(-degrees);
    const auto matrix = [&](int row, int column) { return transpose.column[row][column]; };
    const double cosine_y = std::hypot(matrix(0, 0), matrix(1, 0));
    // Gimbal lock: if the cosine of the y angle is 0, x and z rotate about the same axis, so the z angle is set to 0.
    const double cosine_z = cosine_y > 0 ? matrix(0, 0) / cosine_y : 1;
    const double sine_z = cosine_y > 0 ? matrix(1, 0) / cosine_y : 0;
    // The x angle is computed after undoing the z rotation, as the matrix's third row is noise if cosine_y is near 0.
    const double sine_x = sine_z * matrix(0, 2) - cosine_z * matrix(1, 2);
    const double cosine_x = cosine_z * matrix(1, 1) - sine_z * matrix(0, 1);
    const auto angle = [](double sine, double cosine) {
        const double value = std::atan2(sine, cosine) * (180.0 / pi<double>);
        return std::round(value * 1e12) / 1e12;  // removes rounding errors of angles, as in 30.000000000000004 degrees
    };
    return {angle(sine_x, cosine_x), angle(-matrix(2, 0), cosine_y), angle(sine_z, cosine_z)};
}

}  // namespace pt
