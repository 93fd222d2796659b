// How far an image is from a reference: the metrics of docs/numerics.md section 1.1, in double precision over linear
// radiance. A reference is two independent halves, so that its own noise neither inflates an error nor fakes a plateau.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace pt {

// An image of mean radiance: three channels per pixel, row by row.
using Image = std::vector<double>;

// The mean images of the first and the last half of a render's samples.
struct Halves {
    Image first, second;
};

// The errors of an image against a reference, which are defined only if every pixel is finite.
struct Errors {
    std::array<double, 3> me_rgb{};
    double mse = 0;
    double mse_dual = 0;
    double rel_mse = 0;
    double rel_mse_dual = 0;
    double smape = 0;
    std::optional<double> bias2;  // squared bias; none unless halves of the render's samples are known and independent
};

// Name and definition of each metric, as result files state them.
extern const std::vector<std::pair<std::string_view, std::string_view>> metric_definitions;

// The number of pixels in which at least one channel is not finite.
std::uint64_t nonfinite_pixels(const Image& image);

// The errors of an image against the two halves of a reference; none if a pixel of the image or of `halves` is not
// finite. `halves` may be null. Precondition: all images have the same size and pixels, and the reference is finite.
std::optional<Errors> errors_of(const Image& image, const Halves* halves, const Image& first_reference,
                                const Image& second_reference);

// The noise of a reference image (r1 + r2) / 2, estimated from its halves r1 and r2.
struct ReferenceNoise {
    double variance = 0;     // variance of a pixel's channel of r: mean((r1-r2)^2) / 4
    double mean_square = 0;  // mean square of the reference image over pixels and channels
    // The standard error that the reference's noise adds to mse_dual, for any number of images: that of mean
    // (r1-mu)(r2-mu), from fourth powers of r1-r2, with the three channels of a pixel taken as fully correlated.
    double dual_error = 0;
};
ReferenceNoise noise_of(const Image& first_reference, const Image& second_reference);

}  // namespace pt
