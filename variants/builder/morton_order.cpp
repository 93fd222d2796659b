#include "variants/builder/morton_order.h"

#include <algorithm>

#include "variants/bvh/box.h"
#include "variants/bvh/morton.h"

namespace pt::builder {

std::vector<std::uint64_t> morton_keys(const PrimitiveBoxes& boxes) {
    Box all;
    for (const Box& box : boxes) {
        join(all, centre_box(box));
    }
    std::vector<std::uint64_t> keys(boxes.size());
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        std::uint32_t cell[3];
        for (int axis = 0; axis < 3; ++axis) {
            cell[axis] = morton_cell(centre(boxes[i], axis), all.low[axis], all.high[axis]);
        }
        keys[i] = morton_key(cell[0], cell[1], cell[2], i);
    }
    std::sort(keys.begin(), keys.end());
    return keys;
}

}  // namespace pt::builder
