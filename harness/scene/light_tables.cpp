#include "harness/scene/light_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace pt {

namespace {

constexpr std::uint64_t whole_slot = std::uint64_t{1} << 32;

double largest_power(std::span<const LightExtent> lights) {
    double largest = 0;
    for (const LightExtent& light : lights) {
        largest = std::max(largest, light.power);
    }
    return largest;
}

bool has_known_power(std::span<const LightExtent> lights) {
    const double power = largest_power(lights);
    return power > 0 && std::isfinite(power);
}

// Selection probabilities of the lights in proportion to their power; equal if no power is known.
std::vector<double> power_shares(std::span<const LightExtent> lights) {
    const double largest = largest_power(lights);
    const bool is_known = has_known_power(lights);
    std::vector<double> shares;
    for (const LightExtent& light : lights) {
        shares.push_back(is_known ? std::max(light.power / largest, 0x1p-100) : 1);
    }
    const double total = std::accumulate(shares.begin(), shares.end(), 0.0);
    for (double& share : shares) {
        share /= total;
    }
    return shares;
}

double sum_of(const Vec3d& v) { return v.x + v.y + v.z; }

// Share of each light in the sum over all lights of projected area times radiance, by axis; equal if no power is known.
std::vector<Vec3d> shown_shares(std::span<const LightExtent> lights) {
    const double largest = largest_power(lights);
    const bool is_known = has_known_power(lights);
    std::vector<Vec3d> shares;
    double total = 0;
    for (const LightExtent& light : lights) {
        shares.push_back(is_known ? light.shown / largest : Vec3d(1.0));
        total += sum_of(shares.back());
    }
    for (Vec3d& share : shares) {
        share = share / total;
    }
    return shares;
}

// Converts lights' selection probabilities to whole numbers that add up to one full slot of the alias table per light.
// The rounding error goes to the largest.
std::vector<std::uint64_t> slot_masses(const std::vector<double>& shares) {
    const double total = static_cast<double>(shares.size()) * static_cast<double>(whole_slot);
    std::vector<std::uint64_t> masses;
    for (const double share : shares) {
        masses.push_back(std::max<std::uint64_t>(static_cast<std::uint64_t>(share * total), 1));
    }
    const std::uint64_t sum = std::accumulate(masses.begin(), masses.end(), std::uint64_t{0});
    *std::max_element(masses.begin(), masses.end()) += shares.size() * whole_slot - sum;
    return masses;
}

template <class Real>
std::vector<LightSlot<Real>> alias_table(const std::vector<double>& shares) {
    std::vector<std::uint64_t> left = slot_masses(shares);
    const double total = static_cast<double>(shares.size()) * static_cast<double>(whole_slot);
    std::vector<LightSlot<Real>> slots(shares.size());
    std::vector<std::uint32_t> small, large;
    for (std::uint32_t i = 0; i < slots.size(); ++i) {
        slots[i] = {0, i, static_cast<Real>(total / static_cast<double>(left[i])), 0};
        (left[i] < whole_slot ? small : large).push_back(i);
    }
    while (!small.empty() && !large.empty()) {
        const std::uint32_t taker = small.back(), giver = large.back();
        small.pop_back();
        slots[taker].threshold = static_cast<std::uint32_t>(left[taker]);
        slots[taker].alias = giver;
        left[giver] -= whole_slot - left[taker];
        if (left[giver] < whole_slot) {
            large.pop_back();
            small.push_back(giver);
        }
    }
    return slots;
}

double surface_of(const Bounds<double>& bounds) {
    const Vec3d size = bounds.high - bounds.low;
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

Vec3d centre_of(const Bounds<double>& bounds) { return (bounds.low + bounds.high) * 0.5; }

// A group of lights that are neighbours in the order of the light tree.
struct Cluster {
    Bounds<double> bounds{Vec3d(std::numeric_limits<double>::infinity()),
                          Vec3d(-std::numeric_limits<double>::infinity())};
    Vec3d shown{0, 0, 0};

    void add(const Cluster& other) {
        for (int axis = 0; axis < 3; ++axis) {
            bounds.low[axis] = std::min(bounds.low[axis], other.bounds.low[axis]);
            bounds.high[axis] = std::max(bounds.high[axis], other.bounds.high[axis]);
        }
        shown += other.shown;
    }
    // Split cost of a cluster of lights, by its bounding box's surface: a flat box has a surface too, a line has none.
    double cost() const { return sum_of(shown) > 0 ? sum_of(shown) * surface_of(bounds) : 0; }
};

template <class Real>
class LightTreeBuilder {
public:
    LightTreeBuilder(std::span<const LightExtent> lights, LightTables<Real>& tables)
        : lights_(lights), shown_(shown_shares(lights)), tables_(&tables), order_(lights.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
    }

    void build() {
        tables_->nodes.reserve(2 * order_.size());
        const Range all{0, static_cast<std::uint32_t>(order_.size())};
        scale_ = scale_for(cluster_of(all).bounds);
        tables_->nodes.push_back(node_of(all));
        fill(0, all, 0, 0);
    }

private:
    struct Range {
        std::uint32_t begin, end;
        std::uint32_t size() const { return end - begin; }
    };

    // Scale of the projected areas in light tree nodes: the square of the lights' extent, rounded to a power of two, so
    // that sums of estimated contributions are near 1, where Shares (kernels/light_selection.h) resolve them. Products
    // of scale and distance must stay in float's range, so for an extent below 1 the scale is the extent itself, and
    // from 2^39 on 2^115 over the extent.
    static double scale_for(const Bounds<double>& bounds) {
        const Vec3d size = bounds.high - bounds.low;
        const double extent = std::max({size.x, size.y, size.z});
        const int exponent = extent > 0 ? std::clamp(std::ilogb(extent), -60, 60) : 0;
        return std::exp2(exponent < 0 ? exponent : std::min(2 * exponent, 115 - exponent));
    }

    Cluster single(std::uint32_t light) const { return {lights_[light].bounds, shown_[light]}; }
    double place(std::uint32_t light, int axis) const { return centre_of(lights_[light].bounds)[axis]; }

    Cluster cluster_of(Range range) const {
        Cluster all;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            all.add(single(order_[i]));
        }
        return all;
    }

    LightNode<Real> node_of(Range range) const {
        const Cluster all = cluster_of(range);
        const Vec3d half = (all.bounds.high - all.bounds.low) * 0.5;
        LightNode<Real> made{};
        for (int axis = 0; axis < 3; ++axis) {
            made.centre[axis] = static_cast<Real>(centre_of(all.bounds)[axis]);
            made.half[axis] = static_cast<Real>(half[axis]);
            made.shown[axis] = static_cast<Real>(all.shown[axis] * scale_);
        }
        made.least_square = static_cast<Real>(std::max(dot(half, half), 0x1p-100));
        return made;
    }

    void fill(std::uint32_t node, Range range, std::uint32_t level, std::uint32_t way) {
        if (range.size() == 1) {
            const std::uint32_t light = order_[range.begin];
            tables_->nodes[node].link = light | LightNode<Real>::leaf_bit;
            tables_->slots[light].way = way;
            return;
        }
        const std::vector<Range> children = divide(range, level);
        const std::uint32_t first = static_cast<std::uint32_t>(tables_->nodes.size());
        tables_->nodes[node].link = first;
        tables_->nodes[node].child_count = static_cast<std::uint32_t>(children.size());
        for (const Range& child : children) {
            tables_->nodes.push_back(node_of(child));
        }
        for (std::uint32_t i = 0; i < children.size(); ++i) {
            fill(first + i, children[i], level + 1, way | (i << (4 * level)));
        }
    }

    // Splits a light tree node's lights into up to 16 children by repeatedly splitting the part of highest cost. If a
    // child could not hold so many lights within the levels left, all parts are halved instead.
    std::vector<Range> divide(Range range, std::uint32_t level) {
        constexpr std::uint32_t most = LightNode<Real>::most_children;
        const std::uint64_t below = std::uint64_t{1} << (4 * (LightNode<Real>::most_levels - 1 - level));
        const bool may_be_uneven = range.size() <= below;
        std::vector<Range> parts{range};
        std::vector<double> costs{1};
        const auto cost_of = [&](Range part) {
            const double cost = may_be_uneven ? cluster_of(part).cost() : part.size();
            return part.size() == 1 ? -1 : cost;
        };
        while (parts.size() < most) {
            const std::size_t opened =
                static_cast<std::size_t>(std::max_element(costs.begin(), costs.end()) - costs.begin());
            if (costs[opened] < 0) {
                break;
            }
            const Range part = parts[opened];
            const std::uint32_t middle = may_be_uneven ? split(part) : halved(part);
            const Range halves[] = {{part.begin, middle}, {middle, part.end}};
            parts[opened] = halves[0];
            costs[opened] = cost_of(halves[0]);
            parts.push_back(halves[1]);
            costs.push_back(cost_of(halves[1]));
        }
        return parts;
    }

    // Partitions a range of lights at the best cut of all axes and returns where the second half begins.
    std::uint32_t split(Range range) {
        Cut best;
        for (int axis = 0; axis < 3; ++axis) {
            const Cut cut = best_cut(range, axis);
            best = cut.cost < best.cost ? cut : best;
        }
        if (best.axis < 0) {
            return halved(range);
        }
        const auto is_first = [&](std::uint32_t light) { return bin_of(light, best) <= best.last_bin; };
        const auto begin = order_.begin() + range.begin;
        return range.begin +
               static_cast<std::uint32_t>(std::stable_partition(begin, order_.begin() + range.end, is_first) - begin);
    }

    struct Cut {
        double cost = std::numeric_limits<double>::infinity();
        int axis = -1;
        std::uint32_t last_bin = 0;
        double low = 0, bins_by_length = 0;
    };
    static constexpr std::uint32_t bins = 12;

    std::uint32_t bin_of(std::uint32_t light, const Cut& cut) const {
        const double bin = (place(light, cut.axis) - cut.low) * cut.bins_by_length;
        return std::min(static_cast<std::uint32_t>(std::max(bin, 0.0)), bins - 1);
    }

    Cut best_cut(Range range, int axis) const {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            low = std::min(low, place(order_[i], axis));
            high = std::max(high, place(order_[i], axis));
        }
        Cut best;
        if (!(high - low > 0) || !std::isfinite(bins / (high - low))) {
            return best;
        }
        Cut cut{0, axis, 0, low, bins / (high - low)};
        std::array<Cluster, bins> in_bin;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            in_bin[bin_of(order_[i], cut)].add(single(order_[i]));
        }
        std::array<double, bins> cost_after{};
        Cluster after, before;
        for (std::uint32_t bin = bins - 1; bin > 0; --bin) {
            after.add(in_bin[bin]);
            cost_after[bin - 1] = after.cost();
        }
        for (std::uint32_t bin = 0; bin + 1 < bins; ++bin) {
            before.add(in_bin[bin]);
            cut.cost = before.cost() + cost_after[bin];
            cut.last_bin = bin;
            best = cut.cost < best.cost ? cut : best;
        }
        return best;
    }

    // Halves a range of lights at the median along its longest axis; used if no cut is known or levels run out.
    std::uint32_t halved(Range range) {
        Cluster centres;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const Vec3d centre = centre_of(lights_[order_[i]].bounds);
            centres.add({{centre, centre}, Vec3d(0.0)});
        }
        const Vec3d size = centres.bounds.high - centres.bounds.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        std::stable_sort(order_.begin() + range.begin, order_.begin() + range.end,
                         [&](std::uint32_t a, std::uint32_t b) { return place(a, axis) < place(b, axis); });
        return range.begin + range.size() / 2;
    }

    std::span<const LightExtent> lights_;
    std::vector<Vec3d> shown_;
    LightTables<Real>* tables_;
    std::vector<std::uint32_t> order_;
    // Scale of the projected areas in light tree nodes. Contributions fall with the squared distance, and in some units
    // of length their sums would be so near 0 or infinity that Shares could not make probabilities of them.
    double scale_ = 1;
};

}  // namespace

template <class Real>
LightTables<Real> light_tables(std::span<const LightExtent> lights) {
    LightTables<Real> tables;
    if (lights.empty()) {
        return tables;
    }
    tables.slots = alias_table<Real>(power_shares(lights));
    LightTreeBuilder<Real>(lights, tables).build();
    return tables;
}

template LightTables<float> light_tables(std::span<const LightExtent> lights);
template LightTables<double> light_tables(std::span<const LightExtent> lights);

}  // namespace pt
