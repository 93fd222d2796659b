// The choices that rest on Thrust (remove_if, partition, stable_partition, copy_if, sort_by_key, for_each on
// thrust::omp::par) and the counting sort, held against the standard library on hand-made queues, in both layouts.
#include <algorithm>
#include <atomic>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/hand_made_queue.h"
#include "variants/cpu/parallel_for.h"

namespace pt {
namespace {

using test::HandMadeQueue;
using test::Pattern;
using test::patterns;
using test::queue_sizes;
using test::sorted;

class CompactionTest : public testing::TestWithParam<const char*> {
protected:
    static std::unique_ptr<Compaction> make(const std::string& name) {
        return Registry::instance().find("compaction", name)->hook.compaction();
    }
    // Runs `check(queue before and after)` for every size and pattern.
    template <class Check>
    void for_each_queue(const std::string& compaction_name, Check check) {
        const auto compaction = make(compaction_name);  // one object for all: a render calls it many times too
        ASSERT_TRUE(compaction->is_active());
        std::uint64_t seed = 1;
        for (const std::size_t count : queue_sizes) {
            for (const Pattern pattern : patterns) {
                SCOPED_TRACE(testing::Message() << count << " paths, pattern " << static_cast<int>(pattern));
                HandMadeQueue made(GetParam(), count, pattern, ++seed);
                compaction->compact(made.queue);
                ASSERT_EQ(made.queue.count, made.ids_where(true).size());
                ASSERT_NO_FATAL_FAILURE(check(made, count));
            }
        }
    }
};

TEST_P(CompactionTest, RemoveIfKeepsTheLivePathsInTheirOrder) {
    for_each_queue("thrust_remove_if", [](const HandMadeQueue& made, std::size_t) {
        ASSERT_FALSE(made.queue.indirect);
        ASSERT_EQ(made.ids_in_play(), made.ids_where(true));
        ASSERT_TRUE(made.payload_is_intact(made.queue.count));
    });
}

TEST_P(CompactionTest, PartitionSplitsTheLiveFromTheEnded) {
    for_each_queue("thrust_partition", [](const HandMadeQueue& made, std::size_t count) {
        ASSERT_FALSE(made.queue.indirect);
        ASSERT_EQ(sorted(made.ids_in_play()), made.ids_where(true));
        ASSERT_EQ(sorted(made.ids_in_slots(made.queue.count, count)), made.ids_where(false));
        ASSERT_TRUE(made.payload_is_intact(count));
    });
}

TEST_P(CompactionTest, StablePartitionKeepsTheOrderOfBothGroups) {
    for_each_queue("thrust_stable_partition", [](const HandMadeQueue& made, std::size_t count) {
        ASSERT_FALSE(made.queue.indirect);
        ASSERT_EQ(made.ids_in_play(), made.ids_where(true));
        ASSERT_EQ(made.ids_in_slots(made.queue.count, count), made.ids_where(false));
        ASSERT_TRUE(made.payload_is_intact(count));
    });
}

TEST_P(CompactionTest, CopyIfIndexKeepsThePayloadInPlace) {
    for_each_queue("thrust_copy_if_index", [](const HandMadeQueue& made, std::size_t) {
        ASSERT_TRUE(made.queue.indirect);
        ASSERT_EQ(made.ids_in_play(), made.ids_where(true));
        ASSERT_TRUE(made.payload_is_in_place());
    });
}

TEST_P(CompactionTest, BounceAfterBounceTheLivePathsStay) {
    for (const std::string name :
         {"thrust_remove_if", "thrust_partition", "thrust_stable_partition", "thrust_copy_if_index"}) {
        SCOPED_TRACE(name);
        const auto compaction = make(name);
        HandMadeQueue made(GetParam(), 5000, Pattern::random, 3);
        while (made.queue.count > 0) {
            const std::size_t before = made.queue.count;
            made.end_every_third();
            compaction->compact(made.queue);
            ASSERT_LT(made.queue.count, before);
            ASSERT_EQ(sorted(made.ids_in_play()), made.ids_where(true));
        }
        EXPECT_TRUE(made.ids_where(true).empty());
    }
}

// After a sort of slot numbers the paths in play are listed in `order`; every compaction must cope with that.
TEST_P(CompactionTest, CompactsAfterAnIndexSort) {
    const auto bucket = Registry::instance().find("sorting", "bucket")->hook.sorting();
    for (const std::string name :
         {"thrust_remove_if", "thrust_partition", "thrust_stable_partition", "thrust_copy_if_index"}) {
        SCOPED_TRACE(name);
        const auto compaction = make(name);
        HandMadeQueue made(GetParam(), 10000, Pattern::random, 4);
        for (int bounce = 0; bounce < 3; ++bounce) {
            for (std::size_t i = 0; i < made.queue.count; ++i) {
                made.queue.keys[i] = made.load(made.queue.slot(i)).medium % 5;
            }
            bucket->sort(made.queue, 5);
            const std::vector<std::uint32_t> in_sorted_order = made.ids_in_play();
            made.end_every_third();
            compaction->compact(made.queue);
            ASSERT_EQ(sorted(made.ids_in_play()), made.ids_where(true));
            if (name == "thrust_copy_if_index") {  // keeps the order that it finds
                std::vector<std::uint32_t> expected;
                std::copy_if(in_sorted_order.begin(), in_sorted_order.end(), std::back_inserter(expected),
                             [&](std::uint32_t id) { return made.paths[id].alive(); });
                ASSERT_EQ(made.ids_in_play(), expected);
            }
        }
    }
}

TEST_P(CompactionTest, NoneLeavesTheQueueAlone) {
    const auto compaction = make("none");
    EXPECT_FALSE(compaction->is_active());
    HandMadeQueue made(GetParam(), 1000, Pattern::random, 5);
    compaction->compact(made.queue);
    EXPECT_EQ(made.queue.count, 1000u);
    EXPECT_FALSE(made.queue.indirect);
    EXPECT_TRUE(made.payload_is_in_place());
}

INSTANTIATE_TEST_SUITE_P(Layouts, CompactionTest, testing::Values("aos", "soa"),
                         [](const auto& test) { return std::string(test.param); });

class SortingTest : public testing::TestWithParam<const char*> {
protected:
    static std::unique_ptr<Sorting> make(const std::string& name) {
        return Registry::instance().find("sorting", name)->hook.sorting();
    }
};

// The key of a path is a function of the path, so it can be asked for again after the payload has moved.
std::uint32_t key_of(const Path<float>& path, std::uint32_t key_count) { return path.medium % key_count; }

void fill_keys(HandMadeQueue& made, std::uint32_t key_count) {
    for (std::size_t i = 0; i < made.queue.count; ++i) {
        made.queue.keys[i] = key_of(made.load(made.queue.slot(i)), key_count);
    }
}

std::vector<std::uint32_t> keys_in_play(const HandMadeQueue& made, std::uint32_t key_count) {
    std::vector<std::uint32_t> keys;
    for (std::size_t i = 0; i < made.queue.count; ++i) {
        keys.push_back(key_of(made.load(made.queue.slot(i)), key_count));
    }
    return keys;
}

// The ids in play, ordered by key and, within a key, as they stand now.
std::vector<std::uint32_t> stably_sorted(const HandMadeQueue& made, std::uint32_t key_count) {
    std::vector<std::uint32_t> ids = made.ids_in_play();
    std::stable_sort(ids.begin(), ids.end(), [&](std::uint32_t a, std::uint32_t b) {
        return key_of(made.paths[a], key_count) < key_of(made.paths[b], key_count);
    });
    return ids;
}

TEST_P(SortingTest, SortByKeyMovesPathsAndTheirHitsTogether) {
    const auto sorting = make("thrust_sort_by_key");
    ASSERT_TRUE(sorting->is_active());
    std::uint64_t seed = 10;
    for (const std::size_t count : queue_sizes) {
        // 0xffffffff: keys with the highest bit set, which CCCL 3.0.1 would misplace were they signed.
        for (const std::uint32_t key_count : {1u, 2u, 7u, 300u, 0xffffffffu}) {
            SCOPED_TRACE(testing::Message() << count << " paths, " << key_count << " keys");
            HandMadeQueue made(GetParam(), count, Pattern::random, ++seed);
            fill_keys(made, key_count);
            std::vector<std::uint32_t> expected_keys = keys_in_play(made, key_count);
            std::sort(expected_keys.begin(), expected_keys.end());
            const std::vector<std::uint32_t> ids_before = made.ids_in_play();

            sorting->sort(made.queue, key_count);

            ASSERT_EQ(made.queue.count, count);
            ASSERT_FALSE(made.queue.indirect);
            ASSERT_EQ(keys_in_play(made, key_count), expected_keys);
            ASSERT_EQ(sorted(made.ids_in_play()), ids_before);
            ASSERT_TRUE(made.payload_is_intact(count));
            for (std::size_t slot = 0; slot < count; ++slot) {
                const std::uint32_t id = made.load(slot).pixel;
                ASSERT_EQ(made.queue.hits[slot].side.code, id);
                ASSERT_EQ(made.queue.hits[slot].t, static_cast<float>(id));
            }
        }
    }
}

TEST_P(SortingTest, BucketIsStableAndKeepsThePayloadInPlace) {
    const auto sorting = make("bucket");
    ASSERT_TRUE(sorting->is_active());
    std::uint64_t seed = 100;
    for (const std::size_t count : queue_sizes) {
        for (const std::uint32_t key_count : {1u, 2u, 7u, 300u}) {
            SCOPED_TRACE(testing::Message() << count << " paths, " << key_count << " keys");
            HandMadeQueue made(GetParam(), count, Pattern::random, ++seed);
            fill_keys(made, key_count);
            const std::vector<std::uint32_t> expected = stably_sorted(made, key_count);
            sorting->sort(made.queue, key_count);
            ASSERT_EQ(made.queue.count, count);
            ASSERT_TRUE(made.queue.indirect);
            ASSERT_EQ(made.ids_in_play(), expected);
            ASSERT_TRUE(made.payload_is_in_place());
        }
    }
}

TEST_P(SortingTest, BucketSortsAnOrderThatIsThereAlready) {
    const auto sorting = make("bucket");
    HandMadeQueue made(GetParam(), 20000, Pattern::random, 7);
    Registry::instance().find("compaction", "thrust_copy_if_index")->hook.compaction()->compact(made.queue);
    ASSERT_LT(made.queue.count, 20000u);
    for (const std::uint32_t key_count : {7u, 3u, 11u}) {
        fill_keys(made, key_count);
        const std::vector<std::uint32_t> expected = stably_sorted(made, key_count);
        sorting->sort(made.queue, key_count);
        ASSERT_EQ(made.ids_in_play(), expected);
        ASSERT_TRUE(made.payload_is_in_place());
    }
}

TEST_P(SortingTest, NoneLeavesTheQueueAlone) {
    const auto sorting = make("none");
    EXPECT_FALSE(sorting->is_active());
    HandMadeQueue made(GetParam(), 1000, Pattern::random, 8);
    fill_keys(made, 3);
    sorting->sort(made.queue, 3);
    EXPECT_FALSE(made.queue.indirect);
    EXPECT_TRUE(made.payload_is_in_place());
}

INSTANTIATE_TEST_SUITE_P(Layouts, SortingTest, testing::Values("aos", "soa"),
                         [](const auto& test) { return std::string(test.param); });

TEST(ParallelForTest, MeetsEveryIndexOnceInRangesNoLongerThanAChunk) {
    for (const std::size_t count : queue_sizes) {
        for (const std::size_t chunk : {std::size_t{1}, std::size_t{64}, std::size_t{1000}, std::size_t{1024}}) {
            if (count / chunk > 10000) {
                continue;
            }
            std::vector<std::atomic<int>> met(count);
            std::atomic<bool> in_bounds = true;
            parallel_for(count, chunk, [&](std::size_t begin, std::size_t end) {
                if (begin >= end || end > count || end - begin > chunk || begin % chunk != 0) {
                    in_bounds = false;
                    return;
                }
                for (std::size_t i = begin; i < end; ++i) {
                    met[i] += 1;
                }
            });
            EXPECT_TRUE(in_bounds);
            EXPECT_TRUE(std::all_of(met.begin(), met.end(), [](const std::atomic<int>& times) { return times == 1; }))
                << count << " in chunks of " << chunk;
        }
    }
}

TEST(ParallelForTest, AnExceptionComesOutAfterTheOthersAreDone) {
    std::atomic<int> done = 0;
    const auto body = [&](std::size_t begin, std::size_t) {
        if (begin == 30) {
            throw std::runtime_error("from a chunk");
        }
        done += 1;
    };
    try {
        parallel_for(100, 10, body);
        FAIL() << "no exception";
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "from a chunk");
    }
    EXPECT_EQ(done, 9);
}

}  // namespace
}  // namespace pt
