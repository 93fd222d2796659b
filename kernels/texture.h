// Colours and roughnesses that are images, looked up where a ray meets an object: bilinear between the four nearest
// texels (Williams, "Pyramidal Parametrics", SIGGRAPH 1983, without the pyramid), repeated in both directions, v
// upwards from the image's bottom edge. A blend is a + (b - a) s: exactly a where both are a, and never outside of [0,
// 1] where both are inside. A roughness is blended before it is squared to the width of facets: where all texels are
// one single precision number, that is the width of a material of this roughness, whose square is exact in double.
//
// A quad shows the whole image, upright for who looks down on it with -z away from them; a box shows it so on every
// face, upright as seen from outside (+y up on the sides, -z up on the top, +z up on the bottom); a sphere by latitude
// and longitude, its middle towards +z and its sides meeting at -z; all before rotation. A mesh has coordinates of its
// own.
#pragma once

#include "kernels/environment_map.h"
#include "kernels/intersect.h"

namespace pt {

template <class Real>
PT_HD inline Real whole_below(Real x) {
    using std::floor;
    return floor(x);
}

// The two texels of a row or column between whose middles a coordinate lies, and how far it lies towards the second.
template <class Real>
struct TexelPair {
    std::uint32_t first, second;
    Real share;
};

// The two texels nearest to a coordinate along a row or column of `count` texels, which wrap around. `count` is at most
// 2^22, so that it and the halves below it are numbers of single precision. A coordinate that is not a number gets some
// texels of the image.
template <class Real>
PT_HD inline TexelPair<Real> texel_pair(Real coordinate, std::uint32_t count) {
    const Real place = (coordinate - whole_below(coordinate)) * static_cast<Real>(count) - Real(0.5);
    const Real below = whole_below(place);  // index of the texel below the coordinate, -1 to count - 1
    const std::uint32_t first = below >= Real(0) ? static_cast<std::uint32_t>(below) : count - 1u;
    return {first, first + 1u == count ? 0u : first + 1u, place - below};
}

template <class Real>
PT_HD inline Vec3<Real> blend(const Vec3<Real>& a, const Vec3<Real>& b, Real share) {
    return a + (b - a) * share;
}

template <class Real, class Scene>
PT_HD inline Vec3<Real> image_at(const Scene& scene, const TexelBlock& image, const Vec2<Real>& at) {
    const TexelPair<Real> column = texel_pair(at.x, image.width), row = texel_pair(at.y, image.height);
    const auto texel = [&](std::uint32_t x, std::uint32_t y) {
        return Vec3<Real>(scene.texels[image.first_texel + y * image.width + x]);
    };
    return blend(blend(texel(column.first, row.first), texel(column.second, row.first), column.share),
                 blend(texel(column.first, row.second), texel(column.second, row.second), column.share), row.share);
}

// Texture coordinates u, v of a point on the face of the unit box whose normal is `axis` or, with sign -1, its
// opposite. A quad is the face +y.
template <class Real>
PT_HD inline Vec2<Real> face_coordinates(const Vec3<Real>& p, std::uint32_t axis, Real sign) {
    const Real half(0.5);
    return axis == 0   ? Vec2<Real>{half - sign * p.z, half + p.y}
           : axis == 1 ? Vec2<Real>{half + p.x, half - sign * p.z}
                       : Vec2<Real>{half + sign * p.x, half + p.y};
}

// The axis of the box that the normal is along, but for rounding: the one with the largest square of a cosine.
template <class Real>
PT_HD inline std::uint32_t axis_along(const Transform<Real>& box, const Vec3<Real>& normal) {
    const Real x = dot(box.row[0], normal) * dot(box.column[0], normal);
    const Real y = dot(box.row[1], normal) * dot(box.column[1], normal);
    const Real z = dot(box.row[2], normal) * dot(box.column[2], normal);
    return x > y ? (x > z ? 0u : 2u) : (y > z ? 1u : 2u);
}

// Texture coordinates u, v of a sphere by longitude and latitude, for a point p of any distance but 0 from the centre.
template <class Real>
PT_HD inline Vec2<Real> sphere_coordinates(const Vec3<Real>& p) {
    const Real half(0.5);
    const Real radius = square_root(p.x * p.x + p.z * p.z);
    const Real latitude =
        radius == Real(0) ? (p.y < Real(0) ? -half : half) : arc_tangent(p.y / radius) * (Real(1) / pi<Real>);
    return {fraction_of_turn(azimuth_in_turns(Vec3<Real>(-p.x, p.y, p.z))), half + latitude};
}

// Barycentric weights of a mesh triangle where a ray hits it. A ray that was traced in double may miss the triangle in
// single precision: the weights of its miss are then used as they are.
template <class Real>
PT_HD inline Vec3<Real> weights_of_corners(const MeshInstance<Real>& mesh, std::uint32_t primitive,
                                           const Vec3<Real>& origin, const Vec3<Real>& direction) {
    const TriangleHit<Real> hit = intersect(mesh.triangle(primitive), mesh.point_in(origin),
                                            ShearedDirection<Real>::of(mesh.direction_in(direction)));
    const Real third = Real(1) / Real(3);
    Vec3<Real> weights(third);
    if (hit.det != Real(0)) {
        weights = Vec3<Real>(hit.u, hit.v, hit.w) * (Real(1) / hit.det);
    }
    return weights;
}

// The texture coordinates u, v of the point at which a ray meets a triangle.
template <class Real>
PT_HD inline Vec2<Real> triangle_coordinates(const MeshInstance<Real>& mesh, std::uint32_t primitive,
                                             const CornerCoordinates& corners, const Vec3<Real>& origin,
                                             const Vec3<Real>& direction) {
    const Vec3<Real> weights = weights_of_corners(mesh, primitive, origin, direction);
    return {corners.u[0] * weights.x + corners.u[1] * weights.y + corners.u[2] * weights.z,
            corners.v[0] * weights.x + corners.v[1] * weights.y + corners.v[2] * weights.z};
}

// Texture coordinates u, v of a hit. `position`: the hit point, on the surface; `normal`: unit normal, on either side.
template <class Config, class Scene>
PT_HD inline Vec2<typename Config::Real> texture_coordinates_at(const Scene& scene,
                                                                const ObjectTexture<typename Config::Real>& texture,
                                                                const Ray<typename Config::Real>& ray,
                                                                const Hit<typename Config::Real>& hit,
                                                                const Vec3<typename Config::Real>& position,
                                                                const Vec3<typename Config::Real>& normal) {
    using Real = typename Config::Real;
    const std::uint32_t object = hit.side.object();
    if constexpr (has<Config>(Feature::mesh)) {
        if (texture.place.shape == UnitShape::none) {
            const CornerCoordinates& corners = scene.texture_coordinates[texture.first_coordinate + hit.primitive];
            return triangle_coordinates(scene.meshes[object - first_of<ShapeKind::mesh>(scene)], hit.primitive, corners,
                                        at_rest<Config>(scene, object, ray.origin, ray.time), ray.direction);
        }
    }
    const Vec3<Real> at = at_rest<Config>(scene, object, position, ray.time);
    const Vec3<Real> p = texture.place.direction_to_local(at - texture.place.centre);
    if (texture.place.shape == UnitShape::sphere) {
        return sphere_coordinates(p);
    }
    if (texture.place.shape == UnitShape::quad) {
        return face_coordinates(p, 1u, Real(1));
    }
    const std::uint32_t axis = axis_along(texture.place, normal);
    return face_coordinates(p, axis, component_of(p, axis) < Real(0) ? Real(-1) : Real(1));
}

// Looks up the colour that the object's image has at the hit; `colour` is left as it is where the object shows no
// image.
template <class Config, class Scene>
PT_HD inline void put_texture(Vec3<typename Config::Real>& colour, const Scene& scene,
                              const Ray<typename Config::Real>& ray, const Hit<typename Config::Real>& hit,
                              const Vec3<typename Config::Real>& position, const Vec3<typename Config::Real>& normal) {
    using Real = typename Config::Real;
    if (scene.object_textures.size == 0) {
        return;
    }
    const ObjectTexture<Real>& texture = scene.object_textures[hit.side.object()];
    if (texture.colour.width != 0) {
        colour =
            image_at(scene, texture.colour, texture_coordinates_at<Config>(scene, texture, ray, hit, position, normal));
    }
}

// Looks up the GGX alpha that the object's roughness image gives at the hit; `alpha` is left as it is where there is no
// such image.
template <class Config, class Scene>
PT_HD inline void put_roughness(typename Config::Real& alpha, const Scene& scene, const Ray<typename Config::Real>& ray,
                                const Hit<typename Config::Real>& hit, const Vec3<typename Config::Real>& position,
                                const Vec3<typename Config::Real>& normal) {
    using Real = typename Config::Real;
    if (scene.object_textures.size == 0) {
        return;
    }
    const ObjectTexture<Real>& texture = scene.object_textures[hit.side.object()];
    if (texture.roughness.width != 0) {
        const Real roughness = image_at(scene, texture.roughness,
                                        texture_coordinates_at<Config>(scene, texture, ray, hit, position, normal))
                                   .x;
        alpha = roughness * roughness;
    }
}

}  // namespace pt
