// Imports an OBJECT section of a CIS 565 scene.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/interchange/course_scene.h"
#include "harness/interchange/import_cis565.h"
#include "harness/interchange/import_mtl.h"
#include "harness/json_reader.h"
#include "harness/mesh/resolution.h"
#include "harness/scene/scene_mesh.h"

namespace pt {

namespace {

constexpr const char* zero_vector = "[0, 0, 0]";
// Vertices of a square of side 1 in the plane z = 0.
constexpr const char* unit_square = "[[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]]";

class ObjectImporter {
public:
    ObjectImporter(CourseImport& import, std::size_t index)
        : import_(&import),
          section_(&import.sections->objects[index]),
          reader_(*section_, import.result->problems),
          part_{.place = fmt::format("$.objects[{}]", import.objects.size()), .head = &section_->head, .members = {}} {}

    void add();

private:
    void add_shape();
    void warn_of_shapes_beside(const std::string& shape, const std::vector<std::string>& others);
    void add_mesh();
    bool has_own_materials() const;
    void add_own_parts(const std::filesystem::path& file, const Cis565Line& line);
    void add_vertices();
    void add_material();
    void add_transform();
    void add_velocity();
    std::optional<std::size_t> material_index(const Cis565Line& line);
    std::optional<Vec3d> vector_or(const std::string& key, double neutral);
    void stand_in();
    void warn_of_change(const std::string& key, const std::string& other);

    CourseImport* import_;
    const Cis565Section* section_;
    Cis565SectionReader reader_;
    ScenePart part_;
    std::vector<OwnPart> own_parts_;
    Vec3d turned_{0.0}, scale_{1.0}, place_{0.0};
};

void ObjectImporter::add_shape() {
    const auto has = [&](const char* key) { return reader_.line(key) != nullptr; };
    if (has("sphere") || has("cube")) {
        part_.add("shape", has("sphere") ? "\"sphere\"" : "\"box\"", nullptr);
        warn_of_shapes_beside(has("sphere") ? "sphere" : "cube", {"rect", "VERTICES", "mesh", "FILE"});
        return;
    }
    if (has("rect")) {
        warn_of_shapes_beside("rect", {"VERTICES", "mesh", "FILE"});
        part_.add("shape", "\"mesh\"", nullptr);
        part_.add("vertices", unit_square, nullptr);
        part_.add("triangles", "[[0, 1, 2], [0, 2, 3]]", nullptr);
        return;
    }
    if (has("VERTICES")) {
        warn_of_shapes_beside("VERTICES", {"FILE"});
        add_vertices();
    } else if (has("mesh") || has("FILE")) {
        add_mesh();
    } else {
        part_.add("shape", "\"box\"", nullptr);
        reader_.fail(section_->head, fmt::format("{} without a shape", section_->head.text()), "with cube or sphere");
    }
}

// Warns of an object's further shapes, as it can have only one. Some programs show a mesh behind all objects too.
void ObjectImporter::warn_of_shapes_beside(const std::string& shape, const std::vector<std::string>& others) {
    const Cis565Line* told = nullptr;
    for (const std::string& key : others) {
        const Cis565Line* line = reader_.line(key);
        if (line != nullptr && (told == nullptr || told->number != line->number)) {
            import_->result->warnings.add(line->number,
                                          fmt::format("{} is lost: {} is a {}, and an object has one shape (write an "
                                                      "OBJECT with a material for it)",
                                                      line->text(), section_->head.text(), shape));
            told = line;
        }
    }
}

// Replaces an unavailable mesh by a box, so that the object's other lines can be checked.
void ObjectImporter::stand_in() {
    part_.members.clear();
    part_.add("shape", "\"box\"", nullptr);
}

void ObjectImporter::add_mesh() {
    part_.add("shape", "\"mesh\"", nullptr);
    const Cis565Line* line = reader_.required("FILE", "with the file of its mesh");
    if (line == nullptr) {
        stand_in();
        return;
    }
    const std::string called = course_file_name(*line);
    const auto& aliases = import_->sections->mesh_files;
    const std::string name = aliases.contains(called) ? aliases.at(called) : called;
    const auto found = import_->files.find(name);
    if (!found) {
        reader_.fail(*line, "a mesh file that is there, beside this one or in a folder above it");
        stand_in();
        return;
    }
    if (has_own_materials()) {
        add_own_parts(*found, *line);
        return;
    }
    try {
        warn_of_mesh(*import_->result, line->number, *found, mesh_from_file(*found)->warnings);
    } catch (const InputError& refusal) {
        reader_.fail(*line, fmt::format("\"{}\", of which is said: {}", line->text(), refusal.what()),
                     "a mesh that can be read");
        stand_in();
        return;
    }
    if (!found->string().ends_with(std::filesystem::path(name).lexically_normal().relative_path().string())) {
        import_->result->notes.add(line->number, fmt::format("{} is taken from {}", line->text(), found->string()));
    }
    part_.add("file", json_of(name_beside(course_scene_file(*import_->source), *found)), line);
}

// Whether an object uses the materials of its mesh file: its material is -1 or, in JSON, missing.
bool ObjectImporter::has_own_materials() const {
    const auto has = [&](const char* key) { return reader_.line(key) != nullptr; };
    const bool is_mesh = (has("mesh") || has("FILE")) && !has("sphere") && !has("cube") && !has("rect");
    if (!is_mesh || has("VERTICES")) {
        return false;
    }
    const Cis565Line* material = reader_.line("material");
    return material == nullptr ? import_->sections->is_json : material->words.size() == 2 && material->words[1] == "-1";
}

void ObjectImporter::add_own_parts(const std::filesystem::path& file, const Cis565Line& line) {
    if (ending_of(file) != ".obj") {
        const Cis565Line* material = reader_.line("material");
        reader_.fail(material == nullptr ? section_->head : *material,
                     "a material (of mesh files only the materials of .obj are read)");
        stand_in();
        return;
    }
    own_parts_ = import_own_materials(*import_, file, line);
    if (own_parts_.empty()) {
        stand_in();
        part_.is_whole = false;
    }
}

// Adds an object whose VERTICES line has three corners of three numbers for each triangle.
void ObjectImporter::add_vertices() {
    part_.add("shape", "\"mesh\"", nullptr);
    const Cis565Line& line = *reader_.line("VERTICES");
    const std::size_t count = line.words.size() - 1;
    if (count == 0 || count % 9 != 0) {
        reader_.fail(line, "three corners of three numbers for each triangle");
        stand_in();
        return;
    }
    std::vector<std::string> vertices, triangles;
    Mesh mesh;
    RoundingLoss loss;
    for (std::size_t i = 0; i < count; i += 3) {
        const Vec3d corner =
            reader_.vector_of({line.number, {line.words[0], line.words[i + 1], line.words[i + 2], line.words[i + 3]}})
                .value_or(Vec3d(0.0));
        vertices.push_back(json_of(corner));
        const Vec3<float> rounded(corner);
        mesh.vertices.push_back({rounded.x, rounded.y, rounded.z});
        loss.add({corner.x, corner.y, corner.z}, mesh.vertices.back(), i / 3);
    }
    for (std::uint32_t i = 0; i < count / 3; i += 3) {
        triangles.push_back(fmt::format("[{}, {}, {}]", i, i + 1, i + 2));
        mesh.triangles.push_back({i, i + 1, i + 2});
    }
    if (const auto warning = resolution_warning(mesh, loss.largest())) {
        import_->result->warnings.add(line.number, fmt::format("VERTICES has {}", *warning));
    }
    part_.add("vertices", fmt::format("[{}]", fmt::join(vertices, ", ")), &line);
    part_.add("triangles", fmt::format("[{}]", fmt::join(triangles, ", ")), &line);
}

std::optional<std::size_t> ObjectImporter::material_index(const Cis565Line& line) {
    const Cis565File& file = *import_->sections;
    const std::string word = line.words.size() == 2 ? line.words[1] : "";
    if (const auto found = file.materials_by_word.find(word); found != file.materials_by_word.end()) {
        return found->second;
    }
    const std::size_t count = file.materials.size();
    if (file.is_json && line.words.size() == 2 && count > 0) {
        // If an object names no material of the scene, the course's loader takes the first material in order of names.
        const auto first = std::min_element(file.materials.begin(), file.materials.end(),
                                            [](const auto& a, const auto& b) { return a.name < b.name; });
        import_->result->warnings.add(
            line.number, fmt::format("{} is none of $.Materials: read as \"{}\", the first by its name, which the "
                                     "course's loader takes then",
                                     line.text(), first->name));
        return static_cast<std::size_t>(first - file.materials.begin());
    }
    if (file.is_json) {
        reader_.fail(line, "the name of one of $.Materials");
    } else if (file.has_all_materials || word.empty()) {
        reader_.fail(line, count == 0
                               ? "no material is there"
                               : fmt::format("material 0 to {}{}", count - 1,
                                             word == "-1" ? " (-1 is a mesh's, the materials of its own file)" : ""));
    }
    return std::nullopt;
}

void ObjectImporter::add_material() {
    if (has_own_materials()) {
        return;
    }
    const Cis565Line* line = reader_.required("material");
    const std::optional<std::size_t> index = line == nullptr ? std::nullopt : material_index(*line);
    if (index) {
        import_->used_materials.insert(*index);
        part_.add("material", json_of(material_name(import_->sections->materials[*index])), line);
    }
}

// Reads a vector of the object's transform or returns its neutral value. Programs that read texts take a missing SCALE
// as 0, so it is required in texts.
std::optional<Vec3d> ObjectImporter::vector_or(const std::string& key, double neutral) {
    const bool may_be_missing = import_->sections->is_json || key != "SCALE";
    if (reader_.line(key) != nullptr || !may_be_missing) {
        return reader_.required_vector(key);
    }
    import_->result->warnings.add(section_->head.number,
                                  fmt::format("{} has no {}: read as {}", section_->head.text(), key, neutral));
    return Vec3d(neutral);
}

void ObjectImporter::add_transform() {
    const auto add = [&](const std::string& key, const std::optional<Vec3d>& value, double neutral, const char* line) {
        if (value && *value != Vec3d(neutral)) {
            const bool is_uniform = key == "scale" && value->x == value->y && value->y == value->z;
            part_.add(key, is_uniform ? json_of(value->x) : json_of(*value), reader_.line(line),
                      key == "scale" ? "1" : zero_vector);
        }
    };
    const std::optional<Vec3d> place = vector_or("TRANS", 0), turned = vector_or("ROTAT", 0);
    place_ = place.value_or(Vec3d(0.0));
    turned_ = turned ? rotation_x_first(*turned) : Vec3d(0.0);
    add("translate", place, 0, "TRANS");
    add("rotate_degrees", turned_, 0, "ROTAT");
    if (reader_.line("RADIUS") != nullptr && reader_.line("SCALE") == nullptr) {
        scale_ = Vec3d(2 * reader_.number("RADIUS"));
        add("scale", scale_, 1, "RADIUS");
    } else {
        const std::optional<Vec3d> scale = vector_or("SCALE", 1);
        scale_ = scale.value_or(Vec3d(1.0));
        add("scale", scale, 1, "SCALE");
    }
}

// Warns that a shape rotates or scales while the shutter is open, which scene files cannot express.
void ObjectImporter::warn_of_change(const std::string& key, const std::string& other) {
    const Cis565Line* line = reader_.line(key);
    const Vec3d still = other.empty() ? Vec3d(0.0) : reader_.vector(other);
    if (line != nullptr && reader_.vector(key) != still) {
        import_->result->warnings.add(
            line->number, fmt::format("{} is lost: shapes neither turn nor grow; this one stays as it is when the "
                                      "shutter opens",
                                      line->text()));
    }
}

// Adds the velocity in units a second: VEL itself; T_MOTION, the distance in the second that the shutter is open;
// ANIMET, a velocity before the object's own transform; or TRANS_DST, the place where TRANS ends.
void ObjectImporter::add_velocity() {
    warn_of_change("ANIMER", "");
    warn_of_change("ROTAT_DST", "ROTAT");
    warn_of_change("SCALE_DST", "SCALE");
    Vec3d velocity = reader_.vector("VEL");
    std::string key = "VEL";
    if (reader_.line("ANIMET") != nullptr) {
        const Vec3d inner = reader_.vector("ANIMET");
        const Rotation turn = rotation_of(turned_);
        key = "ANIMET";
        velocity = turn.column[0] * (inner.x * scale_.x) + turn.column[1] * (inner.y * scale_.y) +
                   turn.column[2] * (inner.z * scale_.z);
    } else if (reader_.line("T_MOTION") != nullptr) {
        key = "T_MOTION";
        velocity = reader_.vector(key);
    } else if (reader_.line("TRANS_DST") != nullptr) {
        key = "TRANS_DST";
        velocity = reader_.vector(key) - place_;
    }
    if (velocity == Vec3d(0.0)) {
        return;
    }
    part_.add("velocity", json_of(velocity), reader_.line(key), zero_vector);
    if (import_->motion.first == nullptr) {
        import_->motion = {reader_.line(key), key == "VEL"};
    }
}

void ObjectImporter::add() {
    add_shape();
    add_material();
    add_transform();
    add_velocity();
    part_.is_whole = part_.is_whole && reader_.is_whole();
    if (own_parts_.empty()) {
        import_->objects.push_back(part_);
    }
    for (const OwnPart& own : own_parts_) {
        ScenePart part = part_;
        part.place = fmt::format("$.objects[{}]", import_->objects.size());
        part.add("file", json_of(own.file), reader_.line("FILE"));
        part.add("material", json_of(own.material), reader_.line("FILE"));
        import_->objects.push_back(std::move(part));
    }
}

}  // namespace

std::string course_file_name(const Cis565Line& line) {
    const std::size_t first = line.words.size() > 1 ? 1 : 0;
    return fmt::format("{}", fmt::join(line.words.begin() + static_cast<std::ptrdiff_t>(first), line.words.end(), " "));
}

std::string name_beside(const std::filesystem::path& scene, const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::path folder =
        std::filesystem::canonical(std::filesystem::absolute(scene, error).parent_path(), error);
    const std::filesystem::path found = std::filesystem::weakly_canonical(file);
    const std::filesystem::path relative = error ? std::filesystem::path() : found.lexically_relative(folder);
    return relative.empty() ? found.string() : relative.string();
}

void import_object(CourseImport& import, std::size_t index) { ObjectImporter(import, index).add(); }

std::string course_scene_file(const ImportSource& source) {
    const std::string& beside = source.out.empty() ? source.file : source.out;
    return (std::filesystem::path(beside).parent_path() / "scene.json").string();
}

}  // namespace pt
