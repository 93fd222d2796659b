// The film: integer sums that no order can change, exact for dyadic radiance, with every fault counted.
#include "harness/render/film.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"

namespace pt {
namespace {

struct Sample {
    std::uint32_t pixel;
    Vec3<float> radiance;
};

std::vector<Sample> random_samples(std::uint64_t seed, int count, std::uint32_t pixels) {
    test::Random random(seed);
    std::vector<Sample> samples;
    for (int i = 0; i < count; ++i) {
        const auto value = [&] { return static_cast<float>(std::exp2(random.uniform(-20, 4))); };
        samples.push_back({random.word() % pixels, {value(), value(), value()}});
    }
    return samples;
}

void add_all(Film& film, const std::vector<Sample>& samples) {
    for (const Sample& sample : samples) {
        film.view().add(sample.pixel, sample.radiance);
    }
}

TEST(FilmTest, SumsDoNotDependOnTheOrder) {
    std::vector<Sample> samples = random_samples(1, 10000, 12);
    Film forward(4, 3, 16, 1000), backward(4, 3, 16, 1000), shuffled(4, 3, 16, 1000);
    add_all(forward, samples);
    std::reverse(samples.begin(), samples.end());
    add_all(backward, samples);
    test::Random random(2);
    for (std::size_t i = samples.size() - 1; i > 0; --i) {
        std::swap(samples[i], samples[random.word() % (i + 1)]);
    }
    add_all(shuffled, samples);
    EXPECT_EQ(forward.sums(), backward.sums());
    EXPECT_EQ(forward.sums(), shuffled.sums());
    EXPECT_EQ(forward.hash(), shuffled.hash());
}

TEST(FilmTest, DyadicRadianceIsSummedExactly) {
    Film film(2, 1, 1, 4);
    for (int i = 1; i <= 4; ++i) {
        film.view().add(1, Vec3<float>(0.25f * static_cast<float>(i), 1.0f, 0.0f));
    }
    EXPECT_EQ(film.pixel(1), Vec3d(0.625, 1, 0));
    EXPECT_EQ(film.pixel(0), Vec3d(0, 0, 0));
    EXPECT_EQ(film.mean(), Vec3d(0.3125, 0.5, 0));
    EXPECT_EQ(film.radiance(), (std::vector<float>{0, 0, 0, 0.625f, 1, 0}));
}

TEST(FilmTest, ManySmallSamplesDoNotDrift) {
    // numerics.md S43: a float sum of 0.1 is off by 1 % at 1e6 samples. Here the only error is the first rounding to a
    // quantum.
    constexpr int count = 1000000;
    Film film(1, 1, 1, count);
    for (int i = 0; i < count; ++i) {
        film.view().add(0, Vec3<float>(0.1f, 1.0f, 1e-6f));
    }
    EXPECT_NEAR(film.pixel(0).x, static_cast<double>(0.1f), 1e-11);
    EXPECT_EQ(film.pixel(0).y, 1.0);
    EXPECT_NEAR(film.pixel(0).z / static_cast<double>(1e-6f), 1, 1e-5);
}

TEST(FilmTest, SaturatedSamplesAreCountedAndClamped) {
    Film film(1, 1, 1, 2);
    const FilmView view = film.view();
    const double limit = view.limit / view.scale;
    view.add(0, Vec3<double>(2 * limit, 0.5, -4 * limit));
    EXPECT_EQ(film.faults().saturated, 1u);
    EXPECT_EQ(film.faults().negative, 1u);
    EXPECT_EQ(film.faults().nonfinite, 0u);
    EXPECT_EQ(film.sums()[0], static_cast<std::int64_t>(view.limit));
    EXPECT_EQ(static_cast<double>(film.sums()[1]), 0.5 * view.scale);
    EXPECT_EQ(film.sums()[2], -static_cast<std::int64_t>(view.limit));
    view.add(0, Vec3<double>(limit, 0, 0));  // exactly the limit is no fault
    EXPECT_EQ(film.faults().saturated, 1u);
    EXPECT_GT(film.sums()[0], 0);  // as many samples as the film is for cannot overflow it
}

TEST(FilmTest, NonfiniteSamplesAreCountedAndLeftOut) {
    Film film(1, 1, 1, 8);
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    film.view().add(0, Vec3<float>(1, 1, 1));
    const std::vector<std::int64_t> before = film.sums();
    film.view().add(0, Vec3<float>(nan, 1, 1));
    film.view().add(0, Vec3<float>(1, 1, nan));
    film.view().add(0, Vec3<float>(1, infinity, 1));
    film.view().add(0, Vec3<float>(1, -infinity, 1));
    film.view().add(0, Vec3<float>(infinity, -infinity, 1));
    EXPECT_EQ(film.sums(), before);
    EXPECT_EQ(film.faults().nonfinite, 5u);
    EXPECT_EQ(film.faults().saturated, 0u);
    EXPECT_EQ(film.faults().negative, 0u);
}

TEST(FilmTest, NegativeSamplesAreCountedAndKept) {
    Film film(1, 1, 1, 2);
    film.view().add(0, Vec3<float>(-0.25f, 0.5f, 1));
    film.view().add(0, Vec3<float>(-0.0f, 0.5f, 1));  // minus zero is not negative
    EXPECT_EQ(film.faults().negative, 1u);
    EXPECT_EQ(film.pixel(0), Vec3d(-0.125, 0.5, 1));
}

TEST(FilmTest, TwoPartsOfARunAddUpToTheWhole) {
    const std::vector<Sample> samples = random_samples(3, 5000, 6);
    Film whole(3, 2, 16, 2000), first(3, 2, 16, 2000), second(3, 2, 16, 2000);
    add_all(whole, samples);
    add_all(first, {samples.begin(), samples.begin() + 1700});
    add_all(second, {samples.begin() + 1700, samples.end()});
    for (std::size_t i = 0; i < whole.sums().size(); ++i) {
        EXPECT_EQ(first.sums()[i] + second.sums()[i], whole.sums()[i]);
    }
}

TEST(FilmTest, BrighterByAPowerOfTwoIsTheSameFilm) {
    for (const int exponent : {-60, -7, 1, 30, 80}) {
        std::vector<Sample> samples = random_samples(4, 1000, 6);
        Film film(3, 2, 16, 500), scaled(3, 2, std::ldexp(16.0, exponent), 500);
        EXPECT_EQ(scaled.scale(), std::ldexp(film.scale(), -exponent));
        add_all(film, samples);
        for (Sample& sample : samples) {
            sample.radiance *= std::ldexp(1.0f, exponent);
        }
        add_all(scaled, samples);
        EXPECT_EQ(film.sums(), scaled.sums());
        EXPECT_EQ(scaled.pixel(2).x, std::ldexp(film.pixel(2).x, exponent));
    }
}

TEST(FilmTest, ScaleLeavesRoomForTheBoundAndIsAPowerOfTwo) {
    for (const double bound : {1e-30, 0.7, 1.0, 3.0, 1e6, 1e30}) {
        for (const std::uint64_t samples : {std::uint64_t{1}, std::uint64_t{1} << 16, std::uint64_t{1} << 24}) {
            const double scale = film_scale(bound, samples);
            int exponent = 0;
            EXPECT_EQ(std::frexp(scale, &exponent), 0.5);
            // 64 bounds a sample fit, whatever the number of samples, and no more than a few bits are wasted.
            const double quanta = 64 * bound * scale * static_cast<double>(std::max<std::uint64_t>(samples, 1 << 16));
            EXPECT_LE(quanta, 0x1p62);
            EXPECT_GT(quanta, 0x1p60);
        }
    }
}

// A float times a power of two is exact, so a sample is quantised in single precision where it can be, and both ways
// agree: to the last quantum, and on what is a fault.
TEST(FilmTest, SinglePrecisionAgreesWithDouble) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    constexpr float odd[] = {0.0f,  -0.0f,  1e-45f,   1e-38f,    -1e-6f,
                             3e38f, -3e38f, infinity, -infinity, std::numeric_limits<float>::quiet_NaN()};
    test::Random random(11);
    for (const double bound : {1e-35, 1e-6, 5.0, 1e9, 1e35}) {
        for (const std::uint64_t samples : {std::uint64_t{1}, std::uint64_t{3}, std::uint64_t{1} << 20}) {
            Film single(1, 1, bound, samples), wide(1, 1, bound, samples);
            std::size_t quick = 0;
            for (int i = 0; i < 20000; ++i) {
                const auto value = [&] {
                    return i % 10 == 0 ? odd[random.word() % std::size(odd)]
                                       : static_cast<float>(bound * std::exp2(random.uniform(-30, 8)));
                };
                const Vec3<float> radiance(value(), value(), value());
                const FilmSum a = single.view().quanta(radiance);
                const FilmSum b = wide.view().quanta(Vec3<double>(radiance));
                ASSERT_EQ(a.x, b.x) << bound << " " << radiance.x;
                ASSERT_EQ(a.y, b.y) << bound << " " << radiance.y;
                ASSERT_EQ(a.z, b.z) << bound << " " << radiance.z;
                quick += single.view().single_limit > 0 ? 1 : 0;
            }
            EXPECT_EQ(single.faults().nonfinite, wide.faults().nonfinite);
            EXPECT_EQ(single.faults().negative, wide.faults().negative);
            EXPECT_EQ(single.faults().saturated, wide.faults().saturated);
            EXPECT_GT(wide.faults().nonfinite, 0u);
            // Scenes of ordinary brightness are quantised in single precision.
            EXPECT_EQ(quick > 0, bound > 1e-10 && bound < 1e20) << bound;
        }
    }
}

TEST(FilmTest, HashTellsFilmsApart) {
    Film a(1, 1, 1, 1), b(1, 1, 1, 1);
    EXPECT_EQ(a.hash(), b.hash());
    b.view().add(0, Vec3<float>(0, 0, 0x1p-30f));
    EXPECT_NE(a.hash(), b.hash());
    EXPECT_EQ(b.hash().size(), 16u);
}

// Light of a radiance that float cannot hold: the film is black, and finite.
TEST(FilmTest, TheFaintestLightHasAFiniteScale) {
    for (const double bound : {1e-40, 1e-300, 5e-324}) {
        EXPECT_TRUE(std::isfinite(film_scale(bound, 1u << 20))) << bound;
        Film film(1, 1, bound, 1);
        film.view().add(0, Vec3<float>(0.0f));
        film.view().add(0, Vec3<float>(static_cast<float>(bound)));
        EXPECT_TRUE(film.faults().none()) << faults_text(film.faults());
        EXPECT_TRUE(std::isfinite(film.pixel(0).x));
    }
}

}  // namespace
}  // namespace pt
