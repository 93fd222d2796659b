// Suggests the known name that is nearest to a misspelt one, by edit distance (Damerau 1964: insertions, deletions,
// substitutions and swaps of neighbours).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pt {

// Returns the number of edits that turn one text into the other, where no part of a text is edited twice.
std::size_t edit_distance(std::string_view a, std::string_view b);

// Returns " (did you mean \"NAME\"?)" with the nearest of the known names, the first of several equally near ones, or
// an empty text if no name is near enough: at most one edit in three letters.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& known);

}  // namespace pt
