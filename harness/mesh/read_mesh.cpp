#include "harness/mesh/read_mesh.h"

#include <fmt/format.h>

#include "harness/text_file.h"

namespace pt {

Mesh read_mesh(const std::filesystem::path& path) {
    const std::string file = path.string();
    const std::string ending = ending_of(path);
    if (ending == ".ply") {
        return parse_ply(read_file(file, largest_mesh_file), file);
    }
    if (ending == ".obj") {
        return parse_obj(read_text_file(file, largest_mesh_file), file);
    }
    if (ending == ".glb") {
        return parse_glb(read_file(file, largest_mesh_file), file);
    }
    if (ending == ".gltf") {
        std::string content = read_file(file, largest_mesh_file);
        const bool is_binary = content.starts_with("glTF");
        return parse_gltf(is_binary ? content : readable_text(std::move(content), file), file);
    }
    throw InputError(file, "file name", fmt::format("the ending \"{}\"", ending), ".obj, .ply, .glb or .gltf");
}

}  // namespace pt
