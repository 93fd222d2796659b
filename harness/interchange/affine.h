// Affine maps in double precision, as foreign scenes use them, and their decomposition into what scene files can
// express: translate * rotate * scale.
#pragma once

#include "harness/scene/scene.h"

namespace pt {

struct Affine {
    Vec3d column[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Vec3d origin{0.0};

    Vec3d direction(const Vec3d& v) const { return column[0] * v.x + column[1] * v.y + column[2] * v.z; }
    Vec3d point(const Vec3d& p) const { return direction(p) + origin; }
};

// Composes two affine maps: the right one is applied first.
Affine operator*(const Affine& left, const Affine& right);

Affine translation(const Vec3d& offset);
Affine scaling(const Vec3d& factors);
// Rotation about an axis through the origin, counter-clockwise as seen with the axis pointing to the viewer. Quarter
// turns about a coordinate axis are exact. The axis must not be 0.
Affine rotation_about(const Vec3d& axis, double degrees);

double determinant(const Affine& map);
bool is_finite(const Affine& map);

// The largest |cosine| between two columns of an affine map; 0 without shear, as of translate * rotate * scale.
double shear_of(const Affine& map);

// The decimal number with the fewest digits that is within `tolerance` of a value.
double shortest_within(double value, double tolerance);

struct TranslateRotateScale {
    Vec3d translate{0.0}, rotate_degrees{0.0}, scale{1.0};
    bool is_exact = false;         // whether rotation and scale reproduce every bit of the affine map's columns
    bool is_straightened = false;  // whether a rotation within 1e-5 degrees of quarter turns was snapped to them
};

// Decomposes an affine map without shear into translation, rotation and scale; if the map mirrors, its last column is
// negated first. Angles and scales are the shortest decimals that reproduce the columns to their last bits.
TranslateRotateScale take_apart(const Affine& map);

}  // namespace pt
