#include "harness/scene/environment_table.h"

#include <algorithm>
#include <cmath>

namespace pt {

namespace {

constexpr double all_words = 0x1p32;

// Divides the 2^32 values of a random word into intervals in proportion to the weights, none of them empty (equal
// intervals if all weights are 0), and returns the first value of each interval.
std::vector<std::uint32_t> beginnings_of(const std::vector<double>& weights) {
    double total = 0;
    for (const double weight : weights) {
        total += weight;
    }
    const bool is_known = total > 0;
    const auto count = static_cast<double>(weights.size());
    const double spread = all_words - count;  // random words left to share by weight, after one for each value
    std::vector<std::uint32_t> beginnings;
    double before = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double part = is_known ? before / total : static_cast<double>(i) / count;
        beginnings.push_back(static_cast<std::uint32_t>(std::min(part, 1.0) * spread) + static_cast<std::uint32_t>(i));
        before += weights[i];
    }
    return beginnings;
}

double share_at(const std::vector<std::uint32_t>& beginnings, std::size_t i) {
    const double end = i + 1 < beginnings.size() ? beginnings[i + 1] : all_words;
    return end - beginnings[i];
}

double mean_of(const Vec3d& colour) { return (colour.x + colour.y + colour.z) / 3; }

// Cosines of the polar angles between rows of the environment map, rounded to the kernel's precision, since solid
// angles are computed from the rounded ones.
template <class Real>
std::vector<Real> tops_of(std::uint32_t rows) {
    std::vector<Real> tops;
    for (std::uint32_t i = 0; i < rows; ++i) {
        tops.push_back(static_cast<Real>(sin_cos_turn(static_cast<double>(i) / (2.0 * rows)).cosine));
    }
    return tops;
}

template <class Real>
void set_choice(EnvironmentMap<Real>& map, std::uint32_t lights, bool uniformly) {
    const double objects = uniformly ? lights / (lights + 1.0) : lights > 0 ? 0.5 : 0.0;
    map.object_share = static_cast<std::uint32_t>(objects * all_words);
    const double share = map.object_share;
    map.inverse_probability = static_cast<Real>(all_words / (all_words - share));
    map.inverse_object_probability = static_cast<Real>(share > 0 ? all_words / share : 0.0);
    // stretch = 2^63 / object_share, which maps words below object_share to 32-bit words, must itself fit 32 bits.
    map.stretch = static_cast<std::uint32_t>(share > 0 ? std::min(0x1p31 * (all_words / share), all_words - 1) : 0.0);
}

}  // namespace

template <class Real>
std::unique_ptr<const EnvironmentTable<Real>> environment_table(const SceneEnvironment& environment,
                                                                std::uint32_t lights, bool uniformly) {
    auto table = std::make_unique<EnvironmentTable<Real>>();
    const std::uint32_t width = environment.image.width, height = environment.image.height;
    const std::vector<Real> tops = tops_of<Real>(height);
    std::vector<double> solid_angles, row_weights;
    for (std::uint32_t row = 0; row < height; ++row) {
        const double bottom = row + 1 < height ? static_cast<double>(tops[row + 1]) : -1.0;
        solid_angles.push_back(2 * pi<double> * (static_cast<double>(tops[row]) - bottom) / width);
        std::vector<double> weights;
        double row_weight = 0;
        for (std::uint32_t column = 0; column < width; ++column) {
            const Vec3<float>& texel = environment.image.texels[std::size_t{row} * width + column];
            weights.push_back(mean_of(Vec3d(texel)));
            row_weight += weights.back() * solid_angles.back();
        }
        row_weights.push_back(row_weight);
        const std::vector<std::uint32_t> beginnings = beginnings_of(weights);
        for (std::uint32_t column = 0; column < width; ++column) {
            const Vec3<float>& texel = environment.image.texels[std::size_t{row} * width + column];
            table->texels.push_back({Vec3<Real>(texel), beginnings[column]});
        }
    }
    const std::vector<std::uint32_t> beginnings = beginnings_of(row_weights);
    for (std::uint32_t row = 0; row < height; ++row) {
        const double inverse_pdf = solid_angles[row] * (all_words / share_at(beginnings, row));
        table->rows.push_back({tops[row], static_cast<Real>(inverse_pdf), beginnings[row]});
    }
    EnvironmentMap<Real>& map = table->map;
    map.rows = {table->rows.data(), height};
    map.texels = {table->texels.data(), static_cast<std::uint32_t>(table->texels.size())};
    map.width = width;
    const double turns = environment.rotation_degrees / 360;
    map.turn = static_cast<Real>(turns - std::floor(turns));
    map.turn = map.turn < Real(1) ? map.turn : Real(0);
    set_choice(map, lights, uniformly);
    return table;
}

template std::unique_ptr<const EnvironmentTable<float>> environment_table(const SceneEnvironment&, std::uint32_t, bool);
template std::unique_ptr<const EnvironmentTable<double>> environment_table(const SceneEnvironment&, std::uint32_t,
                                                                           bool);

}  // namespace pt
