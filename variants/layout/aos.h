// The layout aos on the CPU, an array of structures: a path's fields lie together, as in cis565.
#pragma once

#include <vector>

#include "kernels/intersect.h"
#include "variants/descriptor.h"

namespace pt::layout::aos {

inline constexpr Descriptor descriptor{
    .axis = "layout",
    .name = "aos",
    .summary = "array of structures: the fields of a path lie together",
    .origin = "cis565 (two CIS 565 path tracers)",
    .baseline = on_cpu,
    .traits = LayoutTraits{.keeps_paths_whole = true},
};

template <class Real>
class Paths {
public:
    void reserve(std::size_t capacity) {
        if (paths_.size() < capacity) {
            paths_.resize(capacity);
        }
    }
    Path<Real> load(std::size_t slot) const { return paths_[slot]; }
    void store(std::size_t slot, const Path<Real>& path) { paths_[slot] = path; }
    bool alive(std::size_t slot) const { return paths_[slot].alive(); }
    std::uint32_t pixel(std::size_t slot) const { return paths_[slot].pixel; }
    std::uint32_t primitive(std::size_t slot) const { return paths_[slot].primitive; }
    Ray<Real> ray(std::size_t slot) const { return ray_of(paths_[slot]); }
    // A random-access iterator over Path<Real> values for Thrust.
    Path<Real>* begin() { return paths_.data(); }

private:
    std::vector<Path<Real>> paths_;
};

}  // namespace pt::layout::aos
