// A CIS 565 scene parsed into sections of lines with the course's own keywords, before conversion. Members of the JSON
// format (import_course_json.h) become lines too.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/interchange/import_result.h"
#include "harness/scene/scene.h"

namespace pt {

struct Cis565Line {
    std::size_t number = 0;          // line number in the CIS 565 scene file, from 1
    std::vector<std::string> words;  // the line's keyword (in JSON: its path), then its values

    // The words of a CIS 565 scene's line joined by spaces, cut to the length of a message.
    std::string text() const;
    std::vector<std::string> values() const { return {words.begin() + 1, words.end()}; }
};

// A MATERIAL, CAMERA or OBJECT section: its head line and the lines up to the next head, by keyword.
struct Cis565Section {
    std::string kind;
    Cis565Line head;
    std::map<std::string, Cis565Line> lines;
    bool is_whole = true;    // false: some line of the section is invalid
    std::string name = "";   // name of the material, for a MATERIAL section in JSON
    std::string label = "";  // number or word behind MATERIAL, for a section in the text format
};

struct Cis565File {
    std::vector<Cis565Section> materials, objects;
    std::optional<Cis565Section> camera;
    Cis565Section settings{.kind = "SETTINGS", .head = {}, .lines = {}};
    std::optional<Cis565Line> background;                  // line BACKGROUND_COLOR, which belongs to no section
    bool has_all_materials = true;                         // false: some MATERIAL section could not be read
    std::map<std::string, std::size_t> materials_by_word;  // index of each material by its label (text) or name (JSON)
    bool is_json = false;                                  // JSON format: materials have names, values may be missing
    std::string stem;                                      // scene name if no FILE line; empty: the line is required
    std::map<std::string, std::string> mesh_files;         // mesh files by name, from the JSON member "Meshes"
};

// Parses a CIS 565 scene in the text format. Invalid lines are reported as problems and left out, and so are lines that
// change the picture in ways that scene files cannot express.
Cis565File read_cis565_file(const std::string& text, ImportResult& result);

// Keeps, skips or refuses a line of a CIS 565 scene by the use of its keyword, which the file spells `word`.
void add_course_line(Cis565Section& section, const std::string& word, const Cis565Line& line, ImportResult& result);

// Reads the values of one section of a CIS 565 scene. A value that cannot be read is reported as a problem, and the
// section no longer counts as whole.
class Cis565SectionReader {
public:
    Cis565SectionReader(const Cis565Section& section, ImportFindings& problems)
        : section_(&section), problems_(&problems), is_whole_(section.is_whole) {}

    bool is_whole() const { return is_whole_; }
    void fail(const Cis565Line& line, const std::string& found, const std::string& allowed);
    // Reports a problem of a source line and quotes the whole line.
    void fail(const Cis565Line& line, const std::string& allowed);

    // Finds the line of a CIS 565 section with a keyword; null if there is none, which `required` reports as a problem.
    const Cis565Line* line(const std::string& key) const;
    const Cis565Line* required(const std::string& key, const std::string& allowed = "with it");

    // Values of a line that a CIS 565 section must have; nothing if it is missing or wrong. A number must be >= 0.
    std::optional<double> required_number(const std::string& key);
    std::optional<Vec3d> required_vector(const std::string& key);
    // Reads a word of a source line as a whole number from 0 to 10^9.
    std::optional<double> whole(const Cis565Line& line, std::size_t word, const std::string& allowed);
    // Reads a line of a CIS 565 scene as a vector, or as a single number >= 0.
    std::optional<double> number_of(const Cis565Line& line);
    std::optional<Vec3d> vector_of(const Cis565Line& line);
    // Reads the number or vector of an optional keyword in a section; 0 if its line is missing or wrong.
    double number(const std::string& key);
    Vec3d vector(const std::string& key);

private:
    std::optional<double> parse(const Cis565Line& line, std::size_t word, const std::string& allowed);

    const Cis565Section* section_;
    ImportFindings* problems_;
    bool is_whole_;
};

}  // namespace pt
