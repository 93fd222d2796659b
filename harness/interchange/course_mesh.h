// Finds the mesh files and images that CIS 565 scenes name by paths of their author's working folder or disk.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace pt {

class CourseFileFinder {
public:
    explicit CourseFileFinder(const std::string& scene_file);

    // Finds a file that a scene names, or nothing. Tried in turn: the name relative to the scene file; ever shorter
    // ends of the path in the scene's folder and the folders above; a file of that name anywhere in the project (the
    // parent of the folder "scenes"). A name without extension matches mesh formats.
    std::optional<std::filesystem::path> find(const std::string& name);

private:
    std::optional<std::filesystem::path> find_above(const std::string& name) const;
    void list_project();

    std::filesystem::path folder_;
    std::optional<std::map<std::string, std::filesystem::path>>
        project_;  // paths of mesh and image files by file name; meshes also by their name without extension
};

}  // namespace pt
