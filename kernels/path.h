// The state of one path between two stages, and the hit of a ray.
#pragma once

#include "kernels/math.h"

namespace pt {

// An object and a side of its surface in one word. In a Hit: `inside` says that the ray ran through the object's
// interior before it met the surface. In Path::origin_surface: `inside` says that the ray leaves into the interior.
// A Hit may also name the face of an axis box that was met from outside.
struct SurfaceId {
    static constexpr std::uint32_t nowhere = 0xffffffffu;
    static constexpr std::uint32_t most_objects = 1u << 27;
    std::uint32_t code = nowhere;  // bit 0: inside; bits 1-27: object; bit 28: face looks up; bits 29-30: face axis + 1

    PT_HD static constexpr SurfaceId of(std::uint32_t object, bool inside) {
        return {(object << 1) | (inside ? 1u : 0u)};
    }
    // The face of a box whose outward normal is the axis `axis` (0 to 2) or, unless it looks up, the opposite of that
    // axis.
    PT_HD static constexpr SurfaceId of_face(std::uint32_t object, std::uint32_t axis, bool looks_up) {
        return {((axis + 1) << 29) | ((looks_up ? 1u : 0u) << 28) | (object << 1)};
    }
    PT_HD constexpr bool exists() const { return code != nowhere; }
    PT_HD constexpr std::uint32_t object() const { return (code >> 1) & (most_objects - 1); }
    // Whether this surface's object has a lower index than that of `other`; both surfaces must exist, on different
    // objects.
    PT_HD constexpr bool precedes(const SurfaceId& other) const { return (code << 4) < (other.code << 4); }
    // Whether this is a surface of object `number`; false for nowhere.
    PT_HD constexpr bool is_of(std::uint32_t number) const { return exists() && object() == number; }
    PT_HD constexpr bool has_face() const { return (code >> 29) != 0; }
    PT_HD constexpr std::uint32_t face_axis() const { return (code >> 29) - 1; }
    PT_HD constexpr bool face_looks_up() const { return ((code >> 28) & 1u) != 0; }
    PT_HD constexpr bool inside() const { return (code & 1u) != 0; }
};

template <class Real>
struct Hit {
    Real t = Real(0);             // distance of the hit along the ray's unit direction, scene units
    SurfaceId side;               // surface that was hit; nowhere: the ray left the scene
    std::uint32_t primitive = 0;  // triangle of the mesh that was hit; 0 for other shapes
};

// A hit as it lies in memory between two stages. A mesh's primitive lies with the path (Path::primitive), so that
// scenes without meshes move no more than they need.
template <class Real>
struct StoredHit {
    Real t;
    SurfaceId side;
};

template <class Real>
struct Path {
    Vec3<Real> origin;      // ray origin, scene units relative to the camera's eye
    Vec3<Real> direction;   // unit direction of the ray
    Vec3<Real> throughput;  // throughput: product of BSDF * cosine / pdf so far
    Vec3<Real> radiance;    // light that the path has collected so far
    Real time;              // time of the path's rays in seconds
    std::uint32_t pixel;    // row-major index of the path's pixel
    std::uint32_t sample;
    std::uint32_t segment;     // number of ray segments traced so far (segments_of); `ended` once the path is over
    SurfaceId origin_surface;  // the surface that the ray starts on
    std::uint32_t medium;      // material whose absorbing medium the ray runs through, or no_medium
    // Pdf, by solid angle, of the ray's direction if its vertex was connected to a light too; 0 from the camera, a
    // specular surface or a body: lights that the ray hits then count in full. With one-sample MIS
    // (SceneView::one_sample) negative where the connection was chosen: lights that the ray hits then do not count.
    Real bsdf_pdf;
    // The triangle of origin_surface's mesh that the ray starts on. Between intersection and shading in a queue it is
    // the triangle that the ray has hit.
    std::uint32_t primitive;

    static constexpr std::uint32_t ended = 0xffffffffu;
    static constexpr std::uint32_t no_medium = 0xffffffffu;

    PT_HD bool alive() const { return segment != ended; }
};

// Low bits of Path::segment, which count segments. In kernels whose paths split, the bits above number the path's
// branch, from which its random numbers follow.
inline constexpr std::uint32_t segment_bits = 20;

template <class Config>
PT_HD inline std::uint32_t segments_of(const Path<typename Config::Real>& path) {
    if constexpr (has<Config>(Feature::splitting)) {
        return path.segment & ((1u << segment_bits) - 1u);
    } else {
        return path.segment;
    }
}

}  // namespace pt
