// glTF 2.0 (Khronos, ISO/IEC 12113), binary or JSON with its data beside it, by tinygltf where the build has it: its
// JSON and chunks are the library's business; that an accessor lies within its buffer, which tinygltf does not ask, and
// what nodes do to meshes is ours.
#include "harness/mesh/read_mesh.h"

#include <filesystem>

#include <fmt/format.h>

#include "harness/error.h"
#include "harness/json_reader.h"

#ifdef PTBENCH_HAS_TINYGLTF

#include <cstring>
#include <fstream>  // tiny_gltf.h leaves it out with TINYGLTF_NO_FS
#include <set>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

// Pictures are not read, and of files beside the one that was asked for only the data of a .gltf.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

#include "harness/mesh/check_mesh.h"

namespace pt {

namespace {

bool read_beside(std::vector<unsigned char>* data, std::string* message, const std::string& name, void*) {
    try {
        const std::string content = read_file(name, largest_mesh_file);
        data->assign(content.begin(), content.end());
        return true;
    } catch (const InputError& error) {
        *message += error.what();
        return false;
    }
}

bool is_beside(const std::string& name, void*) {
    std::error_code error;
    return std::filesystem::is_regular_file(name, error);
}

// `folder`: where the data of a .gltf is; without one, all data must be within.
tinygltf::Model parse_model(std::string_view content, const std::string& file, const std::string& folder) {
    constexpr std::size_t largest = 0xffffffff;  // by the format
    if (content.size() > largest) {
        throw InputError(file, "file", fmt::format("{} bytes", content.size()), fmt::format("at most {}", largest));
    }
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*,
                             int, void*) { return true; },
                          nullptr);
    const tinygltf::FsCallbacks no_files{
        [](const std::string&, void*) { return false; }, [](const std::string& name, void*) { return name; },
        [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; },
        [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }, nullptr};
    const tinygltf::FsCallbacks files_beside{is_beside, no_files.ExpandFilePath, read_beside, no_files.WriteWholeFile,
                                             nullptr};
    loader.SetFsCallbacks(folder.empty() ? no_files : files_beside);
    tinygltf::Model model;
    std::string errors, warnings;
    bool is_read = false;
    try {
        const auto size = static_cast<unsigned int>(content.size());
        is_read = folder.empty()
                      ? loader.LoadBinaryFromMemory(&model, &errors, &warnings,
                                                    reinterpret_cast<const unsigned char*>(content.data()), size)
                      : loader.LoadASCIIFromString(&model, &errors, &warnings, content.data(), size, folder);
    } catch (const std::exception& error) {
        errors = error.what();
    }
    if (!is_read) {
        throw InputError(file, "file",
                         errors.empty() ? "what tinygltf cannot read" : errors.substr(0, errors.find('\n')),
                         folder.empty() ? "binary glTF 2.0 with its data in it" : "glTF 2.0 with its data beside it");
    }
    return model;
}

// The numbers of an accessor, held to lie within its buffer.
struct AccessorView {
    const unsigned char* data = nullptr;
    std::size_t count = 0, stride = 0;
    int component_type = 0;

    float real(std::size_t i, std::size_t component) const {
        float value;
        std::memcpy(&value, data + i * stride + component * sizeof(float), sizeof(float));
        return value;
    }
    std::uint32_t whole(std::size_t i) const {
        const unsigned char* from = data + i * stride;
        switch (component_type) {
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return *from;
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                return from[0] | from[1] << 8;
            default:
                return from[0] | from[1] << 8 | from[2] << 16 | static_cast<std::uint32_t>(from[3]) << 24;
        }
    }
};

class GlbReader {
public:
    GlbReader(const tinygltf::Model& model, const std::string& file) : model_(model), file_(file) {}

    Mesh read() {
        if (!model_.extensionsRequired.empty()) {
            fail("extensionsRequired", "\"" + model_.extensionsRequired.front() + "\"", "none");
        }
        const glm::dmat4 identity(1.0);
        if (model_.nodes.empty()) {
            for (std::size_t i = 0; i < model_.meshes.size(); ++i) {
                add_mesh(static_cast<int>(i), identity);
            }
        } else {
            for (const int node : roots()) {
                add_node(node, identity, 0);
            }
        }
        if (!has_normals_) {
            mesh_.normals.clear();
        }
        return std::move(mesh_);
    }

private:
    [[noreturn]] void fail(const std::string& place, const std::string& found, const std::string& allowed) const {
        throw InputError(file_, place, found, allowed);
    }

    template <class T>
    const T& element(const std::vector<T>& list, int index, const std::string& place) const {
        if (index < 0 || static_cast<std::size_t>(index) >= list.size()) {
            fail(place, fmt::format("number {}", index), fmt::format("0 to {}", static_cast<int>(list.size()) - 1));
        }
        return list[index];
    }

    // Of the scene that is shown first; without a scene, the nodes that no other has.
    std::vector<int> roots() const {
        if (!model_.scenes.empty()) {
            return element(model_.scenes, std::max(model_.defaultScene, 0), "scene").nodes;
        }
        std::set<int> children;
        for (const tinygltf::Node& node : model_.nodes) {
            children.insert(node.children.begin(), node.children.end());
        }
        std::vector<int> roots;
        for (int i = 0; i < static_cast<int>(model_.nodes.size()); ++i) {
            if (!children.contains(i)) {
                roots.push_back(i);
            }
        }
        return roots;
    }

    static glm::dmat4 matrix_of(const tinygltf::Node& node) {
        glm::dmat4 matrix(1.0);
        if (node.matrix.size() == 16) {
            for (int i = 0; i < 16; ++i) {
                matrix[i / 4][i % 4] = node.matrix[i];
            }
            return matrix;
        }
        if (node.rotation.size() == 4) {
            const double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
            matrix[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0};
            matrix[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0};
            matrix[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0};
        }
        for (int i = 0; i < 3; ++i) {
            matrix[i] *= node.scale.size() == 3 ? node.scale[i] : 1.0;
            matrix[3][i] = node.translation.size() == 3 ? node.translation[i] : 0.0;
        }
        return matrix;
    }

    void add_node(int index, const glm::dmat4& parent, int depth) {
        constexpr int deepest = 64, most_visits = 1 << 20;
        const std::string place = fmt::format("node {}", index);
        const tinygltf::Node& node = element(model_.nodes, index, "node");
        if (depth > deepest || ++visits_ > most_visits) {
            fail(place, "nodes within nodes without end", "at most 64 levels and 2^20 nodes");
        }
        const glm::dmat4 matrix = parent * matrix_of(node);
        if (node.mesh >= 0) {
            add_mesh(node.mesh, matrix);
        }
        for (const int child : node.children) {
            add_node(child, matrix, depth + 1);
        }
    }

    void add_mesh(int index, const glm::dmat4& matrix) {
        const tinygltf::Mesh& mesh = element(model_.meshes, index, "mesh");
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            add_primitive(mesh.primitives[i], matrix, fmt::format("mesh {}, primitive {}", index, i));
        }
    }

    AccessorView view(int index, int type, const std::string& place) const {
        const tinygltf::Accessor& accessor = element(model_.accessors, index, place + ", accessor");
        const std::string at = fmt::format("accessor {}", index);
        if (accessor.sparse.isSparse || accessor.type != type) {
            fail(at, accessor.sparse.isSparse ? "a sparse one" : fmt::format("type {}", accessor.type),
                 fmt::format("{}, not sparse", type == TINYGLTF_TYPE_VEC3 ? "VEC3" : "SCALAR"));
        }
        const tinygltf::BufferView& part = element(model_.bufferViews, accessor.bufferView, at + ", bufferView");
        const tinygltf::Buffer& buffer = element(model_.buffers, part.buffer, at + ", buffer");
        const int size =
            tinygltf::GetComponentSizeInBytes(accessor.componentType) * (type == TINYGLTF_TYPE_VEC3 ? 3 : 1);
        AccessorView view;
        view.count = accessor.count;
        view.component_type = accessor.componentType;
        view.stride = part.byteStride > 0 ? part.byteStride : static_cast<std::size_t>(std::max(size, 1));
        // In this order, no sum can leave its range: counts are below 2^32 first.
        const bool fits = size > 0 && accessor.count > 0 && accessor.count <= most_triangles * 3 &&
                          view.stride <= 4096 && part.byteOffset <= buffer.data.size() &&
                          part.byteLength <= buffer.data.size() - part.byteOffset &&
                          accessor.byteOffset <= part.byteLength &&
                          (accessor.count - 1) * view.stride + static_cast<std::size_t>(size) <=
                              part.byteLength - accessor.byteOffset;
        if (!fits) {
            fail(at,
                 fmt::format("{} elements of {} bytes each {} bytes from byte {} on", accessor.count, size, view.stride,
                             accessor.byteOffset),
                 fmt::format("at least one, within its bufferView ({} bytes) and buffer ({} bytes)", part.byteLength,
                             buffer.data.size()));
        }
        view.data = buffer.data.data() + part.byteOffset + accessor.byteOffset;
        return view;
    }

    AccessorView vectors(int index, const std::string& place) const {
        const AccessorView found = view(index, TINYGLTF_TYPE_VEC3, place);
        if (found.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT) {
            fail(fmt::format("accessor {}", index), fmt::format("component type {}", found.component_type),
                 "float (5126)");
        }
        return found;
    }

    AccessorView indices(int index, const std::string& place) const {
        const AccessorView found = view(index, TINYGLTF_TYPE_SCALAR, place);
        if (found.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
            found.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
            found.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
            fail(fmt::format("accessor {}", index), fmt::format("component type {}", found.component_type),
                 "unsigned byte, short or int (5121, 5123, 5125)");
        }
        return found;
    }

    void add_primitive(const tinygltf::Primitive& primitive, const glm::dmat4& matrix, const std::string& place) {
        const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
        const auto position = primitive.attributes.find("POSITION"), normal = primitive.attributes.find("NORMAL");
        const bool is_surface = mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
                                mode == TINYGLTF_MODE_TRIANGLE_FAN;
        if (!is_surface || position == primitive.attributes.end()) {
            return;  // points and lines, and what has no place
        }
        const AccessorView positions = vectors(position->second, place);
        const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
        if (mesh_.vertices.size() + positions.count > most_vertices) {
            fail(place, "more vertices", fmt::format("at most {}", most_vertices));
        }
        for (std::size_t i = 0; i < positions.count; ++i) {
            const glm::dvec4 moved =
                matrix * glm::dvec4(positions.real(i, 0), positions.real(i, 1), positions.real(i, 2), 1.0);
            mesh_.vertices.push_back(
                {static_cast<float>(moved.x), static_cast<float>(moved.y), static_cast<float>(moved.z)});
        }
        has_normals_ = has_normals_ && normal != primitive.attributes.end();
        if (has_normals_) {
            add_normals(vectors(normal->second, place), positions.count, matrix, place);
        }
        add_triangles(primitive, mode, first, positions.count, glm::determinant(glm::dmat3(matrix)) < 0.0, place);
    }

    // By the matrix's cofactors: right for scales that differ and mirrors, too.
    void add_normals(const AccessorView& normals, std::size_t vertices, const glm::dmat4& matrix,
                     const std::string& place) {
        if (normals.count != vertices) {
            fail(place, fmt::format("{} normals", normals.count), fmt::format("one for each of {} vertices", vertices));
        }
        const glm::dvec3 x(matrix[0]), y(matrix[1]), z(matrix[2]);
        const double side = glm::determinant(glm::dmat3(matrix)) < 0.0 ? -1.0 : 1.0;
        for (std::size_t i = 0; i < vertices; ++i) {
            const glm::dvec3 turned = side * (static_cast<double>(normals.real(i, 0)) * glm::cross(y, z) +
                                              static_cast<double>(normals.real(i, 1)) * glm::cross(z, x) +
                                              static_cast<double>(normals.real(i, 2)) * glm::cross(x, y));
            mesh_.normals.push_back(
                {static_cast<float>(turned.x), static_cast<float>(turned.y), static_cast<float>(turned.z)});
        }
    }

    void add_triangles(const tinygltf::Primitive& primitive, int mode, std::uint32_t first, std::size_t vertices,
                       bool is_mirrored, const std::string& place) {
        const bool has_indices = primitive.indices >= 0;
        const AccessorView list = has_indices ? indices(primitive.indices, place) : AccessorView{};
        const std::size_t count = has_indices ? list.count : vertices;
        const auto corner = [&](std::size_t i) {
            const std::uint32_t index = has_indices ? list.whole(i) : static_cast<std::uint32_t>(i);
            if (index >= vertices) {
                fail(place, fmt::format("vertex {}", index), fmt::format("0 to {}", vertices - 1));
            }
            return first + index;
        };
        const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
        if (mode == TINYGLTF_MODE_TRIANGLES && count % 3 != 0) {
            fail(place, fmt::format("{} corners", count), "three for each triangle");
        }
        for (std::size_t i = 0; i + 2 < count; i += step) {
            const bool is_turned = is_mirrored != (mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1);
            const std::uint32_t a = corner(mode == TINYGLTF_MODE_TRIANGLE_FAN ? 0 : i), b = corner(i + 1),
                                c = corner(i + 2);
            if (mesh_.triangles.size() >= most_triangles) {
                fail(place, "more triangles", fmt::format("at most {}", most_triangles));
            }
            mesh_.triangles.push_back(is_turned ? std::array{a, c, b} : std::array{a, b, c});
        }
    }

    const tinygltf::Model& model_;
    const std::string& file_;
    int visits_ = 0;
    bool has_normals_ = true;  // so far: they are kept where every primitive has them
    Mesh mesh_;
};

}  // namespace

Mesh parse_glb(std::string_view content, const std::string& file) {
    Mesh mesh = GlbReader(parse_model(content, file, ""), file).read();
    check_mesh(mesh, file);
    return mesh;
}

Mesh parse_gltf(std::string_view content, const std::string& file) {
    const std::string folder = std::filesystem::path(file).parent_path().string();
    Mesh mesh = GlbReader(parse_model(content, file, folder.empty() ? "." : folder), file).read();
    check_mesh(mesh, file);
    return mesh;
}

bool reads_glb() { return true; }

}  // namespace pt

#else

namespace pt {

Mesh parse_glb(std::string_view, const std::string& file) {
    throw InputError(file + ": this build has no reader for .glb: install libtinygltf-dev and build again");
}

Mesh parse_gltf(std::string_view, const std::string& file) {
    throw InputError(file + ": this build has no reader for .gltf: install libtinygltf-dev and build again");
}

bool reads_glb() { return false; }

}  // namespace pt

#endif
