#include "harness/ranks/machine_context.h"

#include "harness/cuda/backend.h"
#include "harness/machine/machine.h"
#include "harness/machine/run_context.h"
#include "harness/ranks/ranks.h"

namespace pt {

MachineContext machine_context(Backend backend) {
    MachineContext context = machine_context();
    if (backend == Backend::cuda) {
        context.gpu = cuda::context();
        context.machine = cuda::machine_name();
        context.clock = "a kernel that reads the multiprocessor's cycles and nanoseconds";
    }
    if (ranks().count > 1) {
        context.ranks = std::to_string(ranks().count);
        context.machine = on_ranks(context.machine);
    }
    return context;
}

}  // namespace pt
