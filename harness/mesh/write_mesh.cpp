#include "harness/mesh/write_mesh.h"

#include <bit>
#include <iterator>

#include <fmt/format.h>

#include "harness/error.h"
#include "harness/write_file.h"

namespace pt {

namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
void add_bytes(std::string& content, const std::array<T, 3>& triple) {
    content.append(reinterpret_cast<const char*>(triple.data()), sizeof(triple));
}

// The shortest numbers that read as the same floats.
void add_line(std::string& content, const char* word, const std::array<float, 3>& triple) {
    fmt::format_to(std::back_inserter(content), "{} {} {} {}\n", word, triple[0], triple[1], triple[2]);
}

}  // namespace

std::string ply_of(const Mesh& mesh) {
    const bool has_normals = !mesh.normals.empty();
    std::string content = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
        "property float z\n{}element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.vertices.size(), has_normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
        mesh.triangles.size());
    content.reserve(content.size() + mesh.vertices.size() * (has_normals ? 24 : 12) + mesh.triangles.size() * 13);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        add_bytes(content, mesh.vertices[i]);
        if (has_normals) {
            add_bytes(content, mesh.normals[i]);
        }
    }
    for (const auto& triangle : mesh.triangles) {
        content += '\3';
        add_bytes(content, triangle);
    }
    return content;
}

std::string obj_of(const Mesh& mesh) {
    std::string content;
    for (const auto& vertex : mesh.vertices) {
        add_line(content, "v", vertex);
    }
    for (const auto& normal : mesh.normals) {
        add_line(content, "vn", normal);
    }
    for (const auto& [a, b, c] : mesh.triangles) {
        const std::uint64_t i = std::uint64_t{a} + 1, j = std::uint64_t{b} + 1, k = std::uint64_t{c} + 1;
        if (mesh.normals.empty()) {
            fmt::format_to(std::back_inserter(content), "f {} {} {}\n", i, j, k);
        } else {
            fmt::format_to(std::back_inserter(content), "f {}//{} {}//{} {}//{}\n", i, i, j, j, k, k);
        }
    }
    return content;
}

void check_mesh_name(const std::string& file, const std::string& flag) {
    check_output_file(file, flag);
    const std::string ending = std::filesystem::path(file).extension().string();
    if (ending != ".ply" && ending != ".obj") {
        throw InputError(flag, "file name", "\"" + file + "\"", "a name that ends in .ply or .obj");
    }
}

void write_mesh(const Mesh& mesh, const std::string& file) {
    check_mesh_name(file, "mesh");
    write_file(file, std::filesystem::path(file).extension() == ".ply" ? ply_of(mesh) : obj_of(mesh));
}

}  // namespace pt
