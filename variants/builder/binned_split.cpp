#include "variants/builder/binned_split.h"

namespace pt::builder {

namespace {

using Bins = std::array<Bin, Binning::bins>;

void add(Bin& bin, const Bin& other) {
    join(bin.box, other.box);
    bin.count += other.count;
}

void sweep(const Bins& filled, int axis, std::size_t count, ObjectSplit& best) {
    Bins right;  // entry i: bounding box and count of the references in bins i and above
    right.back() = filled.back();
    for (int i = Binning::bins - 2; i > 0; --i) {
        right[i] = right[i + 1];
        add(right[i], filled[i]);
    }
    Bin left;
    for (int i = 1; i < Binning::bins; ++i) {
        add(left, filled[i - 1]);
        if (left.count == 0 || left.count == count) {
            continue;
        }
        const double cost = half_area(left.box) * left.count + half_area(right[i].box) * right[i].count;
        if (cost < best.cost) {
            best = {cost, axis, i, left.box, right[i].box};
        }
    }
}

}  // namespace

ObjectSplit best_object_split(std::span<const Reference> references, const Bounds& bounds) {
    std::array<Binning, 3> binning;
    std::array<bool, 3> usable{};
    for (int axis = 0; axis < 3; ++axis) {
        binning[axis] = Binning::along(bounds.centres, axis);
        usable[axis] = binning[axis].is_usable();
    }
    std::array<Bins, 3> filled;
    for (const Reference& reference : references) {
        for (int axis = 0; axis < 3; ++axis) {
            if (usable[axis]) {
                Bin& bin = filled[axis][binning[axis].of(reference.box, axis)];
                join(bin.box, reference.box);
                ++bin.count;
            }
        }
    }
    ObjectSplit best;
    for (int axis = 0; axis < 3; ++axis) {
        if (usable[axis]) {
            sweep(filled[axis], axis, references.size(), best);
        }
    }
    return best;
}

void halve_by_centre(std::span<Reference> references, const Bounds& bounds) {
    const int axis = longest_axis(bounds.centres);
    std::nth_element(references.begin(), references.begin() + static_cast<std::ptrdiff_t>(references.size() / 2),
                     references.end(), [&](const Reference& a, const Reference& b) {
                         const float x = centre(a.box, axis), y = centre(b.box, axis);
                         return x < y || (x == y && a.primitive < b.primitive);
                     });
}

}  // namespace pt::builder
