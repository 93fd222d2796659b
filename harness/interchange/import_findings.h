// What the importer has to say of a text file, a line each.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace pt {

struct ImportFinding {
    std::size_t line = 0;  // of the text file, from 1; 0: it is about the file as a whole
    std::string text;      // one line
};

// What an import found in a file, in the file's order. A file can be wrong in every line: all findings are counted, the
// first are kept.
class ImportFindings {
public:
    static constexpr std::size_t most_listed = 50;

    void add(std::size_t line, const std::string& text);

    std::size_t count() const { return count_; }
    const std::vector<ImportFinding>& listed() const { return listed_; }
    // A message for each finding that is kept, "FILE:LINE: KIND: TEXT", and how many more there are. An empty `kind`
    // goes without its colon.
    std::vector<std::string> messages(const std::string& file, const std::string& kind) const;

private:
    std::vector<ImportFinding> listed_;
    std::size_t count_ = 0;
};

}  // namespace pt
