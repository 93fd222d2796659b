// Batches of rays without shading, by which accelerators are compared as in Aila and Laine, "Understanding the
// Efficiency of Ray Traversal on GPUs", HPG 2009.
#pragma once

#include "kernels/triangle.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pt::rays {

struct alignas(16) Ray {
    float origin[3];
    float t_max;
    float direction[3];
    float unused = 0.0f;
};

// The closest hit with t <= t_max, among equal t that of the smallest primitive; {t_max, no_primitive} for a miss.
inline constexpr std::uint32_t no_primitive = ~0u;
struct Hit {
    float t;
    std::uint32_t primitive;

    bool operator==(const Hit&) const = default;
};

// A batch of rays of one class. `any`: an occlusion test, for which any hit will do.
struct RaySet {
    std::string name;
    bool any = false;
    std::vector<Ray> rays;
};

// Traversal work per ray, as means over a batch: nodes visited, boxes tested and triangles tested.
struct Work {
    double nodes = 0, boxes = 0, triangles = 0;
};

struct LeakSource;
struct LeakCounts;

// Traces batches of rays through one tree. For occlusion tests the hits are {0, 0} (occluded) or {t_max, no_primitive}.
class BatchTracer {
public:
    BatchTracer() = default;
    BatchTracer(const BatchTracer&) = delete;
    BatchTracer& operator=(const BatchTracer&) = delete;
    virtual ~BatchTracer() = default;

    // The names of the kernels that can trace a set of rays, usually the fastest first.
    virtual std::vector<std::string> kernels(const RaySet& set) const = 0;
    // Selects the set of rays for later calls of the tracer; the set must outlive them.
    virtual void load(const RaySet& set) = 0;
    virtual double trace(const std::string& kernel) = 0;  // traces the loaded rays; returns the time in milliseconds
    virtual std::vector<Hit> hits() = 0;                  // hits of the rays that the last `trace` traced
    virtual std::optional<Work> count() = 0;              // traversal work; none without counters

    // Sets the mesh and the seed from which make_leak_rays generates leak rays (leak_rays.h) on the tracer's device.
    virtual void take_leak_source(const LeakSource& source) = 0;
    virtual void make_leak_rays(std::uint64_t first, std::uint32_t count) = 0;
    virtual LeakCounts leaks() = 0;  // rays without a hit (leaked) in the last traced batch
};

// Replaces `best` by a hit that is closer, or as close with a smaller primitive index.
PT_HD inline void keep_nearer(const TriangleHit<float>& hit, std::uint32_t primitive, Hit& best) {
    if (hit.hits && (hit.t < best.t || (hit.t == best.t && primitive < best.primitive))) {
        best = {hit.t, primitive};
    }
}

}  // namespace pt::rays
