#include "variants/builder/sah_binned.h"

#include <algorithm>
#include <array>

#include "variants/acceleration/box.h"
#include "variants/acceleration/depth.h"
#include "variants/acceleration/reasons.h"
#include "variants/builder/node_slots.h"
#include "variants/builder/primitive_count.h"
#include "variants/registry.h"

namespace pt::builder::sah_binned {

namespace {

constexpr int bins = 16;
constexpr std::uint32_t task_size = 4096;  // references below which a subtree is one thread's

// A primitive's box travels with its number: the passes over a node read memory in order.
struct Reference {
    Box box;
    std::uint32_t primitive;
};

struct Bounds {
    Box box, centres;

    void add(const Box& other) {
        join(box, other);
        join(centres, centre_box(other));
    }
};

struct Bin {
    Box box;
    std::uint32_t count = 0;
};

// Which bin along an axis: monotone in the centre.
struct Binning {
    float low, scale;

    static Binning along(const Box& centres, int axis) {
        const float extent = centres.high[axis] - centres.low[axis];
        return {centres.low[axis], static_cast<float>(bins) * (1 - 0x1p-20f) / extent};
    }
    int of(const Box& box, int axis) const {
        return std::clamp(static_cast<int>((centre(box, axis) - low) * scale), 0, bins - 1);
    }
    // A scale that overflows would make numbers that no bin has.
    bool is_usable() const { return scale > 0 && scale < std::numeric_limits<float>::max(); }
};

struct Split {
    double cost = std::numeric_limits<double>::infinity();  // of the children's primitives, times area
    int axis = -1;
    int first_right = 0;  // bin
};

class Builder {
public:
    Builder(const PrimitiveBoxes& boxes, std::uint32_t leaf_size, const SahCosts& costs)
        : leaf_size_(std::max(leaf_size, 1u)), costs_(costs), references_(boxes.size()), slots_(2 * boxes.size()) {
        for (std::uint32_t i = 0; i < boxes.size(); ++i) {
            references_[i] = {boxes[i], i};
        }
    }

    BinaryTree build() {
        Bounds all;
        for (const Reference& reference : references_) {
            all.add(reference.box);
        }
#pragma omp parallel
#pragma omp single
        node(0, 0, static_cast<std::uint32_t>(references_.size()), all, 0);
        BinaryTree tree;
        tree.nodes = pack(slots_);
        tree.references.resize(references_.size());
        for (std::size_t i = 0; i < references_.size(); ++i) {
            tree.references[i] = references_[i].primitive;
        }
        return tree;
    }

private:
    void node(std::uint32_t slot, std::uint32_t begin, std::uint32_t end, const Bounds& bounds, std::uint32_t depth) {
        const std::uint32_t count = end - begin;
        const Split split = may_split_unevenly(depth, count) ? best_split(begin, end, bounds) : Split{};
        const double area = half_area(bounds.box);
        const bool pays = split.axis >= 0 && costs_.traversal * area + split.cost < costs_.intersection * count * area;
        if (count == 1 || (count <= leaf_size_ && !pays)) {
            slots_[slot] = {bounds.box, begin, count};
            return;
        }
        std::array<Bounds, 2> halves;
        const std::uint32_t middle =
            split.axis >= 0 ? partition(begin, end, bounds, split, halves) : halve(begin, end, bounds, halves);
        const std::uint32_t child = child_slot(middle);
        slots_[slot] = {bounds.box, child, 0};
#pragma omp task if (count > task_size) firstprivate(halves)
        node(child, begin, middle, halves[0], depth + 1);
        node(child + 1, middle, end, halves[1], depth + 1);
    }

    Split best_split(std::uint32_t begin, std::uint32_t end, const Bounds& bounds) const {
        std::array<Binning, 3> binning;
        std::array<bool, 3> usable{};
        for (int axis = 0; axis < 3; ++axis) {
            binning[axis] = Binning::along(bounds.centres, axis);
            usable[axis] = binning[axis].is_usable();
        }
        std::array<std::array<Bin, bins>, 3> filled;
        for (std::uint32_t i = begin; i < end; ++i) {
            const Box& box = references_[i].box;
            for (int axis = 0; axis < 3; ++axis) {
                if (usable[axis]) {
                    Bin& bin = filled[axis][binning[axis].of(box, axis)];
                    join(bin.box, box);
                    ++bin.count;
                }
            }
        }
        Split best;
        for (int axis = 0; axis < 3; ++axis) {
            if (usable[axis]) {
                sweep(filled[axis], axis, best);
            }
        }
        return best;
    }

    void sweep(const std::array<Bin, bins>& filled, int axis, Split& best) const {
        std::array<double, bins> right_cost;
        Bin right;
        for (int i = bins - 1; i > 0; --i) {
            join(right.box, filled[i].box);
            right.count += filled[i].count;
            right_cost[i] = half_area(right.box) * right.count;
        }
        Bin left;
        for (int i = 1; i < bins; ++i) {
            join(left.box, filled[i - 1].box);
            left.count += filled[i - 1].count;
            const double cost = costs_.intersection * (half_area(left.box) * left.count + right_cost[i]);
            if (left.count > 0 && left.count < count_of(filled) && cost < best.cost) {
                best = {cost, axis, i};
            }
        }
    }

    static std::uint32_t count_of(const std::array<Bin, bins>& filled) {
        std::uint32_t count = 0;
        for (const Bin& bin : filled) {
            count += bin.count;
        }
        return count;
    }

    std::uint32_t partition(std::uint32_t begin, std::uint32_t end, const Bounds& bounds, const Split& split,
                            std::array<Bounds, 2>& halves) {
        const Binning binning = Binning::along(bounds.centres, split.axis);
        std::uint32_t left = begin, right = end;
        while (left < right) {
            if (binning.of(references_[left].box, split.axis) < split.first_right) {
                halves[0].add(references_[left++].box);
            } else {
                std::swap(references_[left], references_[--right]);
                halves[1].add(references_[right].box);
            }
        }
        return left;
    }

    // By number, in the order of the centres along their longest axis: where no plane parts the centres, or where the
    // depth is running out.
    std::uint32_t halve(std::uint32_t begin, std::uint32_t end, const Bounds& bounds, std::array<Bounds, 2>& halves) {
        const std::uint32_t middle = begin + (end - begin) / 2;
        const int axis = longest_axis(bounds.centres);
        std::nth_element(references_.begin() + begin, references_.begin() + middle, references_.begin() + end,
                         [&](const Reference& a, const Reference& b) {
                             const float x = centre(a.box, axis), y = centre(b.box, axis);
                             return x < y || (x == y && a.primitive < b.primitive);
                         });
        for (std::uint32_t i = begin; i < end; ++i) {
            halves[i < middle ? 0 : 1].add(references_[i].box);
        }
        return middle;
    }

    std::uint32_t leaf_size_;
    SahCosts costs_;
    std::vector<Reference> references_;
    std::vector<BinaryTree::Node> slots_;
};

}  // namespace

BinaryTree build(const PrimitiveBoxes& boxes, std::uint32_t leaf_size, const SahCosts& costs) {
    require_primitive_count(boxes.size());
    return boxes.empty() ? BinaryTree{} : Builder(boxes, leaf_size, costs).build();
}

namespace {

const Registration registration(
    {
        .axis = "builder",
        .name = "sah_binned",
        .summary = "top down, the best of 16 planes an axis by the surface area heuristic",
        .origin = "Wald 2007",
        .baseline = on_every_backend,
        .backends = on_every_backend,
    },
    {.builder = {[](const PrimitiveBoxes& boxes, std::span<const Triangle<float>>) { return build(boxes); }}});

}  // namespace

}  // namespace pt::builder::sah_binned
