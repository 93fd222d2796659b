// For direct checks of kernel functions: a case's scene as kernels of a given precision and robustness see it, traced
// by arbitrary rays; and the exact chords of such rays through bodies, in long double from the kernels' numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "harness/scene/scene_buffers.h"
#include "harness/stability/case.h"
#include "kernels/intersect.h"

namespace pt::stability {

using Vec3l = Vec3<long double>;

class RayRandom {
public:
    explicit RayRandom(std::uint64_t seed) : engine_(seed) {}

    // A uniform number; std::uniform_real_distribution is avoided, since standard libraries differ in its numbers.
    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
    }
    std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(uniform(0, count)); }
    Vec3d in_cube(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
    Vec3d on_sphere() {
        const double z = uniform(-1, 1);
        const double angle = uniform(0, 2 * pi<double>);
        const double radius = std::sqrt(1 - z * z);
        return {radius * std::cos(angle), radius * std::sin(angle), z};
    }

private:
    std::mt19937_64 engine_;
};

// Returns the vector rounded to its type, by way of memory. Without it the SLP vectoriser of g++ 12 at -O2 drops the
// conversions of two numbers that are narrowed and widened again.
template <class Real>
Vec3<Real> settled(Vec3<Real> v) {
    asm volatile("" : "+m"(v));
    return v;
}

template <class RealT, FeatureSet formula>
class RayScene {
public:
    using Real = RealT;
    static constexpr FeatureSet shapes = shape_features | Feature::near_sphere;
    using Kernel = Config<Real, shapes | formula>;
    // The kernel configuration with the robust formulas in place of the naive ones, in the same precision.
    using RobustKernel = Config<Real, shapes | (formula & ~static_cast<FeatureSet>(Feature::naive))>;

    explicit RayScene(const SceneText& text)
        : scene_(parse_scene(text.json().dump(), "stability case")), buffers_(scene_, default_settings(scene_)) {}

    const SceneView<Real>& view() const { return buffers_.view(); }

    static Ray<Real> ray(const Vec3<Real>& origin, const Vec3<Real>& direction, SurfaceId origin_surface = {}) {
        return {origin, direction, Real(0), origin_surface};
    }
    Hit<Real> closest(const Ray<Real>& ray) const { return closest_hit<Kernel>(view(), ray); }
    Hit<Real> robust_closest(const Ray<Real>& ray) const { return closest_hit<RobustKernel>(view(), ray); }
    SurfacePoint<Real> surface(const Ray<Real>& ray, const Hit<Real>& hit) const {
        const SurfacePoint<Real> point = surface_at<RobustKernel>(view(), ray, hit);
        return {settled(point.position), settled(point.normal)};
    }

private:
    Scene scene_;
    SceneBuffers<Real> buffers_;
};

// Calls check.template operator()<Real, formula>() with the precision and the formula that the setting asks for.
template <class Check>
auto in_setting(const DirectSetting& setting, const Check& check) {
    constexpr auto naive = static_cast<FeatureSet>(Feature::naive);
    constexpr auto mixed = static_cast<FeatureSet>(Feature::double_intersection);
    if (setting.precision.is_double()) {
        return setting.is_naive ? check.template operator()<double, naive>()
                                : check.template operator()<double, no_features>();
    }
    if (setting.precision.is_mixed()) {
        return setting.is_naive ? check.template operator()<float, naive | mixed>()
                                : check.template operator()<float, mixed>();
    }
    return setting.is_naive ? check.template operator()<float, naive>()
                            : check.template operator()<float, no_features>();
}

template <class Real>
Vec3<Real> rounded(const Vec3d& v) {
    return settled(Vec3<Real>{static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)});
}

template <class Real>
Vec3<Real> direction_to(const Vec3<Real>& from, const Vec3d& to) {
    return rounded<Real>(normalize(to - Vec3d(from)));
}

inline long double length(const Vec3l& v) { return sqrtl(dot(v, v)); }

// The chord of a ray that starts on a body's surface: the distance `t` to the far side, and `slant`, the factor from an
// error in t to an error in the place of the far side (1 where t is computed as a product).
struct Chord {
    long double t, slant;
};

// The chord t = -2 f.g / g.g of a unit sphere from the point f on its surface in the direction g.
inline Chord unit_chord(const Vec3l& f, const Vec3l& g) { return {-2 * dot(f, g) / (length(f) * dot(g, g)), 1}; }

template <class Real>
Chord exact_chord(const Sphere<Real>& sphere, const Vec3l& origin, const Vec3l& direction) {
    const long double inverse = 1 / static_cast<long double>(sphere.radius);
    return unit_chord((origin - Vec3l(sphere.centre)) * inverse, direction * inverse);
}

inline Vec3l in_frame(const Vec3l (&axis)[3], const Vec3l& v) {
    return {dot(axis[0], v), dot(axis[1], v), dot(axis[2], v)};
}

template <class Real>
Chord exact_chord(const Ellipsoid<Real>& e, const Vec3l& origin, const Vec3l& direction) {
    const Vec3l inverse[3] = {Vec3l(e.inverse_axis[0]), Vec3l(e.inverse_axis[1]), Vec3l(e.inverse_axis[2])};
    return unit_chord(in_frame(inverse, origin - Vec3l(e.centre)), in_frame(inverse, direction));
}

// The chord of a box, which ends at the first plane +-half ahead of the ray.
inline Chord box_chord(const Vec3l& half, const Vec3l& origin, const Vec3l& direction) {
    Chord nearest{INFINITY, 1};
    for (int axis = 0; axis < 3; ++axis) {
        const long double t = (std::copysign(half[axis], direction[axis]) - origin[axis]) / direction[axis];
        if (direction[axis] != 0 && t < nearest.t) {
            nearest = {t, std::abs(direction[axis])};
        }
    }
    nearest.t = std::max(nearest.t, 0.0L);  // rounding may put the start beyond an edge of the box
    return nearest;
}

template <class Real>
Chord exact_chord(const AxisBox<Real>& box, const Vec3l& origin, const Vec3l& direction) {
    const Vec3l half = (Vec3l(box.high) - Vec3l(box.low)) * 0.5L;
    return box_chord(half, origin - (Vec3l(box.high) + Vec3l(box.low)) * 0.5L, direction);
}

template <class Real>
Chord exact_chord(const OrientedBox<Real>& box, const Vec3l& origin, const Vec3l& direction) {
    const Vec3l axis[3] = {Vec3l(box.axis[0]), Vec3l(box.axis[1]), Vec3l(box.axis[2])};
    return box_chord(Vec3l(box.half), in_frame(axis, origin - Vec3l(box.centre)), in_frame(axis, direction));
}

// A chord of length 0, for shapes without an inside and for bodies whose chord no case asks for.
template <class Shape>
Chord exact_chord(const Shape&, const Vec3l&, const Vec3l&) {
    return {0, 1};
}

}  // namespace pt::stability
