// A text file in the CIS 565 format as sections of lines, before anything is made of them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/scene/import_findings.h"
#include "harness/scene/scene.h"

namespace pt {

struct SeedLine {
    std::size_t number = 0;  // from 1
    std::vector<std::string> words;

    // The words with a space between them, cut where they are more than a message should hold.
    std::string text() const;
};

// A MATERIAL, CAMERA or OBJECT line and the lines up to the next one, by their first word.
struct SeedSection {
    SeedLine head;
    std::map<std::string, SeedLine> lines;
    bool is_whole = true;  // false: a line of it is no line of the format
};

struct SeedFile {
    std::vector<SeedSection> materials, objects;
    std::optional<SeedSection> camera;
    bool has_all_materials = true;  // false: one is missing, or may be, so nobody knows which an object means
};

// What is no line of the format is a problem, and left out.
SeedFile read_seed_file(const std::string& text, ImportFindings& problems);

// Reads the values of one section. What cannot be read is a problem; the section is not whole then.
class SeedSectionReader {
public:
    SeedSectionReader(const SeedSection& section, ImportFindings& problems)
        : section_(&section), problems_(&problems), is_whole_(section.is_whole) {}

    bool is_whole() const { return is_whole_; }
    void fail(const SeedLine& line, const std::string& found, const std::string& allowed);
    // Found is the line itself.
    void fail(const SeedLine& line, const std::string& allowed);

    // Null where there is no such line; a problem if it is required.
    const SeedLine* line(const std::string& key) const;
    const SeedLine* required(const std::string& key, const std::string& allowed = "with it");

    // Nothing where the line is missing or wrong. Numbers of the format are never below 0.
    std::optional<double> required_number(const std::string& key);
    std::optional<Vec3d> required_vector(const std::string& key);
    // A word of the line as a whole number from 0 to 10^9.
    std::optional<double> whole(const SeedLine& line, std::size_t word, const std::string& allowed);
    // 0 where there is no such line, or a wrong one.
    double number(const std::string& key);
    Vec3d vector(const std::string& key);

private:
    std::optional<double> parse(const SeedLine& line, std::size_t word, const std::string& allowed);
    std::optional<double> number_of(const SeedLine& line);
    std::optional<Vec3d> vector_of(const SeedLine& line);

    const SeedSection* section_;
    ImportFindings* problems_;
    bool is_whole_;
};

}  // namespace pt
