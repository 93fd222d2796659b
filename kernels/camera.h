// Pinhole and thin-lens camera with pixel jitter and a shutter. The eye is the coordinate origin: the loader subtracts
// its position in double.
#pragma once

#include "kernels/path.h"
#include "kernels/rng.h"
#include "kernels/sampling.h"

namespace pt {

template <class Real>
struct Camera {
    Vec3<Real> right, up, forward;  // orthonormal camera axes; `up` points up in the image
    Real pixel_size;                // size of a pixel on the plane at distance 1: 2 tan(vertical_fov / 2) / height
    std::uint32_t width, height;
    Real aperture_radius;               // lens radius in scene units; 0: a pinhole camera
    Real focus_distance;                // distance of the plane in focus along `forward`, scene units
    Real shutter_open, shutter_length;  // when the shutter opens, and for how long, in seconds
    std::uint32_t shutter_late;         // 1: ray times have density 2s/length^2, s = time since the shutter opened
    std::uint32_t jitter;               // 0: every camera ray passes through its pixel's centre
    std::uint32_t initial_medium;       // material whose medium the eye is in, or Path::no_medium
};

// Unit vector along a camera ray. Without a lens `direction` is no shorter than the camera's forward vector, so the
// functions of kernels/in_range.h apply; with a lens it is as long as the focus distance, whatever the scene's scale.
template <class Config>
PT_HD inline Vec3<typename Config::Real> unit_ray(const Vec3<typename Config::Real>& direction) {
    if constexpr (has<Config>(Feature::lens)) {
        return normalize(direction);
    } else {
        return direction * reciprocal_in_range(square_root_in_range(dot(direction, direction)));
    }
}

// A pixel's index in row-major order, and its column and row.
struct PixelPlace {
    std::uint32_t index, x, y;

    PT_HD static PixelPlace of(std::uint32_t index, std::uint32_t width) {
        return {index, index % width, index / width};
    }
};

// Start of a camera path: segment 0, on no surface. The camera ray has the random numbers of sample `camera_sample`,
// which is the path's own unless samples share camera rays (first-bounce cache).
template <class Config>
PT_HD inline Path<typename Config::Real> camera_path(const Camera<typename Config::Real>& camera,
                                                     const RandomSeed& seed, const PixelPlace& place,
                                                     std::uint32_t sample, std::uint32_t camera_sample) {
    using Real = typename Config::Real;
    Path<Real> path;
    path.origin = {Real(0), Real(0), Real(0)};
    path.throughput = {Real(1), Real(1), Real(1)};
    path.radiance = {Real(0), Real(0), Real(0)};
    path.time = camera.shutter_open;
    path.pixel = place.index;
    path.sample = sample;
    path.segment = 0;
    path.origin_surface = SurfaceId{};
    path.primitive = 0;
    path.medium = camera.initial_medium;
    path.bsdf_pdf = Real(0);

    RandomWords words{0, 0, 0, 0};
    if constexpr (has<Config>(Feature::jitter) || has<Config>(Feature::lens)) {
        words = random_words<Config>(seed, {place.index, camera_sample, 0, random_block::camera_position});
    }
    Real in_pixel_x = Real(0.5);
    Real in_pixel_y = Real(0.5);
    if constexpr (has<Config>(Feature::jitter)) {
        if (camera.jitter != 0) {
            in_pixel_x = unit_interval<Real>(words.x);
            in_pixel_y = unit_interval<Real>(words.y);
        }
    }
    // The column - width/2 is exact, so a sample cannot round into the neighbouring pixel (docs/numerics.md S45).
    const Real x = (static_cast<Real>(place.x) - Real(0.5) * static_cast<Real>(camera.width)) + in_pixel_x;
    const Real y = (static_cast<Real>(place.y) - Real(0.5) * static_cast<Real>(camera.height)) + in_pixel_y;
    Vec3<Real> direction =
        camera.right * (x * camera.pixel_size) - camera.up * (y * camera.pixel_size) + camera.forward;
    if constexpr (has<Config>(Feature::lens)) {
        if (camera.aperture_radius > Real(0)) {
            const Vec2<Real> disc = concentric_disc(unit_interval<Real>(words.z), unit_interval<Real>(words.w));
            const Vec3<Real> on_lens = (camera.right * disc.x + camera.up * disc.y) * camera.aperture_radius;
            path.origin = on_lens;
            direction = direction * camera.focus_distance - on_lens;
        }
    }
    path.direction = unit_ray<Config>(direction);
    if constexpr (has<Config>(Feature::motion)) {
        const RandomWords time_words =
            random_words<Config>(seed, {place.index, camera_sample, 0, random_block::camera_time});
        const Real u = unit_interval<Real>(time_words.x);
        path.time = camera.shutter_open + camera.shutter_length * (camera.shutter_late != 0 ? square_root(u) : u);
    }
    return path;
}

}  // namespace pt
