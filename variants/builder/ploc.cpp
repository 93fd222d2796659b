#include "variants/builder/ploc.h"

#include <algorithm>

#include "variants/builder/morton_order.h"
#include "variants/builder/primitive_count.h"
#include "variants/bvh/box.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::builder::ploc {

namespace {

struct Cluster {
    Box box;
    std::uint32_t node;
};

// Returns the neighbour of cluster i whose joint bounding box with it has the least surface, of several the one whose
// number j has the least i ^ j. This orders all pairs, so at least one pair choose each other, and where all boxes are
// equal all pairs do.
std::uint32_t nearest(const std::vector<Cluster>& clusters, std::uint32_t i, std::uint32_t radius) {
    const auto last = static_cast<std::uint32_t>(std::min<std::size_t>(std::size_t(i) + radius, clusters.size() - 1));
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t chosen = i;
    for (std::uint32_t j = i - std::min(i, radius); j <= last; ++j) {
        if (j != i) {
            const double area = half_area(joined(clusters[i].box, clusters[j].box));
            if (chosen == i || area < least || (area == least && (i ^ j) < (i ^ chosen))) {
                least = area;
                chosen = j;
            }
        }
    }
    return chosen;
}

// Merges the pairs of clusters that chose each other; a union takes the place of the pair's first cluster.
void merge(std::vector<Cluster>& clusters, const std::vector<std::uint32_t>& neighbour, std::uint32_t leaves,
           Pairing& pairing) {
    std::size_t kept = 0;
    for (std::uint32_t i = 0; i < neighbour.size(); ++i) {
        const std::uint32_t j = neighbour[i];
        if (neighbour[j] != i) {
            clusters[kept++] = clusters[i];
        } else if (i < j) {
            const auto inner = static_cast<std::uint32_t>(leaves + pairing.left.size());
            pairing.left.push_back(clusters[i].node);
            pairing.right.push_back(clusters[j].node);
            clusters[kept++] = {joined(clusters[i].box, clusters[j].box), inner};
        }
    }
    clusters.resize(kept);
}

}  // namespace

Pairing pair(const PrimitiveBoxes& boxes, std::uint32_t radius) {
    require_primitive_count(boxes.size());
    const std::vector<std::uint64_t> keys = morton_keys(boxes);
    const auto leaves = static_cast<std::uint32_t>(keys.size());
    Pairing pairing;
    std::vector<Cluster> clusters;
    for (const std::uint64_t key : keys) {
        clusters.push_back({boxes[primitive_of(key)], static_cast<std::uint32_t>(pairing.leaf.size())});
        pairing.leaf.push_back(primitive_of(key));
    }
    std::vector<std::uint32_t> neighbour;
    while (clusters.size() > 1) {
        neighbour.resize(clusters.size());
#pragma omp parallel for schedule(dynamic, 4096)
        for (std::size_t i = 0; i < clusters.size(); ++i) {
            neighbour[i] = nearest(clusters, static_cast<std::uint32_t>(i), std::max(radius, 1u));
        }
        merge(clusters, neighbour, leaves, pairing);
    }
    pairing.root = clusters.empty() ? 0 : clusters[0].node;
    return pairing;
}

BinaryTree build(const PrimitiveBoxes& boxes, std::uint32_t leaf_size, const SahCosts& costs, std::uint32_t radius) {
    return assemble(pair(boxes, radius), boxes, leaf_size, costs);
}

namespace {

const Registration registration(
    {
        .axis = "builder",
        .name = "ploc",
        .summary = "bottom up: clusters that are each other's nearest among their neighbours in Morton order merge",
        .origin = "Meister and Bittner 2018",
        .backends = on_every_backend,
        .unsupported_reason = needs_tree,
    },
    {.builder = {[](const PrimitiveBoxes& boxes, std::span<const Triangle<float>>) { return build(boxes); }}});

}  // namespace

}  // namespace pt::builder::ploc
