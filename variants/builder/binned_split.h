// Finds the plane that best parts references by their centres, from bins (binned SAH). Wald, "On fast Construction of
// SAH-based Bounding Volume Hierarchies", RT 2007.
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "variants/bvh/box.h"

namespace pt::builder {

// A reference to a primitive: the primitive's bounding box, or a part of it, beside the primitive's number, so that the
// passes over a node read memory in order.
struct Reference {
    Box box;
    std::uint32_t primitive;
};

// The bounding box of some references, and that of the references' centres.
struct Bounds {
    Box box, centres;

    void add(const Box& other) {
        join(box, other);
        join(centres, centre_box(other));
    }
    static Bounds of(std::span<const Reference> references) {
        Bounds all;
        for (const Reference& reference : references) {
            all.add(reference.box);
        }
        return all;
    }
};

struct Bin {
    Box box;
    std::uint32_t count = 0;
};

// Assigns references to bins along an axis, monotonically in their centres.
struct Binning {
    static constexpr int bins = 16;
    float low, scale;

    static Binning along(const Box& centres, int axis) {
        const float extent = centres.high[axis] - centres.low[axis];
        return {centres.low[axis], static_cast<float>(bins) * (1 - 0x1p-20f) / extent};
    }
    int of(const Box& box, int axis) const {
        return std::clamp(static_cast<int>((centre(box, axis) - low) * scale), 0, bins - 1);
    }
    // Whether the scale from centres to bin numbers is finite: one that overflows would give numbers out of range.
    bool is_usable() const { return scale > 0 && scale < std::numeric_limits<float>::max(); }
};

struct ObjectSplit {
    double cost = std::numeric_limits<double>::infinity();  // sum over both children: half surface area x references
    int axis = -1;                                          // axis across which the split's plane lies; -1: no split
    int first_right = 0;                                    // number of the first bin that goes to the right child
    Box left, right;
};

ObjectSplit best_object_split(std::span<const Reference> references, const Bounds& bounds);

// Moves half of the references, by number, to the front: those whose centres come first along the longest axis.
void halve_by_centre(std::span<Reference> references, const Bounds& bounds);

}  // namespace pt::builder
