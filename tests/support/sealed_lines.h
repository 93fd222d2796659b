// Journals that a test has edited, with the checksums that ptbench would have written: what is refused of them is
// refused for what they say.
#pragma once

#include <string>

#include "harness/bench/line_seal.h"

namespace pt::test {

// Each whole line of `text` that ends as an object does, with its checksum in place of the one that it has; the others,
// and a last line without its end, as they are.
inline std::string sealed_lines(const std::string& text) {
    constexpr std::string_view check = R"(,"check":")";
    constexpr std::size_t ending = check.size() + 16 + 2;  // the digits, "}
    LineSeal seal;
    std::string sealed;
    std::size_t start = 0;
    for (std::size_t end = text.find('\n'); end != std::string::npos; start = end + 1, end = text.find('\n', start)) {
        std::string line = text.substr(start, end - start);
        if (line.size() > ending && line.compare(line.size() - ending, check.size(), check) == 0) {
            line = line.substr(0, line.size() - ending) + "}";
        }
        sealed += (line.size() > 2 && line.back() == '}' ? seal.seal(line) : line) + "\n";
    }
    return sealed + text.substr(start);
}

}  // namespace pt::test
