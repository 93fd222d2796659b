// Images that are known without rendering: a reference without noise.
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

// The exact image of a scene, for two kinds of scene:
// - One emitter that is a still quad wholly in front of a pinhole: a pixel is the quad's radiance on the part of the
// pixel that its image covers, and the environment on the rest.
// - One closed object around the eye, which reflects and emits the same everywhere: a geometric series.
std::optional<ClosedForm> closed_form(const Scene& scene, const RenderSettings& settings);

}  // namespace pt
