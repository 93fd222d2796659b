// Affine maps as other programs' scenes have them, in double precision, and what of them scene files can say: translate
// * rotate * scale.
#pragma once

#include "harness/scene/scene.h"

namespace pt {

struct Affine {
    Vec3d column[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Vec3d origin{0.0};

    Vec3d direction(const Vec3d& v) const { return column[0] * v.x + column[1] * v.y + column[2] * v.z; }
    Vec3d point(const Vec3d& p) const { return direction(p) + origin; }
};

// The map that applies first the right one, then the left one.
Affine operator*(const Affine& left, const Affine& right);

Affine translation(const Vec3d& offset);
Affine scaling(const Vec3d& factors);
// About an axis through the origin, counter-clockwise where the axis points to the eye; about a coordinate axis by a
// quarter turn it is exact. The axis is not 0.
Affine rotation_about(const Vec3d& axis, double degrees);

double determinant(const Affine& map);
bool is_finite(const Affine& map);

// The greatest cosine between two columns: 0 where they are perpendicular, as translate * rotate * scale has them.
double shear_of(const Affine& map);

// The decimal of fewest digits that is off a number by no more than the error given.
double shortest_within(double value, double tolerance);

struct TranslateRotateScale {
    Vec3d translate{0.0}, rotate_degrees{0.0}, scale{1.0};
    bool is_exact = false;         // rotation_of and the scale give every bit of the columns
    bool is_straightened = false;  // a few millionths of a degree off quarter turns were taken away
};

// Takes a map without shear apart; if it mirrors, the map with its last column turned about. Angles and scales are the
// shortest decimals that give the columns back to their last bits.
TranslateRotateScale take_apart(const Affine& map);

}  // namespace pt
