// How a compressed wide node is cut from a binary tree and filled in: what the encoders on the host and on the GPU
// share. Ylitie, Karras, Laine 2017, sections 3.1 (the cut of least SAH cost) and 3.2 (children by octants).
#pragma once

#include <cmath>

#include "variants/accelerator/cwbvh.h"
#include "variants/bvh/binary_tree.h"

namespace pt::accelerator::cwbvh {

// SAH costs of visiting a node and of testing a triangle, 10 to 3: as in the paper and in instructions on an H200.
inline constexpr float node_cost = 1.0f, reference_cost = 0.3f;
inline constexpr std::uint32_t no_node = ~0u;

PT_HD inline float box_area(const Box& box) {  // half of a box's surface area
    const float x = box.high[0] - box.low[0], y = box.high[1] - box.low[1], z = box.high[2] - box.low[2];
    return x * y + y * z + z * x;
}

// How a binary subtree is cut into 1 to 7 subtrees below one wide node: the least SAH costs, and how they come about.
struct alignas(32) Cut {
    float cost[width - 1];
    std::uint32_t choices;

    // How many of `roots` subtrees (2 to 8) come from the left child; 0: a cut into one subtree fewer costs less.
    PT_HD std::uint32_t left_of(std::uint32_t roots) const { return choices >> (3 * (roots - 2)) & 7u; }
    PT_HD bool is_leaf() const { return (choices >> 21 & 1u) != 0; }
    PT_HD std::uint32_t references() const { return choices >> 22; }  // subtree's references, up to largest_leaf + 1

    PT_HD static Cut of_leaf(float area, std::uint32_t count) {
        Cut cut;
        for (float& cost : cut.cost) {
            cost = area * static_cast<float>(count) * reference_cost;
        }
        cut.choices = 1u << 21 | count << 22;
        return cut;
    }

    PT_HD static Cut of_inner(float area, const Cut& a, const Cut& b) {
        Cut cut;
        const std::uint32_t count = min(a.references() + b.references(), largest_leaf + 1);
        float shared[width + 1];
        std::uint32_t left[width + 1];
        for (std::uint32_t roots = 2; roots <= width; ++roots) {
            shared[roots] = a.cost[0] + b.cost[roots - 2];
            left[roots] = 1;
            for (std::uint32_t k = 2; k < roots; ++k) {
                const float cost = a.cost[k - 1] + b.cost[roots - k - 1];
                left[roots] = cost < shared[roots] ? k : left[roots];
                shared[roots] = cost < shared[roots] ? cost : shared[roots];
            }
        }
        const float as_node = shared[width] + area * node_cost;
        const float as_leaf = area * static_cast<float>(count) * reference_cost;
        const bool leaf = count <= largest_leaf && as_leaf <= as_node;
        cut.cost[0] = leaf ? as_leaf : as_node;
        cut.choices = (leaf ? 1u << 21 : 0u) | count << 22 | left[width] << (3 * (width - 2));
        for (std::uint32_t roots = 2; roots < width; ++roots) {
            const bool fewer = cut.cost[roots - 2] <= shared[roots];
            cut.cost[roots - 1] = fewer ? cut.cost[roots - 2] : shared[roots];
            cut.choices |= (fewer ? 0u : left[roots]) << (3 * (roots - 2));
        }
        return cut;
    }
};

// The binary subtrees that become a wide node's children. A type `Tree` of binary trees has left(node), right(node),
// is_leaf(node), box(node), cut(node).
struct Children {
    std::uint32_t node[width];
    std::uint32_t count = 0;

    template <class Tree>
    PT_HD static Children of(const Tree& tree, std::uint32_t parent) {
        Children children;
        struct {
            std::uint32_t node, roots;
        } open[width];
        std::uint32_t depth = 0;
        open[depth++] = {parent, width};
        while (depth != 0) {
            const auto [node, roots] = open[--depth];
            const std::uint32_t on_left = tree.cut(node).left_of(roots);
            for (std::uint32_t side = 0; side < 2; ++side) {
                const std::uint32_t child = side == 0 ? tree.left(node) : tree.right(node);
                const Cut cut = tree.cut(child);
                std::uint32_t share = side == 0 ? on_left : roots - on_left;
                while (share > 1 && cut.left_of(share) == 0) {
                    --share;
                }
                if (share == 1) {
                    children.node[children.count++] = child;
                } else {
                    open[depth++] = {child, share};
                }
            }
        }
        return children;
    }

    // Places the children at the corners of a node; at[corner] becomes the child there, or no_node. The pair of child
    // and corner that lies farthest out is placed first.
    template <class Tree>
    PT_HD void put_at_corners(const Tree& tree, const Box& box, std::uint32_t (&at)[width]) const {
        Wish wishes[width];
        for (std::uint32_t c = 0; c < count; ++c) {
            const Box child = tree.box(node[c]);
            for (int k = 0; k < 3; ++k) {
                wishes[c].from_centre[k] = (child.low[k] + child.high[k]) - (box.low[k] + box.high[k]);
            }
            wishes[c].choose(0xffu);
        }
        for (std::uint32_t& child : at) {
            child = no_node;
        }
        std::uint32_t free = 0xffu, placed = 0;
        for (std::uint32_t n = 0; n < count; ++n) {
            std::uint32_t next = width;
            for (std::uint32_t c = 0; c < count; ++c) {
                if ((placed >> c & 1u) == 0 && (next == width || wishes[c].reach > wishes[next].reach)) {
                    next = c;
                }
            }
            const std::uint32_t corner = wishes[next].corner;
            at[corner] = node[next];
            placed |= 1u << next;
            free &= ~(1u << corner);
            for (std::uint32_t c = 0; c < count; ++c) {
                if ((placed >> c & 1u) == 0 && wishes[c].corner == corner) {
                    wishes[c].choose(free);
                }
            }
        }
    }

private:
    // The free corner of a wide node at which a child lies farthest out.
    struct Wish {
        float from_centre[3], reach;
        std::uint32_t corner;

        PT_HD void choose(std::uint32_t free) {
            corner = width;
            for (std::uint32_t s = 0; s < width; ++s) {
                const float x = (s & 1u) != 0 ? from_centre[0] : -from_centre[0];
                const float y = (s & 2u) != 0 ? from_centre[1] : -from_centre[1];
                const float z = (s & 4u) != 0 ? from_centre[2] : -from_centre[2];
                if ((free >> s & 1u) != 0 && (corner == width || x + y + z > reach)) {
                    reach = x + y + z, corner = s;
                }
            }
        }
    };
};

// Returns 2^exponent for the exponents of a float, -126 to 127.
PT_HD inline double power_of_two(int exponent) { return number_of(static_cast<std::int64_t>(exponent + 1023) << 52); }

PT_HD inline float next_below(double x) {
    const float rounded = static_cast<float>(x);
    if (static_cast<double>(rounded) <= x) {
        return rounded;
    }
    const std::int32_t bits = bits_of(rounded);
    // Moves `rounded` down to the next float, which lies away from zero where it is negative.
    return rounded > 0.0f   ? number_of(bits - 1)
           : rounded < 0.0f ? number_of(bits + 1)
                            : number_of(std::int32_t(0x80000001u));
}

// Sets a cwbvh node's origin and its step: the least power of two with which the planes of the node's box, widened by
// plane_room, fit in 0 to 255.
PT_HD inline void set_frame(Node& node, const Box& box) {
    for (int k = 0; k < 3; ++k) {
        const double low = static_cast<double>(box.low[k]), high = static_cast<double>(box.high[k]);
        // Returns the exponent of the float (high - low) / 256, rounded down; an extent of 0 gives the least exponent.
        int exponent = static_cast<int>(bits_of(high - low) >> 52) - 1023 - 8;
        for (exponent = clamp(exponent, -126, 127);; ++exponent) {
            const double step = power_of_two(exponent);
            node.origin[k] = next_below(low - plane_room * step);
            if ((high - static_cast<double>(node.origin[k])) / step + plane_room <= 255.0 || exponent == 127) {
                break;
            }
        }
        node.exponent[k] = static_cast<std::uint8_t>(exponent + 127);
    }
}

PT_HD inline void set_box(Node& node, std::uint32_t corner, const Box& box) {
    for (int k = 0; k < 3; ++k) {
        const double step = power_of_two(node.exponent[k] - 127), origin = static_cast<double>(node.origin[k]);
        const double low = floor((static_cast<double>(box.low[k]) - origin) / step - plane_room);
        const double high = ceil((static_cast<double>(box.high[k]) - origin) / step + plane_room);
        node.plane[k][0][corner] = static_cast<std::uint8_t>(clamp(low, 0.0, 255.0));
        node.plane[k][1][corner] = static_cast<std::uint8_t>(clamp(high, 0.0, 255.0));
    }
}

// Encodes a cwbvh node, except for the numbers at which its children and slots begin (child_base, slot_base).
template <class Tree>
PT_HD inline Node make_node(const Tree& tree, const Box& box, const std::uint32_t (&at)[width]) {
    Node node{};
    set_frame(node, box);
    for (std::uint32_t corner = 0; corner < width; ++corner) {
        if (at[corner] == no_node) {
            continue;
        }
        const Cut cut = tree.cut(at[corner]);
        set_box(node, corner, tree.box(at[corner]));
        node.contents |= cut.is_leaf() ? ((1u << cut.references()) - 1u) << (3u * corner) : 1u << (24u + corner);
    }
    return node;
}

}  // namespace pt::accelerator::cwbvh
