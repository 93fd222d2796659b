// Studies of error against render time (type "convergence"): their keys in suite files and their cells' references.
#pragma once

#include "harness/bench/suite.h"

namespace pt {

// Suffixes of the names of cells with checkpoints, and of studies that time these cells without checkpoints.
inline constexpr std::string_view checkpoints_suffix = "/checkpoints:octaves";
inline constexpr std::string_view without_checkpoints_suffix = "_without_checkpoints";

// The keys that only a convergence study has in a suite's file.
inline const std::vector<std::string> convergence_keys{"reference", "images", "without_checkpoints"};
ConvergenceSettings read_convergence(const JsonObject& study);

// Returns the sample counts at which a render has its checkpoints: 1, 2, 4, ... and `spp` itself.
std::vector<std::uint32_t> octaves(std::uint32_t spp);

// Turns an ordinary cell into a cell with checkpoints. Precondition: the cell's depth comes from depth_for_mean_of.
void add_checkpoints(Cell& cell, const ConvergenceSettings& settings, std::shared_ptr<const Scene> reference_scene,
                     std::uint32_t reference_depth);

// Lists why the cell's image does or may differ from the reference image in the mean, one reason per line.
std::vector<std::string> declared_biases(const Cell& cell);

}  // namespace pt
