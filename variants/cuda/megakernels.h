// What the integrators that keep their paths in registers have in common: what they cannot be combined with, and what
// their counters must say. (CUDA's host side.)
#pragma once

#include <algorithm>

#include "variants/cuda/job.h"
#include "variants/no_queue.h"
#include "variants/registry.h"

namespace pt::cuda {

inline constexpr Tunable block_tunable{"block", 128, 32, 1024, 32, "threads a block"};
inline constexpr Tunable shading_tunable{
    "shading_fmas",
    0,
    0,
    1048576,
    1,
    "injected cost of a material: dependent multiply-adds, executed material by material",
    true};

inline constexpr Tunable min_blocks_tunable{
    "min_blocks",
    0,
    0,
    32,
    1,
    "blocks that a multiprocessor must hold at once: bounds a thread's registers; half as many in "
    "double precision; 0: no bound"};
inline constexpr Tunable regeneration_tunable{
    "regenerate_at", 24, 0, 31, 1, "ended paths of a warp are replaced once no more lanes than this are alive"};

inline constexpr Tunable megakernel_tunables[] = {
    block_tunable,
    shading_tunable,
    min_blocks_tunable,
    {"spp_in_flight", 1, 1, 1048576, 1, "threads a pixel, each with its share of the samples"}};
inline constexpr Tunable piece_tunable{"piece", 16, 1,
                                       4096,    1,  "samples of a strip of 32 pixels that a warp takes at a time"};
inline constexpr Tunable persistent_tunables[] = {block_tunable, shading_tunable, min_blocks_tunable,
                                                  regeneration_tunable, piece_tunable};

inline std::vector<std::string> regeneration_defines(const Variant& variant) {
    return {"-DPT_REGENERATE_AT=" + std::to_string(tunable(variant, "regenerate_at", Backend::cuda))};
}

inline Reason megakernel_unsupported_reason(FeatureSet, const VariantTraits& variant) {
    if (Reason reason = needs_no_queue(variant, "keeps one path in registers"); !reason.empty()) {
        return reason;
    }
    if (variant.launch.is_captured) {
        return {"nothing_to_capture",
                "is one kernel, nothing to capture: needs launch=stream, not " + std::string(variant.launch.name)};
    }
    return {};
}

inline std::string megakernel_work_missing(const WorkCounters& work, std::uint64_t) {
    if (work.bounces != 0) {
        return "ran a queue";
    }
    return work.launches == 0 ? "launched no kernel" : "";
}

}  // namespace pt::cuda
