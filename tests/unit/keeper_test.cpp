// What is kept is made once; what was used longest ago makes room first.
#include "harness/scene/keeper.h"

#include <gtest/gtest.h>

namespace pt {
namespace {

struct Kept {
    int value = 0;
    std::size_t bytes = 0;
    std::size_t kept_bytes() const { return bytes; }
};

class KeeperTest : public testing::Test {
protected:
    int get(const std::string& key, std::size_t bytes = 1) {
        return keeper.get(key, [&] { return Kept{++made, bytes}; })->value;
    }

    Keeper<Kept> keeper;
    int made = 0;
};

TEST_F(KeeperTest, MakesOnce) {
    EXPECT_EQ(get("a"), 1);
    EXPECT_EQ(get("b"), 2);
    EXPECT_EQ(get("a"), 1);
    EXPECT_EQ(get("b"), 2);
}

TEST_F(KeeperTest, WhatWasUsedLongestAgoMakesRoom) {
    const std::size_t third = most_kept_bytes / 3;
    get("a", third);
    get("b", third);
    EXPECT_EQ(get("a"), 1);
    EXPECT_EQ(get("c", third), 3);  // with the keys more than there is room for: b goes
    EXPECT_EQ(get("a"), 1);
    EXPECT_EQ(get("b", 1), 4);
}

TEST_F(KeeperTest, KeepsNoMoreThanItMay) {
    for (std::size_t i = 0; i <= most_kept; ++i) {
        get(std::to_string(i));
    }
    const int all = made;
    EXPECT_EQ(get(std::to_string(most_kept)), all);
    EXPECT_EQ(get("0"), all + 1);
}

TEST(KeptBytesTest, AreAnEighthOfTheMemoryWithinBounds) {
    constexpr std::size_t gibibyte = std::size_t{1} << 30;
    EXPECT_EQ(kept_bytes_of(4 * gibibyte), 6 * gibibyte);
    EXPECT_EQ(kept_bytes_of(80 * gibibyte), 10 * gibibyte);
    EXPECT_EQ(kept_bytes_of(1024 * gibibyte), 16 * gibibyte);
    EXPECT_GE(most_kept_bytes, 6 * gibibyte);
}

TEST_F(KeeperTest, WhatAloneIsTooLargeIsKeptUntilTheNext) {
    EXPECT_EQ(get("large", most_kept_bytes + 1), 1);
    EXPECT_EQ(get("large"), 1);
    EXPECT_EQ(get("small"), 2);
    EXPECT_EQ(get("large", 1), 3);
}

}  // namespace
}  // namespace pt
