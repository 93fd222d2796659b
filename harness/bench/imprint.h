// The imprint of a render: film hashes and counts that two renders which agree bit for bit have alike.
#pragma once

#include <cstdint>
#include <string>

#include "harness/bench/facts/sample.h"
#include "harness/render/renderer.h"

namespace pt {

// The film, and the work that any way to make it takes: every integrator on both backends counts it alike. (A cached
// first bounce traces fewer rays; the hits that it takes from its cache are counted in their place.) Not how often a
// queue was compacted or sorted, or what was launched: those are a choice's own.
struct Imprint {
    std::string film;               // hash
    std::uint64_t paths = 0;        // started
    std::uint64_t rays = 0;         // traced, and first hits that a cache had
    std::uint64_t connections = 0;  // of the rays, those to lights

    bool operator==(const Imprint&) const = default;
};
Imprint imprint_of(const RenderResult& result);
Imprint imprint_of(const Sample& sample);
// What differs from what is right, as "film 1f.., not 3a..; 20475 rays, not 20478"; empty: nothing.
std::string difference(const Imprint& found, const Imprint& right);

}  // namespace pt
