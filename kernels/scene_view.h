// A scene as flat arrays, ready for a kernel on either side. Objects are numbered by kind, in the order of the arrays
// below, and canonically within a kind: an object's number does not depend on its place in the scene file.
#pragma once

#include "kernels/axis_aligned_enclosure.h"
#include "kernels/camera.h"
#include "kernels/material_list.h"
#include "kernels/object_tree.h"
#include "kernels/shapes.h"
#include "kernels/transform.h"

namespace pt {

template <class Real>
struct Material;  // kernels/materials.h

// What most hits need of an object's material, in one 16-byte read.
template <class Real>
struct alignas(4 * sizeof(Real)) Surface {
    Vec3<Real> colour;  // albedo of a diffuse, reflectance of a mirror, radiance of an emitter material
    MaterialType type;
};

// An object that emits, with what sampling points on it needs.
struct Light {
    std::uint32_t object;
};

// A light in the alias table of all of them, and its way through their tree (kernels/light_selection.h).
template <class Real>
struct LightSlot {
    std::uint32_t threshold;   // of 2^32: how much of the slot is its own light's; the rest is the alias's
    std::uint32_t alias;       // a light
    Real inverse_probability;  // by power
    std::uint32_t way;         // from the root down: bits 4i to 4i + 3 say which child at level i
};

// A node of the tree over lights: the box round its lights, over the whole shutter, and how much of what all lights
// radiate they show along each axis: projected area times radiance.
template <class Real>
struct alignas(16) LightNode {
    Vec3<Real> centre;
    std::uint32_t link;  // the first of its children, side by side, or leaf_bit and a light
    Vec3<Real> half;     // half extents
    std::uint32_t child_count;
    Vec3<Real> shown;
    Real least_square;  // that a distance to the box counts as: of half its diagonal, and at least 2^-100

    static constexpr std::uint32_t leaf_bit = 0x80000000u;
    // Bounds on the light tree, from which the way to a light fits 32 bits.
    static constexpr std::uint32_t most_children = 16;
    static constexpr std::uint32_t most_levels = 8;
    PT_HD bool is_leaf() const { return (link & leaf_bit) != 0; }
    PT_HD std::uint32_t light() const { return link & ~leaf_bit; }
};

// The block of texels that an image fills. Texels are single precision in kernels of both precisions, rows from the
// bottom up.
struct TexelBlock {
    std::uint32_t width;  // in texels; 0: there is no image
    std::uint32_t height;
    std::uint32_t first_texel;  // in SceneView::texels
};

// The images that an object shows, and how points of the object map to their coordinates.
template <class Real>
struct ObjectTexture {
    Transform<Real> place;
    TexelBlock colour;
    TexelBlock roughness;            // the same number in all three channels
    std::uint32_t first_coordinate;  // of a mesh: of its first triangle, in SceneView::texture_coordinates
};

// The normals that an object is shaded with.
template <class Real>
struct ObjectNormals {
    static constexpr std::uint32_t none = 0xffffffffu;
    // The matrix that takes normals from a mesh's own space to the scene, but for a factor that all normals share.
    Vec3<Real> row[3];
    std::uint32_t first_normal;  // of its first triangle, in ShadingNormals::corners; none: the triangles' own
    TexelBlock map;              // in the tangent space of the texture's coordinates
    Real map_scale;              // of its first two components
};

template <class Real>
struct ShadingNormals {
    View<ObjectNormals<Real>> objects;  // by object number; empty: all surfaces are shaded with their own
    View<CornerNormals> corners;
};

template <class Real>
struct Ray;

// Keeps the nearer of a hit and the triangles of a mesh: object, the ray's origin as the object sees it, the ray, and a
// distance: what is met before it ends the search, as NearerThan has it (kernels/intersect.h). 0: nothing does.
template <class Real>
using MeetMesh = void (*)(Hit<Real>&, const MeshInstance<Real>&, std::uint32_t, const Vec3<Real>&, const Ray<Real>&,
                          Real);
// Keeps the nearer of a hit and the triangles of all objects that show meshes: the scene, the ray, and a distance below
// which a hit ends the search (0: none does).
template <class Real>
struct SceneView;
template <class Real>
using MeetMeshes = void (*)(Hit<Real>&, const SceneView<Real>&, const Ray<Real>&, Real);

// An environment from which directions are drawn as from lights.
template <class Real>
struct EnvironmentMap;
// The estimates of what paths bring, for adjoint-driven roulette and splitting (kernels/adjoint.h).
template <class Real>
struct AdjointCache;

// One tree over all triangles of all objects that show meshes, in the scene's space; slots name them.
struct FlatSlot {
    std::uint32_t mesh;  // number of the object among those that show meshes
    std::uint32_t primitive;
};
struct FlatTree {
    TreeView tree;  // in the accelerator's format
    const FlatSlot* slots = nullptr;
};

// The functions and trees by which rays find the objects that show meshes.
template <class Real>
struct MeshSearch {
    // Functions of the host's accelerator: for one mesh, and for all by its tree over objects or triangles (null: each
    // object in turn). A device's kernels have theirs compiled in.
    MeetMesh<Real> meet_mesh = nullptr;
    MeetMeshes<Real> meet_meshes = nullptr;
    ObjectTree objects;
    FlatTree flat;
    // The normals for kernels with Feature::shading_normals. They are kept here, because kernels copy a SceneView:
    // others would have more in memory.
    ShadingNormals<Real> normals;
};

template <class Real>
struct SceneView {
#define PT_VIEW(name, array, Type) View<Type<Real>> array;
    PT_SHAPES(PT_VIEW)
#undef PT_VIEW
    View<Transform<Real>> transforms;     // by object number; only for kernels with Feature::matrix
    View<std::uint32_t> object_material;  // by object number
    View<Surface<Real>> surfaces;         // by object number
    View<Vec3<Real>> velocity;            // by object number, scene units a second
    View<Material<Real>> materials;
    View<Light> lights;
    View<std::uint32_t> object_light;   // by object number: of a light its number; these three for light_selections
    View<LightSlot<Real>> light_slots;  // by light
    View<LightNode<Real>> light_nodes;  // the root first
    View<ObjectTexture<Real>> object_textures;  // by object number; empty: the scene has no images on objects
    View<Vec3<float>> texels;
    View<CornerCoordinates> texture_coordinates;
    Vec3<Real> environment;  // radiance of rays that leave the scene
    Camera<Real> camera;
    AxisAlignedEnclosure<Real> enclosure;  // that the axis boxes make
    RandomSeed seed;
    std::uint32_t depth;           // ray segments in a path, at least 1
    std::uint32_t final_bounce;    // 1: connect the last vertex to a light
    std::uint32_t next_event;      // 1: connect every diffuse vertex but the last to a light
    std::uint32_t mis_exponent;    // 0: lights count where connected only; 1: balance heuristic, 2: power heuristic
    std::uint32_t roulette_start;  // Russian roulette from the vertex at the end of this segment on; 0: none
    LightSampling light_sampling;  // of boxes and quads that emit
    std::uint16_t near_light;      // automatic: in the near form within so many hundredths of a light's half diagonal
    LightSelection light_selection;
    std::uint32_t one_sample;  // 1: of a connection and light that is met, one at random, with mis_exponent

    // The search through meshes; on a device null unless the kernels have one of mesh_levels, or shading_normals.
    const MeshSearch<Real>* mesh_search;
    // The environment that is drawn as a light, and the estimates for adjoint-driven roulette; null: there is none.
    const EnvironmentMap<Real>* environment_map;
    const AdjointCache<Real>* adjoint;

    PT_HD std::uint32_t pixel_count() const { return camera.width * camera.height; }
    // Segments that the longest path can have: with a final bounce, a path whose last vertex is specular goes one
    // further.
    PT_HD std::uint32_t longest_path() const { return depth + final_bounce; }
};

// The number of the first object of a kind, and that past the last: of a SceneView, or what has members of the same
// names.
template <ShapeKind kind, class Scene>
PT_HD constexpr std::uint32_t first_of(const Scene& scene) {
    std::uint32_t first = 0;
#define PT_ADD(name, array, Type)           \
    if constexpr (ShapeKind::name < kind) { \
        first += scene.array.size;          \
    }
    PT_SHAPES(PT_ADD)
#undef PT_ADD
    return first;
}
template <ShapeKind kind, class Scene>
PT_HD constexpr std::uint32_t end_of(const Scene& scene) {
    return first_of<static_cast<ShapeKind>(static_cast<std::uint32_t>(kind) + 1)>(scene);
}
template <class Scene>
PT_HD constexpr std::uint32_t object_count(const Scene& scene) {
    return first_of<static_cast<ShapeKind>(shape_count)>(scene);
}

}  // namespace pt
