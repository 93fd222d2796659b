#include "harness/interchange/import_gltf.h"

#ifdef PTBENCH_HAS_TINYGLTF

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "harness/interchange/import_gltf_material.h"
#include "harness/json_reader.h"
#include "harness/mesh/check_mesh.h"
#include "harness/mesh/gltf_model.h"
#include "harness/scene/scene_mesh.h"

namespace pt {

namespace {

// Values for what glTF leaves to the viewer: image height, path depth, aspect ratio, field of view in degrees.
constexpr int gltf_picture_height = 600, gltf_max_depth = 8;
constexpr double gltf_aspect = 4.0 / 3.0, gltf_view_degrees = 45;

Affine affine_of(const glm::dmat4& matrix) {
    Affine map;
    for (int i = 0; i < 3; ++i) {
        map.column[i] = Vec3d(matrix[i]);
    }
    map.origin = Vec3d(matrix[3]);
    return map;
}

// The matrix of a glTF node with its rotation normalised in double. Files round rotations to single precision, which
// would show in the angles of the scene file.
glm::dmat4 matrix_of_node(const tinygltf::Node& node) {
    tinygltf::Node exact = node;
    double square = 0;
    for (const double part : node.rotation) {
        square += part * part;
    }
    for (double& part : exact.rotation) {
        part = square > 0 ? part / std::sqrt(square) : part;
    }
    return GltfMeshMaker::matrix_of(exact);
}

bool are_directions(const std::vector<std::array<float, 3>>& normals) {
    return std::all_of(normals.begin(), normals.end(), [](const std::array<float, 3>& n) {
        return std::all_of(n.begin(), n.end(), [](float part) { return std::isfinite(part); }) &&
               n != std::array<float, 3>{0, 0, 0};
    });
}

class GltfImporter {
public:
    GltfImporter(const tinygltf::Model& model, const ImportSource& source, ImportResult& result)
        : model_(&model), draft_(source, result), materials_(model, draft_), maker_(model, source.file) {}

    void import();

private:
    void refuse(const std::string& pointer, const std::string& found, const std::string& allowed) {
        draft_.refuse(*draft_.place(0, pointer + ": " + found), allowed);
    }
    void warn(const std::string& pointer, const std::string& what) { draft_.warnings().add(0, pointer + " " + what); }

    void refuse_extensions();
    void add_node(int index, const glm::dmat4& parent, int depth);
    void refuse_of_node(const tinygltf::Node& node, const std::string& pointer);
    void add_mesh(int index, const Affine& map, const Cis565Line* at);
    // The mesh file of a glTF primitive, written on first use; empty, after a message, if it has no valid triangles.
    const std::string& file_of(int mesh, std::size_t primitive, const std::string& pointer);
    void add_camera(int index, const Affine& map, const std::string& node);
    void add_view(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up, double degrees, double aspect,
                  const Cis565Line* at);
    void make_camera(const Scene& scene);
    void light_what_nobody_lights();

    const tinygltf::Model* model_;
    ImportDraft draft_;
    GltfMaterials materials_;
    GltfMeshMaker maker_;
    std::map<std::pair<int, std::size_t>, std::string> files_;
    std::set<std::string> has_coordinates_;  // written mesh files that have texture coordinates
    std::set<std::string> has_normals_;      // written mesh files that have vertex normals
    int visits_ = 0;
    std::uint64_t vertices_ = 0;
    bool has_camera_ = false;
};

void GltfImporter::refuse_extensions() {
    constexpr const char* known[] = {"KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_materials_specular",
                                     "KHR_materials_transmission", "KHR_materials_volume"};
    for (std::size_t i = 0; i < model_->extensionsRequired.size(); ++i) {
        const std::string& name = model_->extensionsRequired[i];
        if (std::none_of(std::begin(known), std::end(known), [&](const char* one) { return name == one; })) {
            refuse(fmt::format("/extensionsRequired/{}", i), name,
                   "KHR_materials_emissive_strength, _ior, _specular, _transmission or _volume");
        }
    }
    for (std::size_t i = 0; i < model_->lights.size(); ++i) {
        refuse(fmt::format("/extensions/KHR_lights_punctual/lights/{}", i), model_->lights[i].type + " light",
               "lamps that are surfaces: a material with emissiveFactor");
    }
    if (!model_->animations.empty()) {
        draft_.notes().add(0, "/animations are left out: all is where it stands at rest");
    }
}

void GltfImporter::refuse_of_node(const tinygltf::Node& node, const std::string& pointer) {
    if (node.skin >= 0) {
        refuse(pointer + "/skin", fmt::format("skin {}", node.skin), "no skin: meshes that do not bend");
    }
    if (node.rotation == std::vector<double>(4, 0.0)) {
        warn(pointer + "/rotation", "is (0, 0, 0, 0), which is none: it turns nothing");
    }
    if (maker_.is_morphed(node)) {
        refuse(pointer + "/weights", "weights of morph targets", "weights of 0");
    }
    for (const auto& [name, value] : node.extensions) {
        if (name != "KHR_lights_punctual") {  // glTF lights are reported elsewhere, once per file
            refuse(pointer + "/extensions/" + name, "an extension", "none of a node");
        }
    }
}

const std::string& GltfImporter::file_of(int mesh, std::size_t primitive, const std::string& pointer) {
    const auto [known, is_new] = files_.try_emplace({mesh, primitive});
    if (!is_new) {
        return known->second;
    }
    const tinygltf::Primitive& part = model_->meshes[static_cast<std::size_t>(mesh)].primitives[primitive];
    if (!GltfMeshMaker::is_surface(part)) {
        warn(pointer, "is left out: points, lines, or no positions");
        return known->second;
    }
    if (part.attributes.contains("COLOR_0")) {
        refuse(pointer + "/attributes/COLOR_0", "colours of vertices", "one colour, of the material");
    }
    try {
        GltfMeshMaker maker(*model_, draft_.source().file);
        maker.add_primitive(part, glm::dmat4(1.0), pointer);
        Mesh made = maker.take();
        if (!are_directions(made.normals)) {
            warn(pointer + "/attributes/NORMAL", "has one that is no direction: the triangles are flat here");
            made.normals.clear();
        }
        vertices_ += made.vertices.size();
        if (vertices_ > most_vertices) {
            refuse(pointer, "more vertices", fmt::format("at most {} in all", most_vertices));
            return known->second;
        }
        check_mesh(made, draft_.source().file);
        known->second = draft_.keep_mesh(made);
        if (!made.coordinates.empty()) {
            has_coordinates_.insert(known->second);
        }
        if (!made.normals.empty()) {
            has_normals_.insert(known->second);
        }
    } catch (const InputError& error) {
        draft_.problems().add(0, fmt::format("{}: {}", pointer, error.what()));
    }
    return known->second;
}

void GltfImporter::add_mesh(int index, const Affine& map, const Cis565Line* at) {
    if (static_cast<std::size_t>(index) >= model_->meshes.size()) {
        draft_.refuse(*at, fmt::format("a mesh from 0 to {}", static_cast<int>(model_->meshes.size()) - 1));
        return;
    }
    const tinygltf::Mesh& mesh = model_->meshes[static_cast<std::size_t>(index)];
    for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
        const std::string& file = file_of(index, i, fmt::format("/meshes/{}/primitives/{}", index, i));
        const std::optional<std::size_t> material = materials_.material_of(mesh.primitives[i].material);
        if (!file.empty() && material && draft_.shows_image(*material) && !has_coordinates_.contains(file)) {
            refuse(fmt::format("/meshes/{}/primitives/{}/attributes", index, i), "no TEXCOORD_0 that can be read",
                   fmt::format("one for each vertex, since {} is an image", draft_.material_name_of(*material)));
        } else if (!file.empty() && material) {
            (void)draft_.add_mesh(file, map, *material, at, has_normals_.contains(file));
        }
    }
}

void GltfImporter::add_view(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up, double degrees, double aspect,
                            const Cis565Line* at) {
    ScenePart& camera = draft_.parts.camera;
    draft_.add_view(eye, look_at, up, at);
    camera.add("vertical_fov_degrees", json_of(degrees), at, "60");
    const double width = std::clamp(std::round(gltf_picture_height * aspect), 1.0, 65536.0);
    camera.add("resolution", fmt::format("[{}, {}]", width, gltf_picture_height), at, "[1, 1]");
    draft_.notes().add(0, fmt::format("{} gets a picture of {} x {} pixels: glTF has no number of them", at->text(),
                                      width, gltf_picture_height));
}

// Adds a glTF node's camera, which looks along -z of the node with y up. Scales of the node do not apply to a camera.
void GltfImporter::add_camera(int index, const Affine& map, const std::string& node) {
    const std::string pointer = fmt::format("/cameras/{}", index);
    if (static_cast<std::size_t>(index) >= model_->cameras.size()) {
        refuse(node + "/camera", fmt::format("{}", index),
               fmt::format("0 to {}", static_cast<int>(model_->cameras.size()) - 1));
        return;
    }
    if (has_camera_) {
        warn(node, fmt::format("with camera {} is left out: a scene has one camera, the first", index));
        return;
    }
    has_camera_ = true;
    const tinygltf::Camera& camera = model_->cameras[static_cast<std::size_t>(index)];
    if (camera.type != "perspective") {
        refuse(pointer + "/type", camera.type, "perspective");
        return;
    }
    if (!(determinant(map) > 0)) {
        refuse(node, "a camera that is mirrored or flat", "one that is neither");
        return;
    }
    const auto unit = [](const Vec3d& v) { return v * (1 / std::sqrt(dot(v, v))); };
    // Rounds away noise from a field of view that the file has in single precision, in radians.
    const double degrees = shortest_within(camera.perspective.yfov * (180 / pi<double>), 1e-12);
    const double aspect = camera.perspective.aspectRatio > 0 ? camera.perspective.aspectRatio : gltf_aspect;
    add_view(map.origin, map.origin - unit(map.column[2]), unit(map.column[1]), degrees, aspect,
             draft_.place(0, pointer));
}

void GltfImporter::add_node(int index, const glm::dmat4& parent, int depth) {
    constexpr int deepest = 64, most_visits = 100000;
    const std::string pointer = fmt::format("/nodes/{}", index);
    if (index < 0 || static_cast<std::size_t>(index) >= model_->nodes.size()) {
        refuse("/nodes", fmt::format("number {}", index),
               fmt::format("0 to {}", static_cast<int>(model_->nodes.size()) - 1));
        return;
    }
    if (depth > deepest || ++visits_ > most_visits) {
        if (visits_ <= most_visits + 1) {  // only the first glTF node beyond the limits is reported
            refuse(pointer, "nodes within nodes without end", "at most 64 levels and 10^5 nodes");
            visits_ = most_visits + 1;
        }
        return;
    }
    const tinygltf::Node& node = model_->nodes[static_cast<std::size_t>(index)];
    if (GltfMeshMaker::is_hidden(node)) {
        draft_.notes().add(0, pointer + " has the scale 0, which hides it and what hangs on it: left out");
        return;
    }
    const glm::dmat4 matrix = parent * matrix_of_node(node);
    refuse_of_node(node, pointer);
    if (node.mesh >= 0) {
        add_mesh(node.mesh, affine_of(matrix), draft_.place(0, pointer));
    }
    if (node.camera >= 0) {
        add_camera(node.camera, affine_of(matrix), pointer);
    }
    for (const int child : node.children) {
        add_node(child, matrix, depth + 1);
    }
}

// Adds a camera in front of all objects that looks along -z from where their bounding sphere fits into the view.
void GltfImporter::make_camera(const Scene& scene) {
    Vec3d low(0.0), high(0.0);
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const SceneObject& object = scene.objects[i];
        const Box box = box_round(*scene.meshes[object.mesh], placement_of(object, Vec3d(0.0)));
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = i == 0 ? box.low[axis] : std::min(low[axis], double{box.low[axis]});
            high[axis] = i == 0 ? box.high[axis] : std::max(high[axis], double{box.high[axis]});
        }
    }
    const Vec3d middle = (low + high) * 0.5, half = (high - low) * 0.5;
    const double radius = std::max(std::sqrt(dot(half, half)), 1e-9);
    const double distance = radius / std::sin(gltf_view_degrees * (pi<double> / 360));
    warn("/cameras", fmt::format("has none that a node shows: one is put {:.6g} before the middle of all", distance));
    draft_.parts.camera.members.clear();
    add_view(middle + Vec3d(0, 0, distance), middle, {0, 1, 0}, gltf_view_degrees, gltf_aspect,
             draft_.place(0, "/cameras"));
}

void GltfImporter::light_what_nobody_lights() {
    const bool is_lit =
        std::any_of(draft_.parts.materials.begin(), draft_.parts.materials.end(), [](const ScenePart& material) {
            return std::any_of(material.members.begin(), material.members.end(), [](const SceneMember& member) {
                return member.key == "emission" || member.key == "radiance";
            });
        });
    if (!is_lit) {
        warn("/materials", "has none that emits: the environment is [1, 1, 1]");
        draft_.parts.root.add("environment", "[1, 1, 1]", nullptr);
    }
}

void GltfImporter::import() {
    const Cis565Line* head = draft_.place(0, "the file");
    draft_.begin(std::filesystem::path(draft_.source().file).stem().string(), head);
    draft_.parts.root.add("max_depth", fmt::format("{}", gltf_max_depth), nullptr);
    draft_.notes().add(0, fmt::format("max_depth is {}: glTF has none", gltf_max_depth));
    refuse_extensions();
    for (const int node : maker_.roots()) {
        add_node(node, glm::dmat4(1.0), 0);
    }
    if (draft_.parts.objects.empty() && draft_.problems().count() == 0) {
        refuse("/nodes", "none that shows a mesh", "at least one");
    }
    light_what_nobody_lights();
    if (!has_camera_) {
        draft_.parts.camera.members = {};
        draft_.parts.camera.add("eye", "[0, 0, 1]", nullptr);
        draft_.parts.camera.add("look_at", "[0, 0, 0]", nullptr);
        draft_.parts.camera.add("up", "[0, 1, 0]", nullptr);
        draft_.parts.camera.add("vertical_fov_degrees", "45", nullptr);
        draft_.parts.camera.add("resolution", "[1, 1]", nullptr);
    }
    const std::optional<Scene> scene = draft_.checked();
    if (scene && !has_camera_) {
        make_camera(*scene);
        (void)draft_.checked();
    }
    draft_.finish();
}

// Reads a data file that a glTF model names by a path relative to the model. Images are never read this way.
std::string read_beside(const ImportSource& source, const std::string& name) {
    return read_file((std::filesystem::path(source.file).parent_path() / name).string(), largest_gltf);
}

}  // namespace

ImportResult import_gltf(const ImportSource& source) {
    ImportResult result(source);
    try {
        const tinygltf::Model model = parse_gltf_model(
            source.text, source.file, [&](const std::string& name) { return read_beside(source, name); });
        GltfImporter(model, source, result).import();
    } catch (const InputError& error) {
        result.problems.add(0, error.what());
        result.json.clear();
    }
    return result;
}

#else

namespace pt {

ImportResult import_gltf(const ImportSource&) {
    ImportResult result;
    result.problems.add(0, "this build has no reader for glTF: install libtinygltf-dev and build again");
    return result;
}

#endif

bool is_like_gltf(const std::string& text) {
    return text.starts_with("glTF");  // glTF in JSON form is recognised by its file extension only
}

}  // namespace pt
