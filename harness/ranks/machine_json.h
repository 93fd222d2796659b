// What a result says of the machine, the build, the backend and the number of MPI ranks that it came from.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "variants/descriptor.h"

namespace pt {

// Keys of a result file's context ("ptbench.machine", ..) with their values, all of them texts.
nlohmann::ordered_json machine_json(Backend backend);

}  // namespace pt
