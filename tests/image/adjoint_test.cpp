// Roulette and splitting by what a path is expected to bring have the mean of whole paths whatever is expected, do in a
// furnace what can be counted beforehand, and learn the same on any number of threads and at any scale.
#include <omp.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "harness/render/adjoint_table.h"
#include "harness/render/renderer.h"
#include "kernels/path_tree.h"
#include "tests/support/stage.h"
#include "variants/integrator/depth_first.h"

namespace pt {
namespace {

using test::expect_equal_means;
using test::lamp;
using test::SceneBuilder;
using test::side;
using test::stage;

template <class Real>
using Splitting = Config<Real, all_features | samplers | traversals | path_trees>;

struct Options {
    std::uint32_t samples = 1;
    std::uint32_t depth = 8;
    std::uint64_t seed = 1;
    bool next_event = false;
    AdjointSettings adjoint = {};
    FeatureSet sampler = no_features;
};

RenderSettings settings_of(const Scene& scene, const Options& options) {
    RenderSettings settings = default_settings(scene);
    settings.depth = options.depth;
    settings.seed = options.seed;
    settings.next_event = options.next_event;
    settings.mis_exponent = options.next_event ? 2 : 0;
    settings.adjoint = options.adjoint;
    settings.sampler = options.sampler;
    return settings;
}

// Changes what was learned; the table's views follow.
template <class Real>
using Spoil = std::function<void(AdjointTable<Real>&)>;

// A scene with a table of its own, path by path.
template <class Real>
class Trees {
public:
    Trees(const Scene& scene, const Options& options, const Spoil<Real>& spoil = {})
        : buffers_(scene, settings_of(scene, options)) {
        const RenderSettings settings = settings_of(scene, options);
        if (options.adjoint.paths != 0) {
            const auto learned = adjoint_table<Real>(learn_adjoint(scene, settings), settings);
            table_.cache = learned->cache;
            table_.by_place = learned->by_place;
            table_.by_segment = learned->by_segment;
            table_.by_pixel = learned->by_pixel;
            if (spoil) {
                spoil(table_);
            }
            table_.cache.by_place.data = table_.by_place.data();
            table_.cache.by_segment.data = table_.by_segment.data();
            table_.cache.by_pixel.data = table_.by_pixel.data();
            buffers_.set_adjoint(&table_.cache);
        }
    }

    Vec3d radiance(std::uint32_t pixel, std::uint32_t sample) {
        const SceneView<Real>& view = buffers_.view();
        Path<Real> path = generate<Splitting<Real>>(view, pixel, sample);
        PathTree<Splitting<Real>> tree;
        Hit<Real> hit = intersect<Splitting<Real>>(view, path);
        for (bool has_branch = true; has_branch; has_branch = tree.take_next(path)) {
            hit = tree.resumes() ? tree.hit() : hit;
            branches_ += 1;
            while (shade_in_tree<Splitting<Real>>(view, view, path, hit, counters_, tree)) {
                hit = intersect<Splitting<Real>>(view, path);
            }
        }
        rays_ += tree.rays();
        return Vec3d(path.radiance);
    }
    std::uint64_t rays() const { return rays_; }  // without connections
    std::uint64_t branches() const { return branches_; }

private:
    SceneBuffers<Real> buffers_;
    AdjointTable<Real> table_;
    PathCounters counters_;
    std::uint64_t rays_ = 0, branches_ = 0;
};

// The means of an image and its blocks, as test::block_means has them.
template <class Real>
std::vector<test::ColourMeanOfPixels> means_of(const Scene& scene, const Options& options,
                                               const Spoil<Real>& spoil = {}) {
    Trees<Real> trees(scene, options, spoil);
    return test::block_means_of(
        options.samples, [&](std::uint32_t pixel, std::uint32_t sample) { return trees.radiance(pixel, sample); });
}

constexpr AdjointSettings roulette{.paths = 2048, .cells = 8, .window = 5, .branches = 1};
constexpr AdjointSettings splitting{.paths = 2048, .cells = 8, .window = 5, .branches = 4};

template <class Real>
class AdjointTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(AdjointTest, Reals);

TYPED_TEST(AdjointTest, HasTheMeanOfWholePaths) {
    const std::function<std::uint32_t(SceneBuilder&)> balls[] = {
        [](auto& b) {
            return b.mix({0.75, 0.5, 0.25}, {0.9, 0.8, 0.7}, 0.4);
        },
        [](auto& b) {
            return b.subsurface({4, 3, 2}, {0.1, 0.2, 0.3}, 0, 1.3);
        },
        [](auto& b) {
            return b.dielectric(1.5, {0.5, 0.25, 1});
        },
    };
    for (const auto& ball : balls) {
        const Scene scene = stage(lamp, ball);
        const auto off = means_of<TypeParam>(scene, {.samples = 450, .seed = 41});
        expect_equal_means(off, means_of<TypeParam>(scene, {.samples = 450, .seed = 42, .adjoint = roulette}),
                           "roulette");
        expect_equal_means(off, means_of<TypeParam>(scene, {.samples = 300, .seed = 43, .adjoint = splitting}),
                           "splitting");
        expect_equal_means(
            off, means_of<TypeParam>(scene, {.samples = 200, .seed = 44, .next_event = true, .adjoint = splitting}),
            "splitting with connections");
    }
}

// Every place, segment and pixel expects something else, each from 10^low to 10^high.
template <class Real>
void spoil_by_noise(AdjointTable<Real>& table, double low, double high) {
    test::Random random(7);
    for (std::vector<float>* values : {&table.by_place, &table.by_segment, &table.by_pixel}) {
        for (float& value : *values) {
            value = static_cast<float>(std::pow(10.0, random.uniform(low, high)));
        }
    }
}

// Whatever is expected: all alike, next to nothing everywhere, or noise over six orders of magnitude.
TYPED_TEST(AdjointTest, HasTheirMeanWithAWrongTable) {
    const Scene scene = stage(lamp);
    const auto off = means_of<TypeParam>(scene, {.samples = 400, .depth = 5, .seed = 51});
    const std::pair<const char*, Spoil<TypeParam>> wrongs[] = {
        {"ones", [](auto& table) { std::ranges::fill(table.by_place, 1.0f); }},
        {"nothing", [](auto& table) { std::ranges::fill(table.by_place, 0.0f); }},
        {"noise", [](auto& table) { spoil_by_noise(table, -1.5, 1); }},
    };
    for (const auto& [name, spoil] : wrongs) {
        for (const AdjointSettings& settings : {roulette, splitting}) {
            // Few survive where nothing is expected: it takes more of them to see the mean.
            const std::uint32_t samples = std::string(name) == "nothing" ? 3200 : 400;
            expect_equal_means(
                off,
                means_of<TypeParam>(scene, {.samples = samples, .depth = 5, .seed = 52, .adjoint = settings}, spoil),
                name + std::string(settings.branches > 1 ? ", splitting" : ", roulette"));
        }
    }
}

// A closed room that shines evenly: every path brings the same, so branches bring together what one path would.
Scene furnace(std::uint32_t depth, const Vec3d& albedo) {
    SceneBuilder builder;
    builder.camera({0.25, 0.125, -0.5}, {0.3, -0.2, 1}).image(4, 4, 120, true).depth(depth);
    builder.sphere(builder.diffuse(albedo, Vec3d(1.0) - albedo), {0, 0, 0}, 2);
    return builder.scene;
}

template <class Real>
void expect_always(AdjointTable<Real>& table, Real share_of_white) {
    std::ranges::fill(table.by_place, static_cast<float>(share_of_white / 3));
    std::ranges::fill(table.by_segment, 1.0f);
    std::ranges::fill(table.by_pixel, 1.0f);
}

// With an albedo of 1/2 every number that is met is a multiple of a power of two, so not a bit may be lost.
TYPED_TEST(AdjointTest, SplittingInAFurnaceLosesNothing) {
    const std::uint32_t depth = 6;
    const Scene scene = furnace(depth, Vec3d(0.5));
    AdjointSettings settings = splitting;
    Trees<TypeParam> trees(scene, {.depth = depth, .adjoint = settings},
                           [](auto& table) { expect_always(table, TypeParam(0x1p20)); });
    for (std::uint32_t pixel = 0; pixel < 16; ++pixel) {
        EXPECT_EQ(trees.radiance(pixel, 0), Vec3d(1 - std::ldexp(1.0, -static_cast<int>(depth)))) << pixel;
    }
    // Split until the tree may have no more.
    EXPECT_EQ(trees.branches(), 16 * most_branches_of_tree);
}

// What paths bring, and their lengths without connections: means of sets of samples, each scrambled by a seed of its
// own, so that their spread tells the error whatever the numbers are drawn by.
struct Outcome {
    test::ColourMean brought;
    test::Mean length;
};

template <class Real>
Outcome outcome_of(const Scene& scene, Options options, std::uint32_t samples, const Spoil<Real>& spoil) {
    Outcome outcome;
    for (options.seed = 100; options.seed < 116; ++options.seed) {
        Trees<Real> trees(scene, options, spoil);
        Vec3d sum(0.0);
        for (std::uint32_t sample = 0; sample < samples; ++sample) {
            sum += trees.radiance(0, sample);
        }
        outcome.brought.add(sum / static_cast<double>(samples));
        outcome.length.add(static_cast<double>(trees.rays()) / samples);
    }
    return outcome;
}

// To some 0.5 %: 4.5 standard errors of at most 0.12 %.
void expect_exact(const test::Mean& mean, double exact, const std::string& what) {
    EXPECT_NEAR(mean.value(), exact, test::tolerated_errors * mean.standard_error() + 2e-6 * exact) << what;
    EXPECT_LT(mean.standard_error(), 0.0012 * exact) << what;
}

// A path that is expected to bring p of the lower bound at its first vertex survives it with p and then brings that
// bound; at every later one the albedo alone is left of it. So many segments in the mean, and the same sum.
TYPED_TEST(AdjointTest, RouletteInAFurnaceHasTheLengthThatFollows) {
    const double albedo = 0.75, first = 0.5;
    const std::uint32_t depth = 9;
    const Scene scene = furnace(depth, Vec3d(albedo));
    const auto outcome = outcome_of<TypeParam>(scene, {.depth = depth, .adjoint = roulette}, 65536, [&](auto& table) {
        expect_always(table, static_cast<TypeParam>(first) * table.cache.lowest);
    });
    double expected = 1;
    for (std::uint32_t segment = 2; segment <= depth; ++segment) {
        expected += first * std::pow(albedo, segment - 2);
    }
    expect_exact(outcome.length, expected, "length");
    expect_exact(outcome.brought.channel[0], 1 - std::pow(albedo, depth), "brought");
}

// Both that end many paths and that split many.
TYPED_TEST(AdjointTest, AFurnaceOfEveryColourShinesEvenlyWhateverIsExpected) {
    const Vec3d albedo{0.75, 0.5, 0.25};
    const std::uint32_t depth = 4;
    const Scene scene = furnace(depth, albedo);
    for (const AdjointSettings& settings : {roulette, splitting}) {
        const double high = settings.branches > 1 ? 1 : 0.25;
        const auto outcome = outcome_of<TypeParam>(scene, {.depth = depth, .adjoint = settings}, 16384,
                                                   [&](auto& table) { spoil_by_noise(table, -1, high); });
        const std::string what = std::to_string(settings.branches) + " branches, channel ";
        for (int i = 0; i < 3; ++i) {
            expect_exact(outcome.brought.channel[i], 1 - std::pow(albedo[i], depth), what + std::to_string(i));
        }
        // A path has `depth` segments, unless it is ended or split.
        if (settings.branches > 1) {
            EXPECT_GT(outcome.length.value(), 2 * depth);
        } else {
            EXPECT_LT(outcome.length.value(), 0.9 * depth);
        }
    }
}

// The floor's centre, below that of a square lamp half its width away: irradiance_test.cpp has the number.
TYPED_TEST(AdjointTest, ConnectionsBringTheIrradianceWhateverIsExpected) {
    SceneBuilder builder;
    builder.camera({-3, 0.5, -3}, {0, 0, 0});
    builder.quad(builder.diffuse(Vec3d(0.75)), {0, 0, 0}, 10, 10);
    builder.quad(builder.emitter(Vec3d(1.0)), {0, 1, 0}, 2, 2);
    const double exact = 0.75 * 1.740839502734206 / pi<double>;
    for (const AdjointSettings& settings : {roulette, splitting}) {
        // A fifth of what the window begins with, or four times what it ends with.
        const auto outcome = outcome_of<TypeParam>(
            builder.scene,
            {.depth = 2, .next_event = true, .adjoint = settings, .sampler = set_of(Feature::sobol_owen)}, 4096,
            [&](auto& table) {
                const AdjointCache<TypeParam>& cache = table.cache;
                const TypeParam share = settings.branches > 1 ? cache.highest * 4 : cache.lowest / 5;
                expect_always(table, share);
            });
        expect_exact(outcome.brought.channel[0], exact, std::to_string(settings.branches) + " branches");
    }
}

// Inside the window nothing happens: the film of paths that no roulette knows.
TYPED_TEST(AdjointTest, WithinTheWindowChangesNothing) {
    const Scene scene = stage(lamp);
    Trees<TypeParam> off(scene, {.depth = 5});
    Trees<TypeParam> on(scene, {.depth = 5, .adjoint = splitting}, [](auto& table) {
        table.cache.lowest = TypeParam(0x1p-60);
        table.cache.highest = TypeParam(0x1p60);
    });
    for (std::uint32_t pixel = 0; pixel < side * side; ++pixel) {
        ASSERT_EQ(on.radiance(pixel, 3), off.radiance(pixel, 3)) << pixel;
    }
    EXPECT_EQ(on.branches(), off.branches());
}

// Branches of a vertex draw numbers of their own, from every source of numbers that has a branch's number in its key.
TYPED_TEST(AdjointTest, BranchesDifferWithEverySampler) {
    const Scene scene = stage(lamp);
    for (const Feature sampler :
         {Feature::philox, Feature::sobol_owen, Feature::sobol_rotated, Feature::pmj02, Feature::halton}) {
        const Options options{.depth = 4, .sampler = set_of(sampler)};
        const RandomSeed seed = SceneBuffers<TypeParam>(scene, settings_of(scene, options)).view().seed;
        using Kernel = Config<TypeParam, all_features | samplers>;
        for (const std::uint32_t block : {random_block::scatter, random_block::light, random_block::walk}) {
            const RandomWords first = random_words<Kernel>(seed, {5, 6, 2, block});
            const RandomWords second = random_words<Kernel>(seed, {5, 6, 2 | (1u << segment_bits), block});
            EXPECT_NE(first.x, second.x);
            EXPECT_NE(first.y, second.y);
            EXPECT_NE(first.w, second.w);
        }
    }
}

void expect_same_estimates(const AdjointTable<float>& a, const AdjointTable<float>& b, const std::string& what) {
    EXPECT_EQ(a.by_place, b.by_place) << what;
    EXPECT_EQ(a.by_segment, b.by_segment) << what;
    EXPECT_EQ(a.by_pixel, b.by_pixel) << what;
}

std::unique_ptr<const AdjointTable<float>> learned(const Scene& scene, std::uint64_t seed = 3) {
    return std::move(learned_adjoint<float>(scene, settings_of(scene, {.seed = seed, .adjoint = roulette})).table);
}

void expect_same_on(int number) {
    const Scene scene = stage(lamp, [](auto& b) { return b.subsurface({4, 3, 2}, {0.1, 0.2, 0.3}); });
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const auto one = learned(scene);
    omp_set_num_threads(number);
    const auto several = learned(scene);
    omp_set_num_threads(threads);
    expect_same_estimates(*one, *several, "threads");
    EXPECT_EQ(one->cache.low, several->cache.low);
    EXPECT_NE(one->by_place, learned(scene, 4)->by_place) << "another seed";
}

TEST(AdjointTableTest, IsTheSameOnThreeThreads) { expect_same_on(3); }

TEST(AdjointTableTest, IsTheSameOnAnyNumberOfThreads) { expect_same_on(7); }

TEST(AdjointTableTest, IsTheSameAtAnyScale) {
    const Scene scene = stage(lamp);
    const auto as_it_is = learned(scene);
    for (const int k : {-30, 20}) {
        const auto larger = learned(test::scaled(scene, std::ldexp(1.0, k)));
        expect_same_estimates(*as_it_is, *larger, "scaled");
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(std::ldexp(as_it_is->cache.low[axis], k), larger->cache.low[axis]);
            EXPECT_EQ(std::ldexp(as_it_is->cache.cells_a_unit[axis], -k), larger->cache.cells_a_unit[axis]);
        }
        expect_same_estimates(*as_it_is, *learned(test::brightened(scene, std::ldexp(1.0, k))), "brightened");
    }
}

TEST(AdjointTableTest, IsNoneWhereThereIsNoLight) {
    const Scene dark = stage([](auto& b) { b.sphere(b.diffuse({0.5, 0.5, 0.5}), {0.5, 3, -1}, 1.2); });
    EXPECT_EQ(learned(dark), nullptr);
}

// The estimates of a furnace are known: each is what is left of the series after so many segments.
TEST(AdjointTableTest, KnowsAFurnace) {
    const double albedo = 0.5;
    const std::uint32_t depth = 6;
    const Scene scene = furnace(depth, Vec3d(albedo));
    RenderSettings settings = settings_of(scene, {.depth = depth, .adjoint = roulette});
    settings.adjoint.cells = 1;
    const AdjointRecords records = learn_adjoint(scene, settings);
    ASSERT_EQ(records.vertices.size(), roulette.paths * (depth - 1));
    const auto carried = [&](std::uint32_t segment) { return 3 * std::pow(albedo, segment - 1); };
    const auto left = [&](std::uint32_t segment) { return albedo - std::pow(albedo, depth - segment + 1); };
    for (const AdjointRecord& record : records.vertices) {
        EXPECT_EQ(record.carried, carried(record.segment));
        EXPECT_EQ(record.brought, carried(record.segment) * left(record.segment));
    }
    const auto table = adjoint_table<float>(records, settings);
    for (const float pixel : table->by_pixel) {
        EXPECT_EQ(pixel, 1.0f);
    }
    double all_carried = 0, all_brought = 0;
    for (std::uint32_t segment = 1; segment < depth; ++segment) {
        all_carried += roulette.paths * carried(segment);
        all_brought += roulette.paths * carried(segment) * left(segment);
    }
    const double average = all_brought / all_carried;
    // A side's estimate is the average but for which segments happen to end there: among its 1700 records, which differ
    // by half of their mean, 5 standard errors are 6 %; 32 records more count as the average.
    ASSERT_EQ(table->by_place.size(), 6u);
    for (const float place : table->by_place) {
        EXPECT_NEAR(place * left(1) * 3, average, 0.06 * average);
    }
    ASSERT_EQ(table->by_segment.size(), depth - 1);
    const double added = 32 * all_brought / static_cast<double>(records.vertices.size());
    for (std::uint32_t segment = 1; segment < depth; ++segment) {
        const double weight = roulette.paths * carried(segment);
        const double expected = (weight * left(segment) + added) / (weight * average + added);
        EXPECT_NEAR(table->by_segment[segment - 1], expected, 0.06 * expected) << segment;
    }
}

}  // namespace
}  // namespace pt
