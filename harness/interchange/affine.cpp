#include "harness/interchange/affine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

namespace pt {

namespace {

double length_of_column(const Vec3d& v) { return std::hypot(v.x, v.y, v.z); }

double from_radians(double angle) { return angle * (180.0 / pi<double>); }

// Wraps an angle into (-180, 180] degrees.
double wrapped(double degrees) {
    const double turned = std::remainder(degrees, 360.0);
    return turned == -180.0 ? 180.0 : turned;
}

// Euler angles in degrees of a rotation Rz Ry Rx, given by its columns of length 1.
Vec3d angles_of(const Vec3d (&unit)[3]) {
    const double cosine_y = std::hypot(unit[0].x, unit[0].y);
    constexpr double locked = 1e-9;  // smallest cosine of the y angle without gimbal lock, which sets the z angle to 0
    const double y = std::atan2(-unit[0].z, cosine_y);
    if (cosine_y < locked) {
        return {from_radians(std::atan2(-unit[2].y, unit[1].y)), from_radians(y), 0};
    }
    return {from_radians(std::atan2(unit[1].z, unit[2].z)), from_radians(y),
            from_radians(std::atan2(unit[0].y, unit[0].x))};
}

Vec3d nearest_quarters(const Vec3d& degrees) {
    return {90 * std::round(degrees.x / 90), 90 * std::round(degrees.y / 90), 90 * std::round(degrees.z / 90)};
}

// Largest error of a matrix's columns when rebuilt from rotation angles and scales, relative to each column's scale.
double error_of_columns(const Vec3d& degrees, const Vec3d& scale, const Vec3d (&column)[3]) {
    const Rotation rotation = rotation_of(degrees);
    double error = 0;
    for (int i = 0; i < 3; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            error = std::max(error, std::abs(rotation.column[i][axis] * scale[i] - column[i][axis]) / scale[i]);
        }
    }
    return error;
}

int turned_axes(const Vec3d& degrees) {
    return (degrees.x != 0 ? 1 : 0) + (degrees.y != 0 ? 1 : 0) + (degrees.z != 0 ? 1 : 0);
}

}  // namespace

double shortest_within(double value, double tolerance) {
    for (int digits = 1; digits < 17; ++digits) {
        std::array<char, 40> text{};
        std::snprintf(text.data(), text.size(), "%.*e", digits - 1, value);
        const double rounded = std::strtod(text.data(), nullptr);
        if (std::abs(rounded - value) <= tolerance) {
            return rounded + 0.0;
        }
    }
    return value;
}

Affine operator*(const Affine& left, const Affine& right) {
    Affine product;
    for (int i = 0; i < 3; ++i) {
        product.column[i] = left.direction(right.column[i]);
    }
    product.origin = left.point(right.origin);
    return product;
}

Affine translation(const Vec3d& offset) {
    Affine map;
    map.origin = offset;
    return map;
}

Affine scaling(const Vec3d& factors) {
    Affine map;
    for (int i = 0; i < 3; ++i) {
        map.column[i] = map.column[i] * factors[i];
    }
    return map;
}

Affine rotation_about(const Vec3d& axis, double degrees) {
    Affine map;
    const auto take = [&](const Vec3d& angles) {
        const Rotation rotation = rotation_of(angles);
        std::copy(std::begin(rotation.column), std::end(rotation.column), std::begin(map.column));
    };
    if (axis.y == 0 && axis.z == 0) {
        take({axis.x > 0 ? degrees : -degrees, 0, 0});
        return map;
    }
    if (axis.x == 0 && axis.z == 0) {
        take({0, axis.y > 0 ? degrees : -degrees, 0});
        return map;
    }
    if (axis.x == 0 && axis.y == 0) {
        take({0, 0, axis.z > 0 ? degrees : -degrees});
        return map;
    }
    // Rodrigues' rotation formula: v cos + (axis x v) sin + axis (axis . v)(1 - cos).
    const Vec3d unit = axis * (1 / length_of_column(axis));
    const double angle = degrees * (pi<double> / 180), sine = std::sin(angle), cosine = std::cos(angle);
    for (Vec3d& column : map.column) {
        column = column * cosine + cross(unit, column) * sine + unit * (dot(unit, column) * (1 - cosine));
    }
    return map;
}

double determinant(const Affine& map) { return dot(map.column[0], cross(map.column[1], map.column[2])); }

bool is_finite(const Affine& map) {
    return std::all_of(std::begin(map.column), std::end(map.column),
                       [](const Vec3d& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }) &&
           std::isfinite(map.origin.x) && std::isfinite(map.origin.y) && std::isfinite(map.origin.z);
}

double shear_of(const Affine& map) {
    double greatest = 0;
    for (int i = 0; i < 3; ++i) {
        const Vec3d &a = map.column[i], &b = map.column[(i + 1) % 3];
        const double lengths = length_of_column(a) * length_of_column(b);
        greatest = std::max(greatest, lengths > 0 ? std::abs(dot(a, b)) / lengths : 0.0);
    }
    return greatest;
}

TranslateRotateScale take_apart(const Affine& map) {
    constexpr double last_bits = 8 * std::numeric_limits<double>::epsilon();
    constexpr double last_bits_of_angle = 1e-12, straight = 1e-5;  // angle tolerances, degrees: decimals, quarter turns
    Vec3d column[3] = {map.column[0], map.column[1], map.column[2]};
    if (determinant(map) < 0) {
        column[2] = -column[2];
    }
    TranslateRotateScale parts;
    parts.translate = map.origin;
    Vec3d unit[3];
    Vec3d lengths, decimals;
    for (int i = 0; i < 3; ++i) {
        lengths[i] = length_of_column(column[i]);
        decimals[i] = shortest_within(lengths[i], last_bits * lengths[i]);
        unit[i] = column[i] * (1 / lengths[i]);
    }
    const Vec3d angles = angles_of(unit);
    // Every rotation has a second set of Euler angles: x and z half a turn further, y mirrored.
    const Vec3d other{wrapped(angles.x + 180), wrapped(180 - angles.y), wrapped(angles.z + 180)};
    const auto snapped = [&](const Vec3d& degrees) {
        return Vec3d{shortest_within(degrees.x, last_bits_of_angle), shortest_within(degrees.y, last_bits_of_angle),
                     shortest_within(degrees.z, last_bits_of_angle)};
    };
    double best = std::numeric_limits<double>::infinity();
    for (const Vec3d& degrees : {snapped(angles), snapped(other), angles, other}) {
        for (const Vec3d& scale : {decimals, lengths}) {
            const double error = error_of_columns(degrees, scale, column);
            const bool is_simpler = error == best && turned_axes(degrees) < turned_axes(parts.rotate_degrees);
            if (error < best || is_simpler) {
                best = error;
                parts.rotate_degrees = degrees;
                parts.scale = scale;
            }
        }
    }
    parts.is_exact = best == 0;
    const Vec3d quarters = nearest_quarters(angles), off = quarters - angles;
    if (!parts.is_exact && std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) < straight) {
        parts.is_straightened = error_of_columns(quarters, decimals, column) > last_bits;
        // A rotation by quarter turns has several sets of Euler angles; those computed anew use the fewest axes.
        parts.rotate_degrees = nearest_quarters(angles_of(rotation_of(quarters).column)) + Vec3d(0.0);
        parts.scale = decimals;
    }
    return parts;
}

}  // namespace pt
