// Batches of rays without shading: what accelerators are compared by, as Aila and Laine do ("Understanding the
// Efficiency of Ray Traversal on GPUs", HPG 2009).
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

// The least (t, primitive) with t at most t_max, or no_primitive and t_max.
inline constexpr std::uint32_t no_primitive = ~0u;
struct Hit {
    float t;
    std::uint32_t primitive;

    bool operator==(const Hit&) const = default;
};

// A set of rays of one class, by its name, and whether any hit will do.
struct RaySet {
    std::string name;
    bool any = false;
    std::vector<Ray> rays;
};

// What a tree's traversal costs: counts per ray, means over a batch.
struct Work {
    double nodes = 0, boxes = 0, triangles = 0;
};

struct LeakSource;
struct LeakCounts;

// Traces batches of rays through one tree. For a set where any hit will do, the hits say {0, 0} or {t_max,
// no_primitive}.
class BatchTracer {
public:
    BatchTracer() = default;
    BatchTracer(const BatchTracer&) = delete;
    BatchTracer& operator=(const BatchTracer&) = delete;
    virtual ~BatchTracer() = default;

    // The kernels by which a set can be traced, as a rule the fastest first.
    virtual std::vector<std::string> kernels(const RaySet& set) const = 0;
    // Loads the set of rays that the calls after this one are about; it must outlive them.
    virtual void load(const RaySet& set) = 0;
    virtual double trace(const std::string& kernel) = 0;  // milliseconds
    virtual std::vector<Hit> hits() = 0;                  // of the last trace
    virtual std::optional<Work> count() = 0;              // nothing: the accelerator counts nothing

    // Takes a source of rays at edges and vertices (leak_rays.h), then makes batches of its rays where they are traced.
    virtual void take_leak_source(const LeakSource& source) = 0;
    virtual void make_leak_rays(std::uint64_t first, std::uint32_t count) = 0;
    virtual LeakCounts leaks() = 0;  // of the last trace
};

// Keeps a hit that comes before the one in hand.
PT_HD inline void keep_nearer(const TriangleHit<float>& hit, std::uint32_t primitive, Hit& best) {
    if (hit.hits && (hit.t < best.t || (hit.t == best.t && primitive < best.primitive))) {
        best = {hit.t, primitive};
    }
}

}  // namespace pt::rays
