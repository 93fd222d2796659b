// Reads studies of suite files from before ptbench 1.1. Those name the figure that a study is drawn as, where later
// files say what the study compares.
#pragma once

#include <string>

#include "harness/json_reader.h"

namespace pt {

inline constexpr const char* older_figure_key = "figure";

struct Compared {
    std::string compares, along;
};

// What a study of an older suite compares that names this figure. `own_tunables` are the tunables that the study names.
// Throws InputError for an unknown figure.
Compared compared_by_figure(const JsonValue& figure, const std::vector<std::string>& own_tunables);

}  // namespace pt
