#include "harness/scene/inline_mesh.h"

#include <map>

#include "harness/mesh/check_mesh.h"
#include "harness/mesh/resolution.h"
#include "harness/scene/scene_mesh.h"

namespace pt {

namespace {

// The three elements of an entry of a mesh's "vertices", "normals" or "triangles".
std::vector<JsonValue> three(const JsonValue& value, const std::string& allowed) {
    std::vector<JsonValue> elements = value.elements();
    if (elements.size() != 3) {
        value.fail(allowed);
    }
    return elements;
}

std::array<double, 3> read_exact_vector(const JsonValue& value) {
    constexpr double most = std::numeric_limits<float>::max();
    std::array<double, 3> vector{};
    std::size_t axis = 0;
    for (const JsonValue& number : three(value, "[x, y, z]")) {
        vector[axis++] = number.number(-most, most, "a number of single precision");
    }
    return vector;
}

std::array<float, 3> rounded(const std::array<double, 3>& vector) {
    return {static_cast<float>(vector[0]), static_cast<float>(vector[1]), static_cast<float>(vector[2])};
}

RoundingLoss read_vertices(const JsonValue& vertices, Mesh& mesh) {
    RoundingLoss loss;
    for (const JsonValue& entry : vertices.elements()) {
        const std::array<double, 3> exact = read_exact_vector(entry);
        loss.add(exact, rounded(exact), mesh.vertices.size());
        mesh.vertices.push_back(rounded(exact));
    }
    if (mesh.vertices.empty()) {
        vertices.fail("at least one vertex");
    }
    return loss;
}

// Reads the key "normals" of a mesh in the scene file, one normal per vertex.
void read_normals(const JsonValue& value, Mesh& mesh) {
    const std::vector<JsonValue> entries = value.elements();
    if (entries.size() != mesh.vertices.size()) {
        value.fail(fmt::format("one for each of the {} vertices", mesh.vertices.size()));
    }
    for (const JsonValue& entry : entries) {
        mesh.normals.push_back(rounded(read_exact_vector(entry)));
        if (mesh.normals.back() == std::array<float, 3>{0, 0, 0}) {
            entry.fail("a direction that is not 0 in single precision");
        }
    }
}

// Reads the key "texture_coordinates" of a mesh in the scene file, one pair [u, v] per vertex.
void read_coordinates(const JsonValue& value, Mesh& mesh) {
    const std::vector<JsonValue> entries = value.elements();
    if (entries.size() != mesh.vertices.size()) {
        value.fail(fmt::format("one for each of the {} vertices", mesh.vertices.size()));
    }
    std::vector<std::array<float, 2>> by_vertex;
    for (const JsonValue& entry : entries) {
        const std::vector<JsonValue> numbers = entry.elements();
        if (numbers.size() != 2) {
            entry.fail("[u, v]");
        }
        const auto number = [&](std::size_t k) {
            return static_cast<float>(numbers[k].number(-1e6, 1e6, "a number from -1e6 to 1e6"));
        };
        by_vertex.push_back({number(0), number(1)});
    }
    mesh.coordinates = places_of_corners(mesh.triangles, by_vertex);
}

}  // namespace

std::shared_ptr<const SceneMesh> read_inline_mesh(const JsonObject& object, bool with_normals) {
    const JsonValue vertices = object.at("vertices"), triangles = object.at("triangles");
    Mesh mesh;
    const RoundingLoss loss = read_vertices(vertices, mesh);
    const auto last = static_cast<long long>(mesh.vertices.size()) - 1;
    for (const JsonValue& entry : triangles.elements()) {
        auto& triangle = mesh.triangles.emplace_back();
        std::size_t corner = 0;
        for (const JsonValue& index : three(entry, "[i, j, k]")) {
            triangle[corner++] = static_cast<std::uint32_t>(
                index.whole(0, last, fmt::format("a vertex, counted from 0: a whole number from 0 to {}", last)));
        }
    }
    if (object.has("texture_coordinates")) {
        read_coordinates(object.at("texture_coordinates"), mesh);
    }
    if (object.has("normals")) {
        read_normals(object.at("normals"), mesh);
    }
    check_mesh(mesh, triangles.file() + ": " + triangles.path());
    if (const auto warning = resolution_warning(mesh, loss.largest())) {
        mesh.warnings.add(fmt::format("{}[{}]", vertices.path(), loss.place()), *warning);
    }
    std::shared_ptr<const SceneMesh> made = make_scene_mesh(mesh, "of the scene file", with_normals);
    // The number of degenerate triangles left out is part of a mesh's cache key, since it is reported although it does
    // not belong to the mesh's content.
    static std::map<std::pair<std::string, std::uint32_t>, std::weak_ptr<const SceneMesh>> known;
    auto& kept = known[{made->hash + made->coordinates_hash + " " + made->normals_hash, made->degenerate_left_out}];
    if (const auto earlier = kept.lock(); earlier != nullptr && earlier->triangles.size() == made->triangles.size()) {
        return earlier;
    }
    kept = made;
    return made;
}

}  // namespace pt
