// The paths of a packet, one a lane: each scalar of a path is an array over the lanes, so that the compiler turns a
// loop over the lanes into vector instructions (g++ 12 does; -fopt-info-vec tells). Such a loop may have selections but
// no branches, `&` and `|` in place of `&&` and `||`, and no test of a single bit.
#pragma once

#include <cstddef>

#include "kernels/shade.h"

namespace pt::lanes {

// Number of lanes in a packet, whose paths are traced together: a multiple of the widest vector's 16 floats. On a Zen 4
// core packets of 64 trace 1.5 (open box) and 1.8 times (closed box) the rays of packets of 16; 128 gain nothing more.
inline constexpr std::uint32_t width = 64;

// A number for each lane. Lane numbers are as wide as an address: an index that may wrap round keeps g++ from vectors.
template <class T>
struct alignas(64) Lanes {
    T of[width];

    T& operator[](std::size_t lane) { return of[lane]; }
    const T& operator[](std::size_t lane) const { return of[lane]; }
};

// Truth values of a packet's lanes, 1 or 0, each as wide as a number.
using Flags = Lanes<std::uint32_t>;

inline bool any(const Flags& flags) {
    std::uint32_t found = 0;
    for (const std::uint32_t flag : flags.of) {
        found |= flag;
    }
    return found != 0;
}

// Lists the lanes whose flags are set, in order, without a branch on a flag, which would be mispredicted.
class LaneList {
public:
    explicit LaneList(const Flags& flags) {
        if (any(flags)) {
            for (std::uint32_t lane = 0; lane < width; ++lane) {
                lanes_[size_] = lane;
                size_ += flags[lane];
            }
        }
    }
    const std::uint32_t* begin() const { return lanes_; }
    const std::uint32_t* end() const { return lanes_ + size_; }
    std::uint32_t size() const { return size_; }

private:
    std::uint32_t lanes_[width];
    std::uint32_t size_ = 0;
};

template <class Real>
struct Vectors {
    Lanes<Real> x, y, z;

    Vec3<Real> operator[](std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }
    void set(std::size_t lane, const Vec3<Real>& v) {
        x[lane] = v.x;
        y[lane] = v.y;
        z[lane] = v.z;
    }
    void set_if(bool condition, std::size_t lane, const Vec3<Real>& v) {
        x[lane] = condition ? v.x : x[lane];
        y[lane] = condition ? v.y : y[lane];
        z[lane] = condition ? v.z : z[lane];
    }
};

template <class Real>
struct Paths {
    Vectors<Real> origin, direction, throughput, radiance;
    Lanes<Real> time, bsdf_pdf;
    Lanes<std::uint32_t> pixel, sample, segment, origin_surface, medium, primitive;

    Path<Real> load(std::uint32_t l) const {
        return {origin[l],   direction[l], throughput[l],
                radiance[l], time[l],      pixel[l],
                sample[l],   segment[l],   SurfaceId{origin_surface[l]},
                medium[l],   bsdf_pdf[l],  primitive[l]};
    }
    void store(std::uint32_t l, const Path<Real>& path) {
        origin.set(l, path.origin);
        direction.set(l, path.direction);
        throughput.set(l, path.throughput);
        radiance.set(l, path.radiance);
        time[l] = path.time;
        bsdf_pdf[l] = path.bsdf_pdf;
        pixel[l] = path.pixel;
        sample[l] = path.sample;
        segment[l] = path.segment;
        origin_surface[l] = path.origin_surface.code;
        medium[l] = path.medium;
        primitive[l] = path.primitive;
    }
    Ray<Real> ray(std::uint32_t l) const {
        return {origin[l], direction[l], time[l], SurfaceId{origin_surface[l]}, primitive[l]};
    }
};

template <class Real>
struct Hits {
    Lanes<Real> t;
    Lanes<std::uint32_t> side, primitive;

    Hit<Real> operator[](std::uint32_t lane) const { return {t[lane], SurfaceId{side[lane]}, primitive[lane]}; }
    void set(std::uint32_t lane, const Hit<Real>& hit) {
        t[lane] = hit.t;
        side[lane] = hit.side.code;
        primitive[lane] = hit.primitive;
    }
};

// Bit number `bit` of a word, by the sign of a shifted word: g++ 12 does not vectorise truth values of one-bit tests.
inline bool has_bit(std::uint32_t word, std::uint32_t bit) {
    return static_cast<std::int32_t>(word << (31u - bit)) < 0;
}
inline bool is_inside(SurfaceId side) { return has_bit(side.code, 0); }
inline bool has_face(SurfaceId side) { return side.code >= 1u << 29; }

}  // namespace pt::lanes
