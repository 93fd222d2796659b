// Rays of the OptiX probe and a few kinds more, made on the device: from the camera, or from the hits of other rays.
// And brute force, which says what their hits must be.
#pragma once

#include "harness/rays/ray_batch.h"

namespace pt::rays {

// pcg3d (Jarzynski, Olano 2020): three words of a ray, a depth and a seed.
struct RandomWords {
    std::uint32_t x, y, z;

    __device__ static RandomWords of(std::uint32_t ray, std::uint32_t depth, std::uint32_t seed) {
        RandomWords w{ray * 1664525u + 1013904223u, depth * 1664525u + 1013904223u, seed * 1664525u + 1013904223u};
        for (int round = 0; round < 2; ++round) {
            w.x += w.y * w.z, w.y += w.z * w.x, w.z += w.x * w.y;
            if (round == 0) {
                w.x ^= w.x >> 16, w.y ^= w.y >> 16, w.z ^= w.z >> 16;
            }
        }
        return w;
    }
    __device__ static float uniform(std::uint32_t word) { return static_cast<float>(word >> 8) * 0x1p-24f; }
};

__device__ inline Ray make_ray(const Vec3<float>& o, const Vec3<float>& d, float t_max) {
    return {{o.x, o.y, o.z}, t_max, {d.x, d.y, d.z}};
}

// One ray in each pixel of an image of 2^(log2_rays / 2) columns, as the probe has them.
__global__ void primary_rays(Ray* rays, std::uint32_t log2_rays) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x, columns = 1u << (log2_rays / 2);
    const std::uint32_t rows = (1u << log2_rays) / columns;
    const RandomWords w = RandomWords::of(index, 0, 1);
    const float x = (static_cast<float>(index % columns) + RandomWords::uniform(w.x)) / columns * 2.0f - 1.0f;
    const float y = (static_cast<float>(index / columns) + RandomWords::uniform(w.y)) / rows * 2.0f - 1.0f;
    const Vec3<float> d{x * 0.8f, y * 0.8f, -1.0f};
    const float length = sqrtf(d.x * d.x + d.y * d.y + d.z * d.z);
    rays[index] = make_ray({0.0f, 0.0f, 1.99f}, d / length, INFINITY);
}

// Uniform origins in the box, uniform directions.
__global__ void random_rays(Ray* rays) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    const RandomWords w = RandomWords::of(index, 0, 2), v = RandomWords::of(index, 1, 2);
    const float z = 2.0f * RandomWords::uniform(v.x) - 1.0f, r = sqrtf(1.0f - z * z);
    float s, c;
    sincospif(2.0f * RandomWords::uniform(v.y), &s, &c);
    rays[index] = make_ray({4.0f * RandomWords::uniform(w.x) - 2.0f, 4.0f * RandomWords::uniform(w.y) - 2.0f,
                            4.0f * RandomWords::uniform(w.z) - 2.0f},
                           {r * c, r * s, z}, INFINITY);
}

struct SurfacePoint {
    Vec3<float> position, normal;  // 1e-4 off the surface, on the ray's side
};

__device__ inline Vec3<float> cross_of(const Vec3<float>& a, const Vec3<float>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

__device__ inline SurfacePoint surface_point(const Ray& ray, const Hit& hit, const Triangle<float>* triangles) {
    const Vec3<float> o{ray.origin[0], ray.origin[1], ray.origin[2]};
    const Vec3<float> d{ray.direction[0], ray.direction[1], ray.direction[2]};
    if (hit.primitive == no_primitive) {
        return {o, {0.0f, 0.0f, 1.0f}};
    }
    const Triangle<float>& t = triangles[hit.primitive];
    Vec3<float> n = cross_of(t.b - t.a, t.c - t.a);
    n = n / sqrtf(n.x * n.x + n.y * n.y + n.z * n.z);
    if (n.x * d.x + n.y * d.y + n.z * d.z > 0.0f) {
        n = -n;
    }
    return {o + d * hit.t + n * 1e-4f, n};
}

// Directions by the cosine (Malley's method), in the frame of Duff et al. 2017.
__global__ void diffuse_rays(const Ray* from, const Hit* hits, const Triangle<float>* triangles, std::uint32_t depth,
                             float t_max, Ray* rays) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    const SurfacePoint point = surface_point(from[index], hits[index], triangles);
    const RandomWords w = RandomWords::of(index, depth, 3);
    const float r2 = RandomWords::uniform(w.x), r = sqrtf(r2), z = sqrtf(1.0f - r2);
    float s, c;
    sincospif(2.0f * RandomWords::uniform(w.y), &s, &c);
    const Vec3<float>& n = point.normal;
    const float sign = copysignf(1.0f, n.z), a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    const Vec3<float> tangent{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    const Vec3<float> bitangent{b, sign + n.y * n.y * a, -n.y};
    rays[index] = make_ray(point.position, tangent * (r * c) + bitangent * (r * s) + n * z, t_max);
}

// Towards points of a square light under the ceiling; t = 1 at the light.
__global__ void shadow_rays(const Ray* from, const Hit* hits, const Triangle<float>* triangles, Ray* rays) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    const SurfacePoint point = surface_point(from[index], hits[index], triangles);
    const RandomWords w = RandomWords::of(index, 0, 4);
    const Vec3<float> light{RandomWords::uniform(w.x) - 0.5f, 1.99f, RandomWords::uniform(w.y) - 0.5f};
    rays[index] = make_ray(point.position, light - point.position, 0.9999f);
}

// keys[ray]: t's bits, then the primitive, at least; start with those of {t_max, no_primitive}. A block takes 128 rays
// and every gridDim.y-th of the triangles.
__global__ void brute_force(const Ray* rays, const Triangle<float>* triangles, std::uint32_t triangle_count,
                            unsigned long long* keys) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    const Ray ray = rays[index];
    const Vec3<float> origin{ray.origin[0], ray.origin[1], ray.origin[2]};
    const auto shear = ShearedDirection<float>::of({ray.direction[0], ray.direction[1], ray.direction[2]});
    Hit best{ray.t_max, no_primitive};
    for (std::uint32_t i = blockIdx.y; i < triangle_count; i += gridDim.y) {
        keep_nearer(intersect(triangles[i], origin, shear), i, best);
    }
    atomicMin(keys + index, static_cast<unsigned long long>(__float_as_uint(best.t)) << 32 | best.primitive);
}

// Order-independent: a sum over rays of a hash of (ray, t, primitive).
__global__ void checksum(const Hit* hits, unsigned long long* sum) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    unsigned long long z =
        (static_cast<unsigned long long>(__float_as_uint(hits[index].t)) << 32 | hits[index].primitive) +
        0x9e3779b97f4a7c15ull * (index + 1ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    atomicAdd(sum, z ^ (z >> 31));
}

}  // namespace pt::rays
