// Shading normals: those of a mesh's corners, interpolated over each triangle (Phong, "Illumination for computer
// generated pictures", CACM 18(6), 1975), and on top of them, or of any surface that has texture coordinates, those of
// a normal map (Cohen, Olano, Manocha, "Appearance-preserving simplification", SIGGRAPH 1998) in the frame of the
// tangent dP/du, the bitangent on the side of dP/dv, and the normal.
//
// Shading takes place on a plane through the point, across the shading normal; on which side of it a direction is, the
// geometric normal decides as well (Veach 1997, sec. 5.3). Directions that the two normals put on different sides carry
// nothing: neither the viewer's, nor a BSDF sample's, nor one to a light. Light is only lost by that, and pdfs stay
// what they are, so that connections and lights that are hit keep one mean. The next ray starts on the geometric
// surface.
#pragma once

#include "kernels/texture.h"

namespace pt {

// Outward shading normal of a mesh's triangle, interpolated from its corners' normals; without these the normal `own`.
template <class Config, class Scene>
PT_HD inline Vec3<typename Config::Real> normal_of_corners(const Scene& scene,
                                                           const ObjectNormals<typename Config::Real>& normals,
                                                           const Ray<typename Config::Real>& ray,
                                                           const Hit<typename Config::Real>& hit,
                                                           const Vec3<typename Config::Real>& own) {
    using Real = typename Config::Real;
    const std::uint32_t object = hit.side.object();
    const CornerNormals corners = scene.mesh_search->normals.corners[normals.first_normal + hit.primitive];
    const Vec3<Real> weights =
        weights_of_corners(scene.meshes[object - first_of<ShapeKind::mesh>(scene)], hit.primitive,
                           at_rest<Config>(scene, object, ray.origin, ray.time), ray.direction);
    const Vec3<Real> local = vector_of<Real>(corners.of[0]) * weights.x + vector_of<Real>(corners.of[1]) * weights.y +
                             vector_of<Real>(corners.of[2]) * weights.z;
    const Vec3<Real> placed = normals.row[0] * local.x + normals.row[1] * local.y + normals.row[2] * local.z;
    const Real square = dot(placed, placed);
    return square > Real(0) ? placed * (Real(1) / square_root(square)) : own;
}

// Directions on a surface in which a texture's u and v grow, of any length; both 0: there are none. In double, since
// the squares for a small triangle would leave the range of float.
struct Tangents {
    Vec3<double> along_u, along_v;
};

template <class Real>
PT_HD inline Tangents tangents_of(const MeshInstance<Real>& mesh, std::uint32_t primitive,
                                  const CornerCoordinates& at) {
    const Triangle<Real> t = mesh.triangle(primitive);
    const Vec3<double> a(t.a), b = Vec3<double>(t.b) - a, c = Vec3<double>(t.c) - a;
    const double bu = double(at.u[1]) - double(at.u[0]), bv = double(at.v[1]) - double(at.v[0]);
    const double cu = double(at.u[2]) - double(at.u[0]), cv = double(at.v[2]) - double(at.v[0]);
    const double area = bu * cv - bv * cu;
    const double sign = area > 0 ? 1 : area < 0 ? -1 : 0;
    const Vec3<double> u = (b * cv - c * bv) * sign, v = (c * bu - b * cu) * sign;
    const auto placed = [&](const Vec3<double>& local) {
        return mesh.is_placed != 0 ? local
                                   : Vec3<double>(mesh.column[0]) * local.x + Vec3<double>(mesh.column[1]) * local.y +
                                         Vec3<double>(mesh.column[2]) * local.z;
    };
    return {placed(u), placed(v)};
}

// Tangents on the face of the unit box whose normal is `axis` or, with sign -1, its opposite; u and v are those of
// face_coordinates.
template <class Real>
PT_HD inline Tangents tangents_of_face(const Transform<Real>& box, std::uint32_t axis, double sign) {
    const Vec3<double> x(box.column[0]), y(box.column[1]), z(box.column[2]);
    return axis == 0 ? Tangents{z * -sign, y} : axis == 1 ? Tangents{x, z * -sign} : Tangents{x * sign, y};
}

// The tangents on a sphere, with u and v as in sphere_coordinates; both 0 at the poles.
template <class Real>
PT_HD inline Tangents tangents_of_sphere(const Transform<Real>& sphere, const Vec3<Real>& p) {
    const Vec3<double> x(sphere.column[0]), y(sphere.column[1]), z(sphere.column[2]);
    const double px(p.x), py(p.y), pz(p.z);
    return {x * pz - z * px, y * (px * px + pz * pz) - (x * px + z * pz) * py};
}

template <class Config, class Scene>
PT_HD inline Tangents tangents_at(const Scene& scene, const ObjectTexture<typename Config::Real>& texture,
                                  const Ray<typename Config::Real>& ray, const Hit<typename Config::Real>& hit,
                                  const Vec3<typename Config::Real>& position, const Vec3<typename Config::Real>& own) {
    using Real = typename Config::Real;
    const std::uint32_t object = hit.side.object();
    if constexpr (has<Config>(Feature::mesh)) {
        if (texture.place.shape == UnitShape::none) {
            return tangents_of(scene.meshes[object - first_of<ShapeKind::mesh>(scene)], hit.primitive,
                               scene.texture_coordinates[texture.first_coordinate + hit.primitive]);
        }
    }
    const Vec3<Real> p =
        texture.place.direction_to_local(at_rest<Config>(scene, object, position, ray.time) - texture.place.centre);
    if (texture.place.shape == UnitShape::sphere) {
        return tangents_of_sphere(texture.place, p);
    }
    if (texture.place.shape == UnitShape::quad) {
        return tangents_of_face(texture.place, 1u, 1.0);
    }
    const std::uint32_t axis = axis_along(texture.place, own);
    return tangents_of_face(texture.place, axis, component_of(p, axis) < Real(0) ? -1.0 : 1.0);
}

// Normal turned by a normal map's texel, in a frame of the normal and the tangents made orthogonal to it. Where there
// is no frame, or the texel is (0, 0, 1), the normal is returned bit for bit.
template <class Real>
PT_HD inline Vec3<Real> turned_by_map(const Vec3<Real>& normal, const Tangents& tangents, const Vec3<Real>& texel) {
    const Vec3<double> n(normal);
    const Vec3<double> across = tangents.along_u - n * dot(n, tangents.along_u);
    const double square = dot(across, across);
    if ((texel.x == Real(0) && texel.y == Real(0)) || !(square > 0)) {
        return normal;
    }
    const Vec3<double> tangent = across * (1.0 / square_root(square));
    const Vec3<double> other = cross(n, tangent);
    const Vec3<double> bitangent = dot(other, tangents.along_v) < 0 ? -other : other;
    return Vec3<Real>(normalize(tangent * double(texel.x) + bitangent * double(texel.y) + n * double(texel.z)));
}

// Outward shading normal at a hit; `own`: the outward geometric normal, which is returned bit for bit where there is no
// other.
template <class Config, class Scene>
PT_HD inline Vec3<typename Config::Real> shading_normal_at(const Scene& scene, const Ray<typename Config::Real>& ray,
                                                           const Hit<typename Config::Real>& hit,
                                                           const Vec3<typename Config::Real>& position,
                                                           const Vec3<typename Config::Real>& own) {
    using Real = typename Config::Real;
    if (scene.mesh_search->normals.objects.size == 0) {
        return own;
    }
    const ObjectNormals<Real>& normals = scene.mesh_search->normals.objects[hit.side.object()];
    Vec3<Real> normal = own;
    if constexpr (has<Config>(Feature::mesh)) {
        if (normals.first_normal != ObjectNormals<Real>::none) {
            normal = normal_of_corners<Config>(scene, normals, ray, hit, own);
        }
    }
    if constexpr (has<Config>(Feature::textures)) {
        if (normals.map.width != 0) {
            const ObjectTexture<Real>& texture = scene.object_textures[hit.side.object()];
            Vec3<Real> texel =
                image_at(scene, normals.map, texture_coordinates_at<Config>(scene, texture, ray, hit, position, own));
            texel.x = texel.x * normals.map_scale;
            texel.y = texel.y * normals.map_scale;
            normal = turned_by_map(normal, tangents_at<Config>(scene, texture, ray, hit, position, own), texel);
        }
    }
    return normal;
}

// Gives the vertex its shading normal. Returns false if the ray comes from behind this normal, and is lost.
template <class Config>
PT_HD inline bool bend_normal(VertexOf<Config>& vertex, const SceneView<typename Config::Real>& scene,
                              const Ray<typename Config::Real>& ray, const Hit<typename Config::Real>& hit) {
    using Real = typename Config::Real;
    const Vec3<Real> facing = vertex.normal();
    const Vec3<Real> own = vertex.inside ? -facing : facing;
    const Vec3<Real> outward = shading_normal_at<Config>(scene, ray, hit, vertex.position, own);
    if (outward == own) {
        return true;
    }
    vertex.is_bent = true;
    vertex.unbent = facing;
    vertex.surface_normal = vertex.inside ? -outward : outward;
    vertex.hit = SurfaceId::of(vertex.object, vertex.inside);
    return dot(ray.direction, vertex.surface_normal) < Real(0);
}

}  // namespace pt
