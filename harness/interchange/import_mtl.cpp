#include "harness/interchange/import_mtl.h"

#include <algorithm>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "harness/mesh/check_mesh.h"
#include "harness/mesh/read_mesh.h"
#include "harness/text_file.h"

namespace pt {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t largest_library = std::uint64_t{1} << 24;  // size limit of an MTL library in bytes

class OwnMaterials {
public:
    OwnMaterials(CourseImport& import, fs::path file, const Cis565Line& at)
        : import_(&import), file_(std::move(file)), at_(&at) {}

    std::vector<OwnPart> parts();

private:
    struct Entry {
        fs::path library;
        MtlMaterial material;
    };

    void fail(const std::string& found, const std::string& allowed) {
        import_->result->problems.add(
            at_->number, fmt::format("found \"{}: {}\", allowed: {}", file_.filename().string(), found, allowed));
        is_whole_ = false;
    }
    std::optional<fs::path> library_called(const std::string& name);
    void read_libraries(const std::vector<std::string>& names);
    void read_library(const std::string& name);
    void add_entry(const fs::path& library, MtlMaterial material);
    // Finds an MTL material by name and returns its index in `entries_`.
    std::optional<std::size_t> entry_called(const std::string& name);
    std::optional<std::size_t> entry_of(const ObjPart& part);
    std::string material_of(std::size_t entry);
    std::optional<OwnPart> part_with(const ObjParts& whole, const std::vector<std::optional<std::size_t>>& entries,
                                     std::size_t entry);

    CourseImport* import_;
    fs::path file_;
    const Cis565Line* at_;
    std::vector<Entry> entries_;
    std::map<std::string, std::size_t> by_name_;
    std::set<fs::path> read_;
    bool is_whole_ = true, has_told_of_groups_ = false;
};

std::optional<fs::path> OwnMaterials::library_called(const std::string& name) {
    std::error_code error;
    const fs::path beside = file_.parent_path() / name;
    return fs::is_regular_file(beside, error) ? std::optional(beside) : import_->files.find(name);
}

// Reads the MTL libraries of an mtllib line, which names one library whose name may contain spaces, or several.
void OwnMaterials::read_libraries(const std::vector<std::string>& names) {
    for (const std::string& whole : names) {
        const std::string name = library_called(whole) ? whole : without_comment(whole);
        std::istringstream words(name);
        if (library_called(name) || name.find(' ') == std::string::npos) {
            read_library(name);
            continue;
        }
        for (std::string word; words >> word;) {
            read_library(word);
        }
    }
}

void OwnMaterials::read_library(const std::string& name) {
    const std::optional<fs::path> found = library_called(name);
    if (!found) {
        fail("mtllib " + name, "a library of materials that is there, beside the mesh");
        return;
    }
    if (!read_.insert(found->lexically_normal()).second) {
        return;  // MTL library read already: some programs name it before every object
    }
    try {
        for (MtlMaterial& material : parse_mtl(read_text_file(found->string(), largest_library), found->string())) {
            add_entry(*found, std::move(material));
        }
    } catch (const InputError& error) {
        fail("mtllib " + name, fmt::format("a library that can be read; of this one is said: {}", error.what()));
    }
}

// Adds a material of an MTL library. Of two with one name the first is used.
void OwnMaterials::add_entry(const fs::path& library, MtlMaterial material) {
    const auto [known, is_new] = by_name_.emplace(material.name, entries_.size());
    if (is_new) {
        entries_.push_back({library, std::move(material)});
        return;
    }
    const Entry& first = entries_[known->second];
    const auto says = [](const MtlMaterial& one) {
        std::map<std::string, std::vector<std::string>> words;
        for (const auto& [key, line] : one.lines) {
            words[key] = {line.words.begin() + 1, line.words.end()};
        }
        return words;
    };
    if (says(first.material) != says(material)) {
        import_->result->warnings.add(
            at_->number,
            fmt::format("{} line {}: newmtl {} is not used: {} line {} has another of that name, the first",
                        library.filename().string(), material.line, material.name, first.library.filename().string(),
                        first.material.line));
    }
}

// Finds an MTL material by name, also if either name has a comment: "wood # of the floor" may mean "wood". "Material
// #25" and "Material #26" are two materials.
std::optional<std::size_t> OwnMaterials::entry_called(const std::string& name) {
    if (const auto found = by_name_.find(name); found != by_name_.end()) {
        return found->second;
    }
    std::vector<std::size_t> meant;
    for (std::size_t i = 0; i < entries_.size() && !name.empty(); ++i) {
        const std::string& other = entries_[i].material.name;
        if (without_comment(name) == other || name == without_comment(other)) {
            meant.push_back(i);
        }
    }
    if (meant.size() != 1) {
        return std::nullopt;
    }
    import_->result->warnings.add(at_->number,
                                  fmt::format("{}: \"{}\" is read as the material \"{}\", as if a comment "
                                              "began at #",
                                              file_.filename().string(), name, entries_[meant.front()].material.name));
    by_name_.emplace(name, meant.front());  // remembers the MTL material's name, to warn of it only once
    return meant.front();
}

std::optional<std::size_t> OwnMaterials::entry_of(const ObjPart& part) {
    if (const auto found = entry_called(part.material)) {
        return found;
    }
    if (const auto found = entry_called(part.group)) {
        if (!has_told_of_groups_) {
            import_->result->warnings.add(
                at_->number, fmt::format("{} has faces whose material no library has: they are of \"{}\", as their "
                                         "group is called",
                                         file_.filename().string(), part.group));
        }
        has_told_of_groups_ = true;
        return found;
    }
    if (is_whole_) {  // with an MTL library missing, an unknown material may be in there and is no problem
        fail(part.material.empty() ? "faces before any usemtl" : "usemtl " + part.material,
             "a material of its libraries, mtllib");
    }
    return std::nullopt;
}

// The name of an MTL material in the scene, to which the material is added on first use.
std::string OwnMaterials::material_of(std::size_t entry) {
    const Entry& meant = entries_[entry];
    const auto [known, is_new] = import_->own_names.try_emplace({meant.library.string(), meant.material.name});
    if (!is_new) {
        return known->second;
    }
    ScenePart part = import_mtl_material(*import_, meant.material, meant.library, *at_);
    const auto is_taken = [&](const std::string& name) {
        const auto has_name = [&](const ScenePart& other) { return other.name == name; };
        return std::any_of(import_->materials.begin(), import_->materials.end(), has_name);
    };
    const std::string plain = plain_part_of(meant.material.name), start = plain.empty() ? "material" : plain;
    part.name = start;
    for (int i = 2; is_taken(part.name); ++i) {
        part.name = fmt::format("{}_{}", start, i);
    }
    part.place = "$.materials." + part.name;
    import_->materials.push_back(part);
    return known->second = part.name;
}

// Writes the triangles of one MTL material as a mesh of their own; returns nothing if no triangle has an area.
std::optional<OwnPart> OwnMaterials::part_with(const ObjParts& whole,
                                               const std::vector<std::optional<std::size_t>>& entries,
                                               std::size_t entry) {
    std::vector<bool> is_in(whole.part_of.size());
    for (std::size_t i = 0; i < is_in.size(); ++i) {
        is_in[i] = entries[whole.part_of[i]] == entry;
    }
    Mesh mesh = part_of_mesh(whole.mesh, is_in);
    try {
        check_mesh(mesh, file_.string());
    } catch (const InputError& error) {
        import_->result->notes.add(at_->number,
                                   fmt::format("{}: what is of \"{}\" is left out: {}", file_.filename().string(),
                                               entries_[entry].material.name, error.what()));
        return std::nullopt;
    }
    const std::string name = add_imported_mesh(*import_->result, *import_->source, std::move(mesh));
    return OwnPart{.file = name, .material = material_of(entry)};
}

std::vector<OwnPart> OwnMaterials::parts() {
    const ObjParts whole = parse_obj_parts(read_text_file(file_.string(), largest_mesh_file), file_.string());
    warn_of_mesh(*import_->result, at_->number, file_, whole.mesh.warnings.messages());
    read_libraries(whole.libraries);
    std::vector<std::optional<std::size_t>> entries;
    std::vector<std::size_t> used;  // MTL materials in the order of their first use
    for (const ObjPart& part : whole.parts) {
        const std::optional<std::size_t> entry = entry_of(part);
        entries.push_back(entry);
        if (entry && std::find(used.begin(), used.end(), *entry) == used.end()) {
            used.push_back(*entry);
        }
    }
    if (!is_whole_ || used.empty()) {
        return {};
    }
    if (used.size() == 1) {
        return {{.file = name_beside(course_scene_file(*import_->source), file_), .material = material_of(used[0])}};
    }
    std::vector<OwnPart> parts;
    for (const std::size_t entry : used) {
        if (auto part = part_with(whole, entries, entry)) {
            parts.push_back(std::move(*part));
        }
    }
    import_->result->notes.add(at_->number, fmt::format("{} has {} materials of its own: an object for each",
                                                        file_.filename().string(), parts.size()));
    return parts;
}

}  // namespace

std::vector<OwnPart> import_own_materials(CourseImport& import, const fs::path& file, const Cis565Line& at) {
    const auto [known, is_new] = import.own_parts.try_emplace(file.string());
    if (is_new) {
        try {
            known->second = OwnMaterials(import, file, at).parts();
        } catch (const InputError& error) {
            import.result->problems.add(at.number, fmt::format("found \"{}\", of which is said: {}, allowed: a mesh "
                                                               "that can be read",
                                                               at.text(), error.what()));
        }
    }
    return known->second;
}

}  // namespace pt
