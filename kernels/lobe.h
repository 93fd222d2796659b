// Interface of a material's lobe for light connections and for continuing the path: all that it scatters from one
// direction to another. A lobe is a class with towards(direction, cosine), `transmits` (whether light may go through)
// and `may_be_opaque` (whether some such lobes let none through, as the member lets_through() then tells).
#pragma once

#include "kernels/math.h"

namespace pt {

// The least cosine that counts as above the surface: squares of it stay within single precision.
template <class Real>
inline constexpr Real least_cosine = Real(0x1p-40);

// What a lobe scatters from one direction to another, and the pdf with which it samples that direction.
template <class Real>
struct LobeValue {
    Vec3<Real> weight;  // weight of a sample of the lobe: BSDF * cosine / pdf
    Real pdf;           // pdf, by solid angle, with which the lobe draws the direction
};

template <class Real>
struct LobeSample {
    Vec3<Real> direction;
    Real cosine;  // cosine of `direction` to the normal; 0: no light gets through, and no other member is set
    LobeValue<Real> value;
};

}  // namespace pt
