#include "harness/interchange/import_course_json.h"

#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "harness/interchange/course_scene.h"
#include "harness/interchange/course_words.h"
#include "harness/json_reader.h"
#include "harness/nearest_name.h"
#include "harness/scene/json_lines.h"

namespace pt {

namespace {

// Collects all numbers and words of a JSON value, however nested, as the words of a line.
void add_words(const Json& value, std::vector<std::string>& words) {
    if (value.is_structured()) {
        for (const Json& element : value) {
            add_words(element, words);
        }
    } else if (value.is_string()) {
        words.push_back(value.get<std::string>());
    } else if (value.is_boolean()) {
        words.emplace_back(value.get<bool>() ? "1" : "0");
    } else {
        words.push_back(value.is_null() ? "NULL" : value.dump());
    }
}

class CourseJsonReader {
public:
    CourseJsonReader(const Json& root, const std::string& text, ImportResult& result)
        : root_(&root), lines_(lines_of_json(text)), result_(&result) {}

    Cis565File read();

private:
    Cis565Line line(const std::string& place, const Json& value = Json::array()) const;
    void fail(const Cis565Line& found, const std::string& allowed) {
        result_->problems.add(found.number, fmt::format("found \"{}\", allowed: {}", found.text(), allowed));
    }
    void read_root();
    void read_meshes();
    void read_materials();
    void read_objects();
    Cis565Section section(const std::string& kind, const Json& value, const std::string& place);
    void add_member(Cis565Section& section, const std::string& key, const Json& value, const std::string& place);
    const Json* member(const char* key);

    const Json* root_;
    std::map<std::string, std::size_t> lines_;
    ImportResult* result_;
    Cis565File file_;
    std::optional<Cis565Line> environment_;
};

Cis565Line CourseJsonReader::line(const std::string& place, const Json& value) const {
    const auto found = lines_.find(place);
    Cis565Line line{found == lines_.end() ? 0 : found->second, {place}};
    add_words(value, line.words);
    return line;
}

// Finds a top-level member of the JSON scene; null if it is missing, which is reported as a problem.
const Json* CourseJsonReader::member(const char* key) {
    if (root_->contains(key)) {
        return &root_->at(key);
    }
    result_->problems.add(0, fmt::format("found no \"{}\", allowed: one", key));
    return nullptr;
}

void CourseJsonReader::read_root() {
    for (const auto& [key, value] : root_->items()) {
        const CourseWord* known = find_course_word("ROOT", key);
        const Cis565Line found = line("$." + key, value);
        if (known == nullptr) {
            fail(found, "Materials, Camera and Objects" + did_you_mean(key, course_keys("ROOT")));
        } else if (known->use == CourseUse::value && known->key != key) {
            fail(found, known->key);
        } else if (known->use == CourseUse::environment) {
            environment_ = found;
        } else if (known->use == CourseUse::background) {
            file_.background = found;
        } else if (known->use != CourseUse::value && known->use != CourseUse::remark &&
                   !is_course_off(key, found.values())) {
            fail(found, missing_for(known->use));
        }
    }
}

void CourseJsonReader::read_meshes() {
    if (!root_->contains("Meshes") || !root_->at("Meshes").is_object()) {
        return;
    }
    for (const auto& [name, value] : root_->at("Meshes").items()) {
        if (value.is_string()) {
            file_.mesh_files.emplace(name, value.get<std::string>());
        }
    }
}

// Adds a member of the JSON scene to a section as a line with the text format's keywords. An object's TYPE and file
// keys are mapped to the text format's shape and FILE lines.
void CourseJsonReader::add_member(Cis565Section& section, const std::string& key, const Json& value,
                                  const std::string& place) {
    const Cis565Line found = line(place + "." + key, value);
    const std::string spelling = course_spelling(key);
    if (section.kind != "OBJECT") {
        add_course_line(section, key, found, *result_);
        return;
    }
    if (spelling == "TYPE") {
        const std::string type = value.is_string() ? value.get<std::string>() : "";
        const CourseWord* known = find_course_word("OBJECT", type);
        const bool is_shape = known != nullptr && (known->key == "cube" || known->key == "sphere" ||
                                                   known->key == "rect" || known->key == "mesh");
        if (is_shape || (known != nullptr && known->use == CourseUse::procedural)) {
            add_course_line(section, type, found, *result_);
        } else {
            fail(found, "cube, sphere, rect, mesh, obj or gltf");
            section.is_whole = false;
        }
        return;
    }
    const bool names_a_file = spelling == "MESH" || spelling == "OBJFILE" || spelling == "OBJ" || spelling == "GLTF";
    add_course_line(section, names_a_file ? "FILE" : key, found, *result_);
}

Cis565Section CourseJsonReader::section(const std::string& kind, const Json& value, const std::string& place) {
    Cis565Section section{.kind = kind, .head = line(place), .lines = {}};
    if (!value.is_object()) {
        fail(section.head, "an object");
        section.is_whole = false;
        return section;
    }
    for (const auto& [key, member] : value.items()) {
        add_member(section, key, member, place);
    }
    return section;
}

void CourseJsonReader::read_materials() {
    const Json* materials = member("Materials");
    if (materials == nullptr) {
        return;
    }
    if (!materials->is_object()) {
        fail(line("$.Materials"), "an object of named materials");
        return;
    }
    for (const auto& [name, value] : materials->items()) {
        file_.materials.push_back(section("MATERIAL", value, "$.Materials." + name));
        file_.materials.back().name = name;
        file_.materials_by_word.emplace(name, file_.materials.size() - 1);
    }
}

void CourseJsonReader::read_objects() {
    const Json* objects = member("Objects");
    if (objects == nullptr) {
        return;
    }
    if (!objects->is_array()) {
        fail(line("$.Objects"), "a list of objects");
        return;
    }
    for (std::size_t i = 0; i < objects->size(); ++i) {
        file_.objects.push_back(section("OBJECT", (*objects)[i], fmt::format("$.Objects[{}]", i)));
    }
}

Cis565File CourseJsonReader::read() {
    file_.is_json = true;
    read_root();
    read_meshes();
    read_materials();
    if (const Json* camera = member("Camera")) {
        file_.camera = section("CAMERA", *camera, "$.Camera");
        if (environment_) {
            file_.camera->lines.emplace("ENVIRONMENT", *environment_);
        }
    }
    read_objects();
    return std::move(file_);
}

// Strips the file name from the start of a JSON parser's message, since messages of an import begin with it anyway.
std::string without_file(const std::string& message, const std::string& file) {
    return message.starts_with(file + ": ") ? message.substr(file.size() + 2) : message;
}

}  // namespace

ImportResult import_course_json(const ImportSource& source) {
    ImportResult result(source);
    if (source.text.size() > largest_import) {
        result.problems.add(0, fmt::format("found {} bytes, allowed: at most {}", source.text.size(), largest_import));
        return result;
    }
    Json root;
    try {
        root = parse_json(source.text, source.file);
    } catch (const InputError& error) {
        result.problems.add(0, without_file(error.what(), source.file));
        return result;
    }
    if (!root.is_object()) {
        result.problems.add(0, "found " + describe(root) + ", allowed: an object with Materials, Camera and Objects");
        return result;
    }
    if (root.contains("materials") && root.contains("camera") && root.contains("objects")) {
        result.problems.add(0, "found a scene file of ptbench, allowed: a scene of CIS 565 (this one needs no import)");
        return result;
    }
    Cis565File sections = CourseJsonReader(root, source.text, result).read();
    sections.stem = std::filesystem::path(source.file).stem().string();
    import_course(sections, source, result);
    return result;
}

bool is_like_json(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string::npos && text[first] == '{';
}

}  // namespace pt
