// The imprint of a render: film hashes and counts that two renders which agree bit for bit have alike.
#pragma once

#include <cstdint>
#include <string>

#include "harness/bench/facts/sample.h"
#include "harness/render/renderer.h"

namespace pt {

// The film hash of a render and the work counts that every integrator on both backends counts alike. (A cached first
// bounce traces fewer rays; its cache hits are added to the rays.) Compactions, sorts and kernel launches are left out,
// since they depend on the variant.
struct Imprint {
    std::string film;               // hash of the film's bits
    std::uint64_t paths = 0;        // number of paths started
    std::uint64_t rays = 0;         // rays traced, plus first hits taken from a cache
    std::uint64_t connections = 0;  // shadow rays to lights, which `rays` includes

    bool operator==(const Imprint&) const = default;
};
Imprint imprint_of(const RenderResult& result);
Imprint imprint_of(const Sample& sample);
// Lists how an imprint differs from the right one, as "film 1f.., not 3a..; 20475 rays, not 20478", or "" if equal.
std::string difference(const Imprint& found, const Imprint& right);

}  // namespace pt
