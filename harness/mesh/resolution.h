// Whether single precision leaves a mesh its shape: a map's easting and northing use up most of its digits.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "harness/mesh/mesh.h"

namespace pt {

// How far vertices lie from where double precision has them.
class RoundingLoss {
public:
    // Takes note of a vertex. `place`: its number, by the reader's own count.
    void add(const std::array<double, 3>& exact, const std::array<float, 3>& rounded, std::size_t place);

    double largest() const { return largest_; }  // along one axis
    std::size_t place() const { return place_; }

private:
    double largest_ = 0;
    std::size_t place_ = 0;
};

// What to say of a mesh some vertex of which rounding has moved by `largest`: nothing below 2^-14 of its extent and
// 2^-7 of the mean length of its edges, which is when neither its outline nor its shading shows it.
std::optional<std::string> resolution_warning(const Mesh& mesh, double largest);

// Whether rounding numbers as large as the mesh's coordinates could be worth a warning: only then need a reader look at
// them in double precision.
bool may_have_lost_digits(const Mesh& mesh);

}  // namespace pt
