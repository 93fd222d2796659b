// Every kernel that a shipped scene can ask for compiles, for every architecture that ptbench supports. No GPU is
// needed: NVRTC compiles for any.
#include <gtest/gtest.h>

#include "harness/cuda/backend.h"
#include "harness/places.h"
#include "harness/bench/suite.h"

namespace pt {
namespace {

TEST(CudaCompile, Probe) {
    const Scene scene = find_scene("cornell_open_five");
    for (const Choice* integrator : Registry::instance().choices("integrator", Backend::cuda)) {
        for (const char* layout : {"aos", "soa", "packed"}) {
            Variant variant = expand({}, Backend::cuda).front();
            variant.set("integrator", std::string(integrator->descriptor.name));
            variant.set("layout", layout);
            const auto start = std::chrono::steady_clock::now();
            const auto size = cuda::compile(scene, variant, "sm_90");
            std::printf("%s %s %zu bytes %.2f s\n", variant.name().c_str(), layout, size,
                        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
    }
}

}  // namespace
}  // namespace pt
