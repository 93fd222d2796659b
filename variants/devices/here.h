// The GPUs of this machine, as the axis `devices` needs to know them.
#pragma once

#include <cstdint>
#include <string>

#include "variants/axes.h"

namespace pt {

struct DevicesHere {
    std::uint32_t count = 0;   // from the first on, those that are alike; 0: it is not known
    std::string missing = {};  // what several of them need and the machine lacks
};

// The function that counts the devices, called once it matters. The CUDA backend sets it; in a build without that
// nothing is known.
using LookForDevices = DevicesHere (*)();
// Sets the function that counts the devices, and returns the one until now.
LookForDevices set_look_for_devices(LookForDevices look);
DevicesHere devices_here();

// Why `count` devices cannot render together here; empty: they can, or it is not known.
Reason why_not_on(const DevicesHere& here, std::uint32_t count);

}  // namespace pt
