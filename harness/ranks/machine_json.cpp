#include "harness/ranks/machine_json.h"

#include <nlohmann/json.hpp>

#include "harness/cuda/backend.h"
#include "harness/machine/machine.h"
#include "harness/ranks/ranks.h"

namespace pt {

nlohmann::ordered_json machine_json(Backend backend) {
    nlohmann::ordered_json json;
    for (const auto& [key, value] : machine_context()) {
        json[key] = value;
    }
    if (backend == Backend::cuda) {
        for (const auto& [key, value] : cuda::context()) {
            json[key] = value;
        }
        json["ptbench.machine"] = cuda::machine_name();
        json["ptbench.clock"] = "a kernel that reads the multiprocessor's cycles and nanoseconds";
    }
    if (ranks().count > 1) {
        json["ptbench.ranks"] = std::to_string(ranks().count);
        json["ptbench.machine"] = on_ranks(json["ptbench.machine"]);
    }
    return json;
}

}  // namespace pt
