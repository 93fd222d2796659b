// Rays that start on a body, and rays through a box's edges, by the thousand million on the GPU: the stability cases
// self_hits and box_edges, as many times as a figure of "none" needs.
#pragma once

#include <cstdint>

#include "kernels/scene_view.h"

namespace pt::test {

struct StartedSegments {
    unsigned long long outward = 0;    // segments that start on the body and run away from it
    unsigned long long self_hits = 0;  // of those, that meet it again
    unsigned long long inward = 0;     // that start on the body and run through it
    unsigned long long leaks = 0;      // of those, that never leave it
};

// 2^18 threads send `rounds` rays each at the only object of the scene, whose bodies lie in host memory, from a
// distance of 4 radii, and one on from each point they meet, to all sides. Throws MachineError.
StartedSegments start_segments(const SceneView<float>& scene, const Vec3<float>& centre, float radius,
                               std::uint32_t rounds);

struct EdgeMisses {
    unsigned long long rays = 0;
    unsigned long long axis_box = 0, oriented_box = 0;  // that miss the box although they pass through a point of it
};

// 2^18 threads send `rounds` rays each through points of the edges of the box [-half, half], every fourth in the plane
// of a face. half: of whole multiples of 2^-6 below 8, or so small that it does not change a coordinate: then all
// numbers are exact. Throws MachineError.
EdgeMisses cross_edges(const Vec3<float>& half, std::uint32_t rounds);

}  // namespace pt::test
