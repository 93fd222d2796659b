// The CUDA side of the compaction that `ptbench new` writes: the C++ compiler takes the host's half here, and NVRTC the
// kernels, in every layout and precision. No GPU is needed. What it does on one, its own test says where it is written.
#include PTBENCH_EXAMPLE

#include <gtest/gtest.h>

#include "harness/cuda/kernel_request.h"
#include "variants/cuda/nvrtc.h"

namespace pt {
namespace {

TEST(NewChoiceTest, KernelsCompile) {
    ASSERT_EQ(cuda::nvrtc_missing(), "");
    for (const Choice* layout : Registry::instance().choices("layout", Backend::cuda)) {
        for (const char* precision : {"float", "double"}) {
            Variant variant = Registry::instance().baseline(Backend::cuda);
            variant.set("layout", std::string(layout->descriptor.name));
            variant.set("precision", precision);
            SCOPED_TRACE(variant.spelled_out());
            // Not from the cache: its key knows the text of embedded sources only.
            const cuda::ModuleImage image =
                cuda::compile_module(cuda::stage_request(variant, PTBENCH_EXAMPLE, "sm_90"));
            EXPECT_NE(image.cubin.find("list_live_slots"), std::string::npos);
        }
    }
}

TEST(NewChoiceTest, SaysWhatItIs) {
    using cuda::compaction::example_::descriptor;
    EXPECT_EQ(descriptor.axis, "compaction");
    EXPECT_EQ(descriptor.name, "example_");
    EXPECT_EQ(descriptor.backends, on_cuda);
    EXPECT_EQ(descriptor.claim, Claim::bitwise);
    EXPECT_NE(descriptor.check_counters, nullptr);
    EXPECT_NE(cuda::compaction::example_::hooks.compaction, nullptr);
}

}  // namespace
}  // namespace pt
