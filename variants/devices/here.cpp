#include "variants/devices/here.h"

#include <utility>

namespace pt {

namespace {

constinit LookForDevices look_for_devices = nullptr;

}  // namespace

LookForDevices set_look_for_devices(LookForDevices look) { return std::exchange(look_for_devices, look); }

DevicesHere devices_here() { return look_for_devices != nullptr ? look_for_devices() : DevicesHere{}; }

Reason why_not_on(const DevicesHere& here, std::uint32_t count) {
    if (here.count == 0 || count <= 1) {
        return {};
    }
    if (here.count < count) {
        return {"needs_devices",
                "needs " + std::to_string(count) + " GPUs that are alike; found here: " + std::to_string(here.count)};
    }
    return here.missing.empty() ? Reason{} : Reason{"needs_nccl", "needs NCCL: " + here.missing};
}

}  // namespace pt
