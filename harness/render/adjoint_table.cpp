#include "harness/render/adjoint_table.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "harness/render/process_clock.h"
#include "harness/render/renderer.h"
#include "kernels/shade.h"
#include "variants/cpu/parallel_for.h"

namespace pt {

namespace {

// The kernel configuration for learning paths: all features of scenes and estimators except the roulette itself.
using LearningConfig =
    Config<float, (all_features | traversals) & ~set_of(Feature::adjoint_roulette), RunTimeAccelerator>;

constexpr std::size_t paths_per_chunk = 128;
// Weight of the overall mean in each estimate of radiance, in records, since estimates from few records are noisy.
constexpr double records_of_the_mean = 32;
constexpr std::uint32_t most_tiles = 16;  // image tiles per side of the image; each tile has an estimate of radiance
constexpr std::uint32_t most_steps = 64;  // path segments with an estimate each; later segments share the last one
// The share of recorded path vertices that may lie outside the grid of estimates, on either side of each axis.
constexpr double left_out = 0.005;
constexpr double least_estimate = 0x1p-20, most_estimate = 0x1p20;

float sum_of(const Vec3<float>& colour) { return sum_of_channels(colour); }

// Records each vertex of a learning path. Until the path ends, `brought` is minus the radiance gathered before it.
struct Notes {
    template <class Config>
    static constexpr bool acts_in = true;
    std::vector<AdjointRecord>& records;

    static constexpr bool resumes() { return false; }
    template <class Config>
    bool goes_on(const SceneView<float>&, Path<float>& path, const Vertex<float>& vertex, const Hit<float>&,
                 float) const {
        records.push_back({vertex.position, nearest_side(vertex.normal()), path.segment, sum_of(path.throughput),
                           -sum_of(path.radiance)});
        return true;
    }
};

// Traces one learning path and puts a record of each of its vertices into `records`.
void note_path(const SceneView<float>& scene, std::uint32_t pixel, std::uint32_t sample,
               std::vector<AdjointRecord>& records) {
    records.clear();
    PathCounters counters;
    Path<float> path = generate<LearningConfig>(scene, pixel, sample);
    bool alive = true;
    while (alive) {
        Walk walk;
        const Hit<float> hit = intersect<LearningConfig>(scene, path);
        alive = shade<LearningConfig>(scene, scene, path, hit, counters, walk, Notes{records});
        while (alive && walk.is_on()) {
            alive = walk_on<LearningConfig>(scene, path, walk, counters);
        }
    }
    const float radiance = sum_of(path.radiance);
    for (AdjointRecord& record : records) {
        record.brought += radiance;
    }
    std::erase_if(records, [&](const AdjointRecord& record) {
        return !std::isfinite(record.brought) || !(record.carried > 0) || !std::isfinite(record.carried);
    });
}

// The pixel of a learning path: one random pixel in each of the equal parts into which the paths divide the image.
std::uint32_t pixel_of(std::uint64_t path, const RenderSettings& settings, const RandomSeed& seed) {
    const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
    const auto hash = pcg4d_words(seed.words, {static_cast<std::uint32_t>(path), 0, 0, 0xadd017u}).x;
    return static_cast<std::uint32_t>((path * pixels + ((hash * pixels) >> 32)) / settings.adjoint.paths);
}

// An estimate of radiance as a ratio: radiance gathered over throughput, into which a prior is mixed with a weight.
class Estimate {
public:
    void add(double brought, double carried) {
        brought_ += brought;
        carried_ += carried;
    }
    double value(double prior, double prior_weight) const {
        return (brought_ + prior * prior_weight) / (carried_ + prior_weight);
    }

private:
    double brought_ = 0, carried_ = 0;
};

float bounded(double estimate) { return static_cast<float>(std::clamp(estimate, least_estimate, most_estimate)); }

// Fits the grid of radiance estimates around the path vertices: sets its low corner and its cells per scene unit.
template <class Real>
void set_grid(AdjointCache<Real>& cache, const std::vector<AdjointRecord>& vertices) {
    const std::size_t stride = vertices.size() / 4096 + 1;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float> places;
        for (std::size_t i = 0; i < vertices.size(); i += stride) {
            places.push_back(vertices[i].position[axis]);
        }
        std::sort(places.begin(), places.end());
        const auto beyond = static_cast<std::size_t>(left_out * static_cast<double>(places.size()));
        const float low = places[beyond];
        const double extent = static_cast<double>(places[places.size() - 1 - beyond]) - low;
        cache.low[axis] = low;
        cache.cells_a_unit[axis] = extent > 0 ? static_cast<Real>(static_cast<float>(cache.cells / extent)) : Real(0);
    }
}

template <class Real>
std::uint32_t place_of(const AdjointCache<Real>& cache, const AdjointRecord& vertex) {
    Vec3<Real> normal(0);
    normal[static_cast<int>(vertex.side / 2)] = vertex.side % 2 != 0 ? Real(-1) : Real(1);
    return adjoint_place(cache, Vec3<Real>(vertex.position), normal);
}

// A factor for each pixel: the image's mean radiance over that of the image tile that contains the pixel.
std::vector<float> by_pixel(const std::vector<AdjointStart>& starts, const RenderSettings& settings, double mean) {
    const std::uint32_t columns = std::min(most_tiles, settings.width), rows = std::min(most_tiles, settings.height);
    const auto tile_of = [&](std::uint32_t x, std::uint32_t y) {
        return static_cast<std::size_t>(std::uint64_t{y} * rows / settings.height * columns +
                                        std::uint64_t{x} * columns / settings.width);
    };
    std::vector<Estimate> tiles(std::size_t{columns} * rows);
    for (const AdjointStart& start : starts) {
        tiles[tile_of(start.pixel % settings.width, start.pixel / settings.width)].add(start.brought, 1);
    }
    std::vector<float> of_tile;
    for (const Estimate& tile : tiles) {
        of_tile.push_back(bounded(mean / tile.value(mean, records_of_the_mean)));
    }
    std::vector<std::size_t> column;
    for (std::uint32_t x = 0; x < settings.width; ++x) {
        column.push_back(tile_of(x, 0));
    }
    std::vector<float> inverse;
    inverse.reserve(std::size_t{settings.width} * settings.height);
    for (std::uint32_t y = 0; y < settings.height; ++y) {
        const std::size_t first = tile_of(0, y);
        for (const std::size_t tile : column) {
            inverse.push_back(of_tile[first + tile]);
        }
    }
    return inverse;
}

template <class Real>
void fill_places(AdjointTable<Real>& table, const std::vector<AdjointRecord>& vertices, double mean) {
    Estimate all;
    std::vector<Estimate> places(std::size_t{6} * table.cache.cells * table.cache.cells * table.cache.cells);
    for (const AdjointRecord& vertex : vertices) {
        all.add(vertex.brought, vertex.carried);
        places[place_of(table.cache, vertex)].add(vertex.brought, vertex.carried);
    }
    const double average = all.value(0, 0);
    double carried = 0;
    for (const AdjointRecord& vertex : vertices) {
        carried += vertex.carried;
    }
    const double weight = records_of_the_mean * carried / static_cast<double>(vertices.size());
    for (const Estimate& place : places) {
        table.by_place.push_back(bounded(place.value(average, weight) / mean));
    }
    const std::uint32_t steps = std::ranges::max(vertices, {}, &AdjointRecord::segment).segment;
    std::vector<Estimate> after(std::min(steps, most_steps));
    for (const AdjointRecord& vertex : vertices) {
        const double expected = vertex.carried * table.by_place[place_of(table.cache, vertex)] * mean;
        after[std::min(vertex.segment, most_steps) - 1].add(vertex.brought, expected);
    }
    for (const Estimate& step : after) {
        table.by_segment.push_back(bounded(step.value(1, weight * average)));
    }
}

template <class T>
View<T> view_of(const std::vector<T>& values) {
    return {values.data(), static_cast<std::uint32_t>(values.size())};
}

}  // namespace

AdjointRecords learn_adjoint(const Scene& scene, const RenderSettings& settings) {
    RenderSettings plain = settings;
    plain.roulette_start = 0;
    plain.sampler = no_features;
    SceneBuffers<float> buffers(scene, plain, quick_acceleration(scene));
    SceneView<float> view = buffers.view();
    view.seed.words = pcg4d({view.seed.words.x, view.seed.words.y, view.seed.words.z, ~view.seed.words.w});
    const std::uint32_t count = settings.adjoint.paths;
    std::vector<AdjointRecords> chunks((count + paths_per_chunk - 1) / paths_per_chunk);
    parallel_for(count, paths_per_chunk, [&](std::size_t begin, std::size_t end) {
        std::vector<AdjointRecord> path;
        AdjointRecords& chunk = chunks[begin / paths_per_chunk];
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t pixel = pixel_of(i, settings, view.seed);
            note_path(view, pixel, static_cast<std::uint32_t>(i), path);
            chunk.vertices.insert(chunk.vertices.end(), path.begin(), path.end());
            if (!path.empty() && path.front().segment == 1) {
                chunk.starts.push_back({pixel, path.front().brought});
            }
        }
    });
    AdjointRecords all;
    for (const AdjointRecords& chunk : chunks) {
        all.vertices.insert(all.vertices.end(), chunk.vertices.begin(), chunk.vertices.end());
        all.starts.insert(all.starts.end(), chunk.starts.begin(), chunk.starts.end());
    }
    return all;
}

template <class Real>
std::unique_ptr<const AdjointTable<Real>> adjoint_table(const AdjointRecords& records, const RenderSettings& settings) {
    Estimate all;
    for (const AdjointStart& start : records.starts) {
        all.add(start.brought, 1);
    }
    const double mean = all.value(0, 0);
    if (!(mean > 0)) {  // no learning path gathered radiance, or none has a first vertex
        return nullptr;
    }
    auto table = std::make_unique<AdjointTable<Real>>();
    AdjointCache<Real>& cache = table->cache;
    cache.cells = settings.adjoint.cells;
    // The bounds of the roulette's weight window have the ratio `window` and the arithmetic mean 1.
    cache.lowest = Real(2) / Real(1 + settings.adjoint.window);
    cache.highest = cache.lowest * Real(settings.adjoint.window);
    cache.most_branches = settings.adjoint.branches;
    set_grid(cache, records.vertices);
    fill_places(*table, records.vertices, mean);
    table->by_pixel = by_pixel(records.starts, settings, mean);
    cache.by_place = view_of(table->by_place);
    cache.by_segment = view_of(table->by_segment);
    cache.by_pixel = view_of(table->by_pixel);
    return table;
}

template <class Real>
LearnedAdjoint<Real> learned_adjoint(const Scene& scene, const RenderSettings& settings) {
    LearnedAdjoint<Real> learned;
    if (settings.adjoint.paths == 0) {
        return learned;
    }
    const SceneBuffers<float> trees(scene, settings, quick_acceleration(scene));  // builds the scene's trees, untimed
    const double cpu_start = process_cpu_ms();
    const auto start = std::chrono::steady_clock::now();
    learned.table = adjoint_table<Real>(learn_adjoint(scene, settings), settings);
    learned.wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    learned.cpu_ms = process_cpu_ms() - cpu_start;
    return learned;
}

template std::unique_ptr<const AdjointTable<float>> adjoint_table(const AdjointRecords&, const RenderSettings&);
template std::unique_ptr<const AdjointTable<double>> adjoint_table(const AdjointRecords&, const RenderSettings&);
template LearnedAdjoint<float> learned_adjoint(const Scene&, const RenderSettings&);
template LearnedAdjoint<double> learned_adjoint(const Scene&, const RenderSettings&);

}  // namespace pt
