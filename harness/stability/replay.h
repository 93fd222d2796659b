// Replays one path bounce by bounce in single and in double precision side by side, to find where a number went wrong
// or where the two paths diverge.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/scene/scene_buffers.h"

namespace pt::stability {

// A path's state at the end of a segment.
struct Step {
    std::uint32_t segment = 0;  // number of the path segment, counted from 1
    std::string object;         // "sphere 3 (glass), inside"; "nothing": the ray left the scene
    std::uint32_t object_code = 0;
    double t = 0;  // distance from the ray's origin to the hit point, scene units
    Vec3d position{0.0}, normal{0.0};
    Vec3d direction{0.0};   // direction in which the path leaves the hit point
    Vec3d throughput{0.0};  // path throughput after the hit
    Vec3d radiance{0.0};    // radiance that the path has gathered so far
    bool is_alive = false;  // whether the path continues after this segment
};

// Replays a path in single or in double precision by kernels with all features and samplers; `formula` may select other
// formulas, such as the naive ones.
std::vector<Step> replay_single(const Scene& scene, const RenderSettings& settings, FeatureSet formula,
                                std::uint32_t pixel, std::uint32_t sample);
std::vector<Step> replay_double(const Scene& scene, const RenderSettings& settings, FeatureSet formula,
                                std::uint32_t pixel, std::uint32_t sample);

// The first segment at which two replays hit different objects or sides, or one of them ends; nothing if they agree.
std::optional<std::uint32_t> first_parting(const std::vector<Step>& a, const std::vector<Step>& b);

// How many of a scene's paths diverge between single and double precision, by the segment at which they part.
struct Divergence {
    std::uint64_t paths = 0;
    std::vector<std::uint64_t> parted_at;  // [k]: number of paths whose two replays differ first at segment k + 1
    double difference = 0;                 // mean radiance in single minus double, over pixels and channels
    double standard_error = 0;             // standard error of `difference`

    std::uint64_t parted() const;
};
Divergence divergence(const Scene& scene, const RenderSettings& settings, FeatureSet formula, std::uint32_t samples);

}  // namespace pt::stability
