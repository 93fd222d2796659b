// The output of `ptbench list` as text: all on one screen, or an axis, scenes or suites in full.
#pragma once

#include <string>

#include "harness/cli/list_json.h"

namespace pt {

// The overview of `ptbench list`: a line an axis with its choices, the names of scenes and suites, and the backends.
std::string overview_text();
// The axes, a line each.
std::string axes_text();
// The features of kernels, a name a line.
std::string features_text();
// The choices of an axis, with origins, claims and tunables.
std::string axis_text(const nlohmann::ordered_json& axis);
std::string scenes_text(const nlohmann::ordered_json& scenes);
std::string suites_text();
std::string backends_text();

}  // namespace pt
