#include "harness/nearest_name.h"

#include <algorithm>

#include <fmt/format.h>

namespace pt {

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> edits(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) {
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                edits[i][j] = i + j;
                continue;
            }
            const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
            edits[i][j] = std::min({edits[i - 1][j] + 1, edits[i][j - 1] + 1, edits[i - 1][j - 1] + change});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                edits[i][j] = std::min(edits[i][j], edits[i - 2][j - 2] + 1);
            }
        }
    }
    return edits[a.size()][b.size()];
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& known) {
    constexpr std::size_t longest = 64;  // longest text, in letters, that counts as a misspelt name
    if (name.empty() || name.size() > longest) {
        return "";
    }
    const std::string* nearest = nullptr;
    std::size_t fewest = std::max<std::size_t>(1, name.size() / 3) + 1;
    for (const std::string& candidate : known) {
        const std::size_t edits = edit_distance(name, candidate);
        if (edits < fewest && edits < candidate.size()) {
            fewest = edits;
            nearest = &candidate;
        }
    }
    return nearest == nullptr ? "" : fmt::format(" (did you mean \"{}\"?)", *nearest);
}

}  // namespace pt
