// Problems, warnings and notes of an import, one line of text each.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace pt {

struct ImportFinding {
    std::size_t line = 0;  // line in the source file, from 1; 0: the whole file
    std::string text;      // text of the problem, warning or note, one line
};

// Findings of an import in file order: all are counted, since every line may be wrong, but only the first are kept.
class ImportFindings {
public:
    static constexpr std::size_t most_listed = 50;

    void add(std::size_t line, const std::string& text);

    std::size_t count() const { return count_; }
    const std::vector<ImportFinding>& listed() const { return listed_; }
    // Messages "FILE:LINE: KIND: TEXT" for the findings that are kept, and the number of further ones. With an empty
    // `kind` the "KIND: " is left out.
    std::vector<std::string> messages(const std::string& file, const std::string& kind) const;

private:
    std::vector<ImportFinding> listed_;
    std::size_t count_ = 0;
};

}  // namespace pt
