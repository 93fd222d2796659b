// Tells the axis `devices` what the CUDA runtime and NCCL say of this machine.
#include "variants/cuda/runtime/device.h"
#include "variants/cuda/runtime/nccl.h"
#include "variants/devices/here.h"

namespace pt::cuda {
namespace {

DevicesHere look() {
    static const DevicesHere here = [] {
        DevicesHere found;
        if (device_missing().empty()) {
            found.count = static_cast<std::uint32_t>(equal_devices());
            found.missing = found.count > 1 ? nccl_missing() : "";
        }
        return found;
    }();
    return here;
}

[[maybe_unused]] const LookForDevices nobody_before = set_look_for_devices(look);

}  // namespace
}  // namespace pt::cuda
