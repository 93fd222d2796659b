// Error metrics against values computed by hand, their laws of scale bit for bit, and what two half references are for.
#include "harness/error/metrics.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"

namespace pt {
namespace {

// A normal number (Box and Muller 1958).
double normal(test::Random& random) {
    return std::sqrt(-2 * std::log(1 - random.uniform())) * std::cos(6.283185307179586 * random.uniform());
}

// A pixel's three channels err independently.
Image noisy(const Image& mean, double deviation, test::Random& random) {
    Image image = mean;
    for (double& value : image) {
        value += deviation * normal(random);
    }
    return image;
}

TEST(Metrics, AreWhatTheirDefinitionsSay) {
    // Two pixels; r = (r1+r2)/2 = {0, 1, 2, 0, 0, 4}.
    const Image r1{0, 0.5, 2, 0, -1, 4};
    const Image r2{0, 1.5, 2, 0, 1, 4};
    const Image x{1, 1, 0, 0, 2, 8};
    const std::optional<Errors> errors = errors_of(x, nullptr, r1, r2);
    ASSERT_TRUE(errors.has_value());
    EXPECT_EQ(errors->me_rgb, (std::array<double, 3>{0.5, 1, 1}));
    EXPECT_EQ(errors->mse, (1 + 0 + 4 + 0 + 4 + 16) / 6.0);
    EXPECT_EQ(errors->mse_dual, (1 + 0.5 * -0.5 + 4 + 0 + 3 * 1 + 16) / 6.0);
    EXPECT_DOUBLE_EQ(errors->rel_mse, (1 / 0.01 + 4 / 4.01 + 4 / 0.01 + 16 / 16.01) / 6);
    EXPECT_DOUBLE_EQ(errors->rel_mse_dual, (1 / 0.01 - 0.25 / 1.01 + 4 / 4.01 + 3 / 0.01 + 16 / 16.01) / 6);
    EXPECT_DOUBLE_EQ(errors->smape, (1 / 1.01 + 2 / 2.01 + 2 / 2.01 + 4 / 12.01) / 6);
    EXPECT_FALSE(errors->bias2.has_value());
}

TEST(Metrics, BiasIsTheProductOfWhatTheHalvesAgreeOn) {
    const Image r1{1, 1, 1};
    const Image r2{3, 1, 1};
    const Halves halves{{2, 2, 0}, {4, 3, 2}};
    const std::optional<Errors> errors = errors_of({3, 2.5, 1}, &halves, r1, r2);
    ASSERT_TRUE(errors.has_value());
    // The channels have ((1)(1) + (-1)(3)) / 2, ((1)(2) + (1)(2)) / 2 and ((-1)(1) + (-1)(1)) / 2.
    EXPECT_EQ(errors->bias2, (-1.0 + 2.0 - 1.0) / 3);
}

TEST(Metrics, TheSameImageHasNoError) {
    const Image image{0.1, 0.2, 0.3, 4, 5, 6};
    const Halves halves{image, image};
    const std::optional<Errors> errors = errors_of(image, &halves, image, image);
    ASSERT_TRUE(errors.has_value());
    for (const double value : {errors->mse, errors->mse_dual, errors->rel_mse, errors->smape, *errors->bias2}) {
        EXPECT_EQ(value, 0);
    }
}

TEST(Metrics, ScaleExactlyByPowersOfTwo) {
    test::Random random(11);
    const Image mean(3 * 50, 0.7);
    const Image x = noisy(mean, 0.5, random);
    const Image r1 = noisy(mean, 0.1, random);
    const Image r2 = noisy(mean, 0.1, random);
    const Halves halves{noisy(mean, 0.7, random), noisy(mean, 0.7, random)};
    const Errors errors = *errors_of(x, &halves, r1, r2);
    for (const int k : {-40, -1, 3, 60}) {
        SCOPED_TRACE(k);
        const auto times = [k](Image image) {
            for (double& value : image) {
                value = std::ldexp(value, k);
            }
            return image;
        };
        const Halves scaled_halves{times(halves.first), times(halves.second)};
        const Errors scaled = *errors_of(times(x), &scaled_halves, times(r1), times(r2));
        EXPECT_EQ(scaled.mse, std::ldexp(errors.mse, 2 * k));
        EXPECT_EQ(scaled.mse_dual, std::ldexp(errors.mse_dual, 2 * k));
        EXPECT_EQ(*scaled.bias2, std::ldexp(*errors.bias2, 2 * k));
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_EQ(scaled.me_rgb[c], std::ldexp(errors.me_rgb[c], k));
        }
        const ReferenceNoise noise = noise_of(r1, r2);
        const ReferenceNoise scaled_noise = noise_of(times(r1), times(r2));
        EXPECT_EQ(scaled_noise.variance, std::ldexp(noise.variance, 2 * k));
        EXPECT_EQ(scaled_noise.mean_square, std::ldexp(noise.mean_square, 2 * k));
        EXPECT_EQ(scaled_noise.dual_error, std::ldexp(noise.dual_error, 2 * k));
    }
}

TEST(Metrics, APixelThatIsNotFiniteLeavesNoNumberBehind) {
    const Image good(3 * 4, 1.0);
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        Image image = good;
        image[4] = bad;
        EXPECT_EQ(nonfinite_pixels(image), 1u);
        EXPECT_FALSE(errors_of(image, nullptr, good, good).has_value());
        image[5] = bad;  // the same pixel
        image[9] = -bad;
        EXPECT_EQ(nonfinite_pixels(image), 2u);
        const Halves halves{good, image};
        EXPECT_FALSE(errors_of(good, &halves, good, good).has_value());
    }
}

TEST(Metrics, ImagesOfDifferentSizesAreNotCompared) {
    EXPECT_THROW(errors_of(Image(6), nullptr, Image(6), Image(3)), std::logic_error);
    EXPECT_THROW(errors_of(Image(), nullptr, Image(), Image()), std::logic_error);
    const Halves halves{Image(3), Image(6)};
    EXPECT_THROW(errors_of(Image(6), &halves, Image(6), Image(6)), std::logic_error);
}

// A noisy reference inflates mse by its own variance; mse_dual and bias2 are right in the mean. 300 images of 100
// pixels, bias 0.1, and a reference as noisy as the images.
TEST(Metrics, TwoHalvesCancelTheReferencesNoise) {
    test::Random random(5);
    const Image mean(3 * 100, 1.0);
    Image biased = mean;
    for (double& value : biased) {
        value += 0.1;
    }
    test::Mean mse, dual, bias;
    test::Mean dual_at_reference;  // of a perfect image: what the reference's own noise does to mse_dual
    double predicted = 0;
    for (int i = 0; i < 300; ++i) {
        const Image r1 = noisy(mean, 0.3, random);
        const Image r2 = noisy(mean, 0.3, random);
        Halves halves{noisy(biased, 0.3, random), noisy(biased, 0.3, random)};
        Image x = halves.first;
        for (std::size_t p = 0; p < x.size(); ++p) {
            x[p] = 0.5 * (x[p] + halves.second[p]);
        }
        const Errors errors = *errors_of(x, &halves, r1, r2);
        mse.add(errors.mse);
        dual.add(errors.mse_dual);
        bias.add(*errors.bias2);
        dual_at_reference.add(errors_of(mean, nullptr, r1, r2)->mse_dual);
        const ReferenceNoise noise = noise_of(r1, r2);
        predicted += noise.dual_error / 300;
        EXPECT_NEAR(noise.variance, 0.045, 0.045 * 0.5);
    }
    const double variance = 0.09 / 2;
    EXPECT_LT(std::abs(dual.value() - (variance + 0.01)), 4.5 * dual.standard_error());
    EXPECT_LT(std::abs(mse.value() - (variance + 0.01 + 0.045)), 4.5 * mse.standard_error());
    EXPECT_LT(std::abs(bias.value() - 0.01), 4.5 * bias.standard_error());
    EXPECT_GT(mse.value() - dual.value(), 20 * dual.standard_error());
    // Here channels err independently, so what is taken as the worst is sqrt(3) times what is seen.
    EXPECT_NEAR(predicted, std::sqrt(3.0 * dual_at_reference.variance()), 0.15 * predicted);
}

TEST(Metrics, EveryNumberHasItsDefinition) {
    std::vector<std::string_view> names;
    for (const auto& [name, definition] : metric_definitions) {
        names.push_back(name);
        EXPECT_FALSE(definition.empty());
    }
    EXPECT_EQ(names, (std::vector<std::string_view>{"images", "me_rgb", "mse", "mse_dual", "rel_mse", "rel_mse_dual",
                                                    "smape", "bias2"}));
}

}  // namespace
}  // namespace pt
