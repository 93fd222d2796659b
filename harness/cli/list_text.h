// Output of `ptbench list` as text: an overview of everything, or an axis, scenes or suites in detail.
#pragma once

#include <string>

#include "harness/cli/list_json.h"

namespace pt {

// The overview of `ptbench list`: one line for each axis with its choices, names of scenes and suites, backends.
std::string overview_text();
// The output of `ptbench list axes`: one line for each axis.
std::string axes_text();
// The list of kernel features, one name per line.
std::string features_text();
// The choices of an axis, with origins, claims and tunables.
std::string axis_text(const nlohmann::ordered_json& axis);
std::string scenes_text(const nlohmann::ordered_json& scenes);
std::string suites_text();
std::string backends_text();

}  // namespace pt
