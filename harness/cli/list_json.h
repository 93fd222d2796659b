// Output of `ptbench list --json`: axes with choices, scenes, suites, backends.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace pt {

// The facts of axis.h about each axis as JSON; analysis/ptbench/io/axes.json, for Python and the schemas, is a copy.
nlohmann::ordered_json list_axis_facts();
// The names of all kernel features as JSON; analysis/ptbench/io/features.json, for the schemas, is a copy.
nlohmann::ordered_json list_features();
nlohmann::ordered_json list_axis(std::string_view axis);
nlohmann::ordered_json list_axes();
// Facts about a scene. Throws InputError if the scene does not exist.
nlohmann::ordered_json list_scene(const std::string& name_or_file);
// Code sizes and registers of a scene's kernels with all features and with fewer, compiled without needing a device.
nlohmann::ordered_json list_kernels(const std::string& scene, const std::string& architecture);
nlohmann::ordered_json list_suite(const std::string& name);
nlohmann::ordered_json list_backends();

}  // namespace pt
