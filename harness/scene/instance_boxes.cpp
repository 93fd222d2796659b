#include "harness/scene/instance_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pt {

namespace {

// Error bound of a ray-triangle test on an instance in single precision, which covers double as well. Roundings of the
// origin in the instance's space: 4, or 6 if it moves; of the direction: 3; of the triangle test: 8 for the distance
// from origin to vertex, 8 for its shear, 2 for the origin. There is room to spare, since these are first-order bounds.
constexpr double roundings = gamma<float>(32);
// Error bound of a ray-triangle test's products and sums that underflow and may be flushed to zero.
constexpr double smallest = 16 * static_cast<double>(std::numeric_limits<float>::min());

double largest_of(const Vec3d& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

float below(double x) { return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity()); }
float above(double x) { return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity()); }

}  // namespace

template <class Real>
InstanceBoxes::InstanceBoxes(const MeshInstance<Real>& instance, const Box& own, const Sweep& sweep)
    : own_(own), sweep_(sweep) {
    const bool is_placed = instance.is_placed != 0;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            row_[i][j] = is_placed ? (i == j ? 1.0 : 0.0) : static_cast<double>(instance.row[i][j]);
        }
    }
    offset_ = is_placed ? Vec3d(0.0) : Vec3d(instance.offset);
    set_inverse();
    set_margins();
}

// Inverts an instance's transformation by cofactors of its matrix rows as rounded for kernels.
void InstanceBoxes::set_inverse() {
    const auto row = [&](int i) { return Vec3d(row_[i][0], row_[i][1], row_[i][2]); };
    // Matrix rows are normalised first, so that products of their entries neither overflow nor underflow.
    double length[3];
    Vec3d unit[3];
    for (int i = 0; i < 3; ++i) {
        length[i] = std::sqrt(dot(row(i), row(i)));
        unit[i] = row(i) / length[i];
    }
    const double determinant = dot(unit[0], cross(unit[1], unit[2]));
    for (int i = 0; i < 3; ++i) {
        const Vec3d column = cross(unit[(i + 1) % 3], unit[(i + 2) % 3]) / (determinant * length[i]);
        for (int axis = 0; axis < 3; ++axis) {
            inverse_[axis][i] = column[axis];
        }
    }
}

void InstanceBoxes::set_margins() {
    const double last = std::max(std::abs(sweep_.first_time), std::abs(sweep_.last_time));
    Vec3d way, farthest, extent;
    for (int axis = 0; axis < 3; ++axis) {
        way[axis] = std::abs(sweep_.velocity[axis]) * last;
        farthest[axis] =
            std::max(std::abs(static_cast<double>(own_.low[axis])), std::abs(static_cast<double>(own_.high[axis])));
        extent[axis] = static_cast<double>(own_.high[axis]) - static_cast<double>(own_.low[axis]);
    }
    Vec3d reach(0.0);  // largest absolute coordinates of the instance's bounding box in scene space
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d p =
            in_scene({(corner & 1) != 0 ? own_.high[0] : own_.low[0], (corner & 2) != 0 ? own_.high[1] : own_.low[1],
                      (corner & 4) != 0 ? own_.high[2] : own_.low[2]});
        for (int axis = 0; axis < 3; ++axis) {
            reach[axis] = std::max(reach[axis], std::abs(p[axis]));
        }
    }
    for (int turn = 0; turn < 2; ++turn) {
        Vec3d own_margin;
        for (int i = 0; i < 3; ++i) {
            double sum = std::abs(offset_[i]) + farthest[i] + largest_of(extent);
            for (int j = 0; j < 3; ++j) {
                sum += std::abs(row_[i][j]) * (2 * way[j] + 1.01 * reach[j]);
            }
            own_margin[i] = roundings * sum + smallest;
        }
        for (int axis = 0; axis < 3; ++axis) {
            margin_[axis] = 0;
            double by_origin = 0;
            for (int i = 0; i < 3; ++i) {
                margin_[axis] += std::abs(inverse_[axis][i]) * own_margin[i];
                for (int j = 0; j < 3; ++j) {
                    by_origin += std::abs(inverse_[axis][i]) * std::abs(row_[i][j]) * roundings;
                }
            }
            margin_by_origin_ = std::max(margin_by_origin_, by_origin);
            reach[axis] += margin_[axis];
        }
    }
}

Vec3d InstanceBoxes::in_scene(const Vec3d& own) const {
    const Vec3d p = own - offset_;
    Vec3d q;
    for (int axis = 0; axis < 3; ++axis) {
        q[axis] = inverse_[axis][0] * p.x + inverse_[axis][1] * p.y + inverse_[axis][2] * p.z;
    }
    return q;
}

Box InstanceBoxes::swept(const Vec3d& low, const Vec3d& high, double margin_of_origins) const {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        const double at_first = sweep_.velocity[axis] * sweep_.first_time;
        const double at_last = sweep_.velocity[axis] * sweep_.last_time;
        const double margin = margin_[axis] + margin_of_origins;
        box.low[axis] = below(low[axis] + std::min(at_first, at_last) - margin);
        box.high[axis] = above(high[axis] + std::max(at_first, at_last) + margin);
    }
    return box;
}

Box InstanceBoxes::box() const {
    const Vec3d origin = in_scene(Vec3d(0.0));
    Vec3d low = origin, high = origin;
    for (int axis = 0; axis < 3; ++axis) {
        for (int i = 0; i < 3; ++i) {
            const double a = inverse_[axis][i] * own_.low[i], b = inverse_[axis][i] * own_.high[i];
            low[axis] += std::min(a, b);
            high[axis] += std::max(a, b);
        }
    }
    return swept(low, high, 0);
}

Box InstanceBoxes::box(const Triangle<float>& triangle, double farthest_origin) const {
    const Vec3d a = in_scene(Vec3d(triangle.a)), b = in_scene(Vec3d(triangle.b)), c = in_scene(Vec3d(triangle.c));
    Vec3d low, high;
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min({a[axis], b[axis], c[axis]});
        high[axis] = std::max({a[axis], b[axis], c[axis]});
    }
    return swept(low, high, margin_by_origin_ * farthest_origin);
}

template <class Real>
double farthest_origin(const SceneView<Real>& scene, double last_time) {
    double farthest = static_cast<double>(scene.camera.aperture_radius);
    const auto add = [&](const auto& shapes, std::uint32_t first) {
        for (std::uint32_t i = 0; i < shapes.size; ++i) {
            const Bounds<Real> bounds = bounds_of(shapes[i]);
            const double way = largest_of(Vec3d(scene.velocity[first + i])) * last_time;
            farthest = std::max({farthest, largest_of(Vec3d(bounds.low)) + way, largest_of(Vec3d(bounds.high)) + way});
        }
    };
#define PT_ADD_KIND(name, array, Type) add(scene.array, first_of<ShapeKind::name>(scene));
    PT_SHAPES(PT_ADD_KIND)
#undef PT_ADD_KIND
    return farthest * 1.001;  // the factor covers rounding of ray origins moved onto a surface
}

template InstanceBoxes::InstanceBoxes(const MeshInstance<float>&, const Box&, const Sweep&);
template InstanceBoxes::InstanceBoxes(const MeshInstance<double>&, const Box&, const Sweep&);
template double farthest_origin(const SceneView<float>&, double);
template double farthest_origin(const SceneView<double>&, double);

}  // namespace pt
