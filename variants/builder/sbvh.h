// The builder sbvh, top down by the SAH with spatial splits: where children of an object split overlap, a plane may
// part triangles, to which both children refer. Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume
// Hierarchies", 2009.
#pragma once

#include <span>

#include "kernels/triangle.h"
#include "variants/builder/sah.h"

namespace pt::builder::sbvh {

struct Settings {
    std::uint32_t leaf_size = 4;  // most references that a leaf may hold
    SahCosts costs = {};
    double overlap = 1e-5;    // spatial splits are tried for overlaps above this share of root area (Stich's alpha)
    double duplicates = 0.5;  // duplicate references allowed, as a share of the primitives
};

BinaryTree build(std::span<const Triangle<float>> triangles, const Settings& settings = {});

}  // namespace pt::builder::sbvh
