// Where scenes and suites lie: in $PTBENCH_HOME, beside the binary, or one folder up (a build folder in the
// repository).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/scene/scene.h"

namespace pt {

// The folder that holds scenes/. Throws InputError if there is none.
std::filesystem::path home_folder();

// Names of the shipped scenes and suites, sorted.
std::vector<std::string> scene_names();
std::vector<std::string> suite_names();

// A shipped scene by name, or any file by a path that ends in .json. Throws InputError.
Scene find_scene(const std::string& name_or_file);
std::string find_suite_file(const std::string& name_or_file);

}  // namespace pt
