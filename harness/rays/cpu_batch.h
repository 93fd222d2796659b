// Traces ray batches on the CPU, parallel over the rays. Closest hits go through the function that renders call
// (AcceleratorHook::meet_single); any-hit queries and counts of traversal work use traversals that are compiled here.
#pragma once

#include <memory>
#include <span>

#include "harness/rays/ray_batch.h"
#include "kernels/scene_view.h"
#include "kernels/triangle.h"

namespace pt::rays {

// Makes a tracer of ray batches on the CPU. `mesh` must outlive the tracer.
std::unique_ptr<BatchTracer> make_cpu_tracer(const MeshView& mesh, const std::string& accelerator,
                                             MeetMesh<float> meet);

// Finds the closest hit of each ray on the CPU by testing every triangle.
std::vector<Hit> brute_force_on_cpu(std::span<const Triangle<float>> triangles, const std::vector<Ray>& rays);

}  // namespace pt::rays
