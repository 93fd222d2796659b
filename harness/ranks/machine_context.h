// What a result says of the machine, the build, the backend and the number of MPI ranks that it came from.
#pragma once

#include "harness/machine/run_context.h"
#include "variants/descriptor.h"

namespace pt {

MachineContext machine_context(Backend backend);

}  // namespace pt
