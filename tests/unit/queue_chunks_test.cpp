// Into how many chunks a queue is divided for sort_key=chunk_material.
#include "variants/cuda/queue_chunks.h"

#include <gtest/gtest.h>

namespace pt::cuda {
namespace {

constexpr std::uint32_t image = 800 * 800;  // paths

// The key of a path, as the kernel has it (variants/cuda/device/hit_keys.cuh).
std::uint32_t key_of(std::uint32_t slot, std::uint32_t material, std::uint32_t materials, std::uint32_t chunk) {
    return slot / chunk * (materials + 1) + material;
}

TEST(QueueChunksTest, AreAsLongAsAskedWhereKeysAreFew) {
    EXPECT_EQ(slots_of_chunk(image, 9, 65536), 65536u);
    EXPECT_EQ(chunks_of(image, 65536), 10u);
    EXPECT_EQ(keys_of_chunks(image, 9, 65536), 100u);
    EXPECT_EQ(slots_of_chunk(image, 66, 65536), 65536u);
    EXPECT_EQ(keys_of_chunks(image, 66, 65536), 670u);
    EXPECT_EQ(slots_of_chunk(image, 9, 4096), 4096u);
    EXPECT_EQ(chunks_of(image, 4096), 157u);
}

TEST(QueueChunksTest, CoverEverySlotOnce) {
    EXPECT_EQ(chunks_of(1, 256), 1u);
    EXPECT_EQ(chunks_of(256, 256), 1u);
    EXPECT_EQ(chunks_of(257, 256), 2u);
    EXPECT_EQ(chunks_of(512, 256), 2u);
    EXPECT_EQ(chunks_of(0x7fffffff, 0x7fffffff), 1u);  // as many paths as a queue may hold
    EXPECT_EQ(chunks_of(0x7fffffff, 1), 0x7fffffffu);
}

TEST(QueueChunksTest, GrowWhereTheirKeysCouldNotBeCounted) {
    // 4095 keys of live paths at 65 a chunk: 63 chunks and no more.
    const std::uint32_t chunk = slots_of_chunk(1u << 24, 64, 65536);
    EXPECT_EQ(chunk, 266306u);
    EXPECT_EQ(chunks_of(1u << 24, chunk), 63u);
    EXPECT_EQ(chunks_of(1u << 24, chunk - 1), 64u);  // the fewest slots that will do
    for (const std::uint32_t capacity : {1u, 255u, image, 1u << 24, 0x7fffffffu}) {
        for (const std::uint32_t materials : {1u, 2u, 7u, 64u, 1000u, 2046u, 2047u, 4093u, 4094u}) {
            for (const std::uint32_t asked : {256u, 65536u, 16777216u}) {
                const std::uint32_t slots = slots_of_chunk(capacity, materials, asked);
                EXPECT_GE(slots, asked);
                EXPECT_LE(keys_of_chunks(capacity, materials, slots) + 1, most_bucket_keys)
                    << capacity << " slots, " << materials << " materials, " << asked << " asked for";
            }
        }
    }
}

TEST(QueueChunksTest, ThereIsOneWhereMaterialsAloneAreTooMany) {
    for (const std::uint32_t materials : {2047u, 4094u, 4095u, 4096u, 1000000u}) {
        EXPECT_EQ(slots_of_chunk(image, materials, 256), image) << materials;
        EXPECT_EQ(keys_of_chunks(image, materials, image), materials + 1);  // those of sort_key=material
    }
    EXPECT_EQ(chunks_of(image, slots_of_chunk(image, 2046, 256)), 2u);
}

// What ended and what lies beyond the count has the key behind all of them.
TEST(QueueChunksTest, TheKeysOfLivePathsAreBelowTheLast) {
    for (const std::uint32_t capacity : {1u, 256u, 257u, 1000u, image}) {
        for (const std::uint32_t materials : {1u, 9u, 66u, 4095u}) {
            const std::uint32_t chunk = slots_of_chunk(capacity, materials, 256);
            EXPECT_LT(key_of(capacity - 1, materials, materials, chunk), keys_of_chunks(capacity, materials, chunk));
        }
    }
    // Keys are ordered by chunk, then by material, "missed" the last of a chunk.
    EXPECT_EQ(key_of(65535, 9, 9, 65536) + 1, key_of(65536, 0, 9, 65536));
}

}  // namespace
}  // namespace pt::cuda
