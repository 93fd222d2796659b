// The GPUs of this machine, as the axis `devices` needs to know them.
#pragma once

#include <cstdint>
#include <string>

#include "variants/axes.h"

namespace pt {

struct DevicesHere {
    std::uint32_t count = 0;   // number of GPUs like the first one, counted from the first; 0: not known
    std::string missing = {};  // what this machine lacks to render on several GPUs; empty: nothing
};

// The function that counts the GPUs, called once their count matters. The CUDA backend sets it; other builds have none.
using LookForDevices = DevicesHere (*)();
// Sets the function that counts the GPUs, and returns the one set before.
LookForDevices set_look_for_devices(LookForDevices look);
DevicesHere devices_here();

// Why `count` GPUs of this machine cannot render one image together; empty: they can, or it is not known.
Reason why_not_on(const DevicesHere& here, std::uint32_t count);

}  // namespace pt
