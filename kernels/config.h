// What a path kernel is compiled for: the number type and the set of features that it contains.
// Everything in kernels/ is a template on a Config, so a feature that the set lacks leaves no instruction behind.
// The idea of a feature mask that is a template argument is Cycles' (kernel/features.h).
#pragma once

#include "kernels/material_list.h"
#include "kernels/sampler_list.h"
#include "kernels/shape_list.h"

#include <cstdint>

// PT_HD marks functions that host and device share: under g++ it is empty; under nvcc and NVRTC it compiles for both.
#if defined(__CUDACC__)
#define PT_HD __host__ __device__
#else
#define PT_HD
#endif

// PT_ROLLED marks a loop that a device must not unroll, however short: a long kernel stalls on instruction fetch.
#if defined(__CUDA_ARCH__)
#define PT_ROLLED _Pragma("unroll 1")
#else
#define PT_ROLLED
#endif

namespace pt {

using FeatureSet = std::uint64_t;

// First bit of each group of features in a FeatureSet. The bits of a group are contiguous, with spare ones for more.
namespace feature_bit {
inline constexpr FeatureSet camera = FeatureSet{1} << 0;      // first of 2 feature bits for the camera
inline constexpr FeatureSet shape = FeatureSet{1} << 2;       // first of 16 feature bits for shapes
inline constexpr FeatureSet material = FeatureSet{1} << 18;   // first of 17 feature bits for materials
inline constexpr FeatureSet light = FeatureSet{1} << 35;      // first of 11 feature bits for lights
inline constexpr FeatureSet sampling = FeatureSet{1} << 46;   // first of 12 feature bits for sampling
inline constexpr FeatureSet traversal = FeatureSet{1} << 58;  // first of 6 feature bits for traversal
}  // namespace feature_bit

enum class Feature : FeatureSet {
    jitter = feature_bit::camera << 0,
    lens = feature_bit::camera << 1,
// One feature per kind of shape. Objects are classified once, at load, and kernels use one formula per kind.
#define PT_FEATURE(name, array, Type) name = feature_bit::shape << static_cast<std::uint32_t>(ShapeKind::name),
    PT_SHAPES(PT_FEATURE)
#undef PT_FEATURE
    // Spheres that are close to the eye for their size, as a ground sphere is (NearSphere in kernels/shapes/sphere.h).
    near_sphere = feature_bit::shape << 13,
    motion = feature_bit::shape << 14,
    // Every object is intersected through its 4x4 matrix (kernels/transform.h), by formulas that round otherwise and so
    // change the film.
    matrix = feature_bit::shape << 15,
// One feature for each material type.
#define PT_FEATURE(name, Type, traits) name = feature_bit::material << static_cast<std::uint32_t>(MaterialType::name),
    PT_MATERIALS(PT_FEATURE)
#undef PT_FEATURE
    // Features of materials that do not follow from a material's type.
    emission = feature_bit::material << 11,             // surfaces that both reflect and emit light
    absorption = feature_bit::material << 12,           // Beer-Lambert absorption inside a dielectric, smooth or rough
    subsurface_boundary = feature_bit::material << 13,  // subsurface bodies with an index of refraction other than 1
    multiple_scattering = feature_bit::material << 14,  // rough conductors with compensation for energy that is lost
    textures = feature_bit::material << 15,             // colours and roughnesses that are images (kernels/texture.h)
    shading_normals = feature_bit::material << 16,      // normals other than geometric ones (kernels/shading_normal.h)
    environment = feature_bit::light << 0,
    // Features that the variant asks for rather than the scene.
    final_bounce = feature_bit::light << 1,
    next_event = feature_bit::light << 2,
    multiple_importance = feature_bit::light << 3,
    // How points on a light are sampled (kernels/light_sampling.h). A kernel with none of these features samples by
    // solid angle, with one of them in that way, with all as chosen at run time (SceneView::light_sampling).
    area_sampling = feature_bit::light << 4,
    projected_sampling = feature_bit::light << 5,
    automatic_sampling = feature_bit::light << 6,
    // How next-event estimation chooses a light (kernels/light_selection.h): a kernel with neither feature uniformly,
    // with one of them in that way, with both as chosen at run time (SceneView::light_selection).
    power_selection = feature_bit::light << 7,
    tree_selection = feature_bit::light << 8,
    // One-sample MIS: at random either the connection to a light counts or the light that the path hits
    // (SceneView::one_sample).
    one_sample = feature_bit::light << 9,
    // An environment that is sampled as lights are (kernels/environment_map.h): an image, or one constant radiance.
    environment_map = feature_bit::light << 10,
    russian_roulette = feature_bit::sampling << 0,
// Samplers other than pcg4d. A kernel with none of these features has pcg4d, a kernel with a single one has that
// one, and a kernel with several chooses at run time among all (RandomSeed::sampler).
#define PT_FEATURE(name) name = feature_bit::sampling << (4u + static_cast<std::uint32_t>(SamplerKind::name)),
    PT_SAMPLERS(PT_FEATURE)
#undef PT_FEATURE
    // Subsurface random walks guided towards the surface (kernels/guided_walk.h), for materials that ask for them.
    guided_walk = feature_bit::sampling << 1,
    // Russian roulette, and splitting, by a path's expected contribution (kernels/adjoint.h, kernels/path_tree.h).
    adjoint_roulette = feature_bit::sampling << 2,
    splitting = feature_bit::sampling << 3,
    // Features that only make a kernel faster: no scene needs them, and they do not change the film.
    enclosure = feature_bit::traversal << 0,
    // Features for other formulas, which round differently: intersection in double precision within single precision
    // (kernels/widen.h), and textbook forms throughout (kernels/naive.h).
    double_intersection = feature_bit::traversal << 1,
    naive = feature_bit::traversal << 2,
    // Ways to search mesh instances other than one by one: a tree over them (kernels/object_tree.h), and one tree over
    // all their triangles. On the host the scene chooses (MeshSearch), and no kernel has either feature.
    object_tree = feature_bit::traversal << 3,
    flat_tree = feature_bit::traversal << 4,
};

// How a light is sampled and selected; a variant asks for it by features in light_samplings and light_selections.
enum class LightSampling : std::uint16_t { solid_angle, area, projected, automatic };
enum class LightSelection : std::uint32_t { uniform, power, tree };

template <class... Features>
PT_HD constexpr FeatureSet set_of(Features... features) {
    return (FeatureSet{0} | ... | static_cast<FeatureSet>(features));
}

inline constexpr FeatureSet no_features = 0;
#define PT_FEATURE(name, array, Type) | static_cast<FeatureSet>(Feature::name)
inline constexpr FeatureSet shape_features = no_features PT_SHAPES(PT_FEATURE);
#undef PT_FEATURE
// Features of all material types that have any of the traits `wanted` (material_trait).
PT_HD constexpr FeatureSet materials_with(std::uint32_t wanted) {
    using namespace material_trait;
    FeatureSet set = no_features;
#define PT_ADD(name, Type, traits) set |= ((traits)&wanted) != 0 ? static_cast<FeatureSet>(Feature::name) : no_features;
    PT_MATERIALS(PT_ADD)
#undef PT_ADD
    return set;
}
#define PT_FEATURE(name, Type, traits) | static_cast<FeatureSet>(Feature::name)
inline constexpr FeatureSet material_types = no_features PT_MATERIALS(PT_FEATURE);
#undef PT_FEATURE
inline constexpr FeatureSet material_features =
    material_types | set_of(Feature::emission, Feature::absorption, Feature::subsurface_boundary,
                            Feature::multiple_scattering, Feature::textures, Feature::shading_normals);
inline constexpr FeatureSet light_samplings =
    set_of(Feature::area_sampling, Feature::projected_sampling, Feature::automatic_sampling);
inline constexpr FeatureSet light_selections = set_of(Feature::power_selection, Feature::tree_selection);
// Features that a scene or an estimator may need: a kernel with all of them renders any scene without meshes.
inline constexpr FeatureSet all_features =
    (shape_features & ~static_cast<FeatureSet>(Feature::mesh)) | material_features | light_samplings |
    light_selections |
    set_of(Feature::near_sphere, Feature::motion, Feature::environment, Feature::environment_map, Feature::jitter,
           Feature::lens, Feature::final_bounce, Feature::next_event, Feature::multiple_importance, Feature::one_sample,
           Feature::russian_roulette, Feature::adjoint_roulette);
inline constexpr FeatureSet shortcuts = set_of(Feature::enclosure);
#define PT_FEATURE(name) | static_cast<FeatureSet>(Feature::name)
inline constexpr FeatureSet samplers = no_features PT_SAMPLERS(PT_FEATURE);
#undef PT_FEATURE
// Features among which a kernel chooses at run time. Only a kernel that is asked for some of them has any: no other
// kernel, not even a generic one, pays for them.
inline constexpr FeatureSet samplings = samplers | static_cast<FeatureSet>(Feature::guided_walk);

// Features with which a kernel traverses meshes. Only kernels for scenes with meshes have them, since the traversal of
// an acceleration structure takes registers from every other shape.
inline constexpr FeatureSet traversals = set_of(Feature::mesh);
// Features for one tree over all meshes (top-level or flat), at most one per kernel, only for scenes with meshes.
inline constexpr FeatureSet mesh_levels = set_of(Feature::object_tree, Feature::flat_tree);

// Features of kernels whose paths split. A kernel has one only for a variant that asks for it: the branches that wait
// take registers and memory.
inline constexpr FeatureSet path_trees = set_of(Feature::splitting);

// Features that change what is computed: a kernel has exactly those of them that its variant asks for.
inline constexpr FeatureSet formulas = set_of(Feature::double_intersection, Feature::naive);

PT_HD constexpr FeatureSet operator|(Feature a, Feature b) {
    return static_cast<FeatureSet>(a) | static_cast<FeatureSet>(b);
}
PT_HD constexpr FeatureSet operator|(FeatureSet a, Feature b) { return a | static_cast<FeatureSet>(b); }
PT_HD constexpr bool contains(FeatureSet set, Feature feature) { return (set & static_cast<FeatureSet>(feature)) != 0; }
// The light sampling that a set of features asks for, which has one of light_samplings or none (solid angle).
PT_HD constexpr LightSampling light_sampling_in(FeatureSet set) {
    return contains(set, Feature::area_sampling)        ? LightSampling::area
           : contains(set, Feature::projected_sampling) ? LightSampling::projected
           : contains(set, Feature::automatic_sampling) ? LightSampling::automatic
                                                        : LightSampling::solid_angle;
}
// The light selection that a set of features asks for, which has one of light_selections or none (uniform).
PT_HD constexpr LightSelection light_selection_in(FeatureSet set) {
    return contains(set, Feature::power_selection)  ? LightSelection::power
           : contains(set, Feature::tree_selection) ? LightSelection::tree
                                                    : LightSelection::uniform;
}
PT_HD constexpr bool is_superset(FeatureSet set, FeatureSet subset) { return (set & subset) == subset; }

// BruteForce tests every triangle of a mesh (kernels/mesh_view.h); a choice of the axis `accelerator`.
struct BruteForce;

template <class RealT, FeatureSet Features, class AcceleratorT = BruteForce>
struct Config {
    using Real = RealT;
    static constexpr FeatureSet features = Features;
    using Accelerator = AcceleratorT;
};

// Whether a kernel is compiled for scenes whose only light is one fixed object, so that all threads read the same light
// data. A configuration on the device has a member has_one_light where that is so.
template <class Config>
PT_HD constexpr bool has_one_light() {
    if constexpr (requires { Config::has_one_light; }) {
        return Config::has_one_light;
    }
    return false;
}

template <class Config>
PT_HD constexpr bool has(Feature feature) {
    return contains(Config::features, feature);
}

// Whether a kernel has materials with an interior that rays travel through.
template <class Config>
PT_HD constexpr bool has_insides() {
    return (Config::features & materials_with(material_trait::has_inside)) != 0;
}

PT_HD constexpr bool has_everything(FeatureSet features) { return is_superset(features, all_features); }

template <class Function>
#if defined(__CUDACC__)
__noinline__
#endif
    PT_HD auto
    call(const Function& function) {
    return function();
}

// Calls `function`; in a kernel with all features out of line, so that all call sites share one compiled body (10^5
// instructions). The call sites must pass the lambda of one function: each lambda expression has a body of its own.
template <class Config, class Function>
PT_HD inline auto in_one_place(const Function& function) {
    if constexpr (has_everything(Config::features)) {
        return call(function);
    } else {
        return function();
    }
}

}  // namespace pt
