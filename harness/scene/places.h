// Finds scene and suite files. Their home folder is $PTBENCH_HOME, the folder beside the binary, or the one above (a
// build folder in the repository).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "harness/scene/scene.h"

namespace pt {

// The folder that holds scenes/. Throws InputError if there is none.
std::filesystem::path home_folder();

// Names of the shipped scenes and suites, sorted.
std::vector<std::string> scene_names();
std::vector<std::string> suite_names();

// Loads a shipped scene by name, or any scene by a path that ends in .json. Prints to stderr how many degenerate
// triangles were left out of its meshes. Throws InputError.
Scene find_scene(const std::string& name_or_file);
// Whether a scene was loaded from a shipped file, so that every user of the program finds it by name.
bool is_shipped(const Scene& scene);
// Whether a scene file has mesh objects, so that loading the scene reads or generates meshes. Throws InputError.
bool names_meshes(const std::string& scene_name_or_file);
// Loads several scenes for one run, in the order given. If different scenes have the same name in their files, each is
// renamed to NAME@H, H the first 8 digits of its hash, a name that no file may contain.
std::vector<Scene> find_scenes(const std::vector<std::string>& names_or_files);
// Path of a suite's file, by the suite's name, its old name if it was renamed, or its path.
std::string find_suite_file(const std::string& name_or_file);
// The present name of a renamed suite. Empty if no suite had the old name, or if one has it again.
std::string_view new_name_of_suite(std::string_view old_name);

}  // namespace pt
