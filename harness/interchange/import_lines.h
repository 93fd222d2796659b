// A scene of CIS 565 as sections of lines by the course's own words, before anything is made of them: from a text, or
// from the course's JSON format, whose members are lines too (import_course_json.h).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/interchange/import_result.h"
#include "harness/scene/scene.h"

namespace pt {

struct Cis565Line {
    std::size_t number = 0;          // from 1
    std::vector<std::string> words;  // the key, in JSON its path, and the values

    // The words with a space between them, cut where they are more than a message should hold.
    std::string text() const;
    std::vector<std::string> values() const { return {words.begin() + 1, words.end()}; }
};

// A MATERIAL, CAMERA or OBJECT line and the lines up to the next one, by the course's words for them.
struct Cis565Section {
    std::string kind;
    Cis565Line head;
    std::map<std::string, Cis565Line> lines;
    bool is_whole = true;    // false: a line of it is no line of the format
    std::string name = "";   // of a material in JSON
    std::string label = "";  // in texts, what is behind MATERIAL: a number, or a word
};

struct Cis565File {
    std::vector<Cis565Section> materials, objects;
    std::optional<Cis565Section> camera;
    Cis565Section settings{.kind = "SETTINGS", .head = {}, .lines = {}};
    std::optional<Cis565Line> background;  // in no section
    bool has_all_materials = true;  // false: one may be missing, so nobody knows whether an object means that one
    std::map<std::string, std::size_t> materials_by_word;  // that objects mean them by: labels, in JSON names
    bool is_json = false;                           // objects name their material, and what is neutral may be missing
    std::string stem;                               // stands for a FILE that is missing; empty: none may be
    std::map<std::string, std::string> mesh_files;  // by the names that objects call them
};

// Reads the text of a scene of CIS 565. What is no line of the format is a problem, and left out; so is what changes
// the picture beyond what scenes hold.
Cis565File read_cis565_file(const std::string& text, ImportResult& result);

// A line by what its word is for: kept, left out, or refused. `word` as the file has it.
void add_course_line(Cis565Section& section, const std::string& word, const Cis565Line& line, ImportResult& result);

// Reads the values of one section. What cannot be read is a problem; the section is not whole then.
class Cis565SectionReader {
public:
    Cis565SectionReader(const Cis565Section& section, ImportFindings& problems)
        : section_(&section), problems_(&problems), is_whole_(section.is_whole) {}

    bool is_whole() const { return is_whole_; }
    void fail(const Cis565Line& line, const std::string& found, const std::string& allowed);
    // Notes a problem of a line, and names the whole line as what was found.
    void fail(const Cis565Line& line, const std::string& allowed);

    // The line of a key; null where there is none, which is a problem if it is required.
    const Cis565Line* line(const std::string& key) const;
    const Cis565Line* required(const std::string& key, const std::string& allowed = "with it");

    // These return nothing where the line is missing or wrong. Numbers of the format are never below 0.
    std::optional<double> required_number(const std::string& key);
    std::optional<Vec3d> required_vector(const std::string& key);
    // A word of the line as a whole number from 0 to 10^9.
    std::optional<double> whole(const Cis565Line& line, std::size_t word, const std::string& allowed);
    // A line as a vector, or as a number of 0 or more.
    std::optional<double> number_of(const Cis565Line& line);
    std::optional<Vec3d> vector_of(const Cis565Line& line);
    // The number or vector of a key; 0 where there is no such line, or a wrong one.
    double number(const std::string& key);
    Vec3d vector(const std::string& key);

private:
    std::optional<double> parse(const Cis565Line& line, std::size_t word, const std::string& allowed);

    const Cis565Section* section_;
    ImportFindings* problems_;
    bool is_whole_;
};

}  // namespace pt
