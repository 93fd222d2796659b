// Every builder on the host, by name, for tests that hold all of them to the same.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tests/acceleration/triangle_scenes.h"
#include "variants/builder/lbvh.h"
#include "variants/builder/ploc.h"
#include "variants/builder/ploc_reinserted.h"
#include "variants/builder/sah_binned.h"
#include "variants/builder/sah_sweep.h"
#include "variants/builder/sbvh.h"
#include "variants/bvh/primitive_boxes.h"

namespace pt::test {

struct BuilderChoice {
    std::string name;
    std::function<BinaryTree(const Triangles&, std::uint32_t leaf_size)> build;
    bool is_whole = true;  // no primitive is parted over leaves
};

inline PrimitiveBoxes boxes_of(const Triangles& triangles) {
    return primitive_boxes(std::span<const Triangle<float>>(triangles));
}

template <class Build>
BuilderChoice of_boxes(const char* name, Build build) {
    return {name, [build](const Triangles& triangles, std::uint32_t leaf_size) {
                return build(boxes_of(triangles), leaf_size, builder::SahCosts{});
            }};
}

inline std::vector<BuilderChoice> builders() {
    return {
        of_boxes("sah_binned", &builder::sah_binned::build),
        of_boxes("sah_sweep", &builder::sah_sweep::build),
        of_boxes("lbvh", &builder::lbvh::build),
        of_boxes("ploc", [](const PrimitiveBoxes& boxes, std::uint32_t leaf_size,
                            const builder::SahCosts& costs) { return builder::ploc::build(boxes, leaf_size, costs); }),
        of_boxes("ploc_reinserted",
                 [](const PrimitiveBoxes& boxes, std::uint32_t leaf_size, const builder::SahCosts& costs) {
                     return builder::ploc_reinserted::build(boxes, leaf_size, costs);
                 }),
        {"sbvh",
         [](const Triangles& triangles, std::uint32_t leaf_size) {
             return builder::sbvh::build(triangles, {.leaf_size = leaf_size});
         },
         false}};
}

}  // namespace pt::test
