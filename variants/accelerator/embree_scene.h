// Embree's device and scenes as objects that own them, and Embree's errors as exceptions. Wald, Woop, Benthin, Johnson,
// Ernst, "Embree: A Kernel Framework for Efficient CPU Ray Tracing", SIGGRAPH 2014.
#pragma once

#include <memory>
#include <type_traits>

#include <embree3/rtcore.h>

#include "variants/mesh_reasons.h"

namespace pt::accelerator::embree {

// Returns the only Embree device of the program, made at the first call.
RTCDevice device();
// Throws std::runtime_error if Embree has reported an error on this thread.
void require_no_error(const char* doing);

struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

// Returns a committed Embree scene that owns this one geometry, whose number is 0.
Scene scene_of(RTCGeometry geometry, RTCSceneFlags flags);

inline Reason needs_embree_rays(FeatureSet scene, const VariantTraits& variant) {
    if (Reason reason = needs_meshes(scene, variant); !reason.empty()) {
        return reason;
    }
    return variant.precision.is_single()
               ? Reason{}
               : Reason{"needs_single_precision", "has rays in single precision only, and precision=" +
                                                      std::string(variant.precision.name) + " wants others"};
}

}  // namespace pt::accelerator::embree
