// A text file in the CIS 565 format as sections of lines, before anything is made of them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/scene/import_findings.h"
#include "harness/scene/scene.h"

namespace pt {

struct Cis565Line {
    std::size_t number = 0;  // from 1
    std::vector<std::string> words;

    // The words with a space between them, cut where they are more than a message should hold.
    std::string text() const;
};

// A MATERIAL, CAMERA or OBJECT line and the lines up to the next one, by their first word.
struct Cis565Section {
    Cis565Line head;
    std::map<std::string, Cis565Line> lines;
    bool is_whole = true;  // false: a line of it is no line of the format
};

struct Cis565File {
    std::vector<Cis565Section> materials, objects;
    std::optional<Cis565Section> camera;
    bool has_all_materials = true;  // false: one is missing, or may be, so nobody knows which an object means
};

// What is no line of the format is a problem, and left out.
Cis565File read_cis565_file(const std::string& text, ImportFindings& problems);

// Reads the values of one section. What cannot be read is a problem; the section is not whole then.
class Cis565SectionReader {
public:
    Cis565SectionReader(const Cis565Section& section, ImportFindings& problems)
        : section_(&section), problems_(&problems), is_whole_(section.is_whole) {}

    bool is_whole() const { return is_whole_; }
    void fail(const Cis565Line& line, const std::string& found, const std::string& allowed);
    // Found is the line itself.
    void fail(const Cis565Line& line, const std::string& allowed);

    // Null where there is no such line; a problem if it is required.
    const Cis565Line* line(const std::string& key) const;
    const Cis565Line* required(const std::string& key, const std::string& allowed = "with it");

    // Nothing where the line is missing or wrong. Numbers of the format are never below 0.
    std::optional<double> required_number(const std::string& key);
    std::optional<Vec3d> required_vector(const std::string& key);
    // A word of the line as a whole number from 0 to 10^9.
    std::optional<double> whole(const Cis565Line& line, std::size_t word, const std::string& allowed);
    // 0 where there is no such line, or a wrong one.
    double number(const std::string& key);
    Vec3d vector(const std::string& key);

private:
    std::optional<double> parse(const Cis565Line& line, std::size_t word, const std::string& allowed);
    std::optional<double> number_of(const Cis565Line& line);
    std::optional<Vec3d> vector_of(const Cis565Line& line);

    const Cis565Section* section_;
    ImportFindings* problems_;
    bool is_whole_;
};

}  // namespace pt
