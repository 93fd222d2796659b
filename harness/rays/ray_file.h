// Sets of rays in a file, little-endian, for another program to trace the same ones. "PTBRAYS1"; uint32: how many sets;
// uint32 0; then each: its class, 24 bytes padded with 0; uint32: 1 where any hit will do; uint32 0; uint64: how many
// rays; uint64: how many of them hit; then the rays, 8 floats each: origin, t_max, direction, 0.
#pragma once

#include <string>
#include <vector>

#include "harness/rays/ray_batch.h"

namespace pt::rays {

// Writes sets of rays to a file. `hits`: for each set, how many rays hit.
void write_rays(const std::string& file, const std::vector<RaySet>& sets, const std::vector<std::uint64_t>& hits);
// Reads sets of rays and, where asked for, how many of each set the file says to hit. Throws InputError for a file that
// is none, is broken, or has a ray that is none.
std::vector<RaySet> read_rays(const std::string& file, std::vector<std::uint64_t>* hits = nullptr);

}  // namespace pt::rays
