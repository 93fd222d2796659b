// Operations on bounding boxes for builders: union, surface area and centre.
#pragma once

#include "variants/bvh/binary_tree.h"

namespace pt {

inline void join(Box& box, const Box& other) {
    for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = other.low[axis] < box.low[axis] ? other.low[axis] : box.low[axis];
        box.high[axis] = other.high[axis] > box.high[axis] ? other.high[axis] : box.high[axis];
    }
}

inline Box joined(Box box, const Box& other) {
    join(box, other);
    return box;
}

inline bool is_empty(const Box& box) { return !(box.low[0] <= box.high[0]); }

inline bool contains(const Box& outer, const Box& inner) {
    bool all = true;
    for (int axis = 0; axis < 3; ++axis) {
        all = all && outer.low[axis] <= inner.low[axis] && inner.high[axis] <= outer.high[axis];
    }
    return all;
}

// Half the surface area of a box, 0 for an empty one; in double, where no finite box overflows.
inline double half_area(const Box& box) {
    if (is_empty(box)) {
        return 0;
    }
    const double x = static_cast<double>(box.high[0]) - static_cast<double>(box.low[0]);
    const double y = static_cast<double>(box.high[1]) - static_cast<double>(box.low[1]);
    const double z = static_cast<double>(box.high[2]) - static_cast<double>(box.low[2]);
    return x * y + y * z + z * x;
}

// The centre of a box along an axis. Bounds are halved before the sum: the centre of any finite box is finite.
inline float centre(const Box& box, int axis) { return 0.5f * box.low[axis] + 0.5f * box.high[axis]; }

inline Box centre_box(const Box& box) {
    Box centres;
    for (int axis = 0; axis < 3; ++axis) {
        centres.low[axis] = centres.high[axis] = centre(box, axis);
    }
    return centres;
}

inline int longest_axis(const Box& box) {
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis) {
        longest = box.high[axis] - box.low[axis] > box.high[longest] - box.low[longest] ? axis : longest;
    }
    return longest;
}

}  // namespace pt
