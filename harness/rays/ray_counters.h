// What a GPU's own counters say of ray batches, each traced once under Nsight Compute: active lanes and how near issue,
// pipes, caches and memory come to what they can do, as Aila and Laine report them ("Understanding the Efficiency of
// Ray Traversal on GPUs", HPG 2009).
#pragma once

#include <string>
#include <vector>

#include "harness/rays/ray_study.h"

namespace pt::rays {

// What runs under ncu: each batch of the study once without counting, then once counted, in the order of `measure`.
void trace_counted(const RayMesh& mesh, const RayStudy& study);

// The batches of what `measure` said of all meshes, in that order: the function of its kernel and its rays.
std::vector<std::pair<std::string, double>> counted_batches(const nlohmann::ordered_json& meshes);

// Gives each batch its counters; `launches`: one for each of counted_batches.
void add_counters(nlohmann::ordered_json& meshes, const nlohmann::ordered_json& launches);

// The counters of one mesh, a line a batch.
std::string counters_table_of(const nlohmann::ordered_json& mesh);

}  // namespace pt::rays
