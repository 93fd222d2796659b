// What a path kernel is compiled for: the number type and the set of features that it contains.
// Everything in kernels/ is a template on a Config, so a feature that the set lacks leaves no instruction behind.
// The idea of a feature mask that is a template argument is Cycles' (kernel/features.h).
#pragma once

#include <cstdint>

// The one host/device macro. Under g++ it vanishes; under nvcc and NVRTC every function serves both sides.
#if defined(__CUDACC__)
#define PT_HD __host__ __device__
#else
#define PT_HD
#endif

namespace pt {

enum class Feature : std::uint32_t {
    // Primitive kinds. An object is classified once, at load: every kernel uses one formula a kind.
    sphere = 1u << 0,
    ellipsoid = 1u << 1,
    axis_box = 1u << 2,
    oriented_box = 1u << 3,
    quad = 1u << 4,
    motion = 1u << 5,
    // Materials.
    diffuse = 1u << 6,
    emitter = 1u << 7,
    mirror = 1u << 8,
    mix = 1u << 9,
    dielectric = 1u << 10,
    subsurface = 1u << 11,
    emission = 1u << 12,             // diffuse, mirror or mix surfaces that also emit
    absorption = 1u << 13,           // Beer-Lambert inside a dielectric
    subsurface_boundary = 1u << 14,  // a subsurface body whose index is not 1
    // Light, camera.
    environment = 1u << 15,
    jitter = 1u << 16,
    lens = 1u << 17,
    // What the variant asks for rather than the scene.
    final_bounce = 1u << 18,
    next_event = 1u << 19,
    multiple_importance = 1u << 20,
    russian_roulette = 1u << 21,
    // Shortcuts: a scene that has them needs them not, and a kernel that has them leaves the same film.
    enclosure = 1u << 22,
    // Another formula for every object: its 4x4 matrix (kernels/transform.h). Changes roundings, and so the film.
    matrix = 1u << 23,
    // Sources of random numbers other than pcg4d. A kernel with none of them has pcg4d, one with a single one has that,
    // and one with several chooses at run time among all (RandomSeed::sampler).
    philox = 1u << 24,
    sobol_owen = 1u << 25,
    minstd = 1u << 26,
    // Other formulas too, and so other roundings: intersection in double within single precision (kernels/widen.h), and
    // textbook forms throughout (kernels/naive.h).
    double_intersection = 1u << 27,
    naive = 1u << 28,
    // Spheres that the eye is near, as the ground under it (sphere.h, NearSphere).
    near_sphere = 1u << 29,
};

using FeatureSet = std::uint32_t;

inline constexpr FeatureSet no_features = 0;
inline constexpr FeatureSet all_features = ((1u << 22) - 1u) | static_cast<FeatureSet>(Feature::near_sphere);
inline constexpr FeatureSet shortcuts = static_cast<FeatureSet>(Feature::enclosure);
inline constexpr FeatureSet samplers = static_cast<FeatureSet>(Feature::philox) |
                                       static_cast<FeatureSet>(Feature::sobol_owen) |
                                       static_cast<FeatureSet>(Feature::minstd);

// Of these a kernel has just the ones that it is asked for: they change what is computed.
inline constexpr FeatureSet formulas =
    static_cast<FeatureSet>(Feature::double_intersection) | static_cast<FeatureSet>(Feature::naive);

PT_HD constexpr FeatureSet operator|(Feature a, Feature b) {
    return static_cast<FeatureSet>(a) | static_cast<FeatureSet>(b);
}
PT_HD constexpr FeatureSet operator|(FeatureSet a, Feature b) { return a | static_cast<FeatureSet>(b); }
PT_HD constexpr bool contains(FeatureSet set, Feature feature) { return (set & static_cast<FeatureSet>(feature)) != 0; }
PT_HD constexpr bool is_superset(FeatureSet set, FeatureSet subset) { return (set & subset) == subset; }

template <class RealT, FeatureSet Features>
struct Config {
    using Real = RealT;
    static constexpr FeatureSet features = Features;
};

template <class Config>
PT_HD constexpr bool has(Feature feature) {
    return contains(Config::features, feature);
}

}  // namespace pt
