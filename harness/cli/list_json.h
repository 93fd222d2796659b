// What there is, as `ptbench list --json` prints it: axes with their choices, scenes, suites, backends.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace pt {

// What each axis.h says: analysis/ptbench/io/axes.json is this, for Python and the schemas.
nlohmann::ordered_json list_axis_facts();
// Every feature that a kernel may have, by name: analysis/ptbench/io/features.json is this, for the schemas.
nlohmann::ordered_json list_features();
nlohmann::ordered_json list_axis(std::string_view axis);
nlohmann::ordered_json list_axes();
// Lists a scene. Throws InputError for one that is not there.
nlohmann::ordered_json list_scene(const std::string& name_or_file);
// Lists what leaving features out saves: a scene's kernel with everything and with less, compiled for a GPU that need
// not be there.
nlohmann::ordered_json list_kernels(const std::string& scene, const std::string& architecture);
nlohmann::ordered_json list_suite(const std::string& name);
nlohmann::ordered_json list_backends();

}  // namespace pt
