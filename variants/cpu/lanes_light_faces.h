// Sampling of box lights by points on the faces that are seen, over all lanes of a packet at once: SeenFaces and
// FacesByArea of kernels/light_sampling.h. The formulas are the kernels', in their order, so a lane's sample has the
// same bits; only their branches are selections.
#pragma once

#include "variants/cpu/lanes_lights.h"

namespace pt::lanes {

// How a kernel samples points on box lights, if it has just one way; solid_angle also for kernels with none.
template <class Config>
inline constexpr LightSampling face_sampling = light_sampling_in(Config::features& light_samplings);

// A coordinate of a light's face as an observer sees it, computed as by SeenFaces::onto (kernels/light_sampling.h).
template <class Real>
inline Real onto_face(Real observer, Real height) {
    return observer > Real(0) ? -height : height;
}

// sample_box_light (kernels/light_sampling.h) for lanes whose light is a box of which they see a face; other lanes are
// flagged in `drawn.is_other`. `near_limit`: as for sample_box_light, for LightSampling::automatic.
template <LightSampling sampling, bool one_light, class Real>
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
        const Vec3<Real> half{of_light<one_light>(half_x, i), of_light<one_light>(half_y, i),
                              of_light<one_light>(half_z, i)};
        const Vec3<Real> o = (positions[l] - Vec3<Real>{of_light<one_light>(x, i), of_light<one_light>(y, i),
                                                        of_light<one_light>(z, i)}) *
                             of_light<one_light>(scales, i);
        const Vec3<Real> area{Real(4) * half.y * half.z, Real(4) * half.z * half.x, Real(4) * half.x * half.y};
        const Vec3<Real> above{absolute(o.x) - half.x, absolute(o.y) - half.y, absolute(o.z) - half.z};
        const bool sees_x = (above.x > Real(0)) & (area.x > Real(0));
        const bool sees_y = (above.y > Real(0)) & (area.y > Real(0));
        const bool sees_z = (above.z > Real(0)) & (area.z > Real(0));
        const Vec3<Real> height{sees_x ? above.x : Real(0), sees_y ? above.y : Real(0), sees_z ? above.z : Real(0)};
        const bool sees = sees_x | sees_y | sees_z;
        bool is_here = sees;
        if constexpr (sampling == LightSampling::automatic) {
            const Vec3<Real> gap{max(Real(0), above.x), max(Real(0), above.y), max(Real(0), above.z)};
            is_here = sees & !(dot(gap, gap) < near_limit * near_limit * dot(half, half));
        }
        constexpr bool is_by_area = sampling == LightSampling::area;
        const Vec3<Real> by_area{sees_x ? area.x : Real(0), sees_y ? area.y : Real(0), sees_z ? area.z : Real(0)};
        const Vec3<Real> share = is_by_area ? by_area : area * height;
        const Real total = share.x + share.y + share.z;
        const Real pick = drawn.w[l] * total;
        const bool has_y = is_by_area ? sees_y : share.y > Real(0);
        const bool has_z = is_by_area ? sees_z : share.z > Real(0);
        const Real of_xy = has_y & (pick >= share.x) ? Real(1) : Real(0);
        const Real axis = has_z & (pick >= share.x + share.y) ? Real(2) : of_xy;
        const Real a = Real(2) * drawn.u[l] - Real(1);
        const Real b = Real(2) * drawn.v[l] - Real(1);
        const Real of_y = axis == Real(0) ? a : b;
        const Vec3<Real> onto{onto_face(o.x, height.x), onto_face(o.y, height.y), onto_face(o.z, height.z)};
        const Vec3<Real> inner{a * half.x - o.x, of_y * half.y - o.y, b * half.z - o.z};
        const Vec3<Real> to_light{axis == Real(0) ? onto.x : inner.x, axis == Real(1) ? onto.y : inner.y,
                                  axis == Real(2) ? onto.z : inner.z};
        const Real square = dot(to_light, to_light);
        const Real root = square_root(square);
        const Real inverse = Real(1) / root;
        const Real of_direction =
            is_by_area ? PickedAxis<Real>{axis}.of(height.x, height.y, height.z) * inverse : inverse;
        const bool is_known = square >= Real(0x1p-100);
        const std::uint32_t draws_box = draws[l] & of_light<one_light>(is_box, i);
        const std::uint32_t taken = is_here ? draws_box : 0u;
        drawn.direction.set(l, to_light * inverse);
        drawn.inverse_pdf[l] = is_known ? total * inverse * inverse * of_direction : Real(0);
        drawn.distance[l] = root * of_light<one_light>(units, i);
        drawn.is_other[l] = draws[l] - taken;
    }
}

}  // namespace pt::lanes
