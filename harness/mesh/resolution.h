// Detects meshes that lose their shape in single precision, such as terrain in map coordinates (easting and northing).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "harness/mesh/mesh.h"

namespace pt {

// Largest rounding error of a mesh's vertices when converted from double to single precision.
class RoundingLoss {
public:
    // Records a mesh vertex before and after rounding. `place` is the vertex's number, as the file's reader counts.
    void add(const std::array<double, 3>& exact, const std::array<float, 3>& rounded, std::size_t place);

    double largest() const { return largest_; }  // largest rounding error of a vertex along one axis
    std::size_t place() const { return place_; }

private:
    double largest_ = 0;
    std::size_t place_ = 0;
};

// Warning for a mesh whose vertices were moved by up to `largest` in rounding. There is none below 2^-14 of the mesh's
// extent and 2^-7 of its mean edge length, where neither outline nor shading shows the error.
std::optional<std::string> resolution_warning(const Mesh& mesh, double largest);

// Whether coordinates are so large that rounding may be worth a warning, for which the file is read in double.
bool may_have_lost_digits(const Mesh& mesh);

}  // namespace pt
