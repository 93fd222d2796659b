// Bounding boxes of triangles for builders: exact for single precision, rounded outward from double.
#pragma once

#include "kernels/triangle.h"
#include "variants/bvh/binary_tree.h"

#include <cmath>
#include <span>

namespace pt {

template <class Real>
Box box_of(const Triangle<Real>& triangle) {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        const Real a = triangle.a[axis], b = triangle.b[axis], c = triangle.c[axis];
        const Real low = min(min(a, b), c), high = max(max(a, b), c);
        box.low[axis] = static_cast<float>(low);
        box.high[axis] = static_cast<float>(high);
        if (static_cast<Real>(box.low[axis]) > low) {
            box.low[axis] = std::nextafter(box.low[axis], -std::numeric_limits<float>::infinity());
        }
        if (static_cast<Real>(box.high[axis]) < high) {
            box.high[axis] = std::nextafter(box.high[axis], std::numeric_limits<float>::infinity());
        }
    }
    return box;
}

template <class Real>
PrimitiveBoxes primitive_boxes(std::span<const Triangle<Real>> triangles) {
    PrimitiveBoxes boxes(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        boxes[i] = box_of(triangles[i]);
    }
    return boxes;
}

}  // namespace pt
