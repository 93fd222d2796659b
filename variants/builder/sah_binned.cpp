#include "variants/builder/sah_binned.h"

#include <algorithm>
#include <array>

#include "variants/builder/binned_split.h"
#include "variants/builder/node_slots.h"
#include "variants/builder/primitive_count.h"
#include "variants/bvh/depth.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::builder::sah_binned {

namespace {

constexpr std::uint32_t task_size = 4096;  // most references of a subtree that is built without an OpenMP task

class Builder {
public:
    Builder(const PrimitiveBoxes& boxes, std::uint32_t leaf_size, const SahCosts& costs)
        : leaf_size_(std::max(leaf_size, 1u)), costs_(costs), references_(boxes.size()), slots_(2 * boxes.size()) {
        for (std::uint32_t i = 0; i < boxes.size(); ++i) {
            references_[i] = {boxes[i], i};
        }
    }

    BinaryTree build() {
        const Bounds all = Bounds::of(references_);
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
        const std::span<Reference> mine(references_.data() + begin, count);
        const double area = half_area(bounds.box);
        ObjectSplit split;
        if (count > 1 && area > 0 && may_split_unevenly(depth, count)) {
            split = best_object_split(mine, bounds);
        }
        if (count == 1 || (count <= leaf_size_ && !split_pays(costs_, area, count, split.cost))) {
            slots_[slot] = {bounds.box, begin, count};
            return;
        }
        std::array<Bounds, 2> halves;
        std::uint32_t middle = begin + count / 2;
        if (split.axis >= 0) {
            middle = begin + partition(mine, bounds, split, halves);
        } else {
            halve_by_centre(mine, bounds);
            halves = {Bounds::of(mine.first(count / 2)), Bounds::of(mine.subspan(count / 2))};
        }
        const std::uint32_t child = child_slot(middle);
        slots_[slot] = {bounds.box, child, 0};
#pragma omp task if (count > task_size) firstprivate(halves)
        node(child, begin, middle, halves[0], depth + 1);
        node(child + 1, middle, end, halves[1], depth + 1);
    }

    static std::uint32_t partition(std::span<Reference> references, const Bounds& bounds, const ObjectSplit& split,
                                   std::array<Bounds, 2>& halves) {
        const Binning binning = Binning::along(bounds.centres, split.axis);
        std::size_t left = 0, right = references.size();
        while (left < right) {
            if (binning.of(references[left].box, split.axis) < split.first_right) {
                halves[0].add(references[left++].box);
            } else {
                std::swap(references[left], references[--right]);
                halves[1].add(references[right].box);
            }
        }
        return static_cast<std::uint32_t>(left);
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
