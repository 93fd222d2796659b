#include "variants/builder/sah_sweep.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "variants/builder/node_slots.h"
#include "variants/builder/primitive_count.h"
#include "variants/bvh/box.h"
#include "variants/bvh/depth.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::builder::sah_sweep {

namespace {

constexpr std::uint32_t task_size = 2048;  // most references of a subtree that is built without an OpenMP task

// A split of a node's references: the first `left` of them in the order of an axis go to the left child.
struct Split {
    double cost = std::numeric_limits<double>::infinity();  // sum over both children: half surface area x references
    int axis = 0;
    std::uint32_t left = 0;
};

// A tree builder whose references stay sorted along all axes from the root down: partitions of a node keep the orders.
class Builder {
public:
    Builder(const PrimitiveBoxes& boxes, std::uint32_t leaf_size, const SahCosts& costs)
        : boxes_(boxes),
          leaf_size_(std::max(leaf_size, 1u)),
          costs_(costs),
          right_costs_(boxes.size()),
          scratch_(boxes.size()),
          is_left_(boxes.size()),
          slots_(2 * boxes.size()) {}

    BinaryTree build() {
#pragma omp parallel for
        for (int axis = 0; axis < 3; ++axis) {
            sort(axis);
        }
#pragma omp parallel
#pragma omp single
        node(0, 0, static_cast<std::uint32_t>(boxes_.size()), 0);
        return {pack(slots_), std::move(order_[0])};
    }

private:
    void sort(int axis) {
        std::vector<std::uint32_t>& order = order_[axis];
        order.resize(boxes_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            const float x = centre(boxes_[a], axis), y = centre(boxes_[b], axis);
            return x < y || (x == y && a < b);
        });
    }

    void node(std::uint32_t slot, std::uint32_t begin, std::uint32_t end, std::uint32_t depth) {
        const std::uint32_t count = end - begin;
        Box box, centres;
        for (std::uint32_t i = begin; i < end; ++i) {
            join(box, boxes_[order_[0][i]]);
            join(centres, centre_box(boxes_[order_[0][i]]));
        }
        const double area = half_area(box);
        Split split;
        if (count > 1 && may_split_unevenly(depth, count)) {
            for (int axis = 0; axis < 3; ++axis) {
                sweep(begin, end, axis, split);
            }
        }
        // Where no partition is cheaper than a leaf, rounding aside, references are halved: equal boxes make all
        // partitions equally dear, and halves leave the lowest tree.
        if (!(split.cost < area * count * (1 - 1e-9))) {
            split.axis = longest_axis(centres);
            split.left = count / 2;
        }
        if (count == 1 || (count <= leaf_size_ && !split_pays(costs_, area, count, split.cost))) {
            slots_[slot] = {box, begin, count};
            return;
        }
        partition(begin, end, split);
        const std::uint32_t middle = begin + split.left, child = child_slot(middle);
        slots_[slot] = {box, child, 0};
#pragma omp task if (count > task_size)
        node(child, begin, middle, depth + 1);
        node(child + 1, middle, end, depth + 1);
    }

    void sweep(std::uint32_t begin, std::uint32_t end, int axis, Split& best) {
        const std::vector<std::uint32_t>& order = order_[axis];
        Box right, left;
        for (std::uint32_t i = end - 1; i > begin; --i) {
            join(right, boxes_[order[i]]);
            right_costs_[i] = half_area(right) * (end - i);
        }
        for (std::uint32_t i = begin + 1; i < end; ++i) {
            join(left, boxes_[order[i - 1]]);
            const double cost = half_area(left) * (i - begin) + right_costs_[i];
            if (cost < best.cost) {
                best = {cost, axis, i - begin};
            }
        }
    }

    void partition(std::uint32_t begin, std::uint32_t end, const Split& split) {
        for (std::uint32_t i = begin; i < end; ++i) {
            is_left_[order_[split.axis][i]] = i - begin < split.left ? 1 : 0;
        }
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<std::uint32_t>& order = order_[axis];
            std::uint32_t left = begin, right = begin;
            for (std::uint32_t i = begin; i < end; ++i) {
                if (is_left_[order[i]] != 0) {
                    order[left++] = order[i];
                } else {
                    scratch_[right++] = order[i];
                }
            }
            std::copy(scratch_.begin() + begin, scratch_.begin() + right, order.begin() + left);
        }
    }

    const PrimitiveBoxes& boxes_;
    std::uint32_t leaf_size_;
    SahCosts costs_;
    std::array<std::vector<std::uint32_t>, 3> order_;
    std::vector<double> right_costs_;
    std::vector<std::uint32_t> scratch_;
    std::vector<std::uint8_t> is_left_;  // by primitive: whether the current split puts it into the left child
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
        .name = "sah_sweep",
        .summary = "top down, the best by the surface area heuristic of all partitions in the order of centres",
        .origin = "Wald, Boulos and Shirley 2007",
        .backends = on_every_backend,
        .unsupported_reason = needs_tree,
    },
    {.builder = {[](const PrimitiveBoxes& boxes, std::span<const Triangle<float>>) { return build(boxes); }}});

}  // namespace

}  // namespace pt::builder::sah_sweep
