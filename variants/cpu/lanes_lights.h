// Sampling of box lights by solid angle over all lanes of a packet at once: SeenBox and SphericalRectangle of
// kernels/solid_angle.h. The formulas are the kernels', in their order, so a lane's sample has the same bits
// (tests/unit/lanes_test.cpp); only their branches are selections.
#pragma once

#include <vector>

#include "variants/cpu/lanes.h"

namespace pt::lanes {

// What SeenBox (kernels/solid_angle.h) computes of an axis box that does not depend on the observer.
template <class Real>
struct BoxLight {
    Vec3<Real> centre;
    Vec3<Real> half;  // half extents of the box in units of its diagonal
    Real diagonal, inverse_diagonal;

    explicit BoxLight(const AxisBox<Real>& box) : centre((box.high + box.low) * Real(0.5)) {
        const Vec3<Real> half_extents = (box.high - box.low) * Real(0.5);
        diagonal = Real(2) * square_root(dot(half_extents, half_extents));
        inverse_diagonal = Real(1) / diagonal;
        half = half_extents * inverse_diagonal;
    }
};
// A scene's lights as tables for all packets: `boxes` has an entry for each axis box, other arrays one for each light.
// Each number is an array of its own, so that packets can gather vectors.
template <class Real>
struct LightTable {
    std::vector<BoxLight<Real>> boxes;
    std::vector<std::uint32_t> object, is_box;
    std::vector<Real> centre[3], half[3], emission[3], diagonal, inverse_diagonal;
    // SeenFaces of each light: half extents in scaled units, scaled units per scene unit, and the inverse of that.
    std::vector<Real> face_half[3], scale, unit;

    LightTable() = default;
    explicit LightTable(const SceneView<Real>& scene)
        : boxes(scene.axis_boxes.data, scene.axis_boxes.data + scene.axis_boxes.size) {
        for (std::uint32_t i = 0; i < scene.lights.size; ++i) {
            add(scene, scene.lights[i].object);
        }
    }

private:
    static void push(std::vector<Real> (&arrays)[3], const Vec3<Real>& v) {
        arrays[0].push_back(v.x);
        arrays[1].push_back(v.y);
        arrays[2].push_back(v.z);
    }
    void add(const SceneView<Real>& scene, std::uint32_t number) {
        const std::uint32_t box = number - first_of<ShapeKind::axis_box>(scene);
        const bool is_one = box < scene.axis_boxes.size;
        // A light that is no axis box has a unit box in the table, whose numbers are not used.
        const AxisBox<Real> unit_box{Vec3<Real>(Real(-1)), Vec3<Real>(Real(1))};
        const BoxLight<Real> light = is_one ? boxes[box] : BoxLight<Real>(unit_box);
        object.push_back(number);
        is_box.push_back(is_one ? 1u : 0u);
        push(centre, light.centre);
        push(half, light.half);
        push(emission, scene.materials[scene.object_material[number]].emission);
        diagonal.push_back(light.diagonal);
        inverse_diagonal.push_back(light.inverse_diagonal);
        const BoxFrame<Real> frame = box_frame(is_one ? scene.axis_boxes[box] : unit_box, Vec3<Real>(Real(0)));
        const SeenFaces<Real> faces(frame);
        push(face_half, faces.half);
        scale.push_back(faces.scale);
        unit.push_back(reciprocal_of_power_of_two(faces.scale));
    }
};

// How many entries of a packed list a loop over it takes at a time; results past the list's end are ignored.
inline constexpr std::uint32_t group = 16;
static_assert(width % group == 0);

// Observers of box lights as a packed list: entry k belongs to lane[k]. Entries past the end name valid lanes, too.
template <class Real>
struct BoxViews {
    std::uint32_t size = 0;
    Lanes<std::uint32_t> lane;
    Vectors<Real> observer, half;  // observer's position and the box's half extents, as in SeenBox
    Lanes<Real> diagonal;
    Vectors<Real> share, skew;  // by axis that a box face lies across: SeenBox::share, and SphericalRectangle's skew
    Lanes<Real> total;
    // Directions sampled towards box lights: the random numbers that sampling takes, and the results.
    Lanes<Real> u, v, w, axis;
    Vectors<Real> direction;
    Lanes<Real> inverse_pdf;

    // Appends lane l to the list if the flag is set, without a branch: a lane not to be added is written past the end.
    // To be called once a lane.
    void add_if(std::uint32_t flag, std::uint32_t l) {
        lane[size] = l;
        size += flag;
    }
};

// The lanes that observe box lights, from near and from far. Lanes within or on the box ask SeenBox itself.
template <class Real>
struct BoxObservers {
    BoxViews<Real> near, far;

    void clear() { near.size = far.size = 0; }
    // Adds a lane to the near or far observers of box lights; false if it sees no face of the box and is not added.
    bool add(std::uint32_t l, const BoxLight<Real>& light, const Vec3<Real>& position) {
        const Vec3<Real> from = (position - light.centre) * light.inverse_diagonal;
        const bool sees = sees_faces(from, light.half);
        BoxViews<Real>& views = dot(from, from) < Real(4) ? near : far;
        if (sees) {
            views.observer.set(views.size, from);
            views.half.set(views.size, light.half);
            views.diagonal[views.size] = light.diagonal;
            views.add_if(1, l);
        }
        return sees;
    }
    static bool sees_faces(const Vec3<Real>& from, const Vec3<Real>& half) {
        return (absolute(from.x) - half.x > Real(0)) | (absolute(from.y) - half.y > Real(0)) |
               (absolute(from.z) - half.z > Real(0));
    }
};

template <class Real>
inline Real arc_tangent(Real x) {
    constexpr Real least_for_quarter = sizeof(Real) == 4 ? Real(0.41421356237309503) : Real(0.66);
    const Real size = absolute(x);
    const bool is_large = size > Real(2.41421356237309504880);
    const bool is_middle = size > least_for_quarter;
    // The arc tangent's series takes dividend / divisor, which for a small x is |x| / 1.
    const Real dividend = is_large ? Real(-1) : is_middle ? size - Real(1) : size;
    const Real divisor = is_large ? size : is_middle ? size + Real(1) : Real(1);
    const Real base = is_large ? pi<Real> / Real(2) : is_middle ? pi<Real> / Real(4) : Real(0);
    const Real rest = dividend / divisor;
    const Real angle = base + (arc_tangent_series(rest * rest) * rest + rest);
    return x < Real(0) ? -angle : angle;
}

template <class Real>
inline Real corner(Real x, Real y, Real height) {
    return lanes::arc_tangent(x * y / (height * square_root(x * x + y * y + height * height)));
}

// The components of all lanes' vectors along one axis.
template <int axis, class Real>
inline Lanes<Real>& along_axis(Vectors<Real>& v) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// Computes for near observers the solid angles of the box faces across one axis.
template <int axis, class Real>
inline void measure_faces(BoxViews<Real>& views) {
    constexpr int b = (axis + 1) % 3;
    constexpr int c = (axis + 2) % 3;
    const Lanes<Real>&at_a = along_axis<axis>(views.observer), &at_b = along_axis<b>(views.observer),
          &at_c = along_axis<c>(views.observer), &half_a = along_axis<axis>(views.half),
          &half_b = along_axis<b>(views.half), &half_c = along_axis<c>(views.half);
    Lanes<Real>&share = along_axis<axis>(views.share), &skews = along_axis<axis>(views.skew);
    for (std::size_t first = 0; first < views.size; first += group) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + group; ++k) {
            const Real height = absolute(at_a[k]) - half_a[k];
            const Real x0 = -half_b[k] - at_b[k];
            const Real x1 = half_b[k] - at_b[k];
            const Real y0 = -half_c[k] - at_c[k];
            const Real y1 = half_c[k] - at_c[k];
            const Real skew = corner(x0, y0, height) - corner(x0, y1, height);
            const Real seen = corner(x1, y1, height) - corner(x1, y0, height) + skew;
            skews[k] = skew;
            share[k] = (height > Real(0)) & (seen > Real(0)) ? seen : Real(0);
        }
    }
}

// Computes SeenBox::share and SeenBox::total for the near observers of box lights.
template <class Real>
inline void measure_near(BoxViews<Real>& views) {
    measure_faces<0>(views);
    measure_faces<1>(views);
    measure_faces<2>(views);
    for (std::size_t first = 0; first < views.size; first += group) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + group; ++k) {
            views.total[k] = views.share.x[k] + views.share.y[k] + views.share.z[k];
        }
    }
}
template <class Real>
inline void measure_far(BoxViews<Real>& views) {
    for (std::size_t first = 0; first < views.size; first += group) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + group; ++k) {
            const Vec3<Real> observer = views.observer[k];
            const Vec3<Real> half = views.half[k];
            const Vec3<Real> height{absolute(observer.x) - half.x, absolute(observer.y) - half.y,
                                    absolute(observer.z) - half.z};
            const Vec3<Real> seen{Real(4) * half.y * half.z * height.x, Real(4) * half.z * half.x * height.y,
                                  Real(4) * half.x * half.y * height.z};
            const Vec3<Real> share{(height.x > Real(0)) & (seen.x > Real(0)) ? seen.x : Real(0),
                                   (height.y > Real(0)) & (seen.y > Real(0)) ? seen.y : Real(0),
                                   (height.z > Real(0)) & (seen.z > Real(0)) ? seen.z : Real(0)};
            views.share.set(k, share);
            views.total[k] = share.x + share.y + share.z;
        }
    }
}

template <class Real>
inline SinCos<Real> sin_cos(Real x) {
    const Real turns = min(absolute(x) * (Real(0.5) / pi<Real>), Real(1));
    const int quarter = static_cast<int>(turns * Real(4) + Real(0.5));
    const SinCos<Real> octant = sin_cos_octant((turns - Real(quarter) * Real(0.25)) * (Real(2) * pi<Real>));
    const Real nearest = Real(quarter);
    const Real of_odd = nearest == Real(3) ? -octant.cosine : octant.cosine;
    const Real of_even = nearest == Real(2) ? -octant.sine : octant.sine;
    const bool is_odd = (nearest == Real(1)) | (nearest == Real(3));
    const Real sine = is_odd ? of_odd : of_even;
    const Real across = is_odd ? octant.sine : octant.cosine;
    const bool is_left = (nearest == Real(1)) | (nearest == Real(2));
    return {x < Real(0) ? -sine : sine, is_left ? -across : across};
}

// Samples a point in a spherical rectangle, as SphericalRectangle::point (kernels/solid_angle.h) does.
template <class Real>
inline Vec2<Real> point_in_rectangle(Real x0, Real x1, Real y0, Real y1, Real height, Real skew, Real solid_angle,
                                     Real u, Real v) {
    const SinCos<Real> angle = lanes::sin_cos(u * solid_angle - skew);
    const Real b0 = -y0 / square_root(y0 * y0 + height * height);
    const Real b1 = y1 / square_root(y1 * y1 + height * height);
    const Real c = angle.cosine * b0 + b1;
    const Real lean = angle.sine * angle.sine * height * height / (y0 * y0 + height * height);
    const Real square = c * c - lean;
    const Real within = clamp(height * angle.sine / square_root(square), x0, x1);
    const Real end = angle.sine < Real(0) ? x0 : x1;
    const Real x = square > Real(0) ? within : end;
    const Real d_squared = x * x + height * height;
    const Real h0 = y0 / square_root(d_squared + y0 * y0);
    const Real h1 = y1 / square_root(d_squared + y1 * y1);
    const Real h = h0 + v * (h1 - h0);
    const Real rest = (Real(1) - h) * (Real(1) + h);
    const Real inner = clamp(h * square_root(d_squared / rest), y0, y1);
    const Real edge = h < Real(0) ? y0 : y1;
    return {x, rest > Real(0) ? inner : edge};
}

// An axis for each lane, stored as a Real: g++ 12 does not vectorise selections by numbers of another type.
template <class Real>
struct PickedAxis {
    Real number;

    Real of(Real of_x, Real of_y, Real of_z) const {
        const Real other = number == Real(1) ? of_y : of_z;
        return number == Real(0) ? of_x : other;
    }
    // Turns components along the picked axis and the two that follow it into a vector in x, y, z.
    Vec3<Real> in_order(Real a, Real b, Real c) const { return {of(a, c, b), of(b, a, c), of(c, b, a)}; }
};

// Light samples by lane: unit directions to lights with 1 / pdf.
template <class Real>
struct LightDirections {
    Lanes<Real> u, v, w;              // random numbers of the lane's light sample
    Lanes<std::uint32_t> light;       // number of the light among the scene's lights
    Vectors<Real> observer;           // observer's position relative to the box light, as in SeenBox
    Flags is_near, is_far, is_other;  // whether the lane sees its box light, from near or from far, or no box light
    Vectors<Real> direction;
    Lanes<Real> inverse_pdf;
    Lanes<Real> distance;            // distance to the light point that was sampled; 0: not known
    Lanes<std::uint32_t> primitive;  // mesh triangle on which the sampled light point lies
};

// Loads a number at a lane's own index. The index is signed, as a gathering load wants it.
template <class T>
inline T gathered(const T* from, std::uint32_t index) {
    return from[static_cast<std::int32_t>(index)];
}

// A light's entry in a table. The table of one light is read without index: a gathering load costs as much as 16 loads.
template <bool one_light, class T>
inline T of_light(const T* from, std::uint32_t light) {
    return one_light ? *from : gathered(from, light);
}

// Computes how lanes that sample a light see it: the observer's position, and whether a box light is near or far.
template <class Real>
inline void look_at_lights(LightDirections<Real>& drawn, const LightTable<Real>& table, const Vectors<Real>& positions,
                           const Flags& draws) {
    const std::uint32_t* const is_box = table.is_box.data();
    const Real *const x = table.centre[0].data(), *const y = table.centre[1].data(), *const z = table.centre[2].data();
    const Real *const half_x = table.half[0].data(), *const half_y = table.half[1].data(),
                      *const half_z = table.half[2].data(), *const inverse = table.inverse_diagonal.data();
#pragma GCC ivdep
    for (std::uint32_t l = 0; l < width; ++l) {
        const std::uint32_t i = drawn.light[l];
        const Vec3<Real> from =
            (positions[l] - Vec3<Real>{gathered(x, i), gathered(y, i), gathered(z, i)}) * gathered(inverse, i);
        const bool sees = BoxObservers<Real>::sees_faces(
            from, Vec3<Real>{gathered(half_x, i), gathered(half_y, i), gathered(half_z, i)});
        const bool is_near = dot(from, from) < Real(4);
        const std::uint32_t is_here = sees ? draws[l] & gathered(is_box, i) : 0u;
        drawn.observer.set(l, from);
        drawn.is_near[l] = is_near ? is_here : 0u;
        drawn.is_far[l] = is_near ? 0u : is_here;
        drawn.is_other[l] = draws[l] - is_here;
    }
}

// Packs the lanes whose flags are set into a list of observers, with all that sampling a direction takes.
template <class Real>
inline void pack(BoxViews<Real>& views, const LightDirections<Real>& drawn, const LightTable<Real>& table,
                 const Flags& flags) {
    views.size = 0;
    for (std::uint32_t l = 0; l < width; ++l) {
        views.add_if(flags[l], l);
    }
    const Real *const half_x = table.half[0].data(), *const half_y = table.half[1].data(),
                      *const half_z = table.half[2].data(), *const diagonal = table.diagonal.data();
    for (std::size_t first = 0; first < views.size; first += group) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + group; ++k) {
            const std::uint32_t l = views.lane[k];
            const std::uint32_t i = gathered(drawn.light.of, l);
            views.observer.x[k] = gathered(drawn.observer.x.of, l);
            views.observer.y[k] = gathered(drawn.observer.y.of, l);
            views.observer.z[k] = gathered(drawn.observer.z.of, l);
            views.half.x[k] = gathered(half_x, i);
            views.half.y[k] = gathered(half_y, i);
            views.half.z[k] = gathered(half_z, i);
            views.diagonal[k] = gathered(diagonal, i);
            views.u[k] = gathered(drawn.u.of, l);
            views.v[k] = gathered(drawn.v.of, l);
            views.w[k] = gathered(drawn.w.of, l);
        }
    }
}
template <class Real>
inline void unpack(const BoxViews<Real>& views, LightDirections<Real>& drawn) {
    for (std::uint32_t k = 0; k < views.size; ++k) {
        const std::uint32_t l = views.lane[k];
        drawn.direction.set(l, views.direction[k]);
        drawn.inverse_pdf[l] = views.inverse_pdf[k];
    }
}

// Picks the faces of boxes by the random number `w`, as SeenBox::sample does.
template <class Real>
inline void pick_axes(BoxViews<Real>& views) {
    for (std::size_t first = 0; first < views.size; first += group) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + group; ++k) {
            const Vec3<Real> share = views.share[k];
            const Real pick = views.w[k] * views.total[k];
            const Real last = share.z > Real(0) ? Real(2) : share.y > Real(0) ? Real(1) : Real(0);
            const Real other = pick < share.x + share.y ? Real(1) : Real(2);
            views.axis[k] = pick < share.x ? Real(0) : min(other, last);
        }
    }
}

template <class Real>
inline void sample_near(BoxViews<Real>& views) {
    measure_near(views);
    pick_axes(views);
    for (std::size_t first = 0; first < views.size; first += group) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + group; ++k) {
            const Vec3<Real> o = views.observer[k];
            const Vec3<Real> half = views.half[k];
            const Vec3<Real> share = views.share[k];
            const Vec3<Real> skew = views.skew[k];
            const PickedAxis<Real> axis{views.axis[k]};
            const Real at_a = axis.of(o.x, o.y, o.z);
            const Real at_b = axis.of(o.y, o.z, o.x);
            const Real at_c = axis.of(o.z, o.x, o.y);
            const Real half_b = axis.of(half.y, half.z, half.x);
            const Real half_c = axis.of(half.z, half.x, half.y);
            const Real height = absolute(at_a) - axis.of(half.x, half.y, half.z);
            const Vec2<Real> point = point_in_rectangle(-half_b - at_b, half_b - at_b, -half_c - at_c, half_c - at_c,
                                                        height, axis.of(skew.x, skew.y, skew.z),
                                                        axis.of(share.x, share.y, share.z), views.u[k], views.v[k]);
            const Vec3<Real> to_light = axis.in_order(at_a > Real(0) ? -height : height, point.x, point.y);
            views.direction.set(k, to_light * (Real(1) / square_root(dot(to_light, to_light))));
            views.inverse_pdf[k] = views.total[k];
        }
    }
}

template <class Real>
inline void sample_far(BoxViews<Real>& views) {
    measure_far(views);
    pick_axes(views);
    for (std::size_t first = 0; first < views.size; first += group) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + group; ++k) {
            const Vec3<Real> o = views.observer[k];
            const Vec3<Real> half = views.half[k];
            const PickedAxis<Real> axis{views.axis[k]};
            const Real at_a = axis.of(o.x, o.y, o.z);
            const Real half_a = axis.of(half.x, half.y, half.z);
            const Real face = at_a > Real(0) ? half_a : -half_a;
            const Real b = (Real(2) * views.u[k] - Real(1)) * axis.of(half.y, half.z, half.x);
            const Real c = (Real(2) * views.v[k] - Real(1)) * axis.of(half.z, half.x, half.y);
            const Vec3<Real> to_light =
                axis.in_order(face - at_a, b - axis.of(o.y, o.z, o.x), c - axis.of(o.z, o.x, o.y));
            const Real length = square_root(dot(to_light, to_light));
            views.direction.set(k, to_light * (Real(1) / length));
            views.inverse_pdf[k] = far_inverse_pdf(views.total[k], length * views.diagonal[k], views.diagonal[k]);
        }
    }
}

// SeenBox::sample (kernels/solid_angle.h) for the lanes that see a box light from near or from far.
template <class Real>
inline void sample_boxes(BoxObservers<Real>& observers, LightDirections<Real>& drawn, const LightTable<Real>& table) {
    pack(observers.near, drawn, table, drawn.is_near);
    sample_near(observers.near);
    unpack(observers.near, drawn);
    pack(observers.far, drawn, table, drawn.is_far);
    sample_far(observers.far);
    unpack(observers.far, drawn);
}

}  // namespace pt::lanes
