// Directions to a rectangle at any distance, sampled with weights below 2 pi: the position across it by the angle of
// the strip that extends it endlessly along its longer side, the position along it by solid angle. Ureña, Fajardo and
// King, "An Area-Preserving Parametrization for Spherical Rectangles", EGSR 2013, draw the latter in this way too, and
// the former so that weights are one. The form here takes one arc tangent and no difference of angles.
#pragma once

#include "kernels/in_range.h"

namespace pt {

// A rectangle in the plane z = `height` > 0 above an observer at the origin; y is along its longer side.
template <class Real>
struct NearRectangle {
    Real x0, x1, y0, y1, height;
    Real length;  // extent of the rectangle along y, known more precisely than the difference y1 - y0
    Real angle;   // angle that the rectangle, made endless along y, subtends, up to pi; 0: it is not visible

    // `at`: the observer's position over the rectangle, from its centre; `half`: the rectangle's half sides.
    PT_HD NearRectangle(Real half_x, Real half_y, Real at_x, Real at_y, Real z)
        : x0(-half_x - at_x),
          x1(half_x - at_x),
          y0(-half_y - at_y),
          y1(half_y - at_y),
          height(z),
          length(Real(2) * half_y) {
        const Real scale = unit();
        const Real across = (z * scale) * (Real(2) * half_x * scale);
        const Real along = (z * scale) * (z * scale) + (x0 * scale) * (x1 * scale);
        const Real beyond_a_quarter = along < Real(0) ? pi<Real> : Real(0);
        angle = across > Real(0) ? arc_tangent(nearly_divide(across, along)) + beyond_a_quarter : Real(0);
    }

    struct Sample {
        Vec3<Real> point;
        Real inverse_pdf;  // 1 / pdf, by solid angle, of the direction to a point of the rectangle
    };
    PT_HD Sample sample(Real u, Real v) const {
        const Real x = x_at(u);
        const Stretch stretch(*this, x);
        return {{x, stretch.y_at(*this, v), height}, angle * stretch.share(*this)};
    }
    // 1 / density, by solid angle, of a direction in which the observer sees the rectangle.
    PT_HD Real inverse_pdf(Real direction_x, Real direction_z) const {
        const Real steepness = max(absolute(direction_z), Real(0x1p-100));
        return angle * Stretch(*this, clamp(height * nearly_divide(direction_x, steepness), x0, x1)).share(*this);
    }

private:
    // Lower bound on squared lengths, so that their reciprocals are finite.
    static constexpr Real least_square = Real(0x1p-100);

    // The line across the rectangle at one x, from y0 to y1, by the sines of the angles from the plane y = 0, in which
    // the observer lies, to the directions of the line's ends.
    struct Stretch {
        Real square;  // squared distance from the observer to the rectangle's line, extended endlessly
        Real low, high;
        Real inverse_low, inverse_high;  // 1 / distances from the observer to the ends of the rectangle's line
        bool on_one_side;                // both ends of the rectangle's line are on one side of the plane y = 0

        PT_HD Stretch(const NearRectangle& of, Real x) : square(x * x + of.height * of.height) {
            inverse_low = inverse_root(square + of.y0 * of.y0);
            inverse_high = inverse_root(square + of.y1 * of.y1);
            low = of.y0 * inverse_low;
            high = of.y1 * inverse_high;
            on_one_side = of.y0 * of.y1 > Real(0);
        }
        // The y at which a share v of the line's solid angle lies on the side of y0. If both ends of the line are on
        // one side of y = 0, the y is found from 1 - |sine|, which may be below the last digit of the sine.
        PT_HD Real y_at(const NearRectangle& of, Real v) const {
            Real sine = low + v * (high - low);
            Real rest = (Real(1) - sine) * (Real(1) + sine);
            if (on_one_side) {
                const Real lack = lack_of(low, inverse_low);
                const Real drawn = lack + v * (lack_of(high, inverse_high) - lack);
                sine = low < Real(0) ? drawn - Real(1) : Real(1) - drawn;
                rest = drawn * (Real(2) - drawn);
            }
            const Real end = sine < Real(0) ? of.y0 : of.y1;
            return rest > Real(0)
                       ? clamp(sine * nearly_square_root_in_range(nearly_divide(max(square, least_square), rest)),
                               of.y0, of.y1)
                       : end;
        }
        // The sines' difference high - low, without cancellation where both ends of the line are on one side of y = 0.
        PT_HD Real share(const NearRectangle& of) const {
            if (!on_one_side) {
                return high - low;
            }
            const Real both = inverse_low * inverse_high;
            return nearly_divide(square * both * (of.length * (of.y0 + of.y1) * both), low + high);
        }
        PT_HD Real lack_of(Real sine, Real inverse) const {
            return nearly_divide(square * inverse * inverse, Real(1) + absolute(sine));
        }
        PT_HD static Real inverse_root(Real square) {
            return nearly_root_and_inverse_in_range(max(square, least_square)).inverse;
        }
    };

    // Scale that brings the distances to the rectangle near 1, so that no squared length in an angle underflows.
    PT_HD Real unit() const { return power_to_one(max(max(absolute(x0), absolute(x1)), height)); }
    // The x up to which, from x0, a share u of the angle lies that the rectangle, made endless along y, subtends.
    PT_HD Real x_at(Real u) const {
        const Real scale = unit();
        const SinCos<Real> turn = sin_cos_turn(u * (angle * (Real(0.5) / pi<Real>)));
        const Real across = x0 * scale * turn.cosine + height * scale * turn.sine;
        const Real up = height * scale * turn.cosine - x0 * scale * turn.sine;
        const Real end = across < Real(0) ? x0 : x1;
        return up > Real(0) ? clamp(height * nearly_divide(across, up), x0, x1) : end;
    }
};

}  // namespace pt
