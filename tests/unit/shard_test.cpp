// Shards: every cell in one of them, what is compared together.
#include "harness/bench/shard.h"

#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace pt {
namespace {

using Positions = std::vector<std::size_t>;

// A cell of a variant `name` in a setting "/scene:S/..."; its work is the number of pixels.
Cell cell_of(const std::string& name, const std::string& setting, std::uint32_t pixels = 1) {
    Cell cell;
    cell.name = name + setting;
    cell.settings.width = pixels;
    cell.settings.height = 1;
    return cell;
}

// And with checkpoints, compared with the reference of a scene.
Cell checked(const std::string& name, const std::string& setting, const std::string& reference) {
    Cell cell = cell_of(name, setting + "/checkpoints:octaves");
    auto scene = std::make_shared<Scene>(test::SceneBuilder().scene);
    scene->name = reference;
    cell.convergence = CellConvergence{{1}, {.scene = scene}, false};
    return cell;
}

std::string refusal(const std::string& text) {
    try {
        (void)parse_shard(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(ShardTest, IsReadFromItsName) {
    EXPECT_EQ(parse_shard("2/4").index, 2u);
    EXPECT_EQ(parse_shard("2/4").count, 4u);
    EXPECT_EQ(parse_shard("2/4").name(), "2/4");
    EXPECT_TRUE(parse_shard("1/1").is_whole());
    for (const std::string text : {"", "2", "2/", "/4", "0/4", "5/4", "0/0", "-1/4", "1/4x", "1/ 4", "a/b", "1.0/2"}) {
        EXPECT_EQ(refusal(text),
                  "--shard: argument: found \"" + text + "\", allowed: I/N, the I-th of N parts, I from 1 to N");
    }
}

TEST(ShardTest, CellsOfOneSettingAreAGroup) {
    const Plan plan{
        {cell_of("a", "/scene:s/depth:2"), cell_of("a", "/scene:s/depth:4"), cell_of("b", "/scene:s/depth:2"),
         cell_of("a", "/scene:t/depth:2"), cell_of("b", "/scene:s/depth:4")},
        {}};
    EXPECT_EQ(groups_of(plan), (std::vector<Positions>{{0, 2}, {1, 4}, {3}}));
}

// A choice that has the mean of a greater depth runs at a smaller one, and is compared with the same image.
TEST(ShardTest, CellsOfOneReferenceAreAGroupWithTheirTwins) {
    const Plan plan{{checked("plain", "/scene:s/depth:8", "s"), cell_of("plain", "/scene:s/depth:8"),
                     checked("final_bounce", "/scene:s/depth:7", "s"), cell_of("final_bounce", "/scene:s/depth:7"),
                     checked("plain", "/scene:t/depth:8", "t"), cell_of("plain", "/scene:u/depth:8")},
                    {}};
    EXPECT_EQ(groups_of(plan), (std::vector<Positions>{{0, 1, 2, 3}, {4}, {5}}));
}

TEST(ShardTest, EveryCellIsInOneShardAndGroupsStayWhole) {
    Plan plan;
    for (std::uint32_t setting = 0; setting < 7; ++setting) {
        for (const char* variant : {"a", "b", "c"}) {
            plan.cells.push_back(cell_of(variant, "/scene:" + std::to_string(setting), 1 + 3 * setting));
        }
    }
    for (std::uint32_t count = 1; count <= 7; ++count) {
        Positions all;
        for (std::uint32_t index = 1; index <= count; ++index) {
            const Positions positions = positions_of(plan, {index, count});
            EXPECT_EQ(positions, positions_of(plan, {index, count}));
            EXPECT_TRUE(std::is_sorted(positions.begin(), positions.end()));
            EXPECT_FALSE(positions.empty()) << index << "/" << count;
            for (std::size_t i = 0; i < positions.size(); i += 3) {
                EXPECT_EQ(positions[i] % 3, 0u);
                EXPECT_EQ(positions[i + 2], positions[i] + 2);
            }
            all.insert(all.end(), positions.begin(), positions.end());
        }
        std::sort(all.begin(), all.end());
        Positions every(plan.cells.size());
        std::iota(every.begin(), every.end(), 0);
        EXPECT_EQ(all, every) << count;
    }
}

TEST(ShardTest, TheLargestGoFirstToWhoHasLeast) {
    const Plan plan{{cell_of("a", "/scene:1", 4), cell_of("a", "/scene:2", 10), cell_of("a", "/scene:3", 5),
                     cell_of("a", "/scene:4", 6)},
                    {}};
    EXPECT_EQ(positions_of(plan, {1, 2}), (Positions{0, 1}));  // 10, then 4
    EXPECT_EQ(positions_of(plan, {2, 2}), (Positions{2, 3}));  // 6, then 5
}

TEST(ShardTest, MoreShardsThanGroupsAreRefused) {
    const Plan plan{{cell_of("a", "/scene:1"), cell_of("b", "/scene:1")}, {}};
    EXPECT_EQ(positions_of(plan, {1, 1}), (Positions{0, 1}));
    try {
        (void)positions_of(plan, {1, 2});
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(),
                     "--shard: argument: found \"1/2\", allowed: at most 1 parts of this run: cells of one scene and "
                     "setting stay together");
    }
}

TEST(ShardTest, APartHasItsCellsAndAllThatDoesNotApply) {
    Plan plan{{cell_of("a", "/scene:1"), cell_of("a", "/scene:2"), cell_of("a", "/scene:3")},
              {{.study = "s", .scene = "1", .variant = {}, .reason = {.code = "test", .text = "why", .axis = {}}}}};
    const Plan part = part_of(plan, {0, 2});
    ASSERT_EQ(part.cells.size(), 2u);
    EXPECT_EQ(part.cells[1].name, "a/scene:3");
    EXPECT_EQ(part.not_applicable.size(), 1u);
}

}  // namespace
}  // namespace pt
