// integrator=wavefront_fused that appends, without a GPU: its kernels and the one that takes subsurface walks, a thread
// a lane (tests/support/block_on_threads.h), leave the film of depth_first, bit for bit. What is tested is that every
// walk is taken once, by whichever lane is free, and that its path comes back into the queue.
#include "tests/support/block_on_threads.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "harness/scene/places.h"
#include "harness/scene/scene_buffers.h"
#include "tests/support/one_by_one.h"
#include "variants/accelerator/brute_force.h"
#include "variants/cuda/device/kernel_config.h"
#include "variants/layout/aos.cuh"

using std::max;
using std::min;

using Real = float;
inline constexpr pt::cuda::KernelConfig kernel_config{.features = pt::all_features, .block = 64};
namespace tuned {
inline constexpr unsigned append_in_kernel = 1, append_counters = 3, walks_apart = 1;
}  // namespace tuned
namespace host_bytes {
inline constexpr pt::test::SameProgram first_bounce, next_bounce, walk_paths, advance;
}  // namespace host_bytes
using Paths = pt::layout::aos::DevicePaths<Real>;
using Accelerator = pt::accelerator::brute_force::Traversal;
#include "variants/cuda/device/scene_in_global.cuh"
// After it: they need no more than its names.
#include "variants/cuda/device/pixels_all.cuh"
#include "variants/cuda/device/walk_paths.cuh"
#include "variants/integrator/wavefront_fused.cuh"

namespace pt::test {
namespace {

constexpr std::uint32_t samples = 3, width = 11, height = 7, total = samples * width * height;
constexpr std::uint32_t first_sample = 2;
constexpr std::uint32_t parts = tuned::append_counters;

// A queue of three parts between two bounces, and what the host's side does with it.
class AppendedQueue {
public:
    AppendedQueue(const SceneView<float>& view, Film film)
        : view_(view),
          film_(std::move(film)),
          blocks_((total + kernel_config.block - 1) / kernel_config.block),
          capacity_((blocks_ + parts - 1) / parts * parts * kernel_config.block),
          records_{Records(capacity_), Records(capacity_)},
          walkers_(capacity_ * sizeof(::Walker)),
          live_(view.longest_path()),
          in_play_(view.longest_path()) {
        const FilmView sums = film_.view();
        run(blocks_, [&] {
            ::first_bounce(view_, sums, store(0), counts_[0].data(), total, first_sample, nullptr, ::HitCache{},
                           totals_.data(), segments(), store(1), list());
        });
        walk(store(1), store(0), counts_[0].data());
    }

    // Takes one segment, from one of the two stores to the other.
    void bounce(std::uint32_t segment) {
        std::fill(counts_[1 - here_].begin(), counts_[1 - here_].end(), 0u);
        const FilmView sums = film_.view();
        run(blocks_, [&] {
            ::next_bounce(view_, sums, store(here_), nullptr, counts_[here_].data(), store(1 - here_),
                          counts_[1 - here_].data(), {segment, nullptr}, totals_.data(), segments(), list());
        });
        walk(store(here_), store(1 - here_), counts_[1 - here_].data());
        here_ = 1 - here_;
    }

    std::uint32_t alive() const {
        std::uint32_t alive = 0;
        for (std::uint32_t part = 0; part < parts; ++part) {
            alive += counts_[here_][part * cuda::counter_stride];
        }
        return alive;
    }
    PathCounters counted() const {
        PathCounters sum;
        for (const cuda::Totals& copy : totals_) {
            sum.paths += copy.paths.paths;
            sum.unfinished_walks += copy.paths.unfinished_walks;
        }
        sum.rays = std::accumulate(live_.begin(), live_.end(), std::uint64_t{0});
        return sum;
    }
    const Film& film() const { return film_; }
    std::uint64_t walks() const { return walks_; }

private:
    using Records = std::vector<layout::aos::Record<float>>;
    using Counts = std::vector<std::uint32_t>;

    template <class Kernel>
    void run(std::uint32_t blocks, const Kernel& kernel) {
        run_blocks(blocks, kernel_config.block, kernel);
    }
    // By fewer lanes than there may be walkers, so that lanes take several.
    void walk(const cuda::PathStore& in, const cuda::PathStore& out, std::uint32_t* out_count) {
        walks_ += walker_counts_.waiting;
        const FilmView sums = film_.view();
        run(2, [&] { ::walk_paths(view_, sums, list(), in, out, out_count, parts, {}, totals_.data()); });
        EXPECT_EQ(walker_counts_.waiting, 0u);
        EXPECT_EQ(walker_counts_.taken, 0u);
        EXPECT_EQ(walker_counts_.finished, 0u);
    }
    cuda::PathStore store(int which) { return {reinterpret_cast<unsigned char*>(records_[which].data()), capacity_}; }
    cuda::WalkerList list() { return {walkers_.data(), &walker_counts_}; }
    cuda::SegmentCounts segments() { return {live_.data(), in_play_.data(), 1}; }

    SceneView<float> view_;
    Film film_;
    std::uint32_t blocks_, capacity_;
    Records records_[2];
    Counts counts_[2] = {Counts(parts * cuda::counter_stride), Counts(parts* cuda::counter_stride)};
    std::vector<unsigned char> walkers_;
    cuda::ListCounts walker_counts_ = {};
    std::vector<std::uint64_t> live_, in_play_;
    std::vector<cuda::Totals> totals_{cuda::counter_copies};
    std::uint64_t walks_ = 0;
    int here_ = 0;
};

PathCounters expect_same(const ::pt::Scene& scene) {
    SCOPED_TRACE(scene.name);
    const RenderSettings settings = few_pixels(scene, width, height);
    const SceneBuffers<float> buffers(scene, settings);
    const SceneView<float> view = buffers.view();
    const Film film(width, height, radiance_bound(scene, settings), first_sample + samples);
    const OneByOne expected = one_by_one<::Configuration>(view, film, first_sample, samples);
    AppendedQueue queue(view, film);
    for (std::uint32_t segment = 1; segment < view.longest_path(); ++segment) {
        queue.bounce(segment);
    }
    EXPECT_EQ(queue.alive(), 0u);
    EXPECT_GT(queue.walks(), 30u);
    EXPECT_EQ(queue.film().sums(), expected.film.sums());
    EXPECT_EQ(queue.counted().paths, total);
    EXPECT_EQ(queue.counted().rays, expected.counted.rays);
    EXPECT_EQ(queue.counted().unfinished_walks, expected.counted.unfinished_walks);
    return expected.counted;
}

TEST(WalksApart, LeaveTheSameFilm) { (void)expect_same(find_scene("cornell_closed_five")); }

// With a cap of five scatterings many walks end without having left the body: their paths are lost, and counted.
TEST(WalksApart, LosePathsAtTheCap) {
    ::pt::Scene scene = find_scene("cornell_closed_five");
    for (auto& material : scene.materials) {
        if (material.name == "wax") {
            material.max_scatterings = 5;
        }
    }
    EXPECT_GT(expect_same(scene).unfinished_walks, 10u);
}

}  // namespace
}  // namespace pt::test
