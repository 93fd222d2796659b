// Division, reciprocal and square root for operands that are known to be far from the ends of the exponents' range:
// correctly rounded, as the operators are, but on a device without the test for the ends and the branch behind it,
// which cost more than the operation. The sequences are those that nvcc itself takes when its test passes: an
// approximation and Newton steps whose last multiply-add rounds right (Markstein 1990).
#pragma once

#include "kernels/math.h"

namespace pt {

// Device code has shorter instruction sequences for operands in range than the operators; fast arithmetic
// (variants/arithmetic/fast.cpp) has shorter ones of its own.
#if defined(__CUDA_ARCH__) && !defined(PT_FAST_MATH)
#define PT_DEVICE_SEQUENCES 1
#else
#define PT_DEVICE_SEQUENCES 0
#endif

// Reciprocal of x for 2^-100 <= |x| <= 2^120.
template <class Real>
PT_HD inline Real reciprocal_in_range(Real x) {
#if PT_DEVICE_SEQUENCES
    if constexpr (sizeof(Real) == 4) {
        float guess;
        asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(guess) : "f"(x));
        return __fmaf_rn(guess, -__fmaf_rn(guess, x, -1.0f), guess);
    }
#endif
    return Real(1) / x;
}

// Quotient a / b for 2^-50 <= |b| <= 2^50 and a = 0 or 2^-50 <= |a| <= 2^50.
template <class Real>
PT_HD inline Real divide_in_range(Real a, Real b) {
#if PT_DEVICE_SEQUENCES
    if constexpr (sizeof(Real) == 4) {
        float guess;
        asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(guess) : "f"(b));
        const float inverse = __fmaf_rn(guess, __fmaf_rn(-b, guess, 1.0f), guess);
        const float quotient = a * inverse;
        return __fmaf_rn(inverse, __fmaf_rn(-b, quotient, a), quotient);
    }
#endif
    return a / b;
}

// The square root of x for 2^-100 <= x < infinity.
template <class Real>
PT_HD inline Real square_root_in_range(Real x) {
#if PT_DEVICE_SEQUENCES
    if constexpr (sizeof(Real) == 4) {
        float guess;
        asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(guess) : "f"(x));
        const float root = x * guess;
        return __fmaf_rn(__fmaf_rn(-root, root, x), 0.5f * guess, root);
    }
#endif
    return square_root(x);
}

// Approximations to a few units in the last place, where the arithmetic allows them (variants/arithmetic): for numbers
// whose error moves a sample or a point along its ray, and nothing else. Other code is correctly rounded.
#if defined(__CUDA_ARCH__) && defined(PT_APPROXIMATE)
#define PT_DEVICE_APPROXIMATIONS 1
#else
#define PT_DEVICE_APPROXIMATIONS 0
#endif

// Whether the kernel uses a device's approximations for random samples, so that the last bits of these samples are not
// specified.
template <class Real>
inline constexpr bool draws_approximately = PT_DEVICE_APPROXIMATIONS && sizeof(Real) == 4;

// Approximate a / b for 2^-120 <= |b| <= 2^120. For a not 0 nor infinite, b = 0 gives infinity, infinite b gives 0.
template <class Real>
PT_HD inline Real nearly_divide(Real a, Real b) {
#if PT_DEVICE_APPROXIMATIONS
    if constexpr (sizeof(Real) == 4) {
        float inverse;
        asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(b));
        return a * inverse;
    }
#endif
    return a / b;
}

// Approximates the square root of x, in the range of square_root_in_range.
template <class Real>
PT_HD inline Real nearly_square_root_in_range(Real x) {
#if PT_DEVICE_APPROXIMATIONS
    if constexpr (sizeof(Real) == 4) {
        float root;
        asm("sqrt.approx.ftz.f32 %0, %1;" : "=f"(root) : "f"(x));
        return root;
    }
#endif
    return square_root_in_range(x);
}

// Approximate square root of x, in the range of square_root_in_range, and approximate reciprocal of that root.
template <class Real>
struct RootAndInverse {
    Real root, inverse;
};
template <class Real>
PT_HD inline RootAndInverse<Real> nearly_root_and_inverse_in_range(Real x) {
#if PT_DEVICE_APPROXIMATIONS
    if constexpr (sizeof(Real) == 4) {
        float inverse;
        asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(x));
        return {x * inverse, inverse};
    }
#endif
    const Real root = square_root_in_range(x);
    return {root, reciprocal_in_range(root)};
}

// Sine and cosine for |x| <= pi/4; the device approximation has an absolute error of 2^-20.
template <class Real>
PT_HD inline SinCos<Real> nearly_sin_cos_octant(Real x) {
#if PT_DEVICE_APPROXIMATIONS
    if constexpr (sizeof(Real) == 4) {
        return {__sinf(x), __cosf(x)};
    }
#endif
    return sin_cos_octant(x);
}

#undef PT_DEVICE_SEQUENCES
#undef PT_DEVICE_APPROXIMATIONS

}  // namespace pt
