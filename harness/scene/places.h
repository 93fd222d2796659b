// Finds the folder in which scenes and suites lie: $PTBENCH_HOME, beside the binary, or one folder up (a build folder
// in the repository).
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

// A shipped scene by name, or any file by a path that ends in .json. Says on stderr how many triangles without area
// its meshes were read without. Throws InputError.
Scene find_scene(const std::string& name_or_file);
// Whether the scene's file is one of those that come with the program: who has the program finds it by its name.
bool is_shipped(const Scene& scene);
// Whether the scene's file names a mesh, which reading it would load or generate. Throws InputError.
bool names_meshes(const std::string& scene_name_or_file);
// Several for one run, in the order given. Different scenes may have one name in their files (the course's call theirs
// "cornell"): each of these is called NAME@H here, H the first 8 digits of its hash, which no file can call itself.
std::vector<Scene> find_scenes(const std::vector<std::string>& names_or_files);
// A suite's file; an old name of a shipped suite is found too.
std::string find_suite_file(const std::string& name_or_file);
// The name that a shipped suite has now which had another; empty: no suite had this name, or one has it again.
std::string_view new_name_of_suite(std::string_view old_name);

}  // namespace pt
