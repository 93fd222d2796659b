// A scene as the flat arrays that kernels read, in one precision. Positions are relative to the camera's eye
// (subtracted in double). Objects are sorted by kind and then by their parameters, so that the order in the file has no
// effect.
#pragma once

#include <optional>

#include "harness/scene/environment_table.h"
#include "harness/scene/light_tables.h"
#include "harness/scene/mesh_search.h"
#include "harness/scene/scene.h"
#include "kernels/materials.h"
#include "kernels/scene_view.h"

namespace pt {

// Settings of adjoint-driven Russian roulette and splitting (harness/render/adjoint_table.h).
struct AdjointSettings {
    std::uint32_t paths = 0;     // number of paths that the adjoint estimate is learnt from; 0: no estimate
    std::uint32_t cells = 8;     // cells of the adjoint estimate's grid along each axis
    std::uint32_t window = 5;    // ratio of the weight window's upper to lower bound
    std::uint32_t branches = 1;  // most branches into which a path splits at a vertex; 1: no splitting
};

// Render settings of a run: some can override the scene file, the others follow from the variant.
struct RenderSettings {
    std::uint32_t width = 0, height = 0;
    std::uint32_t depth = 0;
    std::uint64_t seed = 0;
    // Render settings that follow from the variant (settings_for).
    bool final_bounce = false;
    bool next_event = false;
    std::uint32_t mis_exponent = 0;
    LightSampling light_sampling = LightSampling::solid_angle;
    std::uint16_t near_light = 0;
    LightSelection light_selection = LightSelection::uniform;
    bool one_sample = false;
    std::uint32_t roulette_start = 0;
    double guided_share = 0;  // share of guided steps among all steps of subsurface walks
    AdjointSettings adjoint = {};
    FeatureSet sampler = no_features;
};

RenderSettings default_settings(const Scene& scene);

// Owns the arrays that a SceneView points to.
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
    // Converts a scene to arrays for kernels. `acceleration` chooses the trees over its meshes.
    SceneBuffers(const Scene& scene, const RenderSettings& settings,
                 const Acceleration& acceleration = Acceleration::none());
    // The scene as kernels see it. Valid as long as this SceneBuffers lives and is not moved.
    const SceneView<Real>& view() const { return view_; }
    // Sets the adjoint estimates that the scene view shows to kernels for roulette and splitting; null: no estimates.
    void set_adjoint(const AdjointCache<Real>* adjoint) { view_.adjoint = adjoint; }
    SceneBuffers(const SceneBuffers&) = delete;
    SceneBuffers& operator=(const SceneBuffers&) = delete;

    // Geometry of the mesh of each object that shows one, in the order of object numbers.
    const std::vector<MeshGeometry>& meshes() const { return meshes_; }
    // The tree over all meshes together (axis `levels`), or null.
    const std::shared_ptr<const SceneTree>& tree() const { return tree_; }
    // Maps an object's number in kernels to its index in Scene::objects.
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
    std::vector<std::uint32_t> shown_by_;  // number of objects that show each mesh
    std::vector<MeshGeometry> meshes_;
    std::vector<LightExtent> light_extents_;  // bounding box and power of each light in arrays_.lights
    std::shared_ptr<const SceneTree> tree_;
    std::vector<ObjectNormals<Real>> object_normals_;
    std::vector<CornerNormals> corner_normals_;
    MeshSearch<Real> search_;
    std::unique_ptr<const EnvironmentTable<Real>> environment_;
    SceneView<Real> view_;
};

// Feature flags of the shortcuts that a kernel may take in this scene.
FeatureSet shortcuts_of(const Scene& scene);

// Upper bound on the radiance of one sample from emitters that its path hits: the brightest source times the number of
// times that a path may hit one. Connections to lights may exceed it.
double radiance_bound(const Scene& scene, std::uint32_t depth);
// Upper bound on the radiance of one sample with these settings; samples beyond it are counted. Next-event estimation
// gets 1024 times the room, since its weights grow as a light is sampled more rarely, without bound where lights are
// sampled by area. With adjoint-driven roulette the throughput can grow up to `most_carried`.
double radiance_bound(const Scene& scene, const RenderSettings& settings);

extern template class SceneBuffers<float>;
extern template class SceneBuffers<double>;

}  // namespace pt
