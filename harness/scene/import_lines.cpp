#include "harness/scene/import_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/nearest_name.h"

namespace pt {

namespace {

constexpr std::size_t longest_text = 80;  // bytes of a line that a message quotes

const std::map<std::string, std::vector<std::string>>& keys_of_sections() {
    static const std::map<std::string, std::vector<std::string>> keys{
        {"MATERIAL", {"RGB", "SPECEX", "SPECRGB", "REFL", "REFR", "REFRIOR", "EMITTANCE", "SIGMAA", "SIGMAS"}},
        {"CAMERA", {"RES", "FOVY", "ITERATIONS", "DEPTH", "FILE", "EYE", "LOOKAT", "VIEW", "UP"}},
        {"OBJECT", {"cube", "sphere", "material", "TRANS", "ROTAT", "SCALE", "VEL"}},
    };
    return keys;
}

bool contains(const std::vector<std::string>& list, const std::string& word) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

bool is_key_of_any_section(const std::string& word) {
    const auto& sections = keys_of_sections();
    return std::any_of(sections.begin(), sections.end(), [&](const auto& s) { return contains(s.second, word); });
}

// The key that may not stand beside this one; empty: there is none.
std::string rival_of(const std::string& key) {
    static const std::map<std::string, std::string> rivals{
        {"cube", "sphere"}, {"sphere", "cube"}, {"LOOKAT", "VIEW"}, {"VIEW", "LOOKAT"}};
    const auto found = rivals.find(key);
    return found == rivals.end() ? "" : found->second;
}

class LineSorter {
public:
    explicit LineSorter(ImportFindings& problems) : problems_(&problems) {}

    void add(const Cis565Line& line);
    Cis565File take() { return std::move(file_); }

private:
    void fail(const Cis565Line& line, const std::string& allowed) {
        problems_->add(line.number, fmt::format("found \"{}\", allowed: {}", line.text(), allowed));
    }
    // Null for a second camera: nobody knows whose the lines behind it are.
    Cis565Section* start_section(const Cis565Line& line);
    Cis565Section* start_camera(const Cis565Line& line);
    bool start_numbered(const Cis565Line& line, std::vector<Cis565Section>& sections, std::size_t& next);
    void add_outside(const Cis565Line& line);
    void add_to(Cis565Section& section, const Cis565Line& line);

    ImportFindings* problems_;
    Cis565File file_;
    Cis565Section* section_ = nullptr;
    std::size_t next_material_ = 0, next_object_ = 0;
    bool is_outside_ = false;  // a line was, before the first section
};

void LineSorter::add(const Cis565Line& line) {
    if (keys_of_sections().contains(line.words[0])) {
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
    if (line.words[0] == "MATERIAL") {
        file_.has_all_materials &= start_numbered(line, file_.materials, next_material_);
        return &file_.materials.back();
    }
    start_numbered(line, file_.objects, next_object_);
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
    return &file_.camera.emplace(Cis565Section{.head = line, .lines = {}});
}

// Returns whether the number is `next`. After a wrong one counting goes on from there: a gap is one problem.
bool LineSorter::start_numbered(const Cis565Line& line, std::vector<Cis565Section>& sections, std::size_t& next) {
    const bool is_next = line.words.size() == 2 && line.words[1] == std::to_string(next);
    if (!is_next) {
        fail(line, fmt::format("{} {} (they count up from 0)", line.words[0], next));
    }
    std::size_t number = next;
    if (line.words.size() >= 2) {
        std::from_chars(line.words[1].data(), line.words[1].data() + line.words[1].size(), number);
    }
    next = number + 1;
    sections.push_back({.head = line, .lines = {}});
    return is_next;
}

// The keys behind a section's head that was not known follow from that: they are no problems of their own.
void LineSorter::add_outside(const Cis565Line& line) {
    const bool is_first = !file_.camera && file_.materials.empty() && file_.objects.empty() && !is_outside_;
    is_outside_ = true;
    if (is_first || !is_key_of_any_section(line.words[0])) {
        fail(line, "MATERIAL n, CAMERA or OBJECT n");
        file_.has_all_materials = false;  // this may have been one
    }
}

void LineSorter::add_to(Cis565Section& section, const Cis565Line& line) {
    const std::string& key = line.words[0];
    const std::string& kind = section.head.words[0];
    const std::vector<std::string>& keys = keys_of_sections().at(kind);
    const auto refuse = [&](const std::string& allowed) {
        fail(line, allowed);
        section.is_whole = false;
    };
    if (!contains(keys, key)) {
        refuse(fmt::format("in {}: {}{}", kind, fmt::join(keys, ", "), did_you_mean(key, keys)));
        return;
    }
    const std::string rival = rival_of(key);
    for (const std::string& other : {key, rival}) {
        if (const auto found = section.lines.find(other); found != section.lines.end()) {
            refuse(fmt::format("{} once; line {} has {}", key == other ? key : key + " or " + other,
                               found->second.number, other));
            return;
        }
    }
    if ((key == "cube" || key == "sphere") && line.words.size() != 1) {
        refuse(key + " alone on its line");
    }
    section.lines.emplace(key, line);
}

}  // namespace

std::string Cis565Line::text() const {
    std::string text = fmt::format("{}", fmt::join(words, " "));
    if (text.size() <= longest_text) {
        return text;
    }
    std::size_t cut = longest_text - 3;
    while (cut > 0 && (static_cast<unsigned char>(text[cut]) & 0xc0) == 0x80) {
        cut -= 1;  // not within a character of UTF-8
    }
    return text.substr(0, cut) + "...";
}

Cis565File read_cis565_file(const std::string& text, ImportFindings& problems) {
    LineSorter sorter(problems);
    std::istringstream stream(text);
    std::string content;
    for (std::size_t number = 1; std::getline(stream, content); ++number) {
        Cis565Line line{number, {}};
        std::istringstream words(content);  // white space includes the \r of files from Windows
        for (std::string word; words >> word;) {
            line.words.push_back(word);
        }
        if (!line.words.empty() && !line.words[0].starts_with("//")) {
            sorter.add(line);
        }
    }
    Cis565File file = sorter.take();
    if (!file.camera) {
        problems.add(0, "found no CAMERA, allowed: one");
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
    const std::string& text = line.words[word];
    double value = 0;
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(begin, end, value);
    if (error != std::errc() || stopped != end || !std::isfinite(value)) {
        fail(line, allowed);
        return std::nullopt;
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
            return std::nullopt;  // one problem a line
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
