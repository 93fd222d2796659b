// A scene turned into the flat arrays of one precision that kernels read. Positions are relative to the camera's eye
// (subtracted in double), and objects are in canonical order: by kind, then by their numbers, so that their order in
// the file cannot matter.
#pragma once

#include <optional>

#include "harness/scene/environment_table.h"
#include "harness/scene/light_tables.h"
#include "harness/scene/mesh_search.h"
#include "harness/scene/scene.h"
#include "kernels/materials.h"
#include "kernels/scene_view.h"

namespace pt {

// Settings of adjoint-driven roulette and splitting (harness/render/adjoint_table.h).
struct AdjointSettings {
    std::uint32_t paths = 0;     // that are traced to learn it; 0: there is none
    std::uint32_t cells = 8;     // of the grid, along each axis
    std::uint32_t window = 5;    // the upper bound of the weight window over the lower
    std::uint32_t branches = 1;  // of a path at a vertex, at most; 1: no splitting
};

// What a run may set differently from the scene's file.
struct RenderSettings {
    std::uint32_t width = 0, height = 0;
    std::uint32_t depth = 0;
    std::uint64_t seed = 0;
    // Settings that follow from the variant (settings_for).
    bool final_bounce = false;
    bool next_event = false;
    std::uint32_t mis_exponent = 0;
    LightSampling light_sampling = LightSampling::solid_angle;
    std::uint16_t near_light = 0;
    LightSelection light_selection = LightSelection::uniform;
    bool one_sample = false;
    std::uint32_t roulette_start = 0;
    double guided_share = 0;  // of the steps of walks in bodies
    AdjointSettings adjoint = {};
    FeatureSet sampler = no_features;
};

RenderSettings default_settings(const Scene& scene);

// What the arrays of a SceneView lie in.
template <class Real>
struct SceneStorage {
#define PT_VECTOR(name, array, Type) std::vector<Type<Real>> array;
    PT_SHAPES(PT_VECTOR)
#undef PT_VECTOR
    std::vector<Transform<Real>> transforms;
    std::vector<std::uint32_t> object_material;
    std::vector<Vec3<Real>> velocity;
    std::vector<Material<Real>> materials;
    std::vector<Surface<Real>> surfaces;
    std::vector<Light> lights;
    std::vector<std::uint32_t> object_light;
    std::vector<LightSlot<Real>> light_slots;
    std::vector<LightNode<Real>> light_nodes;
    std::vector<ObjectTexture<Real>> object_textures;
    std::vector<Vec3<float>> texels;
    std::vector<CornerCoordinates> texture_coordinates;
};

template <class Real>
class SceneBuffers {
public:
    // Makes the arrays of a scene. `acceleration`: the trees over its meshes.
    SceneBuffers(const Scene& scene, const RenderSettings& settings,
                 const Acceleration& acceleration = Acceleration::none());
    // Valid as long as this object lives and stays where it is.
    const SceneView<Real>& view() const { return view_; }
    // Sets the estimates for adjoint-driven roulette that the view shows from here on; null: none.
    void set_adjoint(const AdjointCache<Real>* adjoint) { view_.adjoint = adjoint; }
    SceneBuffers(const SceneBuffers&) = delete;
    SceneBuffers& operator=(const SceneBuffers&) = delete;

    // The geometry of meshes, by number of the objects that show one.
    const std::vector<MeshGeometry>& meshes() const { return meshes_; }
    // The tree over all meshes together, or null.
    const std::shared_ptr<const SceneTree>& tree() const { return tree_; }
    // The index in the scene file of each object, by the object's number.
    const std::vector<std::uint32_t>& file_index() const { return file_index_; }

private:
    void add_object(const Scene& scene, std::uint32_t index, const Acceleration& acceleration);
    void complete(MeshInstance<Real>& instance, const Scene& scene, const SceneObject& object,
                  const Placement& placement, const Acceleration& acceleration);
    void make_light_tables();
    void make_textures(const Scene& scene);
    void make_normals(const Scene& scene);
    void make_search(const Acceleration& acceleration);

    SceneStorage<Real> arrays_;
    std::vector<std::uint32_t> file_index_;
    std::vector<std::uint32_t> shown_by_;  // by mesh of the scene: how many objects
    std::vector<MeshGeometry> meshes_;
    std::vector<LightExtent> light_extents_;  // of arrays_.lights
    std::shared_ptr<const SceneTree> tree_;
    std::vector<ObjectNormals<Real>> object_normals_;
    std::vector<CornerNormals> corner_normals_;
    MeshSearch<Real> search_;
    std::unique_ptr<const EnvironmentTable<Real>> environment_;
    SceneView<Real> view_;
};

// The shortcuts that a kernel may take in this scene.
FeatureSet shortcuts_of(const Scene& scene);

// A bound on the radiance that one sample can carry by meeting light (connections to lights may exceed it): the
// brightest source, times the number of times that a path may meet one.
double radiance_bound(const Scene& scene, std::uint32_t depth);
// The bound on radiance for what is rendered with these settings. Connections weigh more than light that is met, the
// rarer the more (without bound where lights are sampled by area), so they have 1024 times the room; what goes beyond
// it is counted. By adjoint-driven roulette a path comes to carry up to most_carried.
double radiance_bound(const Scene& scene, const RenderSettings& settings);

extern template class SceneBuffers<float>;
extern template class SceneBuffers<double>;

}  // namespace pt
