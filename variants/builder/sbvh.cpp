#include "variants/builder/sbvh.h"

#include <algorithm>
#include <memory>

#include "variants/builder/primitive_count.h"
#include "variants/builder/spatial_split.h"
#include "variants/bvh/depth.h"
#include "variants/bvh/primitive_boxes.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::builder::sbvh {

namespace {

constexpr std::size_t task_size = 1024;  // most references of a subtree that is built without an OpenMP task

using References = std::vector<Reference>;

struct Subtree {
    Box box;
    std::vector<std::uint32_t> primitives;  // numbers of the subtree's primitives if it is one leaf
    std::unique_ptr<Subtree> children[2];
};

double overlap_area(const Box& a, const Box& b) {
    Box common;
    for (int axis = 0; axis < 3; ++axis) {
        common.low[axis] = max(a.low[axis], b.low[axis]);
        common.high[axis] = min(a.high[axis], b.high[axis]);
        if (common.low[axis] > common.high[axis]) {
            return 0;
        }
    }
    return half_area(common);
}

class Builder {
public:
    Builder(std::span<const Triangle<float>> triangles, const Settings& settings)
        : triangles_(triangles), settings_(settings) {
        settings_.leaf_size = std::max(settings_.leaf_size, 1u);
    }

    BinaryTree build() {
        References all;
        for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
            all.push_back({box_of(triangles_[i]), i});
        }
        root_area_ = half_area(Bounds::of(all).box);
        const auto spare = static_cast<std::size_t>(settings_.duplicates * static_cast<double>(all.size()));
        require_primitive_count(all.size() + spare);
        Subtree root;
#pragma omp parallel
#pragma omp single
        node(root, std::move(all), spare, 0);
        BinaryTree tree;
        tree.nodes.emplace_back();
        flatten(root, 0, tree);
        return tree;
    }

private:
    // Builds a subtree. `spare`: how many duplicate references it may still make; children share what is left in
    // proportion to their references.
    void node(Subtree& subtree, References references, std::size_t spare, std::uint32_t depth) {
        const Bounds bounds = Bounds::of(references);
        const std::size_t count = references.size();
        const double area = half_area(bounds.box);
        subtree.box = bounds.box;
        ObjectSplit object;
        SpatialSplit spatial;
        if (count > 1 && area > 0 && may_split_unevenly(depth, count)) {
            object = best_object_split(references, bounds);
            const bool overlaps =
                object.axis < 0 || overlap_area(object.left, object.right) > settings_.overlap * root_area_;
            if (overlaps && spare > 0) {
                spatial = best_spatial_split(triangles_, references, bounds.box);
                const std::size_t parted = std::size_t(spatial.left.count) + spatial.right.count;
                if (spatial.axis >= 0 && parted > count + spare) {
                    spatial = {};
                }
            }
        }
        const double cost = std::min(object.cost, spatial.cost);
        if (count == 1 || (count <= settings_.leaf_size && !split_pays(settings_.costs, area, count, cost))) {
            for (const Reference& reference : references) {
                subtree.primitives.push_back(reference.primitive);
            }
            return;
        }
        References left, right;
        if (spatial.cost < object.cost) {
            part_references(references, spatial, left, right);
        } else if (object.axis >= 0) {
            const Binning binning = Binning::along(bounds.centres, object.axis);
            for (const Reference& reference : references) {
                (binning.of(reference.box, object.axis) < object.first_right ? left : right).push_back(reference);
            }
        }
        if (left.empty() || right.empty()) {
            halve_by_centre(references, bounds);
            const auto middle = references.begin() + static_cast<std::ptrdiff_t>(count / 2);
            left.assign(references.begin(), middle);
            right.assign(middle, references.end());
        }
        References().swap(references);
        const std::size_t spare_below = spare - (left.size() + right.size() - count);
        descend(subtree, std::move(left), std::move(right), spare_below, depth);
    }

    void descend(Subtree& subtree, References left, References right, std::size_t spare, std::uint32_t depth) {
        const std::size_t both = left.size() + right.size(), spare_left = spare * left.size() / both;
        subtree.children[0] = std::make_unique<Subtree>();
        subtree.children[1] = std::make_unique<Subtree>();
        Subtree &first = *subtree.children[0], &second = *subtree.children[1];
        if (left.size() > task_size) {
            auto* moved = new References(std::move(left));
#pragma omp task firstprivate(moved, spare_left, depth) shared(first)
            {
                const std::unique_ptr<References> mine(moved);
                node(first, std::move(*mine), spare_left, depth + 1);
            }
            node(second, std::move(right), spare - spare_left, depth + 1);
#pragma omp taskwait
        } else {
            node(first, std::move(left), spare_left, depth + 1);
            node(second, std::move(right), spare - spare_left, depth + 1);
        }
    }

    // Parts a node's references by a plane. The reference to a triangle across the plane goes whole to one side where
    // that is cheaper ("reference unsplitting", Stich et al., section 4.4).
    void part_references(const References& references, const SpatialSplit& split, References& left,
                         References& right) const {
        Bin a = split.left, b = split.right;
        for (const Reference& reference : references) {
            auto [below, above] = part(triangles_[reference.primitive], reference.box, split.axis, split.plane);
            const bool only_right = reference.box.low[split.axis] >= split.plane || is_empty(below);
            const bool only_left = !only_right && (reference.box.high[split.axis] <= split.plane || is_empty(above));
            if (only_left || only_right) {
                (only_left ? left : right).push_back(reference);
                continue;
            }
            const Box grown_a = joined(a.box, reference.box), grown_b = joined(b.box, reference.box);
            const double both = half_area(a.box) * a.count + half_area(b.box) * b.count;
            const double whole_left = half_area(grown_a) * a.count + half_area(b.box) * (b.count - 1);
            const double whole_right = half_area(a.box) * (a.count - 1) + half_area(grown_b) * b.count;
            if (both <= whole_left && both <= whole_right) {
                left.push_back({below, reference.primitive});
                right.push_back({above, reference.primitive});
            } else if (whole_left <= whole_right) {
                a.box = grown_a;
                --b.count;
                left.push_back(reference);
            } else {
                b.box = grown_b;
                --a.count;
                right.push_back(reference);
            }
        }
    }

    static void flatten(const Subtree& subtree, std::uint32_t slot, BinaryTree& tree) {
        if (!subtree.children[0]) {
            const auto count = static_cast<std::uint32_t>(subtree.primitives.size());
            tree.nodes[slot] = {subtree.box, static_cast<std::uint32_t>(tree.references.size()), count};
            tree.references.insert(tree.references.end(), subtree.primitives.begin(), subtree.primitives.end());
            return;
        }
        const auto child = static_cast<std::uint32_t>(tree.nodes.size());
        tree.nodes[slot] = {subtree.box, child, 0};
        tree.nodes.resize(child + 2);
        flatten(*subtree.children[0], child, tree);
        flatten(*subtree.children[1], child + 1, tree);
    }

    std::span<const Triangle<float>> triangles_;
    Settings settings_;
    double root_area_ = 0;
};

}  // namespace

BinaryTree build(std::span<const Triangle<float>> triangles, const Settings& settings) {
    return triangles.empty() ? BinaryTree{} : Builder(triangles, settings).build();
}

namespace {

const Registration registration(
    {
        .axis = "builder",
        .name = "sbvh",
        .summary = "top down by the surface area heuristic, with spatial splits of triangles",
        .origin = "Stich, Friedrich and Dietrich 2009",
        .traits = BuilderTraits{.splits_primitives = true},
        .backends = on_every_backend,
        .unsupported_reason = needs_tree,
    },
    {.builder = {[](const PrimitiveBoxes&, std::span<const Triangle<float>> triangles) { return build(triangles); }}});

}  // namespace

}  // namespace pt::builder::sbvh
