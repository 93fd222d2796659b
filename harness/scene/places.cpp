#include "harness/scene/places.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/counted.h"
#include "harness/failure.h"
#include "harness/json_reader.h"
#include "harness/nearest_name.h"
#include "harness/say.h"

namespace pt {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> json_stems(const fs::path& folder) {
    std::vector<std::string> names;
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
        if (entry.path().extension() == ".json") {
            names.push_back(entry.path().stem().string());
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::string find_file(const std::string& kind, const std::string& name_or_file, const fs::path& folder) {
    if (name_or_file.ends_with(".json")) {
        return name_or_file;
    }
    const fs::path file = folder / (name_or_file + ".json");
    // A scene or suite may be named with a subfolder ("scaling/materials_08"), but not outside the shipped folder.
    const bool leaves = name_or_file.starts_with('/') || name_or_file.find("..") != std::string::npos;
    if (leaves || !fs::is_regular_file(file)) {
        const std::vector<std::string> known = json_stems(folder);
        throw InputError("--" + kind, "name", "\"" + name_or_file + "\"",
                         fmt::format("a file that ends in .json, or one of {}{}", fmt::join(known, ", "),
                                     did_you_mean(name_or_file, known)));
    }
    return file.string();
}

// Prints a warning only once, even if a process reads a scene several times.
void tell_once(const std::string& line) {
    static std::set<std::string> told;
    if (told.insert(line).second) {
        say("{}\n", line);
    }
}

}  // namespace

fs::path home_folder() {
    std::vector<fs::path> candidates;
    if (const char* home = std::getenv("PTBENCH_HOME"); home != nullptr && *home != '\0') {
        candidates.emplace_back(home);
    } else {
        std::error_code failed;
        const fs::path binary = fs::read_symlink("/proc/self/exe", failed);
        candidates.push_back(binary.parent_path());
        candidates.push_back(binary.parent_path().parent_path());
        candidates.push_back(binary.parent_path().parent_path().parent_path());
    }
    for (const fs::path& candidate : candidates) {
        if (fs::is_directory(candidate / "scenes" / "suites")) {
            return candidate;
        }
    }
    throw InputError(fmt::format("no folder scenes/ in {}: set PTBENCH_HOME to the folder that holds it",
                                 candidates.front().string()));
}

std::vector<std::string> scene_names() { return json_stems(home_folder() / "scenes"); }

std::vector<std::string> suite_names() { return json_stems(home_folder() / "scenes" / "suites"); }

Scene find_scene(const std::string& name_or_file) {
    Scene scene = load_scene(find_file("scene", name_or_file, home_folder() / "scenes"));
    for (const auto& mesh : scene.meshes) {
        const std::string place = fmt::format("scene {}: mesh {}", scene.name, one_line(mesh->source));
        for (const std::string& warning : mesh->warnings) {
            tell_once(fmt::format("warning: {}: {}", place, warning));
        }
        if (mesh->degenerate_left_out > 0) {
            tell_once(fmt::format("note: {}: {} without area left out", place,
                                  counted(mesh->degenerate_left_out, "triangle")));
        }
    }
    return scene;
}

bool is_shipped(const Scene& scene) {
    try {
        const fs::path below = fs::path(scene.file).lexically_relative(fs::absolute(home_folder() / "scenes"));
        return !below.empty() && *below.begin() != "..";
    } catch (const InputError&) {
        return false;  // without a home folder there are no shipped scenes
    }
}

bool names_meshes(const std::string& scene_name_or_file) {
    const std::string file = find_file("scene", scene_name_or_file, home_folder() / "scenes");
    const Json scene = parse_loosely(file);
    const Json& objects = array_in(scene, "objects");
    return std::any_of(objects.begin(), objects.end(), [](const Json& object) {
        return object.is_object() && object.value("shape", Json()) == "mesh";
    });
}

std::vector<Scene> find_scenes(const std::vector<std::string>& names_or_files) {
    std::vector<Scene> scenes;
    std::map<std::string, std::set<std::string>> hashes;  // scene hashes by scene name
    for (const std::string& name_or_file : names_or_files) {
        scenes.push_back(find_scene(name_or_file));
        hashes[scenes.back().name].insert(scenes.back().hash);
    }
    for (Scene& scene : scenes) {
        if (hashes.at(scene.name).size() > 1) {
            scene.name = fmt::format("{}@{:.8}", scene.name, scene.hash);
        }
    }
    return scenes;
}

std::string_view new_name_of_suite(std::string_view old_name) {
    const bool is_old = old_name == "seeds" && !fs::exists(home_folder() / "scenes" / "suites" / "seeds.json");
    return is_old ? "cis565" : "";
}

std::string find_suite_file(const std::string& name_or_file) {
    const fs::path folder = home_folder() / "scenes" / "suites";
    const std::string new_name(new_name_of_suite(name_or_file));
    return find_file("suite", new_name.empty() ? name_or_file : new_name, folder);
}

}  // namespace pt
