// The kernels that findings time on a GPU are among those that stability is asked of.
#include "harness/stability/timed_variants.h"

#include <set>

#include <gtest/gtest.h>

#include "harness/cli/stability_tasks.h"
#include "tests/support/backends.h"

namespace pt::stability {
namespace {

using Setting = std::pair<std::string, std::string>;

std::set<Setting> settings(const std::vector<Variant>& variants, const char* axis) {
    std::set<Setting> met;
    for (const Variant& variant : variants) {
        met.emplace(variant["integrator"], axis == std::string("room")
                                               ? std::to_string(tunable(variant, "room", Backend::cuda))
                                               : variant[axis]);
    }
    return met;
}

std::vector<Variant> of_turns(std::size_t first, std::size_t count, bool quick) {
    std::vector<Variant> all;
    for (std::size_t turn = first; turn < first + count; ++turn) {
        for (const Variant& variant : timed_variants(Backend::cuda, turn, quick)) {
            all.push_back(variant);
        }
    }
    return all;
}

class TimedVariantsTest : public testing::Test {
protected:
    void SetUp() override {
        if (!test::cuda_is_built()) {
            GTEST_SKIP() << "built without CUDA";
        }
    }
};

TEST_F(TimedVariantsTest, AreClaimedToPassAndCompiledForTheirScene) {
    for (const Variant& variant : of_turns(0, 8, false)) {
        EXPECT_TRUE(must_pass(variant, Backend::cuda)) << variant.spelled_out();
        EXPECT_EQ(variant["specialisation"], "features") << variant.spelled_out();
        EXPECT_NE(variant["integrator"], "audited");
    }
}

TEST_F(TimedVariantsTest, EverySchedulerMeetsEachArithmeticInEachCase) {
    for (const std::size_t turn : {0u, 1u, 2u, 7u}) {
        const std::set<Setting> met = settings(of_turns(turn, 1, false), "arithmetic");
        for (const char* integrator : {"megakernel", "megakernel_regen", "persistent", "regroup"}) {
            EXPECT_TRUE(met.contains({integrator, "exact"})) << integrator;
            EXPECT_TRUE(met.contains({integrator, "precise"})) << integrator;
        }
        EXPECT_EQ(met.size(), 10u) << "one integrator with a queue beside those";
    }
}

TEST_F(TimedVariantsTest, OfQuickRunsTwoCasesMeetWhatOneDoesOtherwise) {
    const auto without_queues = [](std::set<Setting> met) {
        std::erase_if(met, [](const Setting& setting) { return setting.first.starts_with("wavefront"); });
        return met;
    };
    EXPECT_EQ(without_queues(settings(of_turns(0, 2, true), "arithmetic")),
              without_queues(settings(of_turns(0, 2, false), "arithmetic")));
}

TEST_F(TimedVariantsTest, WithAndWithoutARoomAndByEveryQueueOverTheCases) {
    std::set<Setting> integrators;
    for (const Choice* choice : Registry::instance().choices("integrator", Backend::cuda)) {
        if (!traits_in<IntegratorTraits>(choice->descriptor).inspects) {
            integrators.emplace(choice->descriptor.name, "0");
            integrators.emplace(choice->descriptor.name, "1");
        }
    }
    EXPECT_EQ(settings(of_turns(0, 12, true), "room"), integrators);
}

TEST_F(TimedVariantsTest, EveryAcceleratorAndEstimatorIsAskedByThem) {
    StabilityRequest request;
    request.cases = {"triangle_mesh"};
    std::set<std::string> accelerators, lights;
    for (const Task& task : all_tasks(request, Backend::cuda)) {
        if (task.variant["specialisation"] == "features" && task.variant["arithmetic"] == "precise") {
            accelerators.insert(task.variant["accelerator"]);
            lights.insert(task.variant["direct_light"]);
        }
    }
    for (const Choice* choice : Registry::instance().choices("accelerator", Backend::cuda)) {
        EXPECT_TRUE(accelerators.contains(std::string(choice->descriptor.name))) << choice->descriptor.name;
    }
    const Case& triangle_mesh = *chosen_cases(request).front();
    for (const std::string& choice : triangle_mesh.estimators.at("direct_light")) {
        EXPECT_TRUE(lights.contains(choice)) << choice;
    }
}

TEST_F(TimedVariantsTest, AreLeftOutWhereAnAxisIsNamed) {
    StabilityRequest request;
    request.cases = {"triangle_mesh"};
    request.axes = {"arithmetic=exact"};
    for (const Task& task : all_tasks(request, Backend::cuda)) {
        EXPECT_EQ(task.variant["specialisation"], "generic");
    }
}

TEST(TimedVariantsOnCpuTest, AreNone) { EXPECT_TRUE(timed_variants(Backend::cpu, 0, false).empty()); }

}  // namespace
}  // namespace pt::stability
