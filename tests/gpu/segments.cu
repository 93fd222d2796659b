#include "tests/gpu/segments.h"

#include <vector>

#include "kernels/intersect.h"
#include "kernels/rng.h"
#include "kernels/sampling.h"
#include "variants/cuda/runtime/check.h"

namespace pt::test {
namespace {

constexpr std::uint32_t threads = 256, blocks = 1024;

using Kernel =
    Config<float, Feature::sphere | Feature::ellipsoid | Feature::axis_box | Feature::oriented_box | Feature::quad>;

// Numbers of one ray, in turn.
struct RayNumbers {
    std::uint32_t thread, round, purpose, block = 0;

    __device__ RandomWords next() { return pcg4d({thread, round, purpose, block++}); }
};

__device__ Vec3<float> direction_from(const RandomWords& words) {
    return uniform_sphere(unit_interval<float>(words.x), unit_interval<float>(words.y));
}

__device__ Vec3<float> in_cube(const RandomWords& words, float half) {
    return {half * (2 * unit_interval<float>(words.x) - 1), half * (2 * unit_interval<float>(words.y) - 1),
            half * (2 * unit_interval<float>(words.z) - 1)};
}

__device__ void add(unsigned long long& total, std::uint32_t count) {
    if (count > 0) {
        atomicAdd(&total, static_cast<unsigned long long>(count));
    }
}

__global__ void start_rays(SceneView<float> scene, Vec3<float> centre, float radius, std::uint32_t rounds,
                           StartedSegments* total) {
    const std::uint32_t thread = blockIdx.x * blockDim.x + threadIdx.x;
    std::uint32_t outward = 0, self_hits = 0, inward = 0, leaks = 0;
    for (std::uint32_t round = 0; round < rounds; ++round) {
        RayNumbers numbers{thread, round, 15u};
        const Vec3<float> eye = centre + direction_from(numbers.next()) * (4 * radius);
        const Vec3<float> target = centre + in_cube(numbers.next(), 0.3f * radius);
        const Ray<float> ray{eye, normalize(target - eye), 0.0f, {}};
        const Hit<float> hit = closest_hit<Kernel>(scene, ray);
        if (!hit.side.exists()) {
            continue;
        }
        const SurfacePoint<float> point = surface_at<Kernel>(scene, ray, hit);
        const Vec3<float> direction = direction_from(numbers.next());
        const bool has_inside = scene.quads.size == 0;
        const bool runs_inside = has_inside && dot(point.normal, direction) < 0;
        const SurfaceId origin_surface = SurfaceId::of(0, runs_inside);
        const bool hits = closest_hit<Kernel>(scene, {point.position, direction, 0.0f, origin_surface}).side.exists();
        outward += runs_inside ? 0 : 1;
        self_hits += !runs_inside && hits ? 1 : 0;
        inward += runs_inside ? 1 : 0;
        leaks += runs_inside && !hits ? 1 : 0;
    }
    add(total->outward, outward);
    add(total->self_hits, self_hits);
    add(total->inward, inward);
    add(total->leaks, leaks);
}

__device__ float on_grid(std::uint32_t word, float half, float steps) {
    return rintf(half * (2 * unit_interval<float>(word) - 1) * steps) / steps;
}

__device__ float& coordinate(Vec3<float>& v, std::uint32_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// A ray to a point of an edge. All its numbers are multiples of 2^-11 below 16, so that its line passes through the
// point exactly.
__device__ Ray<float> ray_through_edge(RayNumbers& numbers, Vec3<float> half, bool in_plane) {
    const RandomWords choice = numbers.next();
    const RandomWords place = numbers.next();
    const std::uint32_t axis = choice.x % 3;
    Vec3<float> target(0.0f);
    for (std::uint32_t k = 0; k < 3; ++k) {
        const float extent = coordinate(half, k);
        coordinate(target, k) = k == axis ? rintf(on_grid(place.x, 1.0f, 8192.0f) * extent * 64) / 64
                                          : ((choice.y >> k & 1u) != 0 ? extent : -extent);
    }
    Vec3<float> origin(on_grid(place.y, 8.0f, 8.0f), on_grid(place.z, 8.0f, 8.0f), on_grid(place.w, 8.0f, 8.0f));
    const std::uint32_t outside = (axis + 1 + (choice.z & 1u)) % 3;
    float& across = coordinate(origin, outside);
    across = ((choice.w & 1u) != 0 ? 1.0f : -1.0f) * (9.0f + across / 16);
    if (in_plane) {
        const std::uint32_t plane = 3 - axis - outside;
        coordinate(origin, plane) = coordinate(target, plane);
    }
    return {origin, (target - origin) * (1.0f / 32), 0.0f, {}};
}

__global__ void count_misses(SceneView<float> scene, OrientedBox<float> oriented, std::uint32_t rounds,
                             EdgeMisses* total) {
    const std::uint32_t thread = blockIdx.x * blockDim.x + threadIdx.x;
    const Vec3<float> half = oriented.half;
    std::uint32_t axis_box = 0, oriented_box = 0;
    for (std::uint32_t round = 0; round < rounds; ++round) {
        RayNumbers numbers{thread, round, 21u};
        const Ray<float> ray = ray_through_edge(numbers, half, round % 4 == 0);
        axis_box += closest_hit<Kernel>(scene, ray).side.exists() ? 0 : 1;
        oriented_box += interval(oriented, ray.origin, ray.direction).hits ? 0 : 1;
    }
    add(total->rays, rounds);
    add(total->axis_box, axis_box);
    add(total->oriented_box, oriented_box);
}

template <class T>
class OnDevice {
public:
    explicit OnDevice(View<T> host) : size_(host.size) {
        if (size_ > 0) {
            PT_CUDA_CHECK(cudaMalloc(&data_, size_ * sizeof(T)));
            PT_CUDA_CHECK(cudaMemcpy(data_, host.data, size_ * sizeof(T), cudaMemcpyHostToDevice));
        }
    }
    ~OnDevice() { cudaFree(data_); }
    OnDevice(const OnDevice&) = delete;
    OnDevice& operator=(const OnDevice&) = delete;

    View<T> view() const { return {data_, size_}; }
    T* data() const { return data_; }
    T copy() const {
        T value;
        PT_CUDA_CHECK(cudaMemcpy(&value, data_, sizeof(T), cudaMemcpyDeviceToHost));
        return value;
    }

private:
    T* data_ = nullptr;
    std::uint32_t size_;
};

}  // namespace

StartedSegments start_segments(const SceneView<float>& scene, const Vec3<float>& centre, float radius,
                               std::uint32_t rounds) {
    const OnDevice<Sphere<float>> spheres(scene.spheres);
    const OnDevice<Ellipsoid<float>> ellipsoids(scene.ellipsoids);
    const OnDevice<AxisBox<float>> axis_boxes(scene.axis_boxes);
    const OnDevice<OrientedBox<float>> oriented_boxes(scene.oriented_boxes);
    const OnDevice<Quad<float>> quads(scene.quads);
    SceneView<float> bodies{};
    bodies.spheres = spheres.view();
    bodies.ellipsoids = ellipsoids.view();
    bodies.axis_boxes = axis_boxes.view();
    bodies.oriented_boxes = oriented_boxes.view();
    bodies.quads = quads.view();
    const StartedSegments none;
    const OnDevice<StartedSegments> total({&none, 1});
    start_rays<<<blocks, threads>>>(bodies, centre, radius, rounds, total.data());
    PT_CUDA_CHECK(cudaGetLastError());
    return total.copy();
}

EdgeMisses cross_edges(const Vec3<float>& half, std::uint32_t rounds) {
    const AxisBox<float> box{-half, half};
    const OnDevice<AxisBox<float>> boxes({&box, 1});
    SceneView<float> scene{};
    scene.axis_boxes = boxes.view();
    const OrientedBox<float> oriented{
        Vec3<float>(0.0f), {Vec3<float>(1, 0, 0), Vec3<float>(0, 1, 0), Vec3<float>(0, 0, 1)}, half};
    const EdgeMisses none;
    const OnDevice<EdgeMisses> total({&none, 1});
    count_misses<<<blocks, threads>>>(scene, oriented, rounds, total.data());
    PT_CUDA_CHECK(cudaGetLastError());
    return total.copy();
}

}  // namespace pt::test
