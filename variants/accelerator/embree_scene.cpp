#include "variants/accelerator/embree_scene.h"

#include <stdexcept>
#include <string>

namespace pt::accelerator::embree {

RTCDevice device() {
    struct ReleaseDevice {
        void operator()(RTCDevice made) const { rtcReleaseDevice(made); }
    };
    static const std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice> only{rtcNewDevice(nullptr)};
    if (only == nullptr) {
        throw std::runtime_error("Embree made no device: error " + std::to_string(rtcGetDeviceError(nullptr)));
    }
    return only.get();
}

void require_no_error(const char* doing) {
    if (const RTCError error = rtcGetDeviceError(device()); error != RTC_ERROR_NONE) {
        throw std::runtime_error("Embree could not " + std::string(doing) + ": error " + std::to_string(error));
    }
}

Scene scene_of(RTCGeometry geometry, RTCSceneFlags flags) {
    Scene scene{rtcNewScene(device())};
    rtcSetSceneFlags(scene.get(), flags);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene.get(), geometry, 0);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene.get());
    require_no_error("build a tree");
    return scene;
}

}  // namespace pt::accelerator::embree
