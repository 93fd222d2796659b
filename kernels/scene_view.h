// A scene as flat arrays, ready for a kernel on host or device. Objects are numbered by kind, in the order of
// SceneView's arrays, and canonically within a kind: an object's number does not depend on its place in the scene file.
#pragma once

#include "kernels/axis_aligned_enclosure.h"
#include "kernels/camera.h"
#include "kernels/material_list.h"
#include "kernels/object_tree.h"
#include "kernels/shapes.h"
#include "kernels/transform.h"

namespace pt {

template <class Real>
struct Material;  // the class of materials, defined in kernels/materials.h

// What most hits need of an object's material, in one 16-byte read.
template <class Real>
struct alignas(4 * sizeof(Real)) Surface {
    Vec3<Real> colour;  // albedo of a diffuse, reflectance of a mirror, radiance of an emitter material
    MaterialType type;
};

// A light for next-event estimation: the index of an object that emits.
struct Light {
    std::uint32_t object;
};

// A light's places: its slot in the alias table of all lights, its way in the light tree (kernels/light_selection.h).
template <class Real>
struct LightSlot {
    std::uint32_t threshold;   // share, in 2^-32, of the alias-table slot that is the light's own; the rest: `alias`
    std::uint32_t alias;       // light that has the rest of the alias-table slot
    Real inverse_probability;  // 1 / probability of drawing the light by power
    std::uint32_t way;         // way down the light tree: bits 4i to 4i + 3 are the child at level i
};

// A node of the light tree: the bounding box of its lights over the whole shutter, and in `shown` how much of what all
// lights radiate they show along each axis: projected area times radiance.
template <class Real>
struct alignas(16) LightNode {
    Vec3<Real> centre;
    std::uint32_t link;  // index of the node's first child (children are adjacent), or leaf_bit and a light
    Vec3<Real> half;     // half extents of the node's bounding box
    std::uint32_t child_count;
    Vec3<Real> shown;
    Real least_square;  // minimum of squared distances to the centre: half the box's diagonal squared, at least 2^-100

    static constexpr std::uint32_t leaf_bit = 0x80000000u;
    // Limits of the light tree, with which the way to a light fits 32 bits.
    static constexpr std::uint32_t most_children = 16;
    static constexpr std::uint32_t most_levels = 8;
    PT_HD bool is_leaf() const { return (link & leaf_bit) != 0; }
    PT_HD std::uint32_t light() const { return link & ~leaf_bit; }
};

// Size and place of an image's texels, which are single precision in kernels of both precisions; rows from the bottom
// up.
struct TexelBlock {
    std::uint32_t width;  // image width in texels; 0: there is no image
    std::uint32_t height;
    std::uint32_t first_texel;  // index of the first texel in SceneView::texels
};

// The images that an object shows, and how the object's points map to texture coordinates.
template <class Real>
struct ObjectTexture {
    Transform<Real> place;
    TexelBlock colour;
    TexelBlock roughness;            // roughness image, the same number in all three channels
    std::uint32_t first_coordinate;  // index of a mesh's first triangle in SceneView::texture_coordinates
};

// Shading normals of one object.
template <class Real>
struct ObjectNormals {
    static constexpr std::uint32_t none = 0xffffffffu;
    // The matrix that takes normals from a mesh's own space to the scene, but for a factor that all normals share.
    Vec3<Real> row[3];
    std::uint32_t first_normal;  // index of a mesh's first triangle in ShadingNormals::corners, or none
    TexelBlock map;              // normal map in the tangent space of the texture coordinates, if any
    Real map_scale;              // factor on the normal map's first two components
};

template <class Real>
struct ShadingNormals {
    View<ObjectNormals<Real>> objects;  // shading normals by object index; empty: none differ from geometric normals
    View<CornerNormals> corners;
};

template <class Real>
struct Ray;

// Function that updates the closest hit by a mesh's triangles. Parameters: hit, mesh, object index, ray origin in the
// object's frame, ray, distance below which a hit ends the search (NearerThan, kernels/intersect.h; 0: none does).
template <class Real>
using MeetMesh = void (*)(Hit<Real>&, const MeshInstance<Real>&, std::uint32_t, const Vec3<Real>&, const Ray<Real>&,
                          Real);
// Function that updates the closest hit by all mesh instances. Parameters: hit, scene, ray, and the distance below
// which a hit ends the search (0: none does).
template <class Real>
struct SceneView;
template <class Real>
using MeetMeshes = void (*)(Hit<Real>&, const SceneView<Real>&, const Ray<Real>&, Real);

// An environment that is sampled as lights are.
template <class Real>
struct EnvironmentMap;
// Estimates of paths' contributions for adjoint-driven roulette and splitting (kernels/adjoint.h).
template <class Real>
struct AdjointCache;

// One tree over the triangles of all mesh instances, in scene space; its slots name the triangles.
struct FlatSlot {
    std::uint32_t mesh;  // index of the triangle's mesh instance
    std::uint32_t primitive;
};
struct FlatTree {
    TreeView tree;  // tree over triangles in the accelerator's format
    const FlatSlot* slots = nullptr;
};

// Functions and trees with which rays search mesh instances.
template <class Real>
struct MeshSearch {
    // Functions of the host's accelerator: meet_mesh for one mesh; meet_meshes for all, by a tree over instances or
    // triangles (null: one instance after the other). Device kernels have theirs compiled in.
    MeetMesh<Real> meet_mesh = nullptr;
    MeetMeshes<Real> meet_meshes = nullptr;
    ObjectTree objects;
    FlatTree flat;
    // Shading normals for kernels with Feature::shading_normals. MeshSearch holds them, not SceneView, of which kernels
    // have a copy: kernels without the feature would have more in memory.
    ShadingNormals<Real> normals;
};

template <class Real>
struct SceneView {
#define PT_VIEW(name, array, Type) View<Type<Real>> array;
    PT_SHAPES(PT_VIEW)
#undef PT_VIEW
    View<Transform<Real>> transforms;     // matrices by object index; only for kernels with Feature::matrix
    View<std::uint32_t> object_material;  // material index by object index
    View<Surface<Real>> surfaces;         // what shading reads of each object's surface (Surface), by object index
    View<Vec3<Real>> velocity;            // velocities by object index, scene units a second
    View<Material<Real>> materials;
    View<Light> lights;
    View<std::uint32_t> object_light;           // light index by object index, for kernels with light_selections
    View<LightSlot<Real>> light_slots;          // alias table by light index
    View<LightNode<Real>> light_nodes;          // nodes of the light tree, root first
    View<ObjectTexture<Real>> object_textures;  // textures by object index; empty: there are none
    View<Vec3<float>> texels;
    View<CornerCoordinates> texture_coordinates;
    Vec3<Real> environment;  // radiance of rays that leave the scene
    Camera<Real> camera;
    AxisAlignedEnclosure<Real> enclosure;  // the enclosure whose walls are axis boxes
    RandomSeed seed;
    std::uint32_t depth;           // most ray segments in a path, at least 1
    std::uint32_t final_bounce;    // 1: connect a path's last vertex to a light (final bounce)
    std::uint32_t next_event;      // 1: connect every diffuse vertex of a path but the last to a light
    std::uint32_t mis_exponent;    // MIS weights: 0 none (connections only), 1 balance heuristic, 2 power heuristic
    std::uint32_t roulette_start;  // first segment after which Russian roulette is played; 0: never
    LightSampling light_sampling;  // how points on boxes and quads that emit are sampled
    std::uint16_t near_light;      // automatic light sampling: near limit, in hundredths of a light's half diagonal
    LightSelection light_selection;
    std::uint32_t one_sample;  // 1: one-sample MIS: either a connection counts or a light that is hit

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

// Index of the first object of a kind of shape, and index past the last, in a SceneView or in a class with members of
// the same names.
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
