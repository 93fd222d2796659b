// Box lights by points on the faces that are seen of them, over all lanes of a packet at once: SeenFaces and
// FacesByArea of kernels/light_sampling.h. The formulas are the kernels', in their order, so a lane's answer has the
// same bits; only their branches are selections here.
#pragma once

#include "variants/cpu/lanes_lights.h"

namespace pt::lanes {

// How a kernel draws points on boxes, if in one way; else solid_angle.
template <class Config>
inline constexpr LightSampling face_sampling = light_sampling_in(Config::features& light_samplings);

// SeenFaces::height of one face.
template <class Real>
inline Real seen_height(Real height, Real area) {
    return (height > Real(0)) & (area > Real(0)) ? height : Real(0);
}
// SeenFaces::onto.
template <class Real>
inline Real onto_face(Real observer, Real height) {
    return observer > Real(0) ? -height : height;
}

// sample_box_light of the lanes that draw a point on a box of which they see a face; the others are left to
// `drawn.is_other`. `near_limit`: as there, for LightSampling::automatic.
template <LightSampling sampling, class Real>
inline void sample_faces(LightDirections<Real>& drawn, const LightTable<Real>& table, const Vectors<Real>& positions,
                         const Flags& draws, Real near_limit) {
    const std::uint32_t* const is_box = table.is_box.data();
    const Real *const x = table.centre[0].data(), *const y = table.centre[1].data(), *const z = table.centre[2].data();
    const Real *const half_x = table.face_half[0].data(), *const half_y = table.face_half[1].data(),
                      *const half_z = table.face_half[2].data(), *const scales = table.scale.data(),
                      *const units = table.unit.data();
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const std::uint32_t i = drawn.light[l];
        const Vec3<Real> half{gathered(half_x, i), gathered(half_y, i), gathered(half_z, i)};
        const Vec3<Real> o =
            (positions[l] - Vec3<Real>{gathered(x, i), gathered(y, i), gathered(z, i)}) * gathered(scales, i);
        const Vec3<Real> area{Real(4) * half.y * half.z, Real(4) * half.z * half.x, Real(4) * half.x * half.y};
        const Vec3<Real> height{seen_height(absolute(o.x) - half.x, area.x),
                                seen_height(absolute(o.y) - half.y, area.y),
                                seen_height(absolute(o.z) - half.z, area.z)};
        const bool sees = (height.x > Real(0)) | (height.y > Real(0)) | (height.z > Real(0));
        bool is_here = sees;
        if constexpr (sampling == LightSampling::automatic) {
            const Vec3<Real> gap{max(Real(0), absolute(o.x) - half.x), max(Real(0), absolute(o.y) - half.y),
                                 max(Real(0), absolute(o.z) - half.z)};
            is_here = sees & !(dot(gap, gap) < near_limit * near_limit * dot(half, half));
        }
        constexpr bool is_by_area = sampling == LightSampling::area;
        const Vec3<Real> by_area{height.x > Real(0) ? area.x : Real(0), height.y > Real(0) ? area.y : Real(0),
                                 height.z > Real(0) ? area.z : Real(0)};
        const Vec3<Real> share = is_by_area ? by_area : area * height;
        const Real total = share.x + share.y + share.z;
        const Real pick = drawn.w[l] * total;
        const bool is_z = (share.z > Real(0)) & (pick >= share.x + share.y);
        const bool is_y = !is_z & (share.y > Real(0)) & (pick >= share.x);
        const bool is_x = !is_z & !is_y;
        const Real a = Real(2) * drawn.u[l] - Real(1);
        const Real b = Real(2) * drawn.v[l] - Real(1);
        const Real of_y = is_x ? a : b;
        const Vec3<Real> inner{a * half.x - o.x, of_y * half.y - o.y, b * half.z - o.z};
        const Vec3<Real> to_light{is_x ? onto_face(o.x, height.x) : inner.x, is_y ? onto_face(o.y, height.y) : inner.y,
                                  is_z ? onto_face(o.z, height.z) : inner.z};
        const Real square = dot(to_light, to_light);
        const Real root = square_root(square);
        const Real inverse = Real(1) / root;
        const Real picked_height = is_x ? height.x : is_y ? height.y : height.z;
        const Real of_direction = is_by_area ? picked_height * inverse : inverse;
        const bool is_known = square >= Real(0x1p-100);
        const std::uint32_t taken = is_here ? draws[l] & gathered(is_box, i) : 0u;
        drawn.direction.set(l, to_light * inverse);
        drawn.inverse_pdf[l] = is_known ? total * inverse * inverse * of_direction : Real(0);
        drawn.distance[l] = root * gathered(units, i);
        drawn.is_other[l] = draws[l] - taken;
    }
}

}  // namespace pt::lanes
