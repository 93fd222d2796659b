// Binary glTF 2.0 (Khronos, ISO/IEC 12113) as one mesh: what nodes do to meshes is done here.
#include "harness/mesh/read_mesh.h"

#ifdef PTBENCH_HAS_TINYGLTF

#include <filesystem>

#include "harness/json_reader.h"
#include "harness/mesh/check_mesh.h"
#include "harness/mesh/gltf_model.h"

namespace pt {

namespace {

class GlbReader {
public:
    GlbReader(const tinygltf::Model& model, const std::string& file) : model_(model), maker_(model, file) {}

    Mesh read() {
        if (!model_.extensionsRequired.empty()) {
            maker_.fail("extensionsRequired", "\"" + model_.extensionsRequired.front() + "\"", "none");
        }
        const glm::dmat4 identity(1.0);
        if (model_.nodes.empty()) {
            for (std::size_t i = 0; i < model_.meshes.size(); ++i) {
                add_mesh(static_cast<int>(i), identity);
            }
        } else {
            for (const int node : maker_.roots()) {
                add_node(node, identity, 0);
            }
        }
        return maker_.take();
    }

private:
    void add_node(int index, const glm::dmat4& parent, int depth) {
        constexpr int deepest = 64, most_visits = 1 << 20;
        const std::string place = fmt::format("node {}", index);
        const tinygltf::Node& node = maker_.element(model_.nodes, index, "node");
        if (depth > deepest || ++visits_ > most_visits) {
            maker_.fail(place, "nodes within nodes without end", "at most 64 levels and 2^20 nodes");
        }
        const glm::dmat4 matrix = parent * GltfMeshMaker::matrix_of(node);
        if (node.mesh >= 0) {
            add_mesh(node.mesh, matrix);
        }
        for (const int child : node.children) {
            add_node(child, matrix, depth + 1);
        }
    }

    void add_mesh(int index, const glm::dmat4& matrix) {
        const tinygltf::Mesh& mesh = maker_.element(model_.meshes, index, "mesh");
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            maker_.add_primitive(mesh.primitives[i], matrix, fmt::format("mesh {}, primitive {}", index, i));
        }
    }

    const tinygltf::Model& model_;
    GltfMeshMaker maker_;
    int visits_ = 0;
};

}  // namespace

Mesh parse_glb(std::string_view content, const std::string& file) {
    const tinygltf::Model model = parse_gltf_model(content, file);
    Mesh mesh = GlbReader(model, file).read();
    check_mesh(mesh, file);
    return mesh;
}

Mesh parse_gltf(std::string_view content, const std::string& file) {
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    const tinygltf::Model model = parse_gltf_model(
        content, file, [&](const std::string& name) { return read_file((folder / name).string(), largest_mesh_file); });
    Mesh mesh = GlbReader(model, file).read();
    check_mesh(mesh, file);
    return mesh;
}

bool reads_glb() { return true; }

}  // namespace pt

#else

#include "harness/error.h"

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
