// Counters of ray batches: which launch belongs to which batch of a result. Needs neither ncu nor a GPU.
#include "harness/rays/ray_counters.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace pt {
namespace {

using Json = nlohmann::ordered_json;

Json meshes() {
    return Json::parse(R"([
        {"mesh": "a", "ray_sets": [{"class": "primary", "rays": 16}, {"class": "shadow", "rays": 32}], "trees": [
            {"accelerator": "cwbvh", "builder": "lbvh", "batches": [
                {"class": "primary", "kernel": "persistent"}, {"class": "primary", "kernel": "plain"},
                {"class": "shadow", "kernel": "persistent_no_vote"}]},
            {"accelerator": "brute_force", "builder": null, "batches": [{"class": "shadow", "kernel": "plain"}]}]},
        {"mesh": "b", "ray_sets": [{"class": "shadow", "rays": 64}], "trees": [
            {"accelerator": "bvh2", "builder": "lbvh", "batches": [{"class": "shadow", "kernel": "plain"}]}]}])");
}

Json launch(double lanes) {
    return {{"active_lanes", lanes},
            {"thread_instructions_per_ray", 1000},
            {"memory_bytes_per_ray", 64.5},
            {"of_ceiling", {{"issue", 0.5}, {"alu", 0.75}, {"l1", 0.25}, {"l2", 0.125}, {"memory", 0.0}}},
            {"bound", "alu"}};
}

TEST(RayCountersTest, BatchesAreInTheOrderOfTheResult) {
    const std::vector<std::pair<std::string, double>> expected{
        {"closest_hits", 16}, {"trace_plain", 16}, {"closest_hits", 32}, {"trace_plain", 32}, {"trace_plain", 64}};
    EXPECT_EQ(rays::counted_batches(meshes()), expected);
}

TEST(RayCountersTest, EachBatchHasTheCountersOfItsLaunch) {
    Json counted = meshes(), launches = Json::array();
    for (int i = 0; i < 5; ++i) {
        launches.push_back(launch(i));
    }
    rays::add_counters(counted, launches);
    EXPECT_EQ(counted[0]["trees"][0]["batches"][2]["counters"]["active_lanes"], 2);
    EXPECT_EQ(counted[0]["trees"][1]["batches"][0]["counters"]["active_lanes"], 3);
    EXPECT_EQ(counted[1]["trees"][0]["batches"][0]["counters"]["active_lanes"], 4);
    const std::string table = rays::counters_table_of(counted[0]);
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 4);
    EXPECT_NE(table.find("   2.0      1000     64.5   50 %   25 %   12 %    0 %  alu 75 %\n"), std::string::npos)
        << table;
}

}  // namespace
}  // namespace pt
