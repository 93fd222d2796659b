// Files of ray sets, little-endian, from which other programs can trace the same rays. "PTBRAYS1"; uint32 number of
// sets; uint32 0; then for each set: its class (24 bytes, padded with 0); uint32, 1 for occlusion tests; uint32 0;
// uint64 number of rays; uint64 number of rays that hit; then the rays, 8 floats each: origin, t_max, direction, 0.
#pragma once

#include <string>
#include <vector>

#include "harness/rays/ray_batch.h"

namespace pt::rays {

// Writes ray sets to a file. `hits` holds the number of rays that hit in each set.
void write_rays(const std::string& file, const std::vector<RaySet>& sets, const std::vector<std::uint64_t>& hits);
// Reads ray sets from a file and, if `hits` is given, the number of rays that hit in each set. Throws InputError for a
// file that is no ray file, is damaged, or contains an invalid ray.
std::vector<RaySet> read_rays(const std::string& file, std::vector<std::uint64_t>* hits = nullptr);

}  // namespace pt::rays
