// The best plane that parts space, triangles with it. Stich, Friedrich, Dietrich, HPG 2009, section 4.1.
#pragma once

#include <limits>
#include <span>
#include <utility>

#include "kernels/triangle.h"
#include "variants/builder/binned_split.h"

namespace pt::builder {

struct SpatialSplit {
    double cost = std::numeric_limits<double>::infinity();  // half area times count, of both children
    int axis = -1;                                          // -1: none
    float plane = 0;
    Bin left, right;
};

// Finds the best spatial split of some references; `box` is the one round all of them.
SpatialSplit best_spatial_split(std::span<const Triangle<float>> triangles, std::span<const Reference> references,
                                const Box& box);

// The parts of a reference's box, conservative, that hold the triangle's parts below and above a plane; empty: none.
std::pair<Box, Box> part(const Triangle<float>& triangle, const Box& box, int axis, float plane);

}  // namespace pt::builder
