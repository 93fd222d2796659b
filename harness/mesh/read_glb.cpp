// Reads binary glTF 2.0 (Khronos, ISO/IEC 12113) as one mesh, with the transforms of its nodes applied.
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
        Mesh mesh = maker_.take();
        if (const auto warning = resolution_warning(mesh, maker_.loss().largest())) {
            mesh.warnings.add(fmt::format("vertex {}, where its node places it", maker_.loss().place()), *warning);
        }
        return mesh;
    }

private:
    void add_node(int index, const glm::dmat4& parent, int depth) {
        constexpr int deepest = 64, most_visits = 1 << 20;
        const std::string place = fmt::format("node {}", index);
        const tinygltf::Node& node = maker_.element(model_.nodes, index, "node");
        if (depth > deepest || ++visits_ > most_visits) {
            maker_.fail(place, "nodes within nodes without end", "at most 64 levels and 2^20 nodes");
        }
        if (GltfMeshMaker::is_hidden(node)) {
            maker_.warnings().add(place, "its scale is 0, which hides it and what hangs on it: left out");
            return;
        }
        warn_of_node(node, place);
        const glm::dmat4 matrix = parent * GltfMeshMaker::matrix_of(node);
        if (node.mesh >= 0) {
            add_mesh(node.mesh, matrix);
        }
        for (const int child : node.children) {
            add_node(child, matrix, depth + 1);
        }
    }

    void warn_of_node(const tinygltf::Node& node, const std::string& place) {
        MeshWarnings& warnings = maker_.warnings();
        if (node.skin >= 0) {
            warnings.add(place, "its skin is passed over: the mesh is placed as a mesh without one, and not bent");
        }
        if (maker_.is_morphed(node)) {
            warnings.add(place, "its weights of morph targets are passed over: the mesh has its own shape");
        }
        if (node.rotation == std::vector<double>(4, 0.0)) {
            warnings.add(place, "its rotation is (0, 0, 0, 0), which is none: it turns nothing");
        }
        for (const auto& [name, value] : node.extensions) {
            if (name != "KHR_lights_punctual") {  // glTF lights are no part of a mesh, so no warning
                warnings.add(place, "its extension " + name + " is passed over");
            }
        }
    }

    void add_mesh(int index, const glm::dmat4& matrix) {
        const tinygltf::Mesh& mesh = maker_.element(model_.meshes, index, "mesh");
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            const std::string place = fmt::format("mesh {}, primitive {}", index, i);
            if (!GltfMeshMaker::is_surface(mesh.primitives[i])) {
                maker_.warnings().add(place, "it is passed over: points, lines, or no positions");
            }
            maker_.add_primitive(mesh.primitives[i], matrix, place);
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

#include "harness/failure.h"

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
