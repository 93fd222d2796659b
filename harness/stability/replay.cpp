#include "harness/stability/replay.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kernels/shade.h"
#include "variants/cpu/parallel_for.h"

namespace pt::stability {

namespace {

constexpr FeatureSet plain = all_features | samplers;

template <class Real>
std::string name_of(const Scene& scene, const SceneBuffers<Real>& buffers, SurfaceId side) {
    if (!side.exists()) {
        return "nothing";
    }
#define PT_NAME(name, array, Type) #name,
    static constexpr const char* kinds[] = {PT_SHAPES(PT_NAME)};
#undef PT_NAME
    const std::uint32_t index = buffers.file_index()[side.object()];
    const SceneObject& object = scene.objects[index];
    std::string kind = kinds[static_cast<int>(classify(object))];
    std::replace(kind.begin(), kind.end(), '_', ' ');
    return fmt::format("{} {} ({}), {}", kind, index, scene.materials[object.material].name,
                       side.inside() ? "inside" : "outside");
}

template <class Config>
std::vector<Step> replay(const Scene& scene, const RenderSettings& settings, std::uint32_t pixel,
                         std::uint32_t sample) {
    using Real = typename Config::Real;
    const SceneBuffers<Real> buffers(scene, settings);
    const SceneView<Real>& view = buffers.view();
    PathCounters counters;
    Path<Real> path = generate<Config>(view, pixel, sample);
    std::vector<Step> steps;
    for (bool alive = true; alive;) {
        Step step;
        const Ray<Real> ray = ray_of(path);
        const Hit<Real> hit = closest_hit<Config>(view, ray);
        step.object = name_of(scene, buffers, hit.side);
        step.object_code = hit.side.exists() ? 2 * hit.side.object() + (hit.side.inside() ? 1 : 0) : SurfaceId::nowhere;
        step.t = hit.t;
        if (hit.side.exists()) {
            const SurfacePoint<Real> point = surface_at<Config>(view, ray, hit);
            step.position = Vec3d(point.position) + scene.camera.eye;
            step.normal = Vec3d(point.normal);
        }
        alive = shade<Config>(view, view, path, hit, counters);
        step.segment = path.segment;
        step.direction = Vec3d(path.direction);
        step.throughput = Vec3d(path.throughput);
        step.radiance = Vec3d(path.radiance);
        step.is_alive = alive;
        steps.push_back(step);
    }
    return steps;
}

// Traces a path, records in `met` a code of the object hit by each segment, and returns the path's radiance.
template <class Config>
Vec3<typename Config::Real> walk(const SceneView<typename Config::Real>& view, std::uint32_t pixel,
                                 std::uint32_t sample, std::vector<std::uint32_t>& met) {
    PathCounters counters;
    auto path = generate<Config>(view, pixel, sample);
    met.clear();
    for (bool alive = true; alive;) {
        const auto hit = closest_hit<Config>(view, ray_of(path));
        met.push_back(hit.side.exists() ? 2 * hit.side.object() + (hit.side.inside() ? 1 : 0) : SurfaceId::nowhere);
        alive = shade<Config>(view, view, path, hit, counters);
    }
    return path.radiance;
}

template <class Single, class Fp64>
Divergence diverge(const Scene& scene, const RenderSettings& settings, std::uint32_t samples) {
    const SceneBuffers<float> single(scene, settings);
    const SceneBuffers<double> fp64(scene, settings);
    struct OfPixel {
        double sum = 0, squares = 0;
        std::vector<std::uint64_t> parted_at;
    };
    std::vector<OfPixel> of_pixel(std::size_t{settings.width} * settings.height);
    parallel_for(of_pixel.size(), 16, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> a;
        std::vector<std::uint32_t> b;
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
            for (std::uint32_t sample = 0; sample < samples; ++sample) {
                const Vec3d in_single(walk<Single>(single.view(), static_cast<std::uint32_t>(pixel), sample, a));
                const Vec3d in_double(walk<Fp64>(fp64.view(), static_cast<std::uint32_t>(pixel), sample, b));
                const Vec3d off = in_single - in_double;
                const double difference = (off.x + off.y + off.z) / 3;
                const auto parting = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
                OfPixel& mine = of_pixel[pixel];
                mine.sum += difference;
                mine.squares += difference * difference;
                if (parting.first != a.end() || parting.second != b.end()) {
                    const auto segment = static_cast<std::size_t>(parting.first - a.begin());
                    mine.parted_at.resize(std::max(mine.parted_at.size(), segment + 1));
                    mine.parted_at[segment] += 1;
                }
            }
        }
    });
    Divergence total;
    total.paths = std::uint64_t{samples} * of_pixel.size();
    double sum = 0;
    double squares = 0;
    for (const OfPixel& pixel : of_pixel) {  // sums do not depend on threads: pixels are added in order
        sum += pixel.sum;
        squares += pixel.squares;
        total.parted_at.resize(std::max(total.parted_at.size(), pixel.parted_at.size()));
        for (std::size_t segment = 0; segment < pixel.parted_at.size(); ++segment) {
            total.parted_at[segment] += pixel.parted_at[segment];
        }
    }
    const auto n = static_cast<double>(total.paths);
    total.difference = sum / n;
    total.standard_error = n > 1 ? std::sqrt(std::max(0.0, squares / n - total.difference * total.difference) / n) : 0;
    return total;
}

}  // namespace

std::vector<Step> replay_single(const Scene& scene, const RenderSettings& settings, FeatureSet formula,
                                std::uint32_t pixel, std::uint32_t sample) {
    if (contains(formula, Feature::naive)) {
        return replay<Config<float, plain | Feature::naive>>(scene, settings, pixel, sample);
    }
    if (contains(formula, Feature::double_intersection)) {
        return replay<Config<float, plain | Feature::double_intersection>>(scene, settings, pixel, sample);
    }
    return replay<Config<float, plain>>(scene, settings, pixel, sample);
}

std::vector<Step> replay_double(const Scene& scene, const RenderSettings& settings, FeatureSet formula,
                                std::uint32_t pixel, std::uint32_t sample) {
    return contains(formula, Feature::naive)
               ? replay<Config<double, plain | Feature::naive>>(scene, settings, pixel, sample)
               : replay<Config<double, plain>>(scene, settings, pixel, sample);
}

std::optional<std::uint32_t> first_parting(const std::vector<Step>& a, const std::vector<Step>& b) {
    for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
        if (i >= a.size() || i >= b.size() || a[i].object_code != b[i].object_code) {
            return static_cast<std::uint32_t>(i + 1);
        }
    }
    return std::nullopt;
}

std::uint64_t Divergence::parted() const {
    std::uint64_t count = 0;
    for (const std::uint64_t paths_here : parted_at) {
        count += paths_here;
    }
    return count;
}

Divergence divergence(const Scene& scene, const RenderSettings& settings, FeatureSet formula, std::uint32_t samples) {
    return contains(formula, Feature::naive)
               ? diverge<Config<float, plain | Feature::naive>, Config<double, plain | Feature::naive>>(scene, settings,
                                                                                                        samples)
           : contains(formula, Feature::double_intersection)
               ? diverge<Config<float, plain | Feature::double_intersection>, Config<double, plain>>(scene, settings,
                                                                                                     samples)
               : diverge<Config<float, plain>, Config<double, plain>>(scene, settings, samples);
}

}  // namespace pt::stability
