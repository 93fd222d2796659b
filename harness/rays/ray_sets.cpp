#include "harness/rays/ray_sets.h"

#include <algorithm>
#include <cmath>

#include "harness/mesh/exact_math.h"

namespace pt::rays {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// Three random words from a ray's number, a depth and a seed (pcg3d; Jarzynski, Olano 2020).
struct RandomWords {
    std::uint32_t x, y, z;

    static RandomWords of(std::uint32_t ray, std::uint32_t depth, std::uint32_t seed) {
        RandomWords w{ray * 1664525u + 1013904223u, depth * 1664525u + 1013904223u, seed * 1664525u + 1013904223u};
        w.mix();
        w.x ^= w.x >> 16, w.y ^= w.y >> 16, w.z ^= w.z >> 16;
        w.mix();
        return w;
    }
    static float uniform(std::uint32_t word) { return static_cast<float>(word >> 8) * 0x1p-24f; }

private:
    void mix() { x += y * z, y += z * x, z += x * y; }
};

Vec3<float> vector(const float (&v)[3]) { return {v[0], v[1], v[2]}; }
Ray make_ray(const Vec3<float>& o, const Vec3<float>& d, float t_max) {
    return {{o.x, o.y, o.z}, t_max, {d.x, d.y, d.z}};
}
Vec3<float> unit(const Vec3<float>& v) { return v / std::sqrt(dot(v, v)); }

template <class Make>
std::vector<Ray> make_rays(std::size_t count, const Make& make) {
    std::vector<Ray> rays(count);
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < count; ++i) {
        rays[i] = make(static_cast<std::uint32_t>(i));
    }
    return rays;
}

struct Maker {
    const RayMesh& mesh;
    std::uint32_t log2_rays;
    float reach = half_extent();  // half the mesh's largest extent, by which lengths scale; 2 in the OptiX probe

    float half_extent() const {
        const Vec3<float> extent = mesh.high - mesh.low;
        return 0.5f * std::max({extent.x, extent.y, extent.z});
    }
    std::size_t count() const { return std::size_t{1} << log2_rays; }

    // Primary rays, one in each pixel of an image of 2^(log2_rays / 2) columns, like those of the OptiX probe.
    std::vector<Ray> primary() const {
        const std::uint32_t columns = 1u << (log2_rays / 2), rows = 1u << (log2_rays - log2_rays / 2);
        return make_rays(count(), [&](std::uint32_t i) {
            const RandomWords w = RandomWords::of(i, 0, 1);
            const float x = (static_cast<float>(i % columns) + RandomWords::uniform(w.x)) / static_cast<float>(columns);
            const float y = (static_cast<float>(i / columns) + RandomWords::uniform(w.y)) / static_cast<float>(rows);
            const RayCamera& camera = mesh.camera;
            return make_ray(camera.eye,
                            unit(camera.right * (2.0f * x - 1.0f) + camera.up * (2.0f * y - 1.0f) + camera.forward),
                            infinity);
        });
    }
    // Random rays: uniform origins within the bounds, uniform directions (Archimedes).
    std::vector<Ray> random() const {
        return make_rays(count(), [&](std::uint32_t i) {
            const RandomWords w = RandomWords::of(i, 0, 2), v = RandomWords::of(i, 1, 2);
            const float z = 2.0f * RandomWords::uniform(v.x) - 1.0f, r = std::sqrt(1.0f - z * z);
            const SineCosine angle = exact_sine_cosine(2.0 * exact_pi * static_cast<double>(RandomWords::uniform(v.y)));
            const Vec3<float> u{RandomWords::uniform(w.x), RandomWords::uniform(w.y), RandomWords::uniform(w.z)};
            return make_ray(mesh.low + (mesh.high - mesh.low) * u,
                            {r * static_cast<float>(angle.cosine), r * static_cast<float>(angle.sine), z}, infinity);
        });
    }

    struct SurfacePoint {
        Vec3<float> position, normal;  // a point slightly off a surface, and the normal on that side
    };
    // The point where a ray hit, slightly off the surface, and the normal there; for a ray that missed, its origin.
    SurfacePoint surface_point(const Ray& ray, const Hit& hit) const {
        const Vec3<float> origin = vector(ray.origin), direction = vector(ray.direction);
        if (hit.primitive == no_primitive) {
            return {origin, {0.0f, 0.0f, 1.0f}};
        }
        const Triangle<float>& t = mesh.triangles[hit.primitive];
        Vec3<float> n = unit(cross(t.b - t.a, t.c - t.a));
        if (!(dot(n, n) > 0.5f)) {  // a triangle too small to have a normal
            n = -unit(direction);
        }
        if (dot(n, direction) > 0.0f) {
            n = -n;
        }
        return {origin + direction * hit.t + n * (0.5e-4f * reach), n};
    }
    // Secondary rays of a Lambertian surface: cosine-distributed (Malley's method), in the frame of Duff et al. 2017.
    std::vector<Ray> diffuse(const std::vector<Ray>& from, const std::vector<Hit>& hits, std::uint32_t depth,
                             float t_max) const {
        return make_rays(from.size(), [&](std::uint32_t i) {
            const SurfacePoint point = surface_point(from[i], hits[i]);
            const RandomWords w = RandomWords::of(i, depth, 3);
            const float r2 = RandomWords::uniform(w.x), r = std::sqrt(r2), z = std::sqrt(1.0f - r2);
            const SineCosine angle = exact_sine_cosine(2.0 * exact_pi * static_cast<double>(RandomWords::uniform(w.y)));
            const float s = static_cast<float>(angle.sine), c = static_cast<float>(angle.cosine);
            const Vec3<float>& n = point.normal;
            const float sign = std::copysign(1.0f, n.z), a = -1.0f / (sign + n.z), b = n.x * n.y * a;
            const Vec3<float> tangent{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
            const Vec3<float> bitangent{b, sign + n.y * n.y * a, -n.y};
            return make_ray(point.position, tangent * (r * c) + bitangent * (r * s) + n * z, t_max);
        });
    }
    // Shadow rays to points (t = 1) of a square light below the top of the mesh's box, a quarter as wide as the box.
    std::vector<Ray> shadow(const std::vector<Ray>& from, const std::vector<Hit>& hits) const {
        const Vec3<float> centre = (mesh.low + mesh.high) * 0.5f, half = (mesh.high - mesh.low) * 0.5f;
        return make_rays(from.size(), [&](std::uint32_t i) {
            const SurfacePoint point = surface_point(from[i], hits[i]);
            const RandomWords w = RandomWords::of(i, 0, 4);
            const Vec3<float> on_light{0.5f * RandomWords::uniform(w.x) - 0.25f, 0.995f,
                                       0.5f * RandomWords::uniform(w.y) - 0.25f};
            return make_ray(point.position, centre + half * on_light - point.position, 0.9999f);
        });
    }
};

std::vector<Hit> closest(BatchTracer& tracer, const RaySet& set) {
    tracer.load(set);
    (void)tracer.trace(tracer.kernels(set).front());
    return tracer.hits();
}

}  // namespace

const std::vector<std::string>& ray_classes() {
    static const std::vector<std::string> names{"primary",   "ambient_occlusion", "shadow",
                                                "diffuse_1", "diffuse_3",         "random"};
    return names;
}

bool takes_any_hit(const std::string& ray_class) { return ray_class == "ambient_occlusion" || ray_class == "shadow"; }

std::vector<RaySet> make_ray_sets(const RayMesh& mesh, BatchTracer& tracer, const std::vector<std::string>& classes,
                                  std::uint32_t log2_rays) {
    const Maker maker{mesh, log2_rays};
    const auto wants = [&](const char* name) {
        return std::find(classes.begin(), classes.end(), name) != classes.end();
    };
    std::vector<RaySet> sets;
    const RaySet primary{"primary", false, maker.primary()};
    std::vector<Hit> hits;
    if (wants("ambient_occlusion") || wants("shadow") || wants("diffuse_1") || wants("diffuse_3")) {
        hits = closest(tracer, primary);
    }
    for (const std::string& name : classes) {
        RaySet set{name, takes_any_hit(name), {}};
        if (name == "primary") {
            set.rays = primary.rays;
        } else if (name == "random") {
            set.rays = maker.random();
        } else if (name == "ambient_occlusion") {
            set.rays = maker.diffuse(primary.rays, hits, 9, 0.2f * maker.reach);
        } else if (name == "shadow") {
            set.rays = maker.shadow(primary.rays, hits);
        } else if (name == "diffuse_1") {
            set.rays = maker.diffuse(primary.rays, hits, 1, infinity);
        } else {
            RaySet bounce{"", false, maker.diffuse(primary.rays, hits, 1, infinity)};
            for (const std::uint32_t depth : {2u, 3u}) {
                const std::vector<Hit> met = closest(tracer, bounce);
                bounce.rays = maker.diffuse(bounce.rays, met, depth, infinity);
            }
            set.rays = std::move(bounce.rays);
        }
        sets.push_back(std::move(set));
    }
    return sets;
}

}  // namespace pt::rays
