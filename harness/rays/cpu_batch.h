// Ray batches on the CPU, all cores over the rays: closest hits through the function that renders call
// (AcceleratorHook::meet_single); any hit, and the counts of work, through the traversals that are compiled here.
#pragma once

#include <memory>
#include <span>

#include "harness/rays/ray_batch.h"
#include "kernels/scene_view.h"
#include "kernels/triangle.h"

namespace pt::rays {

// Makes a tracer of batches on the CPU, which `mesh` must outlive.
std::unique_ptr<BatchTracer> make_cpu_tracer(const MeshView& mesh, const std::string& accelerator,
                                             MeetMesh<float> meet);

// The closest hit of each ray, by tests of every triangle on the CPU.
std::vector<Hit> brute_force_on_cpu(std::span<const Triangle<float>> triangles, const std::vector<Ray>& rays);

}  // namespace pt::rays
