// The bound that memory's speed sets to passes over a queue, against sums by hand.
#include <gtest/gtest.h>

#include "harness/cuda/memory_bound.h"

namespace pt::cuda::test {
namespace {

const std::vector<GpuCopyRate> rates{{.bytes = 1e6, .gb_per_s = 4000}, {.bytes = 4e6, .gb_per_s = 2000}};

TEST(MemoryBoundTest, TimeIsThatOfACopyOfTheSize) {
    EXPECT_EQ(least_seconds(1e6, rates), 1e6 / 4e12);
    EXPECT_EQ(least_seconds(4e6, rates), 4e6 / 2e12);
    EXPECT_DOUBLE_EQ(least_seconds(2e6, rates), 2e6 / 3e12);  // half-way between the sizes' logarithms
}

TEST(MemoryBoundTest, BeyondTheMeasuredSizesTheNearestRateHolds) {
    EXPECT_EQ(least_seconds(8.0, rates), 8.0 / 4e12);
    EXPECT_EQ(least_seconds(4e9, rates), 4e9 / 2e12);
    EXPECT_EQ(least_seconds(0, rates), 0);
    EXPECT_EQ(least_seconds(3e6, {{.bytes = 1e6, .gb_per_s = 1000}}), 3e6 / 1e12);
}

TEST(MemoryBoundTest, PassesFollowAllSegmentsButTheLast) {
    // Four paths begin, two of them trace a second segment, one a third.
    const LeastBytes least{.a_path = 1000, .a_survivor = 10};
    const std::vector<GpuCopyRate> rate{{.bytes = 1, .gb_per_s = 1}};
    EXPECT_EQ(bound_of(least, {4, 2, 1}, 3, 1, rate).bytes, 4 * 1000 + 2 * 10 + 2 * 1000 + 1 * 10);
    EXPECT_EQ(bound_of(least, {4, 2, 1}, 8, 1, rate).bytes, 7 * 1000 + 3 * 10);
    EXPECT_EQ(bound_of(least, {4}, 1, 1, rate).bytes, 0);
    EXPECT_EQ(bound_of(least, {}, 8, 1, rate).ms, 0);
}

TEST(MemoryBoundTest, WhatAPassListsTheNextOneReads) {
    const LeastBytes least{.a_path = 1000, .a_survivor = 10, .a_listed = 1};
    const std::vector<GpuCopyRate> rate{{.bytes = 1, .gb_per_s = 1}};
    EXPECT_EQ(bound_of(least, {4, 2, 1}, 8, 1, rate).bytes, 7 * 1000 + 3 * 10 + 3 * 1);
}

class MovesPaths : public Compaction {
public:
    void compact(Queue&) override {}
};
class ListsSlots final : public MovesPaths {
public:
    bool moves_paths() const override { return false; }
};

// Where no path ends, each is read once and written once, its liveness with the rest.
TEST(MemoryBoundTest, ACompactionReadsNoByteTwice) {
    const BytesOfAPath path{.state = 64, .liveness = 4, .hit = 8};
    const std::vector<GpuCopyRate> rate{{.bytes = 1, .gb_per_s = 1}};
    EXPECT_EQ(bound_of(MovesPaths().least_bytes(path), {5, 5}, 2, 1, rate).bytes, 5 * 2 * 64);
    EXPECT_EQ(bound_of(ListsSlots().least_bytes(path), {5, 5}, 2, 1, rate).bytes, 5 * (4 + 4));
    EXPECT_EQ(bound_of(ListsSlots().least_bytes(path), {5, 5, 5}, 3, 1, rate).bytes, 5 * (4 + 4) + 5 * (4 + 4 + 4));
}

TEST(MemoryBoundTest, EachBatchPassesOverItsOwnPaths) {
    const LeastBytes least{.a_path = 1};
    const std::vector<std::uint64_t> live{4'000'000, 4'000'000};
    // In one batch a pass is of 4 MB, in four batches there are four passes of 1 MB, at twice the rate.
    const double at_once = bound_of(least, live, 8, 1, rates).ms, in_four = bound_of(least, live, 8, 4, rates).ms;
    EXPECT_DOUBLE_EQ(at_once, 2 * 1e3 * 4e6 / 2e12);
    EXPECT_DOUBLE_EQ(in_four, at_once / 2);
}

}  // namespace
}  // namespace pt::cuda::test
