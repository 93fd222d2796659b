// Copies on a device, kept from render to render, with a copy that is no more than a number.
#include "harness/cuda/kept_copies.h"

#include <gtest/gtest.h>

namespace pt::cuda {
namespace {

// Counts how often it is compared.
struct CountedKey {
    int value;
    static inline int compared = 0;
    bool operator<(const CountedKey& other) const {
        compared += 1;
        return value < other.value;
    }
};

struct Copied {
    using Key = CountedKey;
    static Key key_of(int host) { return {host}; }
    explicit Copied(int host) : value(host) { made += 1; }
    std::size_t bytes() const { return static_cast<std::size_t>(10 * value); }

    int value;
    static inline int made = 0;
};

TEST(KeptCopies, FindWhatWasMadeAndNothingElse) {
    KeptCopies<Copied> kept;
    EXPECT_EQ(kept.find(1), nullptr);
    const auto one = kept.make(1);
    EXPECT_EQ(kept.make(2)->value, 2);
    EXPECT_EQ(kept.find(1), one);
    EXPECT_EQ(kept.find(3), nullptr);
    EXPECT_EQ(kept.size(), 2u);
    EXPECT_EQ(kept.bytes(), 30u);
}

TEST(KeptCopies, DropWhatWasUsedLongestAgo) {
    KeptCopies<Copied> kept;
    for (const int host : {1, 2, 3}) {
        (void)kept.make(host);
    }
    EXPECT_NE(kept.find(1), nullptr);  // so 2 is the oldest
    kept.drop_oldest();
    EXPECT_EQ(kept.find(2), nullptr);
    EXPECT_EQ(kept.bytes(), 40u);
    kept.drop_oldest();
    EXPECT_EQ(kept.find(3), nullptr);
    EXPECT_NE(kept.find(1), nullptr);
    EXPECT_EQ(kept.size(), 1u);
}

TEST(KeptCopies, ACopyOutlivesItsPlace) {
    KeptCopies<Copied> kept;
    const auto held = kept.make(7);
    kept.drop_oldest();
    EXPECT_EQ(kept.bytes(), 0u);
    EXPECT_EQ(held->value, 7);
    EXPECT_NE(kept.make(7), held);
}

// A balanced tree of 2^14 keys is at most twice as deep as their logarithm, and its keys are compared once on the way
// down and once at the end.
TEST(KeptCopies, ManyAreFoundByFewComparisons) {
    KeptCopies<Copied> kept;
    constexpr int many = 1 << 14;
    for (int host = 0; host < many; ++host) {
        (void)kept.make(host);
    }
    Copied::made = CountedKey::compared = 0;
    for (int host = 0; host < many; ++host) {
        ASSERT_EQ(kept.find(host)->value, host);
    }
    EXPECT_EQ(Copied::made, 0);
    EXPECT_LE(CountedKey::compared, many * (2 * 15 + 1));
}

}  // namespace
}  // namespace pt::cuda
