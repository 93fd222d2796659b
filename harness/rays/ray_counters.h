// GPU performance counters of ray batches, each traced once under Nsight Compute: active lanes, and how close issue
// slots, pipes, caches and memory come to their limits, as in Aila and Laine ("Understanding the Efficiency of Ray
// Traversal on GPUs", HPG 2009).
#pragma once

#include <string>
#include <vector>

#include "harness/rays/ray_study.h"

namespace pt::rays {

// To be run under ncu: traces each batch of the study once uncounted (warm-up) and once counted, in measure()'s order.
void trace_counted(const RayMesh& mesh, const RayStudy& study);

// The counted batches in the results of `measure` for all meshes, in order, as kernel function and number of rays.
std::vector<std::pair<std::string, double>> counted_batches(const nlohmann::ordered_json& meshes);

// Adds performance counters to the results of each batch. `launches`: the counters, in the order of counted_batches.
void add_counters(nlohmann::ordered_json& meshes, const nlohmann::ordered_json& launches);

// A table of a mesh's performance counters, one line per batch.
std::string counters_table_of(const nlohmann::ordered_json& mesh);

}  // namespace pt::rays
