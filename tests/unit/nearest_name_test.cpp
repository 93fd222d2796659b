// What somebody may have meant.
#include "harness/nearest_name.h"

#include <gtest/gtest.h>

namespace pt {
namespace {

TEST(NearestNameTest, CountsEdits) {
    EXPECT_EQ(edit_distance("", ""), 0u);
    EXPECT_EQ(edit_distance("", "abc"), 3u);
    EXPECT_EQ(edit_distance("layout", "layot"), 1u);
    EXPECT_EQ(edit_distance("compactoin", "compaction"), 1u);  // a swap
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
    EXPECT_EQ(edit_distance("sitting", "kitten"), 3u);
}

TEST(NearestNameTest, NamesTheNearestThatIsNear) {
    const std::vector<std::string> known{"cornell_closed", "cornell_open", "edge"};
    EXPECT_EQ(did_you_mean("cornel_open", known), " (did you mean \"cornell_open\"?)");
    EXPECT_EQ(did_you_mean("egde", known), " (did you mean \"edge\"?)");
    EXPECT_EQ(did_you_mean("nothing", known), "");
    EXPECT_EQ(did_you_mean("", known), "");
    EXPECT_EQ(did_you_mean("x", {"y"}), "");  // any letter is one edit from any other
    EXPECT_EQ(did_you_mean(std::string(100000, 'a'), known), "");
}

}  // namespace
}  // namespace pt
