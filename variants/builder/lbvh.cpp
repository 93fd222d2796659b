#include "variants/builder/lbvh.h"

#include <algorithm>
#include <bit>

#include "variants/builder/morton_order.h"
#include "variants/builder/pairing.h"
#include "variants/builder/primitive_count.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::builder::lbvh {

namespace {

// Karras's radix tree over distinct keys, by the names of the paper: delta(i, j) is the length of the common prefix of
// keys i and j, -1 out of range.
class RadixTree {
public:
    explicit RadixTree(const std::vector<std::uint64_t>& keys)
        : keys_(keys), count_(static_cast<std::int64_t>(keys.size())) {}

    void children(std::int64_t i, std::uint32_t& left, std::uint32_t& right) const {
        const std::int64_t d = delta(i, i + 1) > delta(i, i - 1) ? 1 : -1;
        const std::int64_t j = i + length(i, d) * d;
        const std::int64_t middle = split(i, j, d);
        left = node(middle, std::min(i, j) == middle);
        right = node(middle + 1, std::max(i, j) == middle + 1);
    }

private:
    int delta(std::int64_t i, std::int64_t j) const {
        return j < 0 || j >= count_ ? -1 : std::countl_zero(keys_[i] ^ keys_[j]);
    }
    std::uint32_t node(std::int64_t i, bool is_leaf) const {
        return static_cast<std::uint32_t>(is_leaf ? i : count_ + i);
    }
    // The number of keys beyond key i, in direction d, that inner node i of the radix tree covers.
    std::int64_t length(std::int64_t i, std::int64_t d) const {
        const int delta_min = delta(i, i - d);
        std::int64_t longest = 2;
        while (delta(i, i + longest * d) > delta_min) {
            longest *= 2;
        }
        std::int64_t covered = 0;
        for (std::int64_t step = longest / 2; step >= 1; step /= 2) {
            if (delta(i, i + (covered + step) * d) > delta_min) {
                covered += step;
            }
        }
        return covered;
    }
    // Returns the last key that the left child of inner node i covers.
    std::int64_t split(std::int64_t i, std::int64_t j, std::int64_t d) const {
        const int delta_node = delta(i, j);
        std::int64_t covered = 0, step = (j - i) * d;
        do {
            step = (step + 1) / 2;
            if (delta(i, i + (covered + step) * d) > delta_node) {
                covered += step;
            }
        } while (step > 1);
        return i + covered * d + std::min<std::int64_t>(d, 0);
    }

    const std::vector<std::uint64_t>& keys_;
    std::int64_t count_;
};

}  // namespace

BinaryTree build(const PrimitiveBoxes& boxes, std::uint32_t leaf_size, const SahCosts& costs) {
    require_primitive_count(boxes.size());
    const std::vector<std::uint64_t> keys = morton_keys(boxes);
    const auto count = static_cast<std::int64_t>(keys.size()), inner = std::max<std::int64_t>(count - 1, 0);
    Pairing pairing;
    pairing.leaf.resize(keys.size());
    std::transform(keys.begin(), keys.end(), pairing.leaf.begin(), &primitive_of);
    pairing.left.resize(static_cast<std::size_t>(inner));
    pairing.right.resize(static_cast<std::size_t>(inner));
    pairing.root = static_cast<std::uint32_t>(count > 1 ? count : 0);
    const RadixTree radix(keys);
#pragma omp parallel for
    for (std::int64_t i = 0; i < inner; ++i) {
        radix.children(i, pairing.left[i], pairing.right[i]);
    }
    return assemble(pairing, boxes, leaf_size, costs);
}

namespace {

const Registration registration(
    {
        .axis = "builder",
        .name = "lbvh",
        .summary = "the radix tree of Morton codes",
        .origin = "Karras 2012",
        .backends = on_every_backend,
        .unsupported_reason = needs_tree,
    },
    {.builder = {[](const PrimitiveBoxes& boxes, std::span<const Triangle<float>>) { return build(boxes); }}});

}  // namespace

}  // namespace pt::builder::lbvh
