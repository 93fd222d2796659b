// CUDA's side of what `ptbench new` writes. Of a compaction and an integrator: the C++ compiler takes the host's half
// here, and NVRTC the kernels. Of a shape: NVRTC compiles a whole kernel that has it, in every way in which shapes are
// met. No GPU is needed. What they do on one, their own tests say where they are written.
#include <cstdlib>

#include <gtest/gtest.h>

#include "harness/cuda/kernel_request.h"
#include "harness/render/renderer.h"
#include "harness/scene/places.h"
#include "tests/support/places.h"
#include "variants/cuda/runtime/nvrtc.h"
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
            cuda::ModuleRequest request = cuda::stage_request(variant, *choice, "sm_90");
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
    ::setenv("PTBENCH_HOME", test::source_folder().c_str(), 1);
    const Scene scene = find_scene("cornell_open_unjittered");
    for (const auto& [axis, choice] : {std::pair{"specialisation", "features"},
                                       {"specialisation", "generic"},
                                       {"specialisation", "baked"},
                                       {"precision", "double"},
                                       {"first_bounce", "cached"}}) {
        Variant variant = Registry::instance().baseline(Backend::cuda);
        variant.set("integrator", example);
        variant.set(axis, choice);
        SCOPED_TRACE(variant.spelled_out());
        ASSERT_EQ(why_not_applicable(variant, features_of(scene), Backend::cuda), "");
        cuda::ModuleRequest request = cuda::module_request(scene, variant, "sm_90");
        request.options.push_back("-I" PTBENCH_EXAMPLES);
        EXPECT_NE(cuda::compile_quickly(request).cubin.find("trace_tiles"), std::string::npos);
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

// The list with the example's line and its header stand before the program's own.
TEST(NewChoiceTest, KernelsOfAShapeCompile) {
    ASSERT_EQ(cuda::nvrtc_missing(), "");
    const Scene scene = load_scene(test::in_source("scenes/cornell_closed.json"));
    for (const auto& [axis, choice] :
         {std::pair{"direct_light", "nee_mis"}, std::pair{"specialisation", "matrix"}, std::pair{"robustness", "naive"},
          std::pair{"precision", "double"}, std::pair{"precision", "double_intersection"}}) {
        Variant variant = Registry::instance().baseline(Backend::cuda);
        variant.set("integrator", "megakernel");
        variant.set(axis, choice);
        SCOPED_TRACE(variant.spelled_out());
        cuda::ModuleRequest request = cuda::module_request(scene, variant, "sm_90");
        request.config.features |= feature_bit::shape << shape_count;  // the line after the last
        request.config.has_fixed_counts = false;                       // the program's own list has no count of it
        request.options.insert(request.options.begin(), "-I" PTBENCH_EXAMPLE_SHAPE);
        for (cuda::KernelSignature& kernel : request.kernels) {
            kernel.parameter_bytes += sizeof(View<char>);  // the scene's list of them
        }
        const std::string with = cuda::compile_quickly(request).cubin;
        request.config.features &= ~(feature_bit::shape << shape_count);
        EXPECT_NE(with, cuda::compile_quickly(request).cubin);
    }
}

}  // namespace
}  // namespace pt
