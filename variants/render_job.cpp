#include "variants/render_job.h"

#include <algorithm>

namespace pt {

void PathQueue::reserve(std::size_t capacity) {
    std::visit([capacity](auto& layout) { layout.reserve(capacity); }, paths);
    if (hits.size() < capacity) {
        hits.resize(capacity);
        order.resize(capacity);
        keys.resize(capacity);
        scratch.resize(capacity);
    }
}

void StageTimes::add(std::string_view stage, double ms) {
    const auto found =
        std::find_if(milliseconds.begin(), milliseconds.end(), [&](const auto& entry) { return entry.first == stage; });
    if (found == milliseconds.end()) {
        milliseconds.emplace_back(stage, ms);
    } else {
        found->second += ms;
    }
}

void StageTimes::add_live(std::size_t segment, std::uint64_t paths) {
    if (live_paths.size() <= segment) {
        live_paths.resize(segment + 1);
    }
    live_paths[segment] += paths;
}

}  // namespace pt
