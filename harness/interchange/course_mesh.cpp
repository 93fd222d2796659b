#include "harness/interchange/course_mesh.h"

#include <algorithm>
#include <vector>

#include "harness/json_reader.h"
#include "harness/words.h"

namespace pt {

namespace {

namespace fs = std::filesystem;

constexpr const char* mesh_endings[] = {".obj", ".gltf", ".glb", ".ply"};
constexpr const char* image_endings[] = {".png", ".jpg", ".jpeg"};
constexpr int most_folders_above = 4;
constexpr int most_folders_below = 5;
constexpr int most_entries = 20000;  // most directory entries searched for one mesh file

bool is_file(const fs::path& path) {
    std::error_code error;
    return fs::is_regular_file(path, error);
}

std::optional<fs::path> with_an_ending(const fs::path& path) {
    if (is_file(path)) {
        return path;
    }
    for (const char* ending : mesh_endings) {
        if (!path.has_extension() && is_file(path.string() + ending)) {
            return path.string() + ending;
        }
    }
    return std::nullopt;
}

// Splits a path of any operating system into parts: "C:\course\scenes\a.obj" has course, scenes and a.obj.
std::vector<std::string> parts_of(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    std::vector<std::string> parts;
    for (const fs::path& part : fs::path(name)) {
        const std::string text = part.string();
        if (text == "..") {
            parts.clear();  // folders of a path before ".." are unknown
        } else if (text != "." && text != "/" && !text.empty() && text.back() != ':') {
            parts.push_back(text);
        }
    }
    return parts;
}

bool is_called_scenes(const fs::path& folder) {
    const std::string name = in_lower_case(folder.filename().string());
    return name == "scenes" || name == "scene";
}

// The folder of the author's project, which is the parent of "scenes"; without one, the scene's own folder.
fs::path project_of(const fs::path& folder) {
    fs::path above = folder;
    for (int level = 0; level < most_folders_above && above.has_relative_path(); ++level) {
        if (is_called_scenes(above)) {
            return above.parent_path();
        }
        above = above.parent_path();
    }
    return folder;
}

}  // namespace

CourseFileFinder::CourseFileFinder(const std::string& scene_file) {
    std::error_code error;
    folder_ = fs::absolute(scene_file, error).parent_path();
}

std::optional<fs::path> CourseFileFinder::find_above(const std::string& name) const {
    const std::vector<std::string> parts = parts_of(name);
    for (std::size_t first = 0; first < parts.size(); ++first) {
        fs::path end;
        for (std::size_t i = first; i < parts.size(); ++i) {
            end /= parts[i];
        }
        fs::path above = folder_;
        for (int level = 0; level < most_folders_above && above.has_relative_path(); ++level) {
            if (const auto found = with_an_ending(above / end)) {
                return found;
            }
            above = above.parent_path();
        }
    }
    return std::nullopt;
}

// Lists the mesh and image files of the author's project by file name. Of files with one name the first by path counts.
void CourseFileFinder::list_project() {
    project_.emplace();
    std::error_code error;
    fs::recursive_directory_iterator entries(project_of(folder_), fs::directory_options::skip_permission_denied, error);
    for (int i = 0; i < most_entries && !error && entries != fs::recursive_directory_iterator(); ++i) {
        const fs::path path = entries->path();
        if (entries.depth() >= most_folders_below) {
            entries.disable_recursion_pending();
        }
        const auto is_the_ending = [&](const char* ending) { return ending_of(path) == ending; };
        const bool is_mesh = std::any_of(std::begin(mesh_endings), std::end(mesh_endings), is_the_ending);
        const bool is_image = std::any_of(std::begin(image_endings), std::end(image_endings), is_the_ending);
        const auto keep = [&](const std::string& name) {
            fs::path& first = project_->emplace(name, path).first->second;
            first = std::min(first, path);
        };
        if ((is_mesh || is_image) && is_file(path)) {
            keep(path.filename().string());
            if (is_mesh) {
                keep(path.stem().string());
            }
        }
        entries.increment(error);
    }
}

std::optional<fs::path> CourseFileFinder::find(const std::string& name) {
    if (name.empty() || name.find('\0') != std::string::npos || folder_.empty()) {
        return std::nullopt;
    }
    if (const auto literal = with_an_ending(folder_ / name)) {
        return literal->lexically_normal();
    }
    if (const auto above = find_above(name)) {
        return above->lexically_normal();
    }
    const std::vector<std::string> parts = parts_of(name);
    if (!project_) {
        list_project();
    }
    const auto found = parts.empty() ? project_->end() : project_->find(parts.back());
    return found == project_->end() ? std::nullopt : std::optional(found->second.lexically_normal());
}

}  // namespace pt
