// Classes of rays, made on the host with the same bits on every machine: those of the OptiX probe and a few kinds more,
// from the camera or from the hits of other rays.
#pragma once

#include <string>
#include <vector>

#include "harness/rays/ray_batch.h"
#include "harness/rays/ray_meshes.h"

namespace pt::rays {

// The classes of rays, "primary" first, in the order in which they are traced.
const std::vector<std::string>& ray_classes();
bool takes_any_hit(const std::string& ray_class);

// Makes 2^log2_rays rays of each class; `tracer` says what the rays met that others start from.
std::vector<RaySet> make_ray_sets(const RayMesh& mesh, BatchTracer& tracer, const std::vector<std::string>& classes,
                                  std::uint32_t log2_rays);

}  // namespace pt::rays
