// CUDA's side of what `ptbench new` writes: the C++ compiler takes the host's half here, and NVRTC the kernels, in
// every layout and precision. No GPU is needed. What it does on one, its own test says where it is written.
#include <cstdlib>

#include <gtest/gtest.h>

#include "harness/cuda/kernel_request.h"
#include "harness/places.h"
#include "harness/render/renderer.h"
#include "variants/cuda/nvrtc.h"
#include "variants/registry.h"

namespace pt {
namespace {

// The name under which CMake fills the templates in.
constexpr const char* example = "example_";

TEST(NewChoiceTest, KernelsOfACompactionCompile) {
    ASSERT_EQ(cuda::nvrtc_missing(), "");
    const Choice* const choice = Registry::instance().find("compaction", example, Backend::cuda);
    ASSERT_NE(choice, nullptr);
    for (const Choice* layout : Registry::instance().choices("layout", Backend::cuda)) {
        for (const char* precision : {"float", "double"}) {
            Variant variant = Registry::instance().baseline(Backend::cuda);
            variant.set("layout", std::string(layout->descriptor.name));
            variant.set("precision", precision);
            SCOPED_TRACE(variant.spelled_out());
            cuda::ModuleRequest request = cuda::stage_request(
                variant, "variants/compaction/" + std::string(example) + ".cuh", choice->hook.cuda.kernels, "sm_90");
            request.options.push_back("-I" PTBENCH_EXAMPLES);
            // Not from the cache: its key knows the text of embedded sources only.
            EXPECT_NE(cuda::compile_module(request).cubin.find("list_live_slots"), std::string::npos);
        }
    }
}

TEST(NewChoiceTest, ACompactionSaysWhatItIs) {
    const Choice* const choice = Registry::instance().find("compaction", example, Backend::cuda);
    ASSERT_NE(choice, nullptr);
    EXPECT_EQ(choice->descriptor.backends, on_cuda);
    EXPECT_EQ(choice->descriptor.claim, Claim::bitwise);
    EXPECT_NE(choice->descriptor.check_counters, nullptr);
    EXPECT_NE(choice->hook.cuda.compaction, nullptr);
}

TEST(NewChoiceTest, KernelsOfAnIntegratorCompile) {
    ASSERT_EQ(cuda::nvrtc_missing(), "");
    ::setenv("PTBENCH_HOME", PTBENCH_SOURCE_DIR, 1);
    const Scene scene = find_scene("cornell_open_unjittered");
    for (const auto& [axis, choice] : {std::pair{"specialisation", "features"},
                                       {"specialisation", "generic"},
                                       {"specialisation", "baked"},
                                       {"precision", "double"},
                                       {"first_bounce", "cached"}}) {
        Variant variant = Registry::instance().baseline(Backend::cuda);
        variant.set("integrator", example);
        variant.set(axis, choice);
        SCOPED_TRACE(variant.name());
        ASSERT_EQ(why_not_applicable(variant, features_of(scene), Backend::cuda), "");
        cuda::ModuleRequest request = cuda::module_request(scene, variant, "sm_90");
        request.options.push_back("-I" PTBENCH_EXAMPLES);
        EXPECT_NE(cuda::compile_module(request).cubin.find("trace_tiles"), std::string::npos);
    }
}

TEST(NewChoiceTest, AnIntegratorSaysWhatItIs) {
    const Choice* const choice = Registry::instance().find("integrator", example, Backend::cuda);
    ASSERT_NE(choice, nullptr);
    EXPECT_EQ(choice->descriptor.backends, on_cuda);
    EXPECT_EQ(choice->descriptor.claim, Claim::bitwise);
    EXPECT_NE(choice->descriptor.check_counters, nullptr);
    EXPECT_NE(choice->hook.cuda.integrator.make_single, nullptr);
    EXPECT_NE(choice->hook.cuda.integrator.make_double, nullptr);
}

}  // namespace
}  // namespace pt
