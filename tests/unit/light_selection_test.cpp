// Which light is drawn: the alias table's probabilities are whole numbers that add up exactly, the tree's are those
// that its draws have, and no light is out of reach, whatever its power and place.
#include "kernels/light_selection.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "harness/scene/light_tables.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

using test::Random;

template <class Real>
class LightSelectionTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(LightSelectionTest, Reals);

LightExtent extent(const Vec3d& centre, double radius, double power) {
    return {{centre - Vec3d(radius), centre + Vec3d(radius)}, power, Vec3d(power / 6)};
}

// Powers over twelve decades, some lights on one place.
std::vector<LightExtent> random_lights(std::uint32_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<LightExtent> lights;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3d centre{random.uniform(-100, 100), random.uniform(-1, 1), random.uniform(-30, 30)};
        lights.push_back(extent(i % 7 == 0 ? Vec3d(3.0) : centre, std::pow(10, random.uniform(-3, 0)),
                                std::pow(10, random.uniform(-6, 6))));
    }
    return lights;
}

template <class Real>
View<LightSlot<Real>> slots_of(const LightTables<Real>& tables) {
    return {tables.slots.data(), static_cast<std::uint32_t>(tables.slots.size())};
}
template <class Real>
View<LightNode<Real>> nodes_of(const LightTables<Real>& tables) {
    return {tables.nodes.data(), static_cast<std::uint32_t>(tables.nodes.size())};
}

// The probability that pick_from_tree draws a light.
template <class Real>
double tree_probability(const LightTables<Real>& tables, const LitVertex<Real>& vertex, std::uint32_t light) {
    LightNode<Real> node = tables.nodes[0];
    double probability = 1;
    for (std::uint32_t way = tables.slots[light].way; !node.is_leaf(); way >>= 4) {
        const auto sent = [&](std::uint32_t i) {
            const LightNode<Real>& child = tables.nodes[node.link + i];
            return SeenNode<Real>(child, vertex.position).sent_to(vertex, child);
        };
        Real total = 0;
        for (std::uint32_t i = 0; i < node.child_count; ++i) {
            total += sent(i);
        }
        const Shares<Real> shares(total, node.child_count);
        const auto share = [&](std::uint32_t i) { return std::floor(static_cast<double>(shares.of(sent(i)))); };
        double left = 0x1p32;
        for (std::uint32_t i = 0; i + 1 < node.child_count; ++i) {
            left -= share(i);
        }
        const std::uint32_t chosen = way & 15u;
        probability *= (chosen + 1 < node.child_count ? share(chosen) : left) * 0x1p-32;
        node = tables.nodes[node.link + chosen];
    }
    return probability;
}

template <class Real>
Vec3<Real> random_normal(Random& random) {
    return Vec3<Real>(normalize(Vec3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))));
}

RandomWords random_words(Random& random) { return {random.word(), random.word(), random.word(), random.word()}; }

TYPED_TEST(LightSelectionTest, SlotsAddUpToTheProbabilityThatIsDividedBy) {
    for (const std::uint32_t count : {1u, 2u, 3u, 12u, 1000u, 100000u}) {
        const std::vector<LightExtent> lights = random_lights(count, count);
        const LightTables<TypeParam> tables = light_tables<TypeParam>(lights);
        std::vector<std::uint64_t> mass(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            mass[i] += tables.slots[i].threshold;
            mass[tables.slots[i].alias] += (std::uint64_t{1} << 32) - tables.slots[i].threshold;
        }
        const double whole = 0x1p32 * count;
        double power = 0;
        for (const LightExtent& light : lights) {
            power += light.power;
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            ASSERT_GT(mass[i], 0u);
            ASSERT_EQ(tables.slots[i].inverse_probability,
                      static_cast<TypeParam>(whole / static_cast<double>(mass[i])));
            // Rounded to a whole number, what that leaves over by the brightest.
            ASSERT_NEAR(static_cast<double>(mass[i]), lights[i].power / power * whole, 2.0 * count) << count;
        }
    }
}

TYPED_TEST(LightSelectionTest, PowerDrawsWhatTheSlotsSay) {
    // The 64 bits that pick a light, evenly from 0 to 2^64: each light's share of them is its mass, to a step.
    const std::vector<LightExtent> lights = random_lights(12, 5);
    const LightTables<TypeParam> tables = light_tables<TypeParam>(lights);
    constexpr std::uint32_t steps = 1u << 20;
    std::vector<double> drawn(lights.size());
    for (std::uint32_t i = 0; i < steps; ++i) {
        const LightPick<TypeParam> pick = pick_by_power(slots_of(tables), i << 12, 0x80000000u);
        ASSERT_LT(pick.light, lights.size());
        ASSERT_EQ(pick.inverse_probability, tables.slots[pick.light].inverse_probability);
        drawn[pick.light] += 1;
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const double share = 1 / static_cast<double>(tables.slots[i].inverse_probability);
        EXPECT_NEAR(drawn[i] / steps, share, 24.0 / steps) << i;
    }
}

// 64 bits decide: a light of less than 2^-32 of the power is drawn.
TEST(LightSelection, PowerDrawsLightsOfAlmostNoPower) {
    const LightTables<double> tables =
        light_tables<double>(std::vector<LightExtent>{extent(Vec3d(0.0), 1, 1e-11), extent(Vec3d(1.0), 1, 1)});
    EXPECT_EQ(tables.slots[0].inverse_probability, 0x1p33);
    EXPECT_EQ(pick_by_power(slots_of(tables), 0, 0).light, 0u);
    EXPECT_EQ(pick_by_power(slots_of(tables), 0, 0xffffffffu).light, 1u);
}

TYPED_TEST(LightSelectionTest, TreeDrawsWithTheProbabilityThatItSays) {
    for (const std::uint32_t count : {1u, 2u, 12u, 1000u, 100000u}) {
        const LightTables<TypeParam> tables = light_tables<TypeParam>(random_lights(count, 30 + count));
        Random random(count);
        for (int place = 0; place < (count > 1000 ? 2 : 50); ++place) {
            const Vec3<TypeParam> position{
                Vec3d(random.uniform(-150, 150), random.uniform(-9, 9), random.uniform(-50, 50))};
            const LitVertex<TypeParam> vertex{position, random_normal<TypeParam>(random), place % 2 == 1};
            double drawn = 0, weighed = 0;
            for (std::uint32_t light = 0; light < count; ++light) {
                drawn += tree_probability(tables, vertex, light);
                weighed +=
                    1 / static_cast<double>(inverse_tree_weighing(nodes_of(tables), position, tables.slots[light].way));
            }
            EXPECT_NEAR(drawn, 1, 1e-16 * std::max(100u, count));
            // No more than one, but for the roundings of each weight, and one but for what Shares holds back of each
            // level.
            EXPECT_LE(weighed, 1 + (count > 1000 ? static_cast<double>(gamma<TypeParam>(64)) : 0));
            EXPECT_GE(weighed, 1 - LightNode<TypeParam>::most_levels * 0x1p-12);
            for (int draw = 0; draw < 20; ++draw) {
                const LightPick<TypeParam> pick = pick_from_tree(nodes_of(tables), vertex, random_words(random));
                ASSERT_LT(pick.light, count);
                const double probability = tree_probability(tables, vertex, pick.light);
                // 64 roundings are a few for each level of the tree.
                ASSERT_NEAR(static_cast<double>(pick.inverse_probability) * probability, 1,
                            64 * static_cast<double>(gamma<TypeParam>(1)));
                // Both techniques weigh by one density, bit for bit.
                ASSERT_EQ(pick.inverse_weighing,
                          inverse_tree_weighing(nodes_of(tables), position, tables.slots[pick.light].way));
            }
        }
    }
}

// A scene in other units is the same scene: bit for bit, for units that are powers of two.
TYPED_TEST(LightSelectionTest, TreeDrawsAlikeInEveryUnit) {
    constexpr std::uint32_t count = 300;
    const std::vector<LightExtent> lights = random_lights(count, 12);
    const LightTables<TypeParam> tables = light_tables<TypeParam>(lights);
    for (const int exponent : {-30, 10, 30, 40}) {
        const double unit = std::exp2(exponent);
        std::vector<LightExtent> scaled = lights;
        for (LightExtent& light : scaled) {
            light.bounds = {light.bounds.low * unit, light.bounds.high * unit};
        }
        const LightTables<TypeParam> same = light_tables<TypeParam>(scaled);
        Random random(4);
        for (int place = 0; place < 20; ++place) {
            const Vec3d position{random.uniform(-150, 150), random.uniform(-9, 9), random.uniform(-50, 50)};
            const Vec3<TypeParam> normal = random_normal<TypeParam>(random);
            for (std::uint32_t light = 0; light < count; light += 7) {
                ASSERT_EQ(tree_probability(
                              same, {Vec3<TypeParam>(position) * static_cast<TypeParam>(unit), normal, false}, light),
                          tree_probability(tables, {Vec3<TypeParam>(position), normal, false}, light))
                    << "2^" << exponent;
            }
        }
    }
}

// Chi-square of a tree's draws: levels are decided by numbers that know nothing of each other.
TYPED_TEST(LightSelectionTest, TreeDrawsAsOftenAsItSays) {
    constexpr std::uint32_t count = 40;
    std::vector<LightExtent> lights = random_lights(count, 8);
    for (std::uint32_t i = 0; i < count; ++i) {
        lights[i].power = 1 + i % 5;
        lights[i].shown = Vec3d(lights[i].power / 6);
    }
    const LightTables<TypeParam> tables = light_tables<TypeParam>(lights);
    const LitVertex<TypeParam> vertex{Vec3<TypeParam>(Vec3d(4, 0.5, 2)), Vec3<TypeParam>(Vec3d(0, 0.6, 0.8)), false};
    Random random(3);
    constexpr int draws = 400000;
    std::vector<std::uint64_t> drawn(count);
    for (int i = 0; i < draws; ++i) {
        drawn[pick_from_tree(nodes_of(tables), vertex, random_words(random)).light] += 1;
    }
    std::vector<double> probabilities;
    for (std::uint32_t light = 0; light < count; ++light) {
        probabilities.push_back(tree_probability(tables, vertex, light));
    }
    EXPECT_GT(test::chi_square_test(drawn, probabilities), test::chi_square_alpha);
}

// The nearer of equal lights is drawn the oftener, by the square of its distance, and the brighter by its power; by the
// cosine to the normal too, and not from behind it. To what Shares gives to each whatever it sends.
TYPED_TEST(LightSelectionTest, TreeWeighsWhatLightsSend) {
    constexpr double tolerance = 0x1p-11;
    const Vec3<TypeParam> here(TypeParam(0));
    const auto tables_of = [](const Vec3d& first, const Vec3d& second, double power) {
        return light_tables<TypeParam>(std::vector<LightExtent>{extent(first, 0, 1), extent(second, 0, power)});
    };
    const auto weighing = [&](double power) {
        const LightTables<TypeParam> tables = tables_of({-1, 0, 0}, {2, 0, 0}, power);
        return 1 / static_cast<double>(inverse_tree_weighing(nodes_of(tables), here, tables.slots[0].way));
    };
    EXPECT_NEAR(weighing(1), 0.8, tolerance);
    EXPECT_NEAR(weighing(4), 0.5, tolerance);
    // Cosines of 0.6 and 0.8, and of -0.8; distances of 5.
    const auto first_of = [&](double height, bool two_sided) {
        const LitVertex<TypeParam> vertex{here, {TypeParam(0), TypeParam(1), TypeParam(0)}, two_sided};
        return tree_probability(tables_of({4, 3, 0}, {height < 0 ? 3.0 : -3.0, height, 0}, 1), vertex, 0);
    };
    EXPECT_NEAR(first_of(4, false), 3.0 / 7, tolerance);
    EXPECT_NEAR(first_of(-4, true), 3.0 / 7, tolerance);
    EXPECT_NEAR(first_of(-4, false), 1, tolerance);
}

// A lamp shows the more, the more its face is turned to the place, and what may be above the horizon counts.
TYPED_TEST(LightSelectionTest, TreeKnowsFacesByAxis) {
    const LitVertex<TypeParam> vertex{Vec3<TypeParam>(TypeParam(0)), {TypeParam(0), TypeParam(1), TypeParam(0)}, false};
    LightExtent facing = extent({0, 4, 0}, 0, 1), edge_on = extent({0, 4, 0}, 0, 1);
    facing.shown = {0, 1, 0};
    edge_on.shown = {1, 0, 1};
    const LightTables<TypeParam> flat = light_tables<TypeParam>(std::vector<LightExtent>{facing, edge_on});
    EXPECT_NEAR(tree_probability(flat, vertex, 0), 1, 0x1p-11);
    const LightTables<TypeParam> straddling =
        light_tables<TypeParam>(std::vector<LightExtent>{extent({0, -1, 0}, 2, 1), extent({0, -3, 0}, 1, 1)});
    EXPECT_NEAR(tree_probability(straddling, vertex, 0), 1, 0x1p-11);
}

// Probabilities are bounded from below however far, near, bright or large things are.
TYPED_TEST(LightSelectionTest, EveryLightIsWithinReachFromEverywhere) {
    const double huge = sizeof(TypeParam) == 4 ? 1e30 : 1e200;
    const std::vector<LightExtent> lights{extent(Vec3d(0.0), 0, 1),        extent(Vec3d(0.0), 0, 1e-300),
                                          extent(Vec3d(huge), 1, 0),       extent(Vec3d(1.0), huge, 1e300),
                                          extent(Vec3d(0.0), 1 / huge, 1), extent({-huge, 0, huge}, 0, 1e-12)};
    const LightTables<TypeParam> tables = light_tables<TypeParam>(lights);
    for (const Vec3d& place : {Vec3d(0.0), Vec3d(1.0), Vec3d(huge), Vec3d(-huge), Vec3d(0, huge * 1e8, 0)}) {
        for (const LightSlot<TypeParam>& slot : tables.slots) {
            const TypeParam inverse = inverse_tree_weighing(nodes_of(tables), Vec3<TypeParam>(place), slot.way);
            EXPECT_GE(inverse, TypeParam(1));
            EXPECT_LE(inverse, TypeParam(0x1p12));
            for (const bool two_sided : {false, true}) {
                const LitVertex<TypeParam> vertex{
                    Vec3<TypeParam>(place), {TypeParam(0), TypeParam(0.6), TypeParam(0.8)}, two_sided};
                const std::uint32_t light = static_cast<std::uint32_t>(&slot - tables.slots.data());
                const double probability = tree_probability(tables, vertex, light);
                EXPECT_GE(probability, 0x1p-13);
                EXPECT_LE(probability, 1);
            }
            EXPECT_GE(slot.inverse_probability, TypeParam(1));
            EXPECT_LE(slot.inverse_probability, TypeParam(0x1p35));
        }
    }
}

// Lights of which every cut would take one off, so that the levels would run out.
TYPED_TEST(LightSelectionTest, TreesEndWithinTheirLevels) {
    std::vector<LightExtent> lights;
    for (int i = 0; i < 300; ++i) {
        lights.push_back(extent({std::ldexp(1.0, -i), 0, 0}, std::ldexp(1.0, -i - 4), std::ldexp(1.0, -2 * i)));
    }
    const LightTables<TypeParam> tables = light_tables<TypeParam>(lights);
    for (std::uint32_t light = 0; light < lights.size(); ++light) {
        LightNode<TypeParam> node = tables.nodes[0];
        std::uint32_t way = tables.slots[light].way, level = 0;
        for (; !node.is_leaf(); ++level, way >>= 4) {
            ASSERT_LT(level, LightNode<TypeParam>::most_levels);
            ASSERT_LT(way & 15u, node.child_count);
            ASSERT_LE(node.child_count, LightNode<TypeParam>::most_children);
            node = tables.nodes[node.link + (way & 15u)];
        }
        EXPECT_EQ(node.light(), light);
    }
}

}  // namespace
}  // namespace pt
