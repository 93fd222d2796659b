// How a CUDA render's samples are cut into parts and batches, and which rays of a first-bounce cache each part traces:
// the host's side, without a device.
#include <gtest/gtest.h>

#include "variants/cuda/persistent.h"
#include "variants/cuda/wavefronts.h"

namespace pt::cuda {
namespace {

using Cut = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Cut batches_of(const std::vector<std::uint32_t>& checkpoints, std::uint32_t in_flight) {
    Job job;
    Batches batches(job, in_flight, {});
    Cut cut;
    std::uint32_t done = 0;
    for (const std::uint32_t checkpoint : checkpoints) {
        job.first_sample = 100 + done;
        job.samples = checkpoint - done;
        batches.run([&](std::uint32_t first, std::uint32_t samples) { cut.emplace_back(first, samples); });
        done = checkpoint;
    }
    return cut;
}

TEST(BatchesTest, AreAsManySamplesAsFitAndEndWithTheirPart) {
    EXPECT_EQ(batches_of({11}, 1).size(), 11u);
    EXPECT_EQ(batches_of({11}, 4), (Cut{{100, 4}, {104, 4}, {108, 3}}));
    EXPECT_EQ(batches_of({1, 2, 8, 11}, 4), (Cut{{100, 1}, {101, 1}, {102, 4}, {106, 2}, {108, 3}}));
    EXPECT_EQ(batches_of({1, 2, 4, 8, 11}, 16), (Cut{{100, 1}, {101, 1}, {102, 2}, {104, 4}, {108, 3}}));
}

std::vector<std::uint32_t> filled(std::uint32_t rays, const std::vector<std::uint32_t>& parts) {
    Job job;
    job.kept_rays = rays;
    std::vector<std::uint32_t> missing;
    for (const std::uint32_t part : parts) {
        job.samples = part;
        missing.push_back(take_missing_rays(job));
    }
    return missing;
}

using Counts = std::vector<std::uint32_t>;

TEST(BatchesTest, EachRayOfTheCacheIsTracedInThePartThatUsesItFirst) {
    EXPECT_EQ(filled(0, {1, 5}), (Counts{0, 0}));  // no cache
    EXPECT_EQ(filled(1, {1, 1, 2}), (Counts{1, 0, 0}));
    EXPECT_EQ(filled(5, {1, 1, 2, 4, 8}), (Counts{1, 1, 2, 1, 0}));
    EXPECT_EQ(filled(16, {1, 1, 2, 4}), (Counts{1, 1, 2, 4}));  // fewer samples than rays
    EXPECT_EQ(filled(4, {100}), (Counts{4}));
}

TEST(BatchesTest, ALaunchTakesNoMoreSamplesThanThePartHas) {
    Job job;
    job.longest_path = 8;
    job.samples = 3;
    EXPECT_EQ(samples_per_launch(job, 1), 3u);
    job.samples = 0xffffffffu;
    EXPECT_EQ(samples_per_launch(job, 1), 0xffffffffu / (2 * 8 * 128));
    // Each of a pixel's four threads takes that many.
    EXPECT_EQ(samples_per_launch(job, 4), 4 * (0xffffffffu / (2 * 8 * 128)));
    job.longest_path = 1000000;
    EXPECT_EQ(samples_per_launch(job, 1u << 18), (1u << 18) * 16);
    job.samples = 1u << 20;
    EXPECT_EQ(samples_per_launch(job, 1u << 18), 1u << 20);
}

TEST(BatchesTest, TheHostAsksForTheEndOfLongPathsWhereNobodyTellsIt) {
    constexpr bool told = true, capturing = true;
    Job job;
    job.longest_path = 1000000;
    EXPECT_TRUE(asks_for_the_end(job, !told, !capturing, 512));
    EXPECT_FALSE(asks_for_the_end(job, !told, !capturing, 513));
    // The read-back of the count has the pinned words that asking would use.
    EXPECT_FALSE(asks_for_the_end(job, told, !capturing, 512));
    EXPECT_FALSE(asks_for_the_end(job, !told, capturing, 512));
    job.longest_path = few_segments;
    EXPECT_FALSE(asks_for_the_end(job, !told, !capturing, 512));
}

TEST(BatchesTest, APersistentLaunchTakesAsManySamplesAsItHasNumbersForPieces) {
    Job job;
    job.samples = 1u << 20;
    job.longest_path = 1000000;
    job.pixels = 16 * 16;
    EXPECT_EQ(samples_per_persistent_launch(job), 1u << 20);
    job.samples = 0xffffffffu;
    job.pixels = 800 * 800;
    EXPECT_EQ(samples_per_persistent_launch(job), 0xffffffffu / 20000 - 1);
}

TEST(BatchesTest, AThreadCanCountAPiece) {
    Job job;
    job.longest_path = 8;
    EXPECT_EQ(samples_per_strip(job, 128), 128u);
    job.longest_path = 1000000;
    EXPECT_EQ(samples_per_strip(job, 128), 65u);  // 2^32 / (64 * 10^6) = 67, less the two rounds that may wait
    job.longest_path = 0x80000000u;
    EXPECT_EQ(samples_per_strip(job, 128), 1u);
}

}  // namespace
}  // namespace pt::cuda
