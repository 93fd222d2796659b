// Classes of rays, those of the OptiX probe and a few more, generated on the host with the same bits on every machine.
// They start at the camera or at the hits of other rays.
#pragma once

#include <string>
#include <vector>

#include "harness/rays/ray_batch.h"
#include "harness/rays/ray_meshes.h"

namespace pt::rays {

// The names of all ray classes, "primary" first, in the order in which they are traced.
const std::vector<std::string>& ray_classes();
bool takes_any_hit(const std::string& ray_class);

// Generates 2^log2_rays rays of each class; `tracer` finds the hits from which secondary rays start.
std::vector<RaySet> make_ray_sets(const RayMesh& mesh, BatchTracer& tracer, const std::vector<std::string>& classes,
                                  std::uint32_t log2_rays);

}  // namespace pt::rays
