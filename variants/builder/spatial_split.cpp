#include "variants/builder/spatial_split.h"

#include <cmath>

namespace pt::builder {

namespace {

constexpr int bins = 16;

struct SpatialBin {
    Box box;  // bounding box of the parts of triangles that lie in one bin of a spatial split
    std::uint32_t entering = 0, leaving = 0;
};

void join_point(Box& box, const Vec3<float>& point) {
    for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = min(box.low[axis], point[axis]);
        box.high[axis] = max(box.high[axis], point[axis]);
    }
}

// The point where a triangle's edge crosses a plane, as a box rounded outward. It is found in double precision, whose
// own error is far below the margin of the box.
Box crossing(const Vec3<float>& from, const Vec3<float>& to, int axis, float plane) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const double t = (static_cast<double>(plane) - from[axis]) / (static_cast<double>(to[axis]) - from[axis]);
    Box box;
    for (int other = 0; other < 3; ++other) {
        const double a = from[other], b = to[other];
        const double at = a + t * (b - a), nudge = 0x1p-48 * (std::fabs(a) + std::fabs(b));
        const auto low = static_cast<float>(at - nudge), high = static_cast<float>(at + nudge);
        box.low[other] = low > at - nudge ? std::nextafter(low, -infinity) : low;
        box.high[other] = high < at + nudge ? std::nextafter(high, infinity) : high;
    }
    return box;
}

Box overlap(const Box& a, const Box& b) {
    Box common;
    for (int axis = 0; axis < 3; ++axis) {
        common.low[axis] = max(a.low[axis], b.low[axis]);
        common.high[axis] = min(a.high[axis], b.high[axis]);
        if (common.low[axis] > common.high[axis]) {
            return {};
        }
    }
    return common;
}

// Candidate planes of spatial splits, which lie between bins at low + step, low + 2 step and so on. A plane that
// rounding puts outside of (low, high) is left out.
struct Planes {
    float low, step;

    static Planes along(const Box& box, int axis) {
        return {box.low[axis], (box.high[axis] - box.low[axis]) / static_cast<float>(bins)};
    }
    float at(int bin) const { return low + step * static_cast<float>(bin); }
    // Returns the bin of coordinate x in a spatial split, found by comparison with the candidate planes themselves.
    int bin_of(float x) const {
        int bin = std::clamp(static_cast<int>((x - low) / step), 0, bins - 1);
        while (bin > 0 && x < at(bin)) {
            --bin;
        }
        while (bin < bins - 1 && x >= at(bin + 1)) {
            ++bin;
        }
        return bin;
    }
    bool is_usable() const { return step > 0 && at(1) > low && step < std::numeric_limits<float>::max(); }
};

void fill(SpatialBin (&filled)[bins], const Triangle<float>& triangle, const Box& box, int axis, const Planes& planes) {
    const int first = planes.bin_of(box.low[axis]), last = planes.bin_of(box.high[axis]);
    Box rest = box;
    for (int bin = first; bin < last; ++bin) {
        const auto [left, right] = part(triangle, rest, axis, planes.at(bin + 1));
        join(filled[bin].box, left);
        rest = right;
    }
    join(filled[last].box, rest);
    ++filled[first].entering;
    ++filled[last].leaving;
}

void sweep(const SpatialBin (&filled)[bins], std::size_t count, int axis, const Planes& planes, SpatialSplit& best) {
    Bin right[bins];
    for (int i = bins - 1; i > 0; --i) {
        right[i] = i + 1 < bins ? right[i + 1] : Bin{};
        join(right[i].box, filled[i].box);
        right[i].count += filled[i].leaving;
    }
    Bin left;
    for (int i = 1; i < bins; ++i) {
        join(left.box, filled[i - 1].box);
        left.count += filled[i - 1].entering;
        const double cost = half_area(left.box) * left.count + half_area(right[i].box) * right[i].count;
        // A split that gives one child all references is refused, since the recursion would not end.
        if (cost < best.cost && left.count < count && right[i].count < count) {
            best = {cost, axis, planes.at(i), left, right[i]};
        }
    }
}

}  // namespace

std::pair<Box, Box> part(const Triangle<float>& triangle, const Box& box, int axis, float plane) {
    Box left, right;
    const Vec3<float> corner[3] = {triangle.a, triangle.b, triangle.c};
    for (int i = 0; i < 3; ++i) {
        const Vec3<float>&from = corner[i], &to = corner[(i + 1) % 3];
        if (from[axis] <= plane) {
            join_point(left, from);
        }
        if (from[axis] >= plane) {
            join_point(right, from);
        }
        if ((from[axis] < plane && to[axis] > plane) || (from[axis] > plane && to[axis] < plane)) {
            const Box point = crossing(from, to, axis, plane);
            join(left, point);
            join(right, point);
        }
    }
    left.high[axis] = min(left.high[axis], plane);
    right.low[axis] = max(right.low[axis], plane);
    return {overlap(left, box), overlap(right, box)};
}

SpatialSplit best_spatial_split(std::span<const Triangle<float>> triangles, std::span<const Reference> references,
                                const Box& box) {
    SpatialSplit best;
    for (int axis = 0; axis < 3; ++axis) {
        const Planes planes = Planes::along(box, axis);
        if (!planes.is_usable()) {
            continue;
        }
        SpatialBin filled[bins];
        for (const Reference& reference : references) {
            fill(filled, triangles[reference.primitive], reference.box, axis, planes);
        }
        sweep(filled, references.size(), axis, planes, best);
    }
    return best;
}

}  // namespace pt::builder
