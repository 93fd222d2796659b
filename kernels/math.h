// Vectors (GLM) and the few scalar functions whose rounding the kernels depend on.
// min and max are ternaries: they compile to one instruction, stay IEEE, and on the host they vectorise (fminf does
// not). Sine and cosine are our own polynomials (Cephes coefficients), so that host and device round alike.
#pragma once

#include "kernels/config.h"

#include <cmath>
#include <cstdint>

#include <glm/vec3.hpp>

namespace pt {

template <class Real>
using Vec3 = glm::vec<3, Real, glm::defaultp>;

template <class T>
PT_HD constexpr T min(T a, T b) {
    return a < b ? a : b;
}
template <class T>
PT_HD constexpr T max(T a, T b) {
    return a > b ? a : b;
}
template <class T>
PT_HD constexpr T clamp(T value, T low, T high) {
    return min(max(value, low), high);
}

template <class Real>
inline constexpr Real pi = Real(3.14159265358979323846264338327950288);

// Unit round-off and Higham's bound gamma(n) = n u / (1 - n u) on n roundings.
template <class Real>
inline constexpr Real unit_round_off = sizeof(Real) == 4 ? Real(5.9604644775390625e-08) : Real(1.1102230246251565e-16);

template <class Real>
PT_HD constexpr Real gamma(int n) {
    return Real(n) * unit_round_off<Real> / (Real(1) - Real(n) * unit_round_off<Real>);
}

template <class Real>
PT_HD inline Real square_root(Real x) {
    using std::sqrt;
    return sqrt(x);
}
template <class Real>
PT_HD inline Real exponential(Real x) {
    using std::exp;
    return exp(x);
}
template <class Real>
PT_HD inline Real logarithm(Real x) {
    using std::log;
    return log(x);
}
template <class Real>
PT_HD inline Real absolute(Real x) {
    return x < Real(0) ? -x : x;
}

template <class Real>
PT_HD inline Real dot(const Vec3<Real>& a, const Vec3<Real>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
PT_HD inline Vec3<Real> cross(const Vec3<Real>& a, const Vec3<Real>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Real>
PT_HD inline Vec3<Real> normalize(const Vec3<Real>& v) {
    return v * (Real(1) / square_root(dot(v, v)));
}

template <class Real>
struct Vec2 {
    Real x, y;
};

template <class Real>
struct SinCos {
    Real sine, cosine;
};

// Sine and cosine for |x| <= pi/4, to about one unit in the last place.
PT_HD inline SinCos<float> sin_cos_octant(float x) {
    const float z = x * x;
    const float sine = ((-1.9515295891e-4f * z + 8.3321608736e-3f) * z - 1.6666654611e-1f) * z * x + x;
    const float cosine =
        ((2.443315711809948e-5f * z - 1.388731625493765e-3f) * z + 4.166664568298827e-2f) * z * z - 0.5f * z + 1.0f;
    return {sine, cosine};
}
PT_HD inline SinCos<double> sin_cos_octant(double x) {
    const double z = x * x;
    double s = 1.58962301576546568060e-10 * z - 2.50507477628578072866e-8;
    s = s * z + 2.75573136213857245213e-6;
    s = s * z - 1.98412698295895385996e-4;
    s = s * z + 8.33333333332211858878e-3;
    s = s * z - 1.66666666666666307295e-1;
    double c = -1.13585365213876817300e-11 * z + 2.08757008419747316778e-9;
    c = c * z - 2.75573141792967388112e-7;
    c = c * z + 2.48015872888517045348e-5;
    c = c * z - 1.38888888888730564116e-3;
    c = c * z + 4.16666666666665929218e-2;
    return {s * z * x + x, c * z * z - 0.5 * z + 1.0};
}

// Sine and cosine of 2 pi u for u in [0, 1]: the reduction to an octant is exact, only the octant is rounded.
template <class Real>
PT_HD inline SinCos<Real> sin_cos_turn(Real u) {
    const int quarter = static_cast<int>(u * Real(4) + Real(0.5));  // nearest quarter turn, 0..4
    const Real rest = u - Real(quarter) * Real(0.25);               // exact (Sterbenz), in [-1/8, 1/8]
    const SinCos<Real> octant = sin_cos_octant(rest * (Real(2) * pi<Real>));
    switch (quarter & 3) {
        case 0:
            return octant;
        case 1:
            return {octant.cosine, -octant.sine};
        case 2:
            return {-octant.sine, -octant.cosine};
        default:
            return {-octant.cosine, octant.sine};
    }
}

// Two unit vectors that complete the unit vector `normal` to a right-handed frame.
// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
template <class Real>
struct Frame {
    Vec3<Real> tangent, bitangent, normal;

    PT_HD explicit Frame(const Vec3<Real>& n) : normal(n) {
        const Real sign = n.z >= Real(0) ? Real(1) : Real(-1);
        const Real a = Real(-1) / (sign + n.z);
        const Real b = n.x * n.y * a;
        tangent = {Real(1) + sign * n.x * n.x * a, sign * b, -sign * n.x};
        bitangent = {b, sign + n.y * n.y * a, -n.y};
    }
    PT_HD Vec3<Real> to_world(const Vec3<Real>& local) const {
        return tangent * local.x + bitangent * local.y + normal * local.z;
    }
};

// A read-only view of `size` elements; std::span is not to be had under NVRTC.
template <class T>
struct View {
    const T* data = nullptr;
    std::uint32_t size = 0;

    PT_HD const T& operator[](std::uint32_t i) const { return data[i]; }
};

}  // namespace pt
