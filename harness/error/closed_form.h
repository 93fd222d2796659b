// Closed-form images of simple scenes, which are references without noise.
#pragma once

#include <optional>
#include <string>

#include "harness/error/metrics.h"
#include "harness/scene/scene_buffers.h"

namespace pt {

struct ClosedForm {
    Image image;
    std::string formula;
};

// Returns the exact image of a scene and its formula, for two kinds of scene, otherwise nothing:
// - A single emitting quad, not moving and wholly in front of a pinhole camera. A pixel is the quad's radiance on the
// part that the projected quad covers, and the environment on the rest.
// - A closed object around the eye with equal reflectance and emission everywhere (furnace test): a geometric series.
std::optional<ClosedForm> closed_form(const Scene& scene, const RenderSettings& settings);

}  // namespace pt
