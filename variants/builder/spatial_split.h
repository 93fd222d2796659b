// Finds the plane that best parts space, and triangles with it. Stich, Friedrich, Dietrich, HPG 2009, section 4.1.
#pragma once

#include <limits>
#include <span>
#include <utility>

#include "kernels/triangle.h"
#include "variants/builder/binned_split.h"

namespace pt::builder {

struct SpatialSplit {
    double cost = std::numeric_limits<double>::infinity();  // sum over both children: half surface area x references
    int axis = -1;                                          // axis across which the split's plane lies; -1: no split
    float plane = 0;
    Bin left, right;
};

// Finds the best spatial split of some references; `box` is their bounding box.
SpatialSplit best_spatial_split(std::span<const Triangle<float>> triangles, std::span<const Reference> references,
                                const Box& box);

// Bounding boxes, conservative, of a triangle's parts below and above a plane within a reference's box; empty: no part.
std::pair<Box, Box> part(const Triangle<float>& triangle, const Box& box, int axis, float plane);

}  // namespace pt::builder
