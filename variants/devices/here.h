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

// Asked once it matters. Who looks is set by the CUDA backend; in a build without one nothing is known.
using LookForDevices = DevicesHere (*)();
// Returns who looked until now.
LookForDevices set_look_for_devices(LookForDevices look);
DevicesHere devices_here();

// Why so many cannot render together there; empty: they can, or it is not known.
Reason why_not_on(const DevicesHere& here, std::uint32_t count);

}  // namespace pt
