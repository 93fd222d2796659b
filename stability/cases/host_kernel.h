// Runs the stage functions of kernels/ on the host for direct checks: the scene of a SceneText as kernels see it, with
// the number type and formulas of a DirectSetting.
#pragma once

#include <memory>

#include "harness/scene/scene_buffers.h"
#include "harness/stability/case.h"
#include "kernels/shade.h"

namespace pt::stability {

template <class Kernel>
class HostScene {
public:
    using Real = typename Kernel::Real;

    explicit HostScene(const SceneText& text, std::uint64_t seed = 1) {
        const Scene scene = parse_scene(text.json().dump(), "a direct check");
        RenderSettings settings = default_settings(scene);
        settings.seed = seed;
        buffers_ = std::make_unique<SceneBuffers<Real>>(scene, settings);
    }
    const SceneView<Real>& view() const { return buffers_->view(); }

private:
    std::unique_ptr<SceneBuffers<Real>> buffers_;
};

// Calls check.operator()<Kernel>() with the kernel configuration that has every feature and the setting's precision.
template <class Check>
auto with_kernel(const DirectSetting& setting, const Check& check) {
    constexpr FeatureSet naive = all_features | Feature::naive;
    constexpr FeatureSet mixed = all_features | Feature::double_intersection;
    if (setting.precision.is_double()) {
        return setting.is_naive ? check.template operator()<Config<double, naive>>()
                                : check.template operator()<Config<double, all_features>>();
    }
    if (setting.precision.is_mixed()) {
        return setting.is_naive ? check.template operator()<Config<float, mixed | Feature::naive>>()
                                : check.template operator()<Config<float, mixed>>();
    }
    return setting.is_naive ? check.template operator()<Config<float, naive>>()
                            : check.template operator()<Config<float, all_features>>();
}

}  // namespace pt::stability
