// The mesh files and images that scenes of CIS 565 name: relative to a folder that their author's program ran in, or on
// a disk that nobody else has.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace pt {

class CourseFileFinder {
public:
    explicit CourseFileFinder(const std::string& scene_file);

    // The name itself, beside the scene file; else as much of its end as there is in one of the folders above it, the
    // longest end first; else a file of that name somewhere in the project: beside the folder "scenes" that the scene
    // is in. A name without an ending has that of a format of meshes. Nothing where there is no such file.
    std::optional<std::filesystem::path> find(const std::string& name);

private:
    std::optional<std::filesystem::path> find_above(const std::string& name) const;
    void list_project();

    std::filesystem::path folder_;
    std::optional<std::map<std::string, std::filesystem::path>>
        project_;  // by file names with their endings; of meshes, without too
};

}  // namespace pt
