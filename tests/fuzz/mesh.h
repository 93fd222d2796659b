// What a reader of meshes promises of any file: a mesh that holds, or one line.
#pragma once

#include <cmath>

#include "harness/mesh/check_mesh.h"
#include "harness/mesh/read_mesh.h"
#include "tests/fuzz/findings.h"

namespace pt::fuzz {

inline void require_mesh(const Mesh& mesh) {
    require(!mesh.triangles.empty(), "an empty mesh");
    require(mesh.normals.empty() || mesh.normals.size() == mesh.vertices.size(), "normals that are not one a vertex");
    for (const auto* triples : {&mesh.vertices, &mesh.normals}) {
        for (const auto& [x, y, z] : *triples) {
            require(std::isfinite(x) && std::isfinite(y) && std::isfinite(z), "a number that is not finite");
        }
    }
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t corner : triangle) {
            require(corner < mesh.vertices.size(), "a corner that is no vertex");
        }
        require(!is_degenerate(mesh, triangle), "a triangle without area");
    }
}

template <class Parse>
void parse_mesh(const Parse& parse, const std::uint8_t* data, std::size_t size) {
    accept_or_refuse([&] { require_mesh(parse({reinterpret_cast<const char*>(data), size}, "mesh")); });
}

}  // namespace pt::fuzz
