#include "harness/scene/inline_mesh.h"

#include <map>

#include "harness/mesh/check_mesh.h"
#include "harness/scene/scene_mesh.h"

namespace pt {

namespace {

// The three elements of an entry of "vertices" or "triangles".
std::vector<JsonValue> three(const JsonValue& value, const std::string& allowed) {
    std::vector<JsonValue> elements = value.elements();
    if (elements.size() != 3) {
        value.fail(allowed);
    }
    return elements;
}

}  // namespace

std::shared_ptr<const SceneMesh> read_inline_mesh(const JsonValue& vertices, const JsonValue& triangles) {
    constexpr double most = std::numeric_limits<float>::max();
    Mesh mesh;
    for (const JsonValue& entry : vertices.elements()) {
        auto& vertex = mesh.vertices.emplace_back();
        std::size_t axis = 0;
        for (const JsonValue& number : three(entry, "[x, y, z]")) {
            vertex[axis++] = static_cast<float>(number.number(-most, most, "a number of single precision"));
        }
    }
    if (mesh.vertices.empty()) {
        vertices.fail("at least one vertex");
    }
    const auto last = static_cast<long long>(mesh.vertices.size()) - 1;
    for (const JsonValue& entry : triangles.elements()) {
        auto& triangle = mesh.triangles.emplace_back();
        std::size_t corner = 0;
        for (const JsonValue& index : three(entry, "[i, j, k]")) {
            triangle[corner++] = static_cast<std::uint32_t>(
                index.whole(0, last, fmt::format("a vertex, counted from 0: a whole number from 0 to {}", last)));
        }
    }
    check_mesh(mesh, triangles.file() + ": " + triangles.path());
    std::shared_ptr<const SceneMesh> made = make_scene_mesh(mesh, "of the scene file");
    // What was left out is part of what is told of a mesh, not of its content.
    static std::map<std::pair<std::string, std::uint32_t>, std::weak_ptr<const SceneMesh>> known;
    auto& kept = known[{made->hash, made->degenerate_left_out}];
    if (const auto earlier = kept.lock(); earlier != nullptr && earlier->triangles.size() == made->triangles.size()) {
        return earlier;
    }
    kept = made;
    return made;
}

}  // namespace pt
