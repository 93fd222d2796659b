// Parses glTF 2 files by tinygltf and turns their primitives into meshes. Only for files compiled with tinygltf
// (PTBENCH_HAS_TINYGLTF). Checks that accessors lie within their buffers, which tinygltf does not.
#pragma once

#include <fstream>  // tiny_gltf.h lacks <fstream> with TINYGLTF_NO_FS
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <glm/mat4x4.hpp>

// tinygltf is compiled to decode no images, and to read files only through a function that its caller gives it.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

#include "harness/failure.h"
#include "harness/mesh/mesh.h"
#include "harness/mesh/resolution.h"

namespace pt {

// Function that returns the content of a file which a glTF model names; throws InputError.
using GltfFileReader = std::function<std::string(const std::string& name)>;

// Parses glTF, binary or JSON by its first bytes; without `read`, data must be embedded. Throws InputError.
tinygltf::Model parse_gltf_model(std::string_view content, const std::string& file,
                                 const GltfFileReader& read = nullptr);

// Builds one mesh from the primitives of a glTF model. Throws InputError for invalid primitives.
class GltfMeshMaker {
public:
    GltfMeshMaker(const tinygltf::Model& model, const std::string& file) : model_(model), file_(file) {}

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

    // Root nodes of the glTF file's default or first scene; without scenes, all nodes that have no parent.
    std::vector<int> roots() const;
    static glm::dmat4 matrix_of(const tinygltf::Node& node);
    // Whether a glTF node is hidden, children included, by a scale of 0 along all axes.
    static bool is_hidden(const tinygltf::Node& node);
    // Whether morph targets move the node's vertices, by the node's weights or, if it has none, by its mesh's.
    bool is_morphed(const tinygltf::Node& node) const;

    // Whether a glTF primitive has triangles. Points, lines and primitives without positions have none.
    static bool is_surface(const tinygltf::Primitive& primitive);
    void add_primitive(const tinygltf::Primitive& primitive, const glm::dmat4& matrix, const std::string& place);
    Mesh take();
    MeshWarnings& warnings() { return mesh_.warnings; }
    const RoundingLoss& loss() const { return loss_; }  // largest rounding error of the mesh's transformed vertices

private:
    struct AccessorView;
    AccessorView view(int index, int type, const std::string& place) const;
    AccessorView vectors(int index, const std::string& place) const;
    AccessorView indices(int index, const std::string& place) const;
    void add_normals(const AccessorView& normals, std::size_t vertices, const glm::dmat4& matrix,
                     const std::string& place);
    void add_coordinates(const tinygltf::Primitive& primitive, std::size_t vertices, const std::string& place);
    void add_triangles(const tinygltf::Primitive& primitive, int mode, std::uint32_t first, std::size_t vertices,
                       bool is_mirrored, const std::string& place);

    const tinygltf::Model& model_;
    const std::string& file_;
    bool has_normals_ = true;                        // whether all glTF primitives so far have vertex normals
    bool has_coordinates_ = true;                    // whether all glTF primitives so far have texture coordinates
    std::vector<std::array<float, 2>> coordinates_;  // texture coordinates of the glTF mesh by vertex
    RoundingLoss loss_;
    Mesh mesh_;
};

}  // namespace pt
