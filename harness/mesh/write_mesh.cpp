#include "harness/mesh/write_mesh.h"

#include <bit>
#include <iterator>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/write_file.h"

namespace pt {

namespace {

static_assert(std::endian::native == std::endian::little);

template <class T, std::size_t count>
void add_bytes(std::string& content, const std::array<T, count>& numbers) {
    content.append(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
}

// A mesh with texture coordinates by vertex, as files need them: a vertex whose corners have several coordinates is
// duplicated, and vertices that no triangle uses are left out.
struct CoordinatesByVertex {
    Mesh mesh;  // mesh without its texture coordinates, which are in `places` by vertex
    std::vector<std::array<float, 2>> places;
};

CoordinatesByVertex by_vertex(const Mesh& mesh) {
    constexpr std::uint32_t none = 0xffffffffu;
    std::vector<std::uint32_t> last(mesh.vertices.size(), none), before;  // duplicates of each vertex, as linked lists
    CoordinatesByVertex made;
    const auto number_of = [&](std::uint32_t vertex, const std::array<float, 2>& place) {
        for (std::uint32_t i = last[vertex]; i != none; i = before[i]) {
            if (std::bit_cast<std::uint64_t>(made.places[i]) == std::bit_cast<std::uint64_t>(place)) {
                return i;
            }
        }
        const auto number = static_cast<std::uint32_t>(made.places.size());
        made.places.push_back(place);
        made.mesh.vertices.push_back(mesh.vertices[vertex]);
        if (!mesh.normals.empty()) {
            made.mesh.normals.push_back(mesh.normals[vertex]);
        }
        before.push_back(last[vertex]);
        last[vertex] = number;
        return number;
    };
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        const auto& at = mesh.coordinates[i];
        const std::uint32_t first = number_of(a, at[0]), second = number_of(b, at[1]), third = number_of(c, at[2]);
        made.mesh.triangles.push_back({first, second, third});
    }
    return made;
}

// Adds a line with three numbers in the fewest digits that read back as the same floats.
void add_line(std::string& content, const char* word, const std::array<float, 3>& triple) {
    fmt::format_to(std::back_inserter(content), "{} {} {} {}\n", word, triple[0], triple[1], triple[2]);
}

// Encodes a mesh as PLY. `places`: texture coordinates, empty or one pair per vertex.
std::string ply_with(const Mesh& mesh, const std::vector<std::array<float, 2>>& places) {
    const bool has_normals = !mesh.normals.empty();
    std::string content = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
        "property float z\n{}{}element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.vertices.size(), has_normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
        places.empty() ? "" : "property float s\nproperty float t\n", mesh.triangles.size());
    const std::size_t of_vertex = 12 + (has_normals ? 12 : 0) + (places.empty() ? 0 : 8);
    content.reserve(content.size() + mesh.vertices.size() * of_vertex + mesh.triangles.size() * 13);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        add_bytes(content, mesh.vertices[i]);
        if (has_normals) {
            add_bytes(content, mesh.normals[i]);
        }
        if (!places.empty()) {
            add_bytes(content, places[i]);
        }
    }
    for (const auto& triangle : mesh.triangles) {
        content += '\3';
        add_bytes(content, triangle);
    }
    return content;
}

// Adds a face to an OBJ file, which counts vertices from 1.
void add_obj_face(std::string& content, const std::array<std::uint32_t, 3>& triangle, bool has_places,
                  bool has_normals) {
    content += 'f';
    for (const std::uint32_t corner : triangle) {
        const std::uint64_t i = std::uint64_t{corner} + 1;
        fmt::format_to(std::back_inserter(content), " {}", i);
        if (has_places) {
            fmt::format_to(std::back_inserter(content), "/{}", i);
        }
        if (has_normals) {
            fmt::format_to(std::back_inserter(content), "{}{}", has_places ? "/" : "//", i);
        }
    }
    content += '\n';
}

std::string obj_with(const Mesh& mesh, const std::vector<std::array<float, 2>>& places) {
    std::string content;
    for (const auto& vertex : mesh.vertices) {
        add_line(content, "v", vertex);
    }
    for (const auto& normal : mesh.normals) {
        add_line(content, "vn", normal);
    }
    for (const auto& [u, v] : places) {
        fmt::format_to(std::back_inserter(content), "vt {} {}\n", u, v);
    }
    for (const auto& triangle : mesh.triangles) {
        add_obj_face(content, triangle, !places.empty(), !mesh.normals.empty());
    }
    return content;
}

}  // namespace

std::string ply_of(const Mesh& mesh) {
    if (mesh.coordinates.empty()) {
        return ply_with(mesh, {});
    }
    const CoordinatesByVertex made = by_vertex(mesh);
    return ply_with(made.mesh, made.places);
}

std::string obj_of(const Mesh& mesh) {
    if (mesh.coordinates.empty()) {
        return obj_with(mesh, {});
    }
    const CoordinatesByVertex made = by_vertex(mesh);
    return obj_with(made.mesh, made.places);
}

void check_mesh_name(const std::string& file, const std::string& flag) {
    check_output_file(file, flag);
    const std::string ending = std::filesystem::path(file).extension().string();
    if (ending != ".ply" && ending != ".obj") {
        throw InputError(flag, "file name", "\"" + file + "\"", "a name that ends in .ply or .obj");
    }
}

std::string mesh_file_of(const Mesh& mesh, const std::string& file) {
    return std::filesystem::path(file).extension() == ".ply" ? ply_of(mesh) : obj_of(mesh);
}

void write_mesh(const Mesh& mesh, const std::string& file) {
    check_mesh_name(file, "mesh");
    write_file(file, mesh_file_of(mesh, file));
}

}  // namespace pt
