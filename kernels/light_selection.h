// Light selection for next-event estimation other than uniform: in proportion to power, by an alias table (Walker 1977;
// Vose 1991), or by a light tree of up to 16 children per node, which draws a child in proportion to what it may send
// to the vertex (Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACMCGIT
// 1(2), 2018; bounding boxes and areas by axis stand for its cones, wide nodes for its splitting). Probabilities are
// whole multiples of 2^-32, so the sampled probability and the one divided by are the same number. Multiple importance
// sampling weighs by another density, which depends on the vertex's position alone: where a path hits a light, the
// normal is not known any more. Both techniques weigh by it, so their weights add up to 1 (Veach 1997, sec. 9.2).
#pragma once

#include "kernels/random_words.h"
#include "kernels/vertex.h"

namespace pt {

// A light chosen for next-event estimation. `light` is an index into SceneView::lights; `inverse_weighing` is 1 / the
// probability of the light in weights of multiple importance sampling (inverse_light_weighing).
template <class Real>
struct LightPick {
    std::uint32_t light;
    Real inverse_probability;
    Real inverse_weighing;
};

// Picks one of `count` lights with equal probability, by one random word.
template <class Real>
PT_HD inline LightPick<Real> pick_uniformly(std::uint32_t count, std::uint32_t word) {
    const Real inverse = static_cast<Real>(count);
    return {static_cast<std::uint32_t>((static_cast<std::uint64_t>(word) * count) >> 32), inverse, inverse};
}

// Picks a light in proportion to its power from an alias table. It takes 64 random bits, since one light of many may
// have a probability below 2^-32.
template <class Real>
PT_HD inline LightPick<Real> pick_by_power(const View<LightSlot<Real>>& slots, std::uint32_t word,
                                           std::uint32_t low_word) {
    const std::uint64_t low = static_cast<std::uint64_t>(low_word) * slots.size;
    const std::uint64_t scaled = static_cast<std::uint64_t>(word) * slots.size + (low >> 32);
    const std::uint32_t own = static_cast<std::uint32_t>(scaled >> 32);
    const std::uint32_t light = static_cast<std::uint32_t>(scaled) < slots[own].threshold ? own : slots[own].alias;
    return {light, slots[light].inverse_probability, slots[light].inverse_probability};
}

// A vertex that is to be connected to a light; `two_sided`: also to lights behind it.
template <class Real>
struct LitVertex {
    Vec3<Real> position, normal;
    bool two_sided;
};

// A node of the light tree as seen from one position.
template <class Real>
struct SeenNode {
    Vec3<Real> to_centre;
    Real inverse;         // 1 / distance to the light-tree node's centre, taken as at least half the node's diagonal
    Real inverse_square;  // 1 / squared distance to the light-tree node's centre, with the minimum of `inverse`
    Real shown;           // radiance times projected area of the node's lights, seen from the position, times distance

    PT_HD SeenNode(const LightNode<Real>& node, const Vec3<Real>& position) : to_centre(node.centre - position) {
        const Real square = min(max(dot(to_centre, to_centre), node.least_square), Real(0x1p120));
        inverse = nearly_root_and_inverse_in_range(square).inverse;
        inverse_square = inverse * inverse;
        shown = node.shown.x * (absolute(to_centre.x) + node.half.x) +
                node.shown.y * (absolute(to_centre.y) + node.half.y) +
                node.shown.z * (absolute(to_centre.z) + node.half.z);
    }
    // What the light-tree node sends to the position: radiance times projected area, over the squared distance. In this
    // order of factors no product leaves the range, as powers of the distance would.
    PT_HD Real sent() const { return shown * inverse_square * inverse; }
    // An upper bound on what the light-tree node sends to a surface: sent() times the largest cosine between the
    // surface's normal and a direction into the node's box.
    PT_HD Real sent_to(const LitVertex<Real>& vertex, const LightNode<Real>& node) const {
        const Real height = dot(to_centre, vertex.normal);
        const Real reach = absolute(vertex.normal.x) * node.half.x + absolute(vertex.normal.y) * node.half.y +
                           absolute(vertex.normal.z) * node.half.z;
        const Real highest = max(Real(0), (vertex.two_sided ? absolute(height) : height) + reach);
        return (shown * inverse_square) * (highest * inverse_square);
    }
};

// Turns what a light-tree node's children send, `total` together, into probabilities in units of 2^-32: each at least
// 2^-12, so that every light can be drawn, whatever rounds to 0 or overflows. The last child has the rest.
template <class Real>
struct Shares {
    static constexpr Real least = Real(0x1p20);
    Real scale, floor;

    PT_HD Shares(Real total, std::uint32_t count) {
        const Real number = static_cast<Real>(count);
        // A `total` that is 0, out of range or NaN gives every child of the light-tree node the same share.
        const bool is_known = total > Real(0x1p-80) && total < Real(0x1p80);
        scale = is_known ? nearly_divide(Real(0x1p32) - (number + Real(1)) * least, total) : Real(0);
        floor = is_known ? least : nearly_divide(Real(0x1p32), number) - Real(0x1p9);
    }
    PT_HD Real of(Real amount) const { return scale > Real(0) ? amount * scale + floor : floor; }
};

// Picks a light by the light tree: at the root by the first random word, for its stratification, then by its hashes.
template <class Real>
PT_HD inline LightPick<Real> pick_from_tree(const View<LightNode<Real>>& nodes, const LitVertex<Real>& vertex,
                                            const RandomWords& words) {
    RandomWords more = words;
    LightNode<Real> node = nodes[0];
    Real probability = Real(1);
    Real weighing = Real(1);
    for (std::uint32_t level = 0; !node.is_leaf(); ++level) {
        const std::uint32_t first = node.link, last = node.child_count - 1;
        Real amounts[LightNode<Real>::most_children];
        Real total = Real(0), total_by_place = Real(0);
        PT_ROLLED
        for (std::uint32_t i = 0; i <= last; ++i) {
            const LightNode<Real> child = nodes[first + i];
            const SeenNode<Real> seen(child, vertex.position);
            amounts[i] = seen.sent_to(vertex, child);
            total += amounts[i];
            total_by_place += seen.sent();
        }
        const Shares<Real> shares(total, last + 1), shares_by_place(total_by_place, last + 1);
        std::uint32_t drawn = more.x, left = 0;  // `left`: part of 2^32 not yet given to a child; 0 means 2^32
        std::uint32_t chosen = 0, share = 0;
        PT_ROLLED
        for (;; ++chosen) {
            share = static_cast<std::uint32_t>(shares.of(amounts[chosen]));
            if (chosen == last || drawn < share) {
                break;
            }
            drawn -= share;
            left -= share;
        }
        probability *= Real(0x1p-32) * (chosen < last ? static_cast<Real>(share)
                                        : last > 0    ? static_cast<Real>(left)
                                                      : Real(0x1p32));
        node = nodes[first + chosen];
        weighing *= Real(0x1p-32) * shares_by_place.of(SeenNode<Real>(node, vertex.position).sent());
        more = level % 4 == 0 ? pcg4d(more) : RandomWords{more.y, more.z, more.w, more.x};
    }
    return {node.light(), nearly_divide(Real(1), probability), nearly_divide(Real(1), weighing)};
}

// 1 / probability of the light at the end of the path `way` down the light tree, seen from `position`, as multiple
// importance sampling weighs it.
template <class Real>
PT_HD inline Real inverse_tree_weighing(const View<LightNode<Real>>& nodes, const Vec3<Real>& position,
                                        std::uint32_t way) {
    LightNode<Real> node = nodes[0];
    Real weighing = Real(1);
    while (!node.is_leaf()) {
        const std::uint32_t first = node.link, count = node.child_count, chosen = way & 15u;
        Real total = Real(0);
        PT_ROLLED
        for (std::uint32_t i = 0; i < count; ++i) {
            total += SeenNode<Real>(nodes[first + i], position).sent();
        }
        node = nodes[first + chosen];
        weighing *= Real(0x1p-32) * Shares<Real>(total, count).of(SeenNode<Real>(node, position).sent());
        way >>= 4;
    }
    return nearly_divide(Real(1), weighing);
}

// The light selection of the kernel or, where the kernel chooses at run time, of the scene.
template <class Config, class Scene>
PT_HD inline LightSelection light_selection_of(const Scene& scene) {
    constexpr FeatureSet compiled = Config::features & light_selections;
    constexpr bool is_chosen_at_run_time = (compiled & (compiled - 1u)) != 0;
    if constexpr (is_chosen_at_run_time) {
        return scene.light_selection;
    } else {
        return light_selection_in(compiled);
    }
}

// Picks a light for next-event estimation at a vertex. `two_sided`: the vertex is connected to what is behind it too.
// The first of `words` is for the choice of the light, the others for the point on it.
template <class Config>
PT_HD inline LightPick<typename Config::Real> pick_light(const SceneView<typename Config::Real>& scene,
                                                         const Vertex<typename Config::Real>& vertex, bool two_sided,
                                                         const RandomWords& words) {
    using Real = typename Config::Real;
    if constexpr ((Config::features & light_selections) != 0) {
        const LightSelection selection = light_selection_of<Config>(scene);
        if (selection == LightSelection::power) {
            return pick_by_power(scene.light_slots, words.x, pcg4d(words).x);
        }
        if (selection == LightSelection::tree) {
            return pick_from_tree(scene.light_nodes, LitVertex<Real>{vertex.position, vertex.normal(), two_sided},
                                  words);
        }
    }
    return pick_uniformly<Real>(scene.lights.size, words.x);
}

// 1 / probability of a light, seen from `position`, in weights of multiple importance sampling (LightPick's
// inverse_weighing). `object`: the object that emits.
template <class Config>
PT_HD inline typename Config::Real inverse_light_weighing(const SceneView<typename Config::Real>& scene,
                                                          std::uint32_t object,
                                                          const Vec3<typename Config::Real>& position) {
    using Real = typename Config::Real;
    if constexpr ((Config::features & light_selections) != 0) {
        const LightSelection selection = light_selection_of<Config>(scene);
        if (selection != LightSelection::uniform) {
            const LightSlot<Real>& slot = scene.light_slots[scene.object_light[object]];
            return selection == LightSelection::power ? slot.inverse_probability
                                                      : inverse_tree_weighing(scene.light_nodes, position, slot.way);
        }
    }
    return static_cast<Real>(scene.lights.size);
}

}  // namespace pt
