// Vectors (GLM) and the few scalar functions whose rounding the kernels depend on.
// min and max are ternaries: they compile to one instruction, stay IEEE, and on the host they vectorise (fminf does
// not). Sine, cosine, arc tangent, exponential and logarithm (coefficients of Cephes and fdlibm) use + - * / and the
// bits of IEEE numbers alone, so that host and device round alike.
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
// The larger (smaller) of a number and a candidate, which is ignored if it is NaN: one instruction on a device, into
// which a compiler may not turn the ternary. Of two zeros either may be returned.
template <class Real>
PT_HD inline Real keep_larger(Real kept, Real candidate) {
#if defined(__CUDA_ARCH__)
    if constexpr (sizeof(Real) == 4) {
        return fmaxf(kept, candidate);
    }
#endif
    return candidate > kept ? candidate : kept;
}
template <class Real>
PT_HD inline Real keep_smaller(Real kept, Real candidate) {
#if defined(__CUDA_ARCH__)
    if constexpr (sizeof(Real) == 4) {
        return fminf(kept, candidate);
    }
#endif
    return candidate < kept ? candidate : kept;
}
template <class T>
PT_HD constexpr T clamp(T value, T low, T high) {
    return min(max(value, low), high);
}

// Component of a vector along an axis from 0 to 2. It is selected by comparisons, since an index would put the vector
// into memory.
template <class Real, class Axis>
PT_HD constexpr Real component_of(const Vec3<Real>& v, Axis axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
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

// A product that is rounded before it is added: no compiler makes a fused multiply-add of it. Fused, a b - c d is not
// the negative of c d - a b, so two triangles can disagree about the edge that they share; and two kernels of one
// formula can differ in the last bit of a ray's position.
PT_HD inline float rounded_product(float a, float b) {
#if defined(__CUDA_ARCH__)
    return __fmul_rn(a, b);
#else
    return a * b;
#endif
}
PT_HD inline double rounded_product(double a, double b) {
#if defined(__CUDA_ARCH__)
    return __dmul_rn(a, b);
#else
    return a * b;
#endif
}

template <class Real>
PT_HD inline Real square_root(Real x) {
    using std::sqrt;
    return sqrt(x);
}
template <class Real>
PT_HD inline Real absolute(Real x) {
    using std::fabs;
    return fabs(x);
}

// Converts a number to its bits and back; NVRTC has no std::bit_cast.
PT_HD inline std::int32_t bits_of(float x) { return __builtin_bit_cast(std::int32_t, x); }
PT_HD inline std::int64_t bits_of(double x) { return __builtin_bit_cast(std::int64_t, x); }
PT_HD inline float number_of(std::int32_t bits) { return __builtin_bit_cast(float, bits); }
PT_HD inline double number_of(std::int64_t bits) { return __builtin_bit_cast(double, bits); }

// A power of two p with 1 <= p x < 2, for 2^-126 <= x < 2^126 (in double 2^1022).
PT_HD inline float power_to_one(float x) { return number_of(0x7f000000 - (bits_of(x) & 0x7f800000)); }
PT_HD inline double power_to_one(double x) {
    return number_of(std::int64_t{0x7fe0000000000000} - (bits_of(x) & std::int64_t{0x7ff0000000000000}));
}

template <class Real>
inline constexpr int mantissa_bits = sizeof(Real) == 4 ? 23 : 52;
template <class Real>
inline constexpr int infinite_exponent = sizeof(Real) == 4 ? 128 : 1024;

// 2^k for k from 2 - infinite_exponent, the smallest normal number, to infinite_exponent.
template <class Real>
PT_HD inline Real power_of_two(int k) {
    return number_of(bits_of(Real(1)) + k * (bits_of(Real(2)) - bits_of(Real(1))));
}

// The greatest power of two at or below x, and 1 over it: for x from the least normal number to half of the largest.
template <class Real>
PT_HD inline Real power_of_two_below(Real x) {
    return number_of(bits_of(x) >> mantissa_bits<Real> << mantissa_bits<Real>);
}
template <class Real>
PT_HD inline Real reciprocal_of_power_of_two(Real power) {
    return number_of(bits_of(Real(1)) + bits_of(Real(1)) - bits_of(power));
}

// ln 2 in two parts. The first has so few bits that its product with an exponent is exact.
template <class Real>
inline constexpr Real ln2_high = sizeof(Real) == 4 ? Real(0x1.62e4p-1) : Real(0x1.62e42feep-1);
template <class Real>
inline constexpr Real ln2_low = sizeof(Real) == 4 ? Real(1.4286067653e-6) : Real(1.90821492927058770002e-10);

// Series of r coth(r/2) - 2 in z = r^2, for |r| <= ln(2)/2. Coefficients: fdlibm, e_exp.c (Sun Microsystems 1993), and
// its single precision in FreeBSD's msun, e_expf.c.
PT_HD inline float exponential_series(float z) { return (-2.7667332906e-3f * z + 1.6666625440e-1f) * z; }
PT_HD inline double exponential_series(double z) {
    double s = 4.13813679705723846039e-8 * z - 1.65339022054652515390e-6;
    s = s * z + 6.61375632143793436117e-5;
    s = s * z - 2.77777777770155933842e-3;
    s = s * z + 1.66666666666666019037e-1;
    return s * z;
}

// e^x, to less than one unit in the last place, through the denormal numbers down to 0; exactly 1 at 0.
template <class Real>
PT_HD inline Real exponential(Real x) {
    constexpr Real log2_e = Real(1.44269504088896340736);
    // Beyond the clamp's bounds e^x rounds to 0 or to infinity. NaN becomes the lower bound, yet NaN is returned.
    const Real within = sizeof(Real) == 4 ? clamp(x, Real(-104), Real(89)) : clamp(x, Real(-746), Real(710));
    const int k = static_cast<int>(within * log2_e + (within < Real(0) ? Real(-0.5) : Real(0.5)));
    const Real high = within - Real(k) * ln2_high<Real>;
    const Real low = Real(k) * ln2_low<Real>;
    const Real r = high - low;  // e^r = 1 + 2 r / (r coth(r/2) - r)
    const Real c = r - exponential_series(r * r);
    const Real power = Real(1) - ((low - r * c / (Real(2) - c)) - high);
    // The factor 2^k is applied in two steps, since 2^k may be no normal number; only the second step can round.
    const Real result = power * power_of_two<Real>(k / 2) * power_of_two<Real>(k - k / 2);
    return x == x ? result : x;
}

// Series of ln((1+s)/(1-s)) / s - 2 in z = s^2, |s| <= 3 - sqrt(8). Coefficients: fdlibm, e_log.c; msun, e_logf.c.
PT_HD inline float logarithm_series(float z) {
    return (((0.24279078841f * z + 0.28498786688f) * z + 0.40000972152f) * z + 0.66666662693f) * z;
}
PT_HD inline double logarithm_series(double z) {
    double s = 1.479819860511658591e-1 * z + 1.531383769920937332e-1;
    s = s * z + 1.818357216161805012e-1;
    s = s * z + 2.222219843214978396e-1;
    s = s * z + 2.857142874366239149e-1;
    s = s * z + 3.999999999940941908e-1;
    s = s * z + 6.666666666666735130e-1;
    return s * z;
}

// The natural logarithm, to less than one unit in the last place; exactly 0 at 1. Minus infinity at 0, NaN below.
template <class Real>
PT_HD inline Real logarithm(Real x) {
    const Real infinity = power_of_two<Real>(infinite_exponent<Real>);
    if (!(x > Real(0) && x < infinity)) {
        const Real not_a_number = number_of(~bits_of(Real(0)));  // fixed bits: host and device make different NaNs
        return x == Real(0) ? -infinity : x == infinity ? infinity : not_a_number;
    }
    const bool denormal = x < power_of_two<Real>(2 - infinite_exponent<Real>);
    const auto bits = bits_of(denormal ? x * power_of_two<Real>(mantissa_bits<Real>) : x);
    // Splits x into 2^k (1 + f) such that 1 + f is from sqrt(1/2) to sqrt(2).
    const auto k = (bits - bits_of(Real(0.70710678118654752440))) >> mantissa_bits<Real>;
    const Real f = number_of(bits - (k << mantissa_bits<Real>)) - Real(1);
    const Real exponent = Real(static_cast<int>(k) - (denormal ? mantissa_bits<Real> : 0));
    const Real s = f / (Real(2) + f);
    const Real half_square = Real(0.5) * f * f;
    const Real correction = s * (half_square + logarithm_series(s * s)) + exponent * ln2_low<Real>;
    return exponent * ln2_high<Real> - ((half_square - correction) - f);
}

template <class Real>
PT_HD inline Real dot(const Vec3<Real>& a, const Vec3<Real>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
// The dot product as a sum of rounded products, which no fused multiply-add contracts.
template <class Real>
PT_HD inline Real rounded_dot(const Vec3<Real>& a, const Vec3<Real>& b) {
    return rounded_product(a.x, b.x) + rounded_product(a.y, b.y) + rounded_product(a.z, b.z);
}
template <class Real>
PT_HD inline Vec3<Real> rounded_product(const Vec3<Real>& v, Real factor) {
    return {rounded_product(v.x, factor), rounded_product(v.y, factor), rounded_product(v.z, factor)};
}
template <class Real>
PT_HD inline Vec3<Real> cross(const Vec3<Real>& a, const Vec3<Real>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Real>
PT_HD inline Vec3<Real> normalize(const Vec3<Real>& v) {
    return v * (Real(1) / square_root(dot(v, v)));
}

// Normalizes a vector whose square d is 1 but for rounding: one Newton step on d^(-1/2) from 1, whose error is 3/8 (d -
// 1)^2. It needs no division and no root.
template <class Real>
PT_HD inline Vec3<Real> renormalize(const Vec3<Real>& v) {
    return v * (Real(1.5) - Real(0.5) * dot(v, v));
}

// Normalizes a vector that is unit but for the rounding of a point on a surface, which far from the eye may be more
// than a Newton step from 1 can mend.
template <class Real>
PT_HD inline Vec3<Real> nearly_unit(const Vec3<Real>& v) {
    const Real excess = dot(v, v) - Real(1);
    constexpr Real most = sizeof(Real) == 4 ? Real(1e-4) : Real(1e-8);  // excess that one Newton step removes
    return absolute(excess) < most ? v * (Real(1) - Real(0.5) * excess) : normalize(v);
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
    const int quarter = static_cast<int>(u * Real(4) + Real(0.5));  // number of the quarter turn nearest to u, 0 to 4
    const Real rest = u - Real(quarter) * Real(0.25);               // u - quarter / 4: exact (Sterbenz), within 1/8
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

// Sine and cosine of x for |x| <= 2 pi, in radians; for |x| <= pi/4 about as precise as sin_cos_octant.
template <class Real>
PT_HD inline SinCos<Real> sin_cos(Real x) {
    const SinCos<Real> of_size = sin_cos_turn(min(absolute(x) * (Real(0.5) / pi<Real>), Real(1)));
    return {x < Real(0) ? -of_size.sine : of_size.sine, of_size.cosine};
}

// Series of atan(x) / x - 1 in z = x^2, for |x| up to tan(pi/8) in single precision and up to 0.66 in double.
// Coefficients: Cephes, atanf.c and atan.c.
PT_HD inline float arc_tangent_series(float z) {
    return (((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z - 3.33329491539e-1f) * z;
}
PT_HD inline double arc_tangent_series(double z) {
    double p = -8.750608600031904122785e-1 * z - 1.615753718733365076637e1;
    p = p * z - 7.500855792314704667340e1;
    p = p * z - 1.228866684490136173410e2;
    p = p * z - 6.485021904942025371773e1;
    double q = z + 2.485846490142306297962e1;
    q = q * z + 1.650270098316988542046e2;
    q = q * z + 4.328810604912902668951e2;
    q = q * z + 4.853903996359136964868e2;
    q = q * z + 1.945506571482613964425e2;
    return z * (p / q);
}

// The arc tangent, to about two units in the last place; odd, and +-pi/2 at +-infinity.
template <class Real>
PT_HD inline Real arc_tangent(Real x) {
    constexpr Real least_for_quarter = sizeof(Real) == 4 ? Real(0.41421356237309503) : Real(0.66);
    Real size = absolute(x);
    Real base = Real(0);
    if (size > Real(2.41421356237309504880)) {
        base = pi<Real> / Real(2);
        size = Real(-1) / size;
    } else if (size > least_for_quarter) {
        base = pi<Real> / Real(4);
        size = (size - Real(1)) / (size + Real(1));
    }
    const Real angle = base + (arc_tangent_series(size * size) * size + size);
    return x < Real(0) ? -angle : angle;
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

// A read-only view of `size` elements; NVRTC has no std::span.
template <class T>
struct View {
    const T* data = nullptr;
    std::uint32_t size = 0;

    PT_HD const T& operator[](std::uint32_t i) const { return data[i]; }
};

// The number of bits that are 1.
PT_HD inline std::uint32_t bits_in(std::uint32_t x) {
#if defined(__CUDA_ARCH__)
    return static_cast<std::uint32_t>(__popc(static_cast<int>(x)));
#else
    return static_cast<std::uint32_t>(__builtin_popcount(x));
#endif
}

}  // namespace pt
