// Studies of error against run time (type "convergence"): their keys in a suite's file, and what their cells compare
// with what.
#pragma once

#include "harness/bench/suite.h"

namespace pt {

// The endings of names of cells with checkpoints, and of studies of the same cells without them.
inline constexpr std::string_view checkpoints_suffix = "/checkpoints:octaves";
inline constexpr std::string_view without_checkpoints_suffix = "_without_checkpoints";

// The keys that only a convergence study has in a suite's file.
inline const std::vector<std::string> convergence_keys{"reference", "images", "without_checkpoints"};
// Reads the keys of a convergence study from its object; throws InputError.
ConvergenceSettings read_convergence(const JsonObject& study);

// The checkpoints 1, 2, 4, ... and the last sample.
std::vector<std::uint32_t> octaves(std::uint32_t spp);

// Turns an ordinary cell into one with checkpoints. Precondition: its depth is that of depth_for_mean_of.
void add_checkpoints(Cell& cell, const ConvergenceSettings& settings, std::shared_ptr<const Scene> reference_scene,
                     std::uint32_t reference_depth);

// The reasons why the cell's images differ, or may differ, from the reference's; one line each.
std::vector<std::string> declared_biases(const Cell& cell);

}  // namespace pt
