// Sampling of directions towards a light of any shape, with pdfs (kernels/solid_angle.h or kernels/light_sampling.h)
// and with the length of the shadow ray along a direction.
#pragma once

#include "kernels/light_sampling.h"
#include "kernels/line_of_sight.h"
#include "kernels/naive.h"

namespace pt {

// How the kernel draws points on boxes and quads that emit: as compiled, or as the scene says.
template <class Config, class Scene>
PT_HD inline LightSampling light_sampling_of(const Scene& scene) {
    constexpr FeatureSet compiled = Config::features & light_samplings;
    constexpr bool is_chosen_at_run_time = (compiled & (compiled - 1u)) != 0;
    if constexpr (is_chosen_at_run_time) {
        return scene.light_sampling;
    } else {
        return light_sampling_in(compiled);
    }
}

// Distance from a light, in half diagonals of its box, below which the light counts as near.
template <class Real, class Scene>
PT_HD inline Real near_light_of(const Scene& scene) {
    return static_cast<Real>(scene.near_light) * Real(0.01);
}

// Draws a direction towards a shape by the density that the kernel is compiled for; naive kernels use the textbook form
// where the shape has one.
template <class Config, class Scene, class Shape, class Real>
PT_HD inline DirectionSample<Real> sample_direction_in(const Scene& scene, const Shape& shape,
                                                       const Vec3<Real>& observer, Real u, Real v, Real w) {
    if constexpr (has<Config>(Feature::naive)) {
        return naive::sample_direction(shape, observer, u, v, w);
    } else {
        if constexpr ((Config::features & light_samplings) != 0 && IsBoxLike<Shape, Real>) {
            const LightSampling sampling = light_sampling_of<Config>(scene);
            if (sampling != LightSampling::solid_angle) {
                return sample_box_light(shape, observer, sampling, near_light_of<Real>(scene), u, v, w);
            }
        }
        return sample_direction(shape, observer, u, v, w);
    }
}

template <class Config, class Scene, class Shape, class Real>
PT_HD inline Real inverse_direction_pdf_in(const Scene& scene, const Shape& shape, const Vec3<Real>& observer,
                                           const Vec3<Real>& direction, Real distance) {
    if constexpr (has<Config>(Feature::naive)) {
        return naive::inverse_direction_pdf(shape, observer, direction, distance);
    } else {
        if constexpr ((Config::features & light_samplings) != 0 && IsBoxLike<Shape, Real>) {
            const LightSampling sampling = light_sampling_of<Config>(scene);
            if (sampling != LightSampling::solid_angle) {
                return inverse_box_light_pdf(shape, observer, direction, distance, sampling,
                                             near_light_of<Real>(scene));
            }
        }
        return inverse_direction_pdf(shape, observer, direction, distance);
    }
}

// Whether the kernel draws points on the faces of more than one kind of shape that is sampled as a box.
template <class Config>
PT_HD constexpr bool has_many_box_likes() {
    using Real = typename Config::Real;
    std::uint32_t kinds = 0;
#define PT_COUNT(name, array, Type) kinds += has<Config>(Feature::name) && IsBoxLike<Type<Real>, Real> ? 1u : 0u;
    PT_SHAPES(PT_COUNT)
#undef PT_COUNT
    return kinds > 1 && (Config::features & light_samplings) != 0 && !has<Config>(Feature::naive);
}

// A shape that is sampled as a box, as its observer sees it: the box's frame, and a direction in that frame.
template <class Real>
struct SeenAsBox {
    bool is_box_like = false;
    BoxFrame<Real> frame{};
    Vec3<Real> direction{Real(0)};

    template <class Shape>
    PT_HD void look_at(const Shape& shape, const Vec3<Real>& observer, const Vec3<Real>& towards) {
        if constexpr (IsBoxLike<Shape, Real>) {
            is_box_like = true;
            frame = box_frame(shape, observer);
            direction = box_to_local(shape, towards);
        }
    }
};

// Length of a shadow ray towards a body: the distance at which the ray enters the body, computed as by closest_hit, or
// 0 if not known. (Light samples on the faces of boxes come with their distance.)
template <class Config, class Shape, class Real>
PT_HD inline Real distance_to_light(const Shape& shape, const Vec3<Real>& observer, const Vec3<Real>& direction) {
    constexpr bool looks = has_lines_of_sight<Config> && (Config::features & light_samplings) != 0;
    if constexpr (looks && IsConvexBody<Shape, Real> && !IsBoxLike<Shape, Real>) {
        const Interval<Real> crossing = interval(as_met<Config>(shape), observer, direction);
        return crossing.hits && crossing.near > Real(0) ? crossing.near : Real(0);
    } else {
        return Real(0);
    }
}

// Samples a direction in the scene towards an object that emits. Its distance is the length of the shadow ray.
template <class Config>
PT_HD inline DirectionSample<typename Config::Real> sample_direction_to(
    const SceneView<typename Config::Real>& scene, std::uint32_t object, const Vec3<typename Config::Real>& position,
    typename Config::Real time, typename Config::Real u, typename Config::Real v, typename Config::Real w) {
    using Real = typename Config::Real;
    const Vec3<Real> observer = at_rest<Config>(scene, object, position, time);
    DirectionSample<Real> sample{{Real(0), Real(0), Real(1)}, Real(0)};
    const auto sample_shape = [&](const auto& shape) {
        sample = sample_direction_in<Config>(scene, shape, observer, u, v, w);
        if (!(sample.distance > Real(0))) {
            sample.distance = distance_to_light<Config>(shape, observer, sample.direction);
        }
    };
    if constexpr (has_many_box_likes<Config>()) {
        // In this visit a box light only gives its box: the threads of a warp sample points together afterwards,
        // whatever shapes their lights have.
        const LightSampling sampling = light_sampling_of<Config>(scene);
        SeenAsBox<Real> box;
        visit_shape<Config>(scene, object, [&](const auto& shape) {
            if (sampling != LightSampling::solid_angle) {
                box.look_at(shape, observer, Vec3<Real>(Real(0)));
            }
            if (!box.is_box_like) {
                sample_shape(shape);
            }
        });
        if (box.is_box_like) {
            sample = sample_box_light(box.frame, sampling, near_light_of<Real>(scene), u, v, w);
            visit_shape<Config>(scene, object, [&]<class Shape>(const Shape& shape) {
                if constexpr (IsBoxLike<Shape, Real>) {
                    sample.direction = box_to_world(shape, sample.direction);
                }
            });
        }
    } else {
        visit_shape<Config>(scene, object, sample_shape);
    }
    return sample;
}

// 1 / pdf, by solid angle, with which sample_direction_to draws the direction of a ray that hits an object at `hit`.
template <class Config>
PT_HD inline typename Config::Real inverse_direction_pdf_to(const SceneView<typename Config::Real>& scene,
                                                            const Hit<typename Config::Real>& hit,
                                                            const Ray<typename Config::Real>& ray) {
    using Real = typename Config::Real;
    const std::uint32_t object = has_one_light<Config>() ? scene.lights[0].object : hit.side.object();
    return in_one_place<Config>([&] {
        const Vec3<Real> observer = at_rest<Config>(scene, object, ray.origin, ray.time);
        Real inverse_pdf = Real(0);
        const auto ask_shape = [&](const auto& shape) {
            inverse_pdf = inverse_direction_pdf_in<Config>(scene, primitive_of(shape, hit.primitive), observer,
                                                           ray.direction, hit.t);
        };
        if constexpr (has_many_box_likes<Config>()) {
            const LightSampling sampling = light_sampling_of<Config>(scene);
            SeenAsBox<Real> box;
            visit_shape<Config>(scene, object, [&](const auto& shape) {
                if (sampling != LightSampling::solid_angle) {
                    box.look_at(shape, observer, ray.direction);
                }
                if (!box.is_box_like) {
                    ask_shape(shape);
                }
            });
            if (box.is_box_like) {
                inverse_pdf =
                    inverse_box_light_pdf(box.frame, box.direction, hit.t, sampling, near_light_of<Real>(scene));
            }
        } else {
            visit_shape<Config>(scene, object, ask_shape);
        }
        return inverse_pdf;
    });
}

}  // namespace pt
