#include "harness/interchange/import_lines.h"

#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/interchange/course_words.h"
#include "harness/nearest_name.h"
#include "harness/words.h"

namespace pt {

namespace {

constexpr std::size_t longest_text = 80;  // most bytes of a line quoted in a message

bool is_key_of_any_section(const std::string& word) {
    return find_course_word("MATERIAL", word) != nullptr || find_course_word("CAMERA", word) != nullptr ||
           find_course_word("OBJECT", word) != nullptr;
}

bool is_section(const std::string& word) {
    return word == "MATERIAL" || word == "CAMERA" || word == "OBJECT" || word == "SETTINGS";
}

bool is_shape(const std::string& key) { return key == "cube" || key == "sphere" || key == "rect" || key == "mesh"; }

// Whether a word is a mesh file's name, which in some dialects stands alone on its line.
bool is_file_name(const std::string& word) {
    for (const char* ending : {".obj", ".gltf", ".glb", ".ply"}) {
        if (word.ends_with(ending)) {
            return true;
        }
    }
    return false;
}

// The keyword that may not stand beside `key` in a section of a CIS 565 scene; empty if there is none.
std::string rival_of(const std::string& key) {
    static const std::map<std::string, std::string> rivals{
        {"cube", "sphere"}, {"sphere", "cube"}, {"LOOKAT", "VIEW"}, {"VIEW", "LOOKAT"}};
    const auto found = rivals.find(key);
    return found == rivals.end() ? "" : found->second;
}

// Whether a character can end a number; a comma behind it is skipped, as many programs read "0.5," as 0.5.
bool is_of_number(char c) { return (c >= '0' && c <= '9') || c == '.'; }

class LineSorter {
public:
    explicit LineSorter(ImportResult& result) : result_(&result) {}

    // Adds a line to the current section or starts a section. `is_first`: an empty line or a comment comes before it.
    void add(const Cis565Line& line, bool is_first);
    Cis565File take() { return std::move(file_); }

private:
    void fail(const Cis565Line& line, const std::string& allowed) {
        result_->problems.add(line.number, fmt::format("found \"{}\", allowed: {}", line.text(), allowed));
    }
    bool starts_section(const Cis565Line& line, bool is_first) const;
    // Starts a section. Returns null for a second camera, since its lines belong to no section.
    Cis565Section* start_section(const Cis565Line& line);
    Cis565Section* start_camera(const Cis565Line& line);
    void start_numbered(const Cis565Line& line, std::vector<Cis565Section>& sections);
    void add_label(const Cis565Line& line);
    void add_outside(const Cis565Line& line);
    void add_background(const Cis565Line& line);
    void add_to(Cis565Section& section, const Cis565Line& line);

    ImportResult* result_;
    Cis565File file_;
    Cis565Section* section_ = nullptr;
    bool is_outside_ = false;  // some line came before the first section of the CIS 565 scene
};

// Whether a line starts a section. In some dialects MATERIAL within an object names the object's material.
bool LineSorter::starts_section(const Cis565Line& line, bool is_first) const {
    const bool is_of_object = !is_first && section_ != nullptr && section_->kind == "OBJECT" &&
                              line.words[0] == "MATERIAL" && !section_->lines.contains("material");
    return is_section(line.words[0]) && !is_of_object;
}

void LineSorter::add(const Cis565Line& line, bool is_first) {
    const CourseWord* of_all = find_course_word("ROOT", line.words[0]);
    if (of_all != nullptr && of_all->use == CourseUse::background) {
        add_background(line);
    } else if (starts_section(line, is_first)) {
        section_ = start_section(line);
    } else if (section_ != nullptr) {
        add_to(*section_, line);
    } else {
        add_outside(line);
    }
}

Cis565Section* LineSorter::start_section(const Cis565Line& line) {
    if (line.words[0] == "CAMERA") {
        return start_camera(line);
    }
    if (line.words[0] == "SETTINGS") {
        return &file_.settings;
    }
    if (line.words[0] == "MATERIAL") {
        start_numbered(line, file_.materials);
        add_label(line);
        return &file_.materials.back();
    }
    start_numbered(line, file_.objects);
    return &file_.objects.back();
}

Cis565Section* LineSorter::start_camera(const Cis565Line& line) {
    if (file_.camera) {
        fail(line, fmt::format("one CAMERA; the first is in line {}", file_.camera->head.number));
        return nullptr;
    }
    if (line.words.size() != 1) {
        fail(line, "CAMERA alone on its line");
    }
    return &file_.camera.emplace(Cis565Section{.kind = "CAMERA", .head = line, .lines = {}});
}

// Starts a numbered section. The course's programs skip sections that do not count up from 0; students' programs do
// not, and neither does this importer.
void LineSorter::start_numbered(const Cis565Line& line, std::vector<Cis565Section>& sections) {
    const std::string next = std::to_string(sections.size());
    const std::string label = line.words.size() == 2 ? line.words[1] : "";
    if (label.empty()) {
        fail(line, fmt::format("{} {}", line.words[0], next));
    } else if (label != next) {
        result_->warnings.add(line.number, fmt::format("{} stands where {} {} does: it is not left out", line.text(),
                                                       line.words[0], next));
    }
    sections.push_back({.kind = line.words[0], .head = line, .lines = {}, .label = label.empty() ? next : label});
}

// Registers a material's label, by which objects refer to the material.
void LineSorter::add_label(const Cis565Line& line) {
    std::string& label = file_.materials.back().label;
    const auto [first, is_new] = file_.materials_by_word.emplace(label, file_.materials.size() - 1);
    if (!is_new) {
        result_->warnings.add(line.number, fmt::format("{} is not used: line {} has it", line.text(),
                                                       file_.materials[first->second].head.number));
        label += fmt::format("_{}", line.number);
    }
}

// Reports a line outside of all sections; not behind an unknown section's head, as that line is reported itself.
void LineSorter::add_outside(const Cis565Line& line) {
    const bool is_first = !file_.camera && file_.materials.empty() && file_.objects.empty() && !is_outside_;
    is_outside_ = true;
    if (is_first || !is_key_of_any_section(line.words[0])) {
        fail(line, "MATERIAL n, CAMERA or OBJECT n");
        file_.has_all_materials = false;  // an unknown section may have been meant as a MATERIAL
    }
}

// Stores the line BACKGROUND_COLOR, which belongs to no section and may be anywhere in the file.
void LineSorter::add_background(const Cis565Line& line) {
    if (file_.background) {
        fail(line, fmt::format("{} once; line {} has it", line.words[0], file_.background->number));
        return;
    }
    file_.background = line;
}

void LineSorter::add_to(Cis565Section& section, const Cis565Line& line) {
    const std::string& word = line.words[0];
    const CourseWord* known = find_course_word(section.kind, word);
    if (section.kind == "OBJECT" && known == nullptr && is_file_name(line.words.back())) {
        add_course_line(section, "FILE", line, *result_);
        return;
    }
    const bool is_of_shape = known != nullptr && is_shape(known->key) && line.words.size() != 1;
    if (is_of_shape && known->key == "mesh") {  // such as "GLTF path", which names a mesh file
        add_course_line(section, "FILE", line, *result_);
    } else if (is_of_shape) {
        fail(line, word + " alone on its line");
        section.is_whole = false;
    }
    add_course_line(section, word, line, *result_);
}

// Whether a keyword is repeated, or stands beside one that excludes it; reports a problem if so.
bool stands_twice(const Cis565Section& section, const std::string& key, const Cis565Line& line, ImportResult& result) {
    for (const std::string& other : {key, rival_of(key)}) {
        if (const auto found = section.lines.find(other); found != section.lines.end()) {
            result.problems.add(line.number,
                                fmt::format("found \"{}\", allowed: {} once; line {} has {}", line.text(),
                                            key == other ? key : key + " or " + other, found->second.number, other));
            return true;
        }
    }
    return false;
}

}  // namespace

std::string Cis565Line::text() const {
    std::string text = fmt::format("{}", fmt::join(words, " "));
    if (text.size() <= longest_text) {
        return text;
    }
    std::size_t cut = longest_text - 3;
    while (cut > 0 && (static_cast<unsigned char>(text[cut]) & 0xc0) == 0x80) {
        cut -= 1;  // moves the cut of a long message to the start of a UTF-8 character
    }
    return text.substr(0, cut) + "...";
}

void add_course_line(Cis565Section& section, const std::string& word, const Cis565Line& line, ImportResult& result) {
    const CourseWord* known = find_course_word(section.kind, word);
    const bool is_off = is_course_off(known == nullptr ? word : known->key, line.values());
    if (known == nullptr && is_off && line.words.size() > 1) {
        result.notes.add(line.number, fmt::format("{} is left out: no known key, and off", line.text()));
        return;
    }
    const auto refuse = [&](const std::string& allowed) {
        result.problems.add(line.number, fmt::format("found \"{}\", allowed: {}", line.text(), allowed));
        section.is_whole = false;
    };
    if (known == nullptr) {
        const std::vector<std::string>& keys = course_keys(section.kind);
        refuse(fmt::format("in {}: {}{}", section.kind, fmt::join(keys, ", "), did_you_mean(word, keys)));
        return;
    }
    if (known->use == CourseUse::value || (known->use == CourseUse::image && !is_off)) {
        section.is_whole &= !stands_twice(section, known->key, line, result);
        section.lines.emplace(known->key, line);
        return;
    }
    if (known->use == CourseUse::remark || (is_off && (section.kind != "OBJECT" || line.words.size() > 1))) {
        return;
    }
    if (known->use == CourseUse::run) {
        result.notes.add(line.number, fmt::format("{} is left out: it belongs to a run of the program", line.text()));
    } else if (known->use == CourseUse::lost) {
        result.warnings.add(line.number, fmt::format("{} is lost: scene files have nothing like it", line.text()));
    } else {
        refuse(missing_for(known->use));
    }
}

Cis565File read_cis565_file(const std::string& text, ImportResult& result) {
    LineSorter sorter(result);
    std::istringstream stream(text);
    std::string content;
    bool is_first = true;
    for (std::size_t number = 1; std::getline(stream, content); ++number) {
        Cis565Line line{number, {}};
        std::istringstream words(content);  // splits a line at white space, which includes the \r of Windows files
        for (std::string word; words >> word && !word.starts_with("//") && word[0] != '#';) {
            const bool is_listed = word.size() > 1 && word.back() == ',' && is_of_number(word[word.size() - 2]);
            line.words.push_back(is_listed ? word.substr(0, word.size() - 1) : word);
        }
        if (!line.words.empty()) {
            sorter.add(line, is_first);
        }
        is_first = line.words.empty();
    }
    Cis565File file = sorter.take();
    if (!file.camera) {
        result.problems.add(0, "found no CAMERA, allowed: one");
    }
    return file;
}

void Cis565SectionReader::fail(const Cis565Line& line, const std::string& found, const std::string& allowed) {
    problems_->add(line.number, fmt::format("found {}, allowed: {}", found, allowed));
    is_whole_ = false;
}

void Cis565SectionReader::fail(const Cis565Line& line, const std::string& allowed) {
    fail(line, fmt::format("\"{}\"", line.text()), allowed);
}

const Cis565Line* Cis565SectionReader::line(const std::string& key) const {
    const auto found = section_->lines.find(key);
    return found == section_->lines.end() ? nullptr : &found->second;
}

const Cis565Line* Cis565SectionReader::required(const std::string& key, const std::string& allowed) {
    const Cis565Line* found = line(key);
    if (found == nullptr) {
        fail(section_->head, fmt::format("{} without {}", section_->head.text(), key), allowed);
    }
    return found;
}

std::optional<double> Cis565SectionReader::parse(const Cis565Line& line, std::size_t word, const std::string& allowed) {
    const std::optional<double> value = parse_finite(line.words[word]);
    if (!value) {
        fail(line, allowed);
    }
    return value;
}

std::optional<double> Cis565SectionReader::whole(const Cis565Line& line, std::size_t word, const std::string& allowed) {
    const std::optional<double> value = parse(line, word, allowed);
    if (value && (*value != std::floor(*value) || *value < 0 || *value > 1e9)) {
        fail(line, allowed);
        return std::nullopt;
    }
    return value;
}

std::optional<double> Cis565SectionReader::number_of(const Cis565Line& line) {
    const std::string allowed = line.words[0] + " and 1 finite number";
    if (line.words.size() != 2) {
        fail(line, allowed);
        return std::nullopt;
    }
    const std::optional<double> value = parse(line, 1, allowed);
    if (value && *value < 0) {
        fail(line, line.words[0] + " of 0 or more");
        return std::nullopt;
    }
    return value;
}

std::optional<Vec3d> Cis565SectionReader::vector_of(const Cis565Line& line) {
    const std::string allowed = line.words[0] + " and 3 finite numbers";
    if (line.words.size() != 4) {
        fail(line, allowed);
        return std::nullopt;
    }
    double values[3] = {};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::optional<double> value = parse(line, i + 1, allowed);
        if (!value) {
            return std::nullopt;  // a line has one problem reported, even if several of its numbers are wrong
        }
        values[i] = *value;
    }
    return Vec3d(values[0], values[1], values[2]);
}

std::optional<double> Cis565SectionReader::required_number(const std::string& key) {
    const Cis565Line* found = required(key);
    return found == nullptr ? std::nullopt : number_of(*found);
}

std::optional<Vec3d> Cis565SectionReader::required_vector(const std::string& key) {
    const Cis565Line* found = required(key);
    return found == nullptr ? std::nullopt : vector_of(*found);
}

double Cis565SectionReader::number(const std::string& key) {
    const Cis565Line* found = line(key);
    return found == nullptr ? 0 : number_of(*found).value_or(0);
}

Vec3d Cis565SectionReader::vector(const std::string& key) {
    const Cis565Line* found = line(key);
    return found == nullptr ? Vec3d(0.0) : vector_of(*found).value_or(Vec3d(0.0));
}

}  // namespace pt
