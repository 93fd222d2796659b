// The closest hit by brute force and through an accelerator, with every bit that leaves the triangle's test.
#pragma once

#include <span>

#include "tests/acceleration/triangle_scenes.h"
#include "variants/bvh/encoded_tree.h"

namespace pt::test {

struct ClosestHit {
    TriangleHit<float> hit{std::numeric_limits<float>::infinity(), 0, 0, 0, 0, false, false};
    std::uint32_t primitive = ~0u;

    // Equal bits, an infinite t for none.
    bool operator==(const ClosestHit& other) const {
        return primitive == other.primitive && hit.from_behind == other.hit.from_behind &&
               bits_of(hit.t) == bits_of(other.hit.t) && bits_of(hit.det) == bits_of(other.hit.det) &&
               bits_of(hit.u) == bits_of(other.hit.u) && bits_of(hit.v) == bits_of(other.hit.v) &&
               bits_of(hit.w) == bits_of(other.hit.w);
    }
    void meet(const TriangleHit<float>& candidate, std::uint32_t number) {
        if (candidate.hits && (candidate.t < hit.t || (candidate.t == hit.t && number < primitive))) {
            hit = candidate;
            primitive = number;
        }
    }
};

inline ClosestHit brute_force(std::span<const Triangle<float>> triangles, const TestRay& ray) {
    const auto sheared = ShearedDirection<float>::of(ray.direction);
    ClosestHit closest;
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        closest.meet(intersect(triangles[i], ray.origin, sheared), i);
    }
    return closest;
}

// `traverse(tree, origin, direction, best_t, leaf, counter)` of an accelerator.
template <class Traverse>
ClosestHit through(const EncodedTree& tree, std::span<const Triangle<float>> triangles, const TestRay& ray,
                   Traverse&& traverse, TraversalCounter& counter) {
    const auto sheared = ShearedDirection<float>::of(ray.direction);
    ClosestHit closest;
    const auto leaf = [&](std::uint32_t first, std::uint32_t count) {
        for (std::uint32_t slot = first; slot < first + count; ++slot) {
            const std::uint32_t primitive = tree.references[slot];
            closest.meet(intersect(triangles[primitive], ray.origin, sheared), primitive);
        }
    };
    traverse(tree.view(), ray.origin, ray.direction, closest.hit.t, leaf, counter);
    return closest;
}

}  // namespace pt::test
