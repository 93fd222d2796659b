// Environment light as an equirectangular image, y up, importance-sampled by a piecewise-constant distribution: first a
// row, then a texel in it (Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, sections 12.5 and
// A.5). A direction has the radiance of its texel, and directions in a texel are drawn uniformly by solid angle, so
// radiance over pdf is constant in a texel. Probabilities are whole multiples of 2^-32, none 0: weights divide by
// exactly the probability drawn by. A constant environment is an image of one texel, drawn uniformly over the sphere.
// |
// |The image's left edge is in the direction -z, and a quarter of its width on is +x, as in Mitsuba's `envmap`.
#pragma once

#include "kernels/sampling.h"
#include "kernels/scene_view.h"

namespace pt {

// A row of an environment image: directions whose cosine to +y is from the next row's `top` (or -1) to `top`.
template <class Real>
struct EnvironmentRow {
    Real top;
    Real inverse_pdf;     // 1 / pdf of a direction in this environment row if its texel had probability 1
    std::uint32_t first;  // first random word in [0, 2^32) that draws this row; the last is before the next row's first
};

template <class Real>
struct EnvironmentTexel {
    Vec3<Real> radiance;
    std::uint32_t first;  // first of the random words that draw this texel in its row; they end at the next texel's
};

template <class Real>
struct EnvironmentMap {
    View<EnvironmentRow<Real>> rows;      // rows of the environment image from +y down
    View<EnvironmentTexel<Real>> texels;  // texels of the environment image, row by row
    std::uint32_t width;                  // number of texels in a row of the environment image
    Real turn;                            // rotation about y: the image column of direction -z, in image widths
    std::uint32_t object_share;           // a random word below this draws an emitting object, not the environment
    std::uint32_t stretch;                // 2^63 / object_share, to stretch random words below object_share
    Real inverse_probability;             // 1 / probability of drawing the environment
    Real inverse_object_probability;      // 1 / probability of drawing an emitting object
};

// Index of the last of `count` table entries whose interval of random words begins at or below `word`: binary search.
template <class Entry>
PT_HD inline std::uint32_t entry_at(const Entry* entries, std::uint32_t count, std::uint32_t word) {
    std::uint32_t low = 0, high = count;
    while (high - low > 1) {
        const std::uint32_t middle = low + (high - low) / 2;
        const bool is_above = entries[middle].first > word;
        high = is_above ? middle : high;
        low = is_above ? low : middle;
    }
    return low;
}

// Width of entry i's interval in a table that divides the 2^32 random words among its entries: 2^32 itself for an only
// entry. The last interval ends at 2^32, whose low word is 0.
template <class Real, class Entry>
PT_HD inline Real share_of_entry(const Entry* entries, std::uint32_t count, std::uint32_t i) {
    const std::uint32_t end = i + 1 < count ? entries[i + 1].first : 0u;
    return static_cast<Real>(end - entries[i].first - 1u) + Real(1);
}

// Relative position in [0, 1] of a random word within its table entry's interval. An interval may be one word wide, so
// 16 bits of `more` place it between two words.
template <class Real, class Entry>
PT_HD inline Real place_in_entry(const Entry& entry, Real share, std::uint32_t word, std::uint32_t more) {
    const Real between = (static_cast<Real>(more & 0xffffu) + Real(0.5)) * Real(0x1p-16);
    return min((static_cast<Real>(word - entry.first) + between) / share, Real(1));
}

// Radiance of an environment texel, and 1 / pdf by solid angle with which directions to the texel are drawn.
template <class Real>
struct EnvironmentPlace {
    Vec3<Real> radiance;
    Real inverse_pdf;
};

template <class Real>
PT_HD inline EnvironmentPlace<Real> place_at(const EnvironmentMap<Real>& map, std::uint32_t row, std::uint32_t column) {
    const EnvironmentTexel<Real>* const texels = map.texels.data + static_cast<std::size_t>(row) * map.width;
    const Real share = share_of_entry<Real>(texels, map.width, column);
    return {texels[column].radiance, map.rows[row].inverse_pdf * (Real(0x1p32) / share)};
}

// Azimuth of a direction about y in turns: 0 at -z, 1/4 at +x; up to rounding within [-1/4, 3/4].
template <class Real>
PT_HD inline Real azimuth_in_turns(const Vec3<Real>& direction) {
    const Real along = -direction.z;
    if (along == Real(0)) {
        return direction.x < Real(0) ? Real(-0.25) : direction.x > Real(0) ? Real(0.25) : Real(0);
    }
    const Real angle = arc_tangent(direction.x / along) * (Real(0.5) / pi<Real>);
    return along < Real(0) ? angle + Real(0.5) : angle;
}

// Fractional part, in [0, 1), of a number of turns from -1 to 2.
template <class Real>
PT_HD inline Real fraction_of_turn(Real turns) {
    const Real above = turns < Real(0) ? turns + Real(1) : turns;
    return above >= Real(1) ? above - Real(1) : above;
}

template <class Real>
PT_HD inline std::uint32_t row_at(const EnvironmentMap<Real>& map, Real cosine) {
    std::uint32_t low = 0, high = map.rows.size;
    while (high - low > 1) {
        const std::uint32_t middle = low + (high - low) / 2;
        const bool is_above = cosine > map.rows[middle].top;
        high = is_above ? middle : high;
        low = is_above ? low : middle;
    }
    return low;
}

// Radiance of the environment texel that a unit direction points to, and 1 / pdf of directions to that texel.
template <class Real>
PT_HD inline EnvironmentPlace<Real> environment_towards(const EnvironmentMap<Real>& map, const Vec3<Real>& direction) {
    const Real across = fraction_of_turn(azimuth_in_turns(direction) + map.turn) * static_cast<Real>(map.width);
    const std::uint32_t column = min(static_cast<std::uint32_t>(across), map.width - 1u);
    return place_at(map, row_at(map, direction.y), column);
}

template <class Real>
struct EnvironmentSample {
    Vec3<Real> direction;
    EnvironmentPlace<Real> place;
};

template <class Real>
PT_HD inline EnvironmentSample<Real> sample_environment(const EnvironmentMap<Real>& map, std::uint32_t row_word,
                                                        std::uint32_t column_word, std::uint32_t more) {
    const std::uint32_t row = entry_at(map.rows.data, map.rows.size, row_word);
    const EnvironmentTexel<Real>* const texels = map.texels.data + static_cast<std::size_t>(row) * map.width;
    const std::uint32_t column = entry_at(texels, map.width, column_word);
    const Real down =
        place_in_entry(map.rows[row], share_of_entry<Real>(map.rows.data, map.rows.size, row), row_word, more >> 16);
    const Real across =
        place_in_entry(texels[column], share_of_entry<Real>(texels, map.width, column), column_word, more);
    const Real top = map.rows[row].top;
    const Real bottom = row + 1 < map.rows.size ? map.rows[row + 1].top : Real(-1);
    const Real cosine = clamp(top + (bottom - top) * down, Real(-1), Real(1));
    const Real radius = square_root(max(Real(0), (Real(1) - cosine) * (Real(1) + cosine)));
    const Real turns = (static_cast<Real>(column) + across) / static_cast<Real>(map.width) - map.turn;
    const SinCos<Real> azimuth = sin_cos_turn(fraction_of_turn(turns));
    return {{radius * azimuth.sine, cosine, -radius * azimuth.cosine}, place_at(map, row, column)};
}

// Whether a random word draws the environment among all lights; if not, the word is stretched to 32 uniform bits.
template <class Real>
PT_HD inline bool draws_environment(const EnvironmentMap<Real>& map, std::uint32_t& word) {
    if (word >= map.object_share) {
        return true;
    }
    word = static_cast<std::uint32_t>((static_cast<std::uint64_t>(word) * map.stretch) >> 31);
    return false;
}

}  // namespace pt
