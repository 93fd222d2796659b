// Reads glTF 2.0 (Khronos, ISO/IEC 12113): tinygltf parses JSON and binary chunks, this file makes meshes of them.
#ifdef PTBENCH_HAS_TINYGLTF

#define TINYGLTF_IMPLEMENTATION
#include "harness/mesh/gltf_model.h"

#include <cmath>
#include <cstring>
#include <set>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "harness/words.h"

namespace pt {

namespace {

bool read_for_tinygltf(std::vector<unsigned char>* content, std::string* error, const std::string& name, void* user) {
    try {
        const std::string text = (*static_cast<GltfFileReader*>(user))(name);
        content->assign(text.begin(), text.end());
        return true;
    } catch (const InputError& wrong) {
        *error += wrong.what();
        return false;
    }
}

std::uint32_t word_at(const unsigned char* from) {
    return from[0] | from[1] << 8 | from[2] << 16 | static_cast<std::uint32_t>(from[3]) << 24;
}

// Checks that the second chunk of a .glb ends within the file. tinygltf 2.7 leaves the 8 bytes of that chunk's header
// out of its check and then reads beyond the end; it detects all other faults of chunks itself.
void check_binary_chunk(std::string_view content, const std::string& file) {
    constexpr std::size_t file_header = 12, chunk_header = 8;
    if (content.size() < file_header + chunk_header) {
        return;
    }
    const auto* const bytes = reinterpret_cast<const unsigned char*>(content.data());
    const std::size_t length = word_at(bytes + 8);
    const std::size_t data = file_header + chunk_header + word_at(bytes + file_header) + chunk_header;
    if (length > content.size() || data > length) {
        return;
    }
    const std::size_t size = word_at(bytes + data - chunk_header);
    if (size > length - data) {
        throw InputError(file, "chunk BIN", fmt::format("{} bytes", size),
                         fmt::format("at most {}, where the file ends", length - data));
    }
}

// Refuses glTF versions after 2.x, by `minVersion`, the version that a reader needs, or else by `version`.
void check_version(const tinygltf::Asset& asset, const std::string& file) {
    const bool has_least = !asset.minVersion.empty();
    const std::string& needed = has_least ? asset.minVersion : asset.version;
    const double number = parse_number<double>(needed).value_or(0);  // glTF version, such as "2.1", as a number
    if (has_least ? number != 2.0 : !(number >= 2.0 && number < 3.0)) {
        throw InputError(file, has_least ? "asset.minVersion" : "asset.version", "\"" + needed + "\"",
                         has_least ? "2.0" : "2.0, or a later 2.x");
    }
}

}  // namespace

tinygltf::Model parse_gltf_model(std::string_view content, const std::string& file, const GltfFileReader& read) {
    constexpr std::size_t largest = 0xffffffff;  // largest glTF file in bytes, by the format
    if (content.size() > largest) {
        throw InputError(file, "file", fmt::format("{} bytes", content.size()), fmt::format("at most {}", largest));
    }
    const bool is_binary = content.starts_with("glTF") || !read;
    if (is_binary) {
        check_binary_chunk(content, file);
    }
    tinygltf::TinyGLTF loader;
    // The bytes of a glTF image in a data URI are kept, as they are stored nowhere else; bytes in a buffer stay there.
    loader.SetImageLoader(
        [](tinygltf::Image* image, const int, std::string*, std::string*, int, int, const unsigned char* bytes,
           int size, void*) {
            if (image->bufferView < 0) {
                image->image.assign(bytes, bytes + size);
            }
            return true;
        },
        nullptr);
    GltfFileReader reader = read;
    const tinygltf::FsCallbacks files{
        [](const std::string&, void* user) { return bool(*static_cast<GltfFileReader*>(user)); },
        [](const std::string& name, void*) { return name; }, read_for_tinygltf,
        [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }, &reader};
    loader.SetFsCallbacks(files);
    tinygltf::Model model;
    std::string errors, warnings;
    bool is_read = false;
    try {
        const auto size = static_cast<unsigned int>(content.size());
        is_read = is_binary ? loader.LoadBinaryFromMemory(&model, &errors, &warnings,
                                                          reinterpret_cast<const unsigned char*>(content.data()), size)
                            : loader.LoadASCIIFromString(&model, &errors, &warnings, content.data(), size, "");
    } catch (const std::exception& error) {
        errors = error.what();
    }
    if (!is_read) {
        throw InputError(file, "file",
                         errors.empty() ? "what tinygltf cannot read" : errors.substr(0, errors.find('\n')),
                         read ? "glTF 2.0 with its data beside it" : "binary glTF 2.0 with its data in it");
    }
    check_version(model.asset, file);
    return model;
}

// The numbers of a glTF accessor, checked to lie within its buffer.
struct GltfMeshMaker::AccessorView {
    const unsigned char* data = nullptr;
    std::size_t count = 0, stride = 0;
    int component_type = 0;

    float real(std::size_t i, std::size_t component) const {
        float value;
        std::memcpy(&value, data + i * stride + component * sizeof(float), sizeof(float));
        return value;
    }
    bool is_texture() const {
        return component_type == TINYGLTF_COMPONENT_TYPE_FLOAT ||
               component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
               component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    }
    // A component of an accessor's element; integers are normalised by their largest value.
    float fraction(std::size_t i, std::size_t component) const {
        const unsigned char* from = data + i * stride;
        switch (component_type) {
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return static_cast<float>(from[component]) / 255.0f;
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                return static_cast<float>(from[2 * component] | from[2 * component + 1] << 8) / 65535.0f;
            default:
                return real(i, component);
        }
    }
    std::uint32_t whole(std::size_t i) const {
        const unsigned char* from = data + i * stride;
        switch (component_type) {
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return *from;
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                return from[0] | from[1] << 8;
            default:
                return word_at(from);
        }
    }
};

std::vector<int> GltfMeshMaker::roots() const {
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

namespace {

// A glTF node's rotation, normalised unless it is off by rounding to single precision only.
glm::dvec4 unit_rotation(const tinygltf::Node& node) {
    constexpr double rounding = 1e-6;
    const glm::dvec4 rotation(node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]);
    const double square = glm::dot(rotation, rotation);
    const bool is_other = std::abs(square - 1) > rounding && square > 0 && std::isfinite(square);
    return is_other ? rotation / std::sqrt(square) : rotation;
}

}  // namespace

bool GltfMeshMaker::is_hidden(const tinygltf::Node& node) {
    const auto is_zero = [](double number) { return number == 0; };
    if (node.matrix.size() != 16) {
        return node.scale.size() == 3 && std::all_of(node.scale.begin(), node.scale.end(), is_zero);
    }
    return std::all_of(node.matrix.begin(), node.matrix.begin() + 3, is_zero) &&
           std::all_of(node.matrix.begin() + 4, node.matrix.begin() + 7, is_zero) &&
           std::all_of(node.matrix.begin() + 8, node.matrix.begin() + 11, is_zero);
}

bool GltfMeshMaker::is_morphed(const tinygltf::Node& node) const {
    const bool has_mesh = node.mesh >= 0 && static_cast<std::size_t>(node.mesh) < model_.meshes.size();
    const std::vector<double>& weights =
        node.weights.empty() && has_mesh ? model_.meshes[static_cast<std::size_t>(node.mesh)].weights : node.weights;
    return std::any_of(weights.begin(), weights.end(), [](double weight) { return weight != 0; });
}

glm::dmat4 GltfMeshMaker::matrix_of(const tinygltf::Node& node) {
    glm::dmat4 matrix(1.0);
    if (node.matrix.size() == 16) {
        for (int i = 0; i < 16; ++i) {
            matrix[i / 4][i % 4] = node.matrix[i];
        }
        return matrix;
    }
    if (node.rotation.size() == 4) {
        const glm::dvec4 unit = unit_rotation(node);
        const double x = unit.x, y = unit.y, z = unit.z, w = unit.w;
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

bool GltfMeshMaker::is_surface(const tinygltf::Primitive& primitive) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    return (mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
            mode == TINYGLTF_MODE_TRIANGLE_FAN) &&
           primitive.attributes.contains("POSITION");
}

GltfMeshMaker::AccessorView GltfMeshMaker::view(int index, int type, const std::string& place) const {
    const tinygltf::Accessor& accessor = element(model_.accessors, index, place + ", accessor");
    const std::string at = fmt::format("accessor {}", index);
    if (accessor.sparse.isSparse || accessor.type != type) {
        fail(at, accessor.sparse.isSparse ? "a sparse one" : fmt::format("type {}", accessor.type),
             fmt::format("{}, not sparse", type == TINYGLTF_TYPE_VEC3   ? "VEC3"
                                           : type == TINYGLTF_TYPE_VEC2 ? "VEC2"
                                                                        : "SCALAR"));
    }
    if (accessor.bufferView < 0) {
        fail(at, "no bufferView, so that all its numbers are 0", "one with a bufferView");
    }
    const tinygltf::BufferView& part = element(model_.bufferViews, accessor.bufferView, at + ", bufferView");
    const tinygltf::Buffer& buffer = element(model_.buffers, part.buffer, at + ", buffer");
    const int size = tinygltf::GetComponentSizeInBytes(accessor.componentType) * tinygltf::GetNumComponentsInType(type);
    AccessorView view;
    view.count = accessor.count;
    view.component_type = accessor.componentType;
    view.stride = part.byteStride > 0 ? part.byteStride : static_cast<std::size_t>(std::max(size, 1));
    // Counts are bounded by 2^32 before the accessor's other terms are checked, so that no product or sum overflows.
    const bool fits =
        size > 0 && accessor.count > 0 && accessor.count <= most_triangles * 3 && view.stride <= 4096 &&
        part.byteOffset <= buffer.data.size() && part.byteLength <= buffer.data.size() - part.byteOffset &&
        accessor.byteOffset <= part.byteLength &&
        (accessor.count - 1) * view.stride + static_cast<std::size_t>(size) <= part.byteLength - accessor.byteOffset;
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

GltfMeshMaker::AccessorView GltfMeshMaker::vectors(int index, const std::string& place) const {
    const AccessorView found = view(index, TINYGLTF_TYPE_VEC3, place);
    if (found.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT) {
        fail(fmt::format("accessor {}", index), fmt::format("component type {}", found.component_type), "float (5126)");
    }
    return found;
}

GltfMeshMaker::AccessorView GltfMeshMaker::indices(int index, const std::string& place) const {
    const AccessorView found = view(index, TINYGLTF_TYPE_SCALAR, place);
    if (found.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        found.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        found.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
        fail(fmt::format("accessor {}", index), fmt::format("component type {}", found.component_type),
             "unsigned byte, short or int (5121, 5123, 5125)");
    }
    return found;
}

void GltfMeshMaker::add_primitive(const tinygltf::Primitive& primitive, const glm::dmat4& matrix,
                                  const std::string& place) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    const auto position = primitive.attributes.find("POSITION"), normal = primitive.attributes.find("NORMAL");
    const bool is_surface =
        mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP || mode == TINYGLTF_MODE_TRIANGLE_FAN;
    if (!is_surface || position == primitive.attributes.end()) {
        return;  // a glTF primitive without triangles or without positions adds nothing
    }
    const AccessorView positions = vectors(position->second, place);
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    if (mesh_.vertices.size() + positions.count > most_vertices) {
        fail(place, "more vertices", fmt::format("at most {}", most_vertices));
    }
    for (std::size_t i = 0; i < positions.count; ++i) {
        const glm::dvec4 moved =
            matrix * glm::dvec4(positions.real(i, 0), positions.real(i, 1), positions.real(i, 2), 1.0);
        const std::array rounded{static_cast<float>(moved.x), static_cast<float>(moved.y), static_cast<float>(moved.z)};
        loss_.add({moved.x, moved.y, moved.z}, rounded, mesh_.vertices.size());
        mesh_.vertices.push_back(rounded);
    }
    has_normals_ = has_normals_ && normal != primitive.attributes.end();
    if (has_normals_) {
        add_normals(vectors(normal->second, place), positions.count, matrix, place);
    }
    has_coordinates_ = has_coordinates_ && primitive.attributes.contains("TEXCOORD_0");
    if (has_coordinates_) {
        add_coordinates(primitive, positions.count, place);
    }
    add_triangles(primitive, mode, first, positions.count, glm::determinant(glm::dmat3(matrix)) < 0.0, place);
}

// Adds vertex normals transformed by a node matrix's cofactors, which is right for non-uniform scales and mirrors, too.
void GltfMeshMaker::add_normals(const AccessorView& normals, std::size_t vertices, const glm::dmat4& matrix,
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

// Adds texture coordinates, with glTF's v flipped. Unreadable ones are dropped silently: most scenes show no texture.
void GltfMeshMaker::add_coordinates(const tinygltf::Primitive& primitive, std::size_t vertices,
                                    const std::string& place) {
    try {
        const AccessorView found = view(primitive.attributes.at("TEXCOORD_0"), TINYGLTF_TYPE_VEC2, place);
        has_coordinates_ = found.count == vertices && found.is_texture();
        for (std::size_t i = 0; has_coordinates_ && i < vertices; ++i) {
            coordinates_.push_back({found.fraction(i, 0), 1.0f - found.fraction(i, 1)});
        }
    } catch (const InputError&) {
        has_coordinates_ = false;
    }
}

void GltfMeshMaker::add_triangles(const tinygltf::Primitive& primitive, int mode, std::uint32_t first,
                                  std::size_t vertices, bool is_mirrored, const std::string& place) {
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

Mesh GltfMeshMaker::take() {
    if (!has_normals_) {
        mesh_.normals.clear();
    }
    if (has_coordinates_) {
        mesh_.coordinates = places_of_corners(mesh_.triangles, coordinates_);
    }
    coordinates_.clear();
    return std::move(mesh_);
}

}  // namespace pt

#endif
