// The queues of integrator=wavefront_materials on threads of the host (tests/support/block_on_threads.h), and what
// their kernels leave in them. A test includes it after it has said what NVRTC's text would, and the kernels.
#pragma once

#include <algorithm>
#include <functional>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "harness/scene/places.h"
#include "harness/scene/scene_buffers.h"
#include "tests/support/one_by_one.h"

namespace pt::test {
namespace {

constexpr std::uint32_t total = samples * width * height;
constexpr std::uint32_t first_sample = 2;
constexpr std::uint32_t queues = cuda::queues_of_all_kinds;
constexpr std::uint32_t blocks = (total + kernel_config.block - 1) / kernel_config.block + queues;
constexpr std::uint32_t chunks = (total + cuda::slots_per_chunk - 1) / cuda::slots_per_chunk + queues;
constexpr std::uint32_t slots = chunks * cuda::slots_per_chunk;
constexpr std::uint32_t words_of_counts = (queues + 1) * cuda::counter_stride;

// One of the two sides that paths go to and fro between, as the host's side reserves it.
struct Side {
    std::vector<layout::aos::Record<float>> records = std::vector<layout::aos::Record<float>>(slots);
    std::vector<StoredHit<float>> hits = std::vector<StoredHit<float>>(slots);
};

class MaterialQueueing {
public:
    MaterialQueueing(const SceneView<float>& view, Film film)
        : view_(view), film_(std::move(film)), live_(view.longest_path()), in_play_(view.longest_path()) {
        const FilmView sums = film_.view();
        run((total + kernel_config.block - 1) / kernel_config.block, [&] {
            ::trace_first(view_, sums, at(0), total, first_sample, nullptr, ::HitCache{}, totals_.data(), segments(),
                          list());
        });
        go_through_meshes(0);
    }

    void bounce(std::uint32_t segment) {
        expect_each_path_once(segment);
        const FilmView sums = film_.view();
        run(blocks, [&] {
            ::shade_and_trace(view_, sums, at(segment), at(segment + 1), words_[(segment + 2) % 3].data(),
                              static_cast<std::uint32_t>(words_[0].size()), segment, totals_.data(), segments(),
                              list());
        });
        const std::vector<std::uint32_t>& cleared = words_[(segment + 2) % 3];
        EXPECT_EQ(std::count(cleared.begin(), cleared.end(), 0u), static_cast<std::ptrdiff_t>(cleared.size()));
        go_through_meshes(segment + 1);
    }

    const Film& film() const { return film_; }
    std::uint64_t through_meshes() const { return through_meshes_; }
    std::uint64_t rays() const { return std::accumulate(live_.begin(), live_.end(), std::uint64_t{0}); }
    std::uint64_t counted(std::uint64_t PathCounters::*counter) const {
        std::uint64_t sum = 0;
        for (const cuda::Totals& copy : totals_) {
            sum += copy.paths.*counter;
        }
        return sum;
    }
    const std::vector<std::uint64_t>& live() const { return live_; }
    const std::vector<std::uint64_t>& in_play() const { return in_play_; }
    std::uint64_t mixed() const { return mixed_; }
    std::uint64_t ended() const { return ended_; }
    std::uint32_t chunks_used() const { return chunks_used_; }

private:
    template <class Kernel>
    void run(std::uint32_t count, const Kernel& kernel) {
        run_blocks(count, kernel_config.block, kernel);
    }
    cuda::MaterialQueues<float> at(std::uint32_t segment) {
        Side& side = sides_[segment % 2];
        std::uint32_t* const counts = words_[segment % 3].data();
        return {{reinterpret_cast<unsigned char*>(side.records.data()), slots},
                side.hits.data(),
                counts,
                counts + words_of_counts,
                chunks};
    }
    cuda::MeshQueue list() { return {waiting_.data(), &list_counts_}; }
    cuda::SegmentCounts segments() { return {live_.data(), in_play_.data(), 1}; }

    void go_through_meshes(std::uint32_t segment) {
        through_meshes_ += list_counts_.waiting;
        const cuda::MaterialQueues<float> queue = at(segment);
        run(2, [&] { ::intersect_meshes(view_, queue.paths, nullptr, list(), queue.hits, nullptr, 0, 1, {}); });
        EXPECT_EQ(list_counts_.waiting, 0u);
    }

    // Every slot in play holds a path of its own, with the hit of its ray, in a queue of its kind unless a mesh
    // decided.
    void expect_each_path_once(std::uint32_t segment) {
        const cuda::MaterialQueues<float> queue = at(segment);
        const ::Paths paths(queue.paths);
        std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
        for (std::uint32_t number = 0; number < queues; ++number) {
            const std::uint32_t count = queue.counts[number * cuda::counter_stride];
            for (std::uint32_t position = 0; position < count; ++position) {
                const std::uint32_t place = cuda::place_of_chunk(queue, number, position) - 1;
                ASSERT_LT(place, chunks);
                const std::uint32_t slot = place * cuda::slots_per_chunk + position % cuda::slots_per_chunk;
                const Path<float> path = paths.load(slot);
                EXPECT_TRUE(seen.insert({path.pixel, path.sample}).second);
                EXPECT_EQ(path.segment, segment);
                const SurfaceId side = queue.hits[slot].side;
                const bool ends = ::QueueKinds::is_ended_by(view_, path, {queue.hits[slot].t, side, 0});
                const std::uint32_t kind = number / tuned::append_counters;
                if (ends) {
                    ended_ += 1;
                    mixed_ += ::QueueKinds::keeps_ends && kind == ::QueueKinds::ending ? 0u : 1u;
                } else {
                    mixed_ += kind == ::QueueKinds::of(view_, side.object()) ? 0u : 1u;
                }
                chunks_used_ = std::max(chunks_used_, position / cuda::slots_per_chunk + 1);
            }
        }
    }

    SceneView<float> view_;
    Film film_;
    Side sides_[2];
    // Counts and chunks of three segments.
    std::vector<std::uint32_t> words_[3] = {std::vector<std::uint32_t>(words_of_counts + queues * chunks),
                                            std::vector<std::uint32_t>(words_of_counts + queues * chunks),
                                            std::vector<std::uint32_t>(words_of_counts + queues * chunks)};
    std::vector<std::uint32_t> waiting_ = std::vector<std::uint32_t>(slots);
    cuda::ListCounts list_counts_ = {};
    std::vector<std::uint64_t> live_, in_play_;
    std::vector<cuda::Totals> totals_{cuda::counter_copies};
    std::uint64_t through_meshes_ = 0;
    std::uint64_t mixed_ = 0;        // paths in a queue of another kind than their hit's
    std::uint64_t ended_ = 0;        // paths in a queue whose hit ends them
    std::uint32_t chunks_used_ = 0;  // most chunks of a queue
};

struct Outcome {
    std::uint64_t through_meshes, mixed, ended;
    std::uint32_t chunks_used;
};

Outcome expect_same(const ::pt::Scene& scene, const std::function<void(RenderSettings&)>& change) {
    RenderSettings settings = few_pixels(scene, width, height);
    change(settings);
    const SceneBuffers<float> buffers(scene, settings, by_cwbvh());
    const SceneView<float> view = buffers.view();
    const Film film(width, height, radiance_bound(scene, settings), first_sample + samples);
    const OneByOne expected = one_by_one<::Configuration>(view, film, first_sample, samples);
    MaterialQueueing queueing(view, film);
    for (std::uint32_t segment = 0; segment < view.longest_path(); ++segment) {
        queueing.bounce(segment);
    }
    EXPECT_EQ(queueing.film().sums(), expected.film.sums());
    EXPECT_EQ(queueing.counted(&PathCounters::paths), total);
    EXPECT_EQ(queueing.counted(&PathCounters::connections), expected.counted.connections);
    EXPECT_EQ(queueing.counted(&PathCounters::unfinished_walks), expected.counted.unfinished_walks);
    EXPECT_EQ(queueing.rays() + expected.counted.connections, expected.counted.rays);
    EXPECT_EQ(queueing.live(), queueing.in_play());
    EXPECT_EQ(queueing.live().front(), total);
    return {queueing.through_meshes(), queueing.mixed(), queueing.ended(), queueing.chunks_used()};
}

}  // namespace
}  // namespace pt::test
