// The state of one path between two stages, and what a ray meets.
#pragma once

#include "kernels/math.h"

namespace pt {

// An object and a side of its surface in one word. In a Hit: `inside` says that the ray ran through the object's
// interior before it met the surface. In Path::departed: `inside` says that the ray leaves into the interior.
struct ObjectSide {
    static constexpr std::uint32_t nowhere = 0xffffffffu;
    std::uint32_t code = nowhere;

    PT_HD static constexpr ObjectSide of(std::uint32_t object, bool inside) {
        return {(object << 1) | (inside ? 1u : 0u)};
    }
    PT_HD constexpr bool exists() const { return code != nowhere; }
    PT_HD constexpr std::uint32_t object() const { return code >> 1; }
    PT_HD constexpr bool inside() const { return (code & 1u) != 0; }
};

template <class Real>
struct Hit {
    Real t = Real(0);  // distance along the unit direction, scene units
    ObjectSide side;   // nowhere: the ray left the scene
};

template <class Real>
struct Path {
    Vec3<Real> origin;      // scene units, relative to the camera's eye
    Vec3<Real> direction;   // unit
    Vec3<Real> throughput;  // product of BSDF * cosine / density so far
    Vec3<Real> radiance;    // collected so far
    Real time;              // seconds
    std::uint32_t pixel;    // row-major index
    std::uint32_t sample;
    std::uint32_t segment;  // ray segments traced so far; `ended` once the path is over
    ObjectSide departed;    // the surface that the ray starts on
    std::uint32_t medium;   // material whose absorption the ray runs through, or no_medium

    static constexpr std::uint32_t ended = 0xffffffffu;
    static constexpr std::uint32_t no_medium = 0xffffffffu;

    PT_HD bool alive() const { return segment != ended; }
};

}  // namespace pt
