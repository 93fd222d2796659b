// Wavefront .obj meshes, and which of their triangles have which material.
#include "harness/mesh/obj_materials.h"
#include "tests/fuzz/mesh.h"

namespace pt::fuzz {

static void parse_parts(const std::uint8_t* data, std::size_t size) {
    accept_or_refuse([&] {
        const ObjParts whole = parse_obj_parts({reinterpret_cast<const char*>(data), size}, "mesh");
        require(whole.part_of.size() == whole.mesh.triangles.size(), "a triangle of no part");
        std::vector<bool> is_first(whole.part_of.size());
        std::size_t count = 0;
        for (std::size_t i = 0; i < whole.part_of.size(); ++i) {
            require(whole.part_of[i] < whole.parts.size(), "a part that is not there");
            is_first[i] = whole.part_of[i] == 0;
            count += is_first[i] ? 1 : 0;
        }
        const Mesh part = part_of_mesh(whole.mesh, is_first);
        require(part.triangles.size() == count, "triangles that are lost");
        for (const auto& triangle : part.triangles) {
            for (const std::uint32_t corner : triangle) {
                require(corner < part.vertices.size(), "a corner that is no vertex");
            }
        }
    });
}

}  // namespace pt::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pt::fuzz::parse_mesh(pt::parse_obj, data, size);
    pt::fuzz::parse_parts(data, size);
    return 0;
}
