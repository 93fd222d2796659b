// What goes wrong on a GPU ends in a MachineError that says what, and the program goes on as far as the device does:
// too little memory leaves it usable, a kernel that faults leaves it broken for the process, and each later call says
// so. Skipped where there is no GPU.
#include <gtest/gtest.h>

#include <cuda_runtime_api.h>

#include "harness/bench/journal.h"
#include "harness/cuda/backend.h"
#include "harness/failure.h"
#include "harness/render/renderer.h"
#include "harness/scene/places.h"
#include "tests/support/command.h"

// gpu/faulty_kernel.cu: launches a kernel that ends in a trap, and waits for it.
cudaError_t run_faulty_kernel();

namespace pt {
namespace {

// A queue of four million paths, two hundred megabytes.
RenderRequest large_request(const Scene& scene) {
    RenderRequest request{.variant = Registry::instance().baseline(Backend::cuda),
                          .backend = Backend::cuda,
                          .settings = default_settings(scene),
                          .samples = 1};
    request.variant.set("integrator", "wavefront");
    request.settings.width = request.settings.height = 2048;
    request.settings.depth = 2;
    return request;
}

std::string fault_of(const Scene& scene, const RenderRequest& request) {
    try {
        (void)render(scene, request);
    } catch (const MachineError& error) {
        return error.what();
    }
    return "";
}

class FaultsTest : public testing::Test {
protected:
    test::TemporaryFolder folder;

    void SetUp() override {
        if (const std::string reason = cuda::not_available(); !reason.empty()) {
            GTEST_SKIP() << reason;
        }
    }
};

// A package's gpu_tests lets nothing run beside a suite of such a name: this one takes all of a GPU's memory.
using FaultsTestAlone = FaultsTest;

TEST_F(FaultsTestAlone, TooLittleMemoryIsSaidAndLeavesTheDeviceUsable) {
    const Scene scene = find_scene("cornell_open");
    const RenderRequest request = large_request(scene);
    RenderRequest small = request;
    small.settings.width = small.settings.height = 16;
    const std::string hash = render(scene, small).film.hash();

    std::size_t free_bytes = 0, total_bytes = 0;
    ASSERT_EQ(cudaMemGetInfo(&free_bytes, &total_bytes), cudaSuccess);
    constexpr std::size_t left = 64u << 20;
    ASSERT_GT(free_bytes, left);
    void* taken = nullptr;
    ASSERT_EQ(cudaMalloc(&taken, free_bytes - left), cudaSuccess);
    const std::string fault = fault_of(scene, request);
    EXPECT_EQ(cudaFree(taken), cudaSuccess);

    EXPECT_NE(fault.find("out of device memory: asked for "), std::string::npos) << fault;
    EXPECT_EQ(fault.find('\n'), std::string::npos);
    EXPECT_EQ(render(scene, small).film.hash(), hash);
    EXPECT_EQ(fault_of(scene, request), "");
}

// In a process of its own: the device is lost to the one that the kernel faulted in.
TEST_F(FaultsTest, AfterAKernelThatFaultsEveryRenderSaysSoAndTheJournalIsWhole) {
    const std::string file = folder.file("journal");
    const auto fault_and_report = [&] {
        const Scene scene = find_scene("cornell_open");
        RenderRequest request = large_request(scene);
        request.settings.width = request.settings.height = 16;
        Journal journal(file, "identity", false);
        journal.set_cell("a", {});
        (void)render(scene, request);
        journal.add_sample("a", {.wall_ms = 1});
        const bool faulted = run_faulty_kernel() != cudaSuccess;
        const bool said = !fault_of(scene, request).empty();
        std::_Exit(faulted && said ? exit_machine_failed : exit_good);
    };
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    // The child has a folder of its own (the test begins again in it), so what it wrote is told by its exit code alone.
    EXPECT_EXIT(fault_and_report(), testing::ExitedWithCode(exit_machine_failed), "");
}

}  // namespace
}  // namespace pt
