// A new axis is a folder with an axis.h and its choices: the registry, compiled again with such a folder beside the
// repository's own (tests/overlay/variants/example_), knows it, and no line elsewhere names it.
#include <gtest/gtest.h>

#include "variants/registry.h"

namespace pt {
namespace {

Variant with(std::string choice) {
    Variant variant;
    variant.set("example_", std::move(choice));
    return variant;
}

TEST(NewAxisTest, StandsWhereItsOrderPutsIt) {
    const std::size_t place = Variant::index("example_");
    EXPECT_EQ(axis_table[place].what, "what a test adds");
    EXPECT_EQ(axis_names[place - 1], "sorting");
    EXPECT_EQ(axis_names[place + 1], "sort_key");
    EXPECT_EQ(axis_count, std::variant_size_v<Traits> - 1);
}

TEST(NewAxisTest, ChoicesAreFoundTheBaselineFirst) {
    for (const Backend backend : all_backends) {
        const std::vector<const Choice*> choices = Registry::instance().choices("example_", backend);
        ASSERT_EQ(choices.size(), 2u);
        EXPECT_EQ(choices[0]->descriptor.name, "plain");
        EXPECT_EQ(choices[1]->descriptor.name, "other");
    }
}

TEST(NewAxisTest, TraitsReachTheChoicesOfOtherAxes) {
    EXPECT_EQ(traits_of(with("plain"), Backend::cpu).example_.value, 1);
    EXPECT_EQ(traits_of(with("other"), Backend::cpu).example_.value, 2);
    EXPECT_EQ(traits_of(with("other"), Backend::cpu).example_.name, "other");
}

}  // namespace
}  // namespace pt
