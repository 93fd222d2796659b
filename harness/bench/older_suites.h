// What suites of before 1.1 say otherwise: they name the figure that a study is drawn as, where a suite now says what
// the study compares.
#pragma once

#include <string>

#include "harness/json_reader.h"

namespace pt {

inline constexpr const char* older_figure_key = "figure";

struct Compared {
    std::string compares, along;
};

// What a study with this figure compares. `own_tunables` are the study's. Throws InputError for a name that no figure
// had.
Compared compared_by_figure(const JsonValue& figure, const std::vector<std::string>& own_tunables);

}  // namespace pt
