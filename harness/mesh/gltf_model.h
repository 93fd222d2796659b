// A glTF 2 file as tinygltf reads it, and its primitives as meshes. Only for files that are compiled with tinygltf
// (PTBENCH_HAS_TINYGLTF). That an accessor lies within its buffer, which tinygltf does not ask, is held here.
#pragma once

#include <fstream>  // tiny_gltf.h leaves it out with TINYGLTF_NO_FS
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <glm/mat4x4.hpp>

// The library is told to decode no images, and to read no file that no reader is given for.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

#include "harness/failure.h"
#include "harness/mesh/mesh.h"
#include "harness/mesh/resolution.h"

namespace pt {

// The content of a file that the model names; throws InputError.
using GltfFileReader = std::function<std::string(const std::string& name)>;

// Parses glTF, binary or JSON by its first bytes. Without a reader of files, all data must be within. Throws
// InputError.
tinygltf::Model parse_gltf_model(std::string_view content, const std::string& file,
                                 const GltfFileReader& read = nullptr);

// Makes one mesh of primitives; what is wrong with them throws InputError.
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

    // The nodes of the scene that is shown first; without a scene, those that no other has.
    std::vector<int> roots() const;
    static glm::dmat4 matrix_of(const tinygltf::Node& node);
    // Whether a node is hidden by a scale of 0 along all axes, which hides what hangs on it too.
    static bool is_hidden(const tinygltf::Node& node);
    // Whether a node's weights, or without any its mesh's, move its vertices.
    bool is_morphed(const tinygltf::Node& node) const;

    // Whether a primitive has triangles: points and lines have none, nor has one without positions.
    static bool is_surface(const tinygltf::Primitive& primitive);
    void add_primitive(const tinygltf::Primitive& primitive, const glm::dmat4& matrix, const std::string& place);
    Mesh take();
    MeshWarnings& warnings() { return mesh_.warnings; }
    const RoundingLoss& loss() const { return loss_; }  // of vertices that were placed, by their numbers

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
    bool has_normals_ = true;                        // so far: they are kept where every primitive has them
    bool has_coordinates_ = true;                    // likewise
    std::vector<std::array<float, 2>> coordinates_;  // by vertex
    RoundingLoss loss_;
    Mesh mesh_;
};

}  // namespace pt
