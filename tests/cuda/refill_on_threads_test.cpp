// integrator=wavefront_refill without a GPU: its kernels, a thread a lane (tests/support/block_on_threads.h), leave the
// film of depth_first, bit for bit, in the rounds that the host's side counts on. What is tested is which path goes
// into which slot, when, and that none is lost or traced twice.
#include "tests/support/block_on_threads.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include <gtest/gtest.h>

#include "harness/scene/places.h"
#include "harness/scene/scene_buffers.h"
#include "tests/support/key_of_material.h"
#include "tests/support/one_by_one.h"
#include "variants/accelerator/brute_force.h"
#include "variants/cuda/device/kernel_config.h"
#include "variants/layout/aos.cuh"

using std::max;
using std::min;

using Real = float;
inline constexpr pt::cuda::KernelConfig kernel_config{.features = pt::all_features, .block = 64};
namespace tuned {
inline constexpr unsigned walks_apart = 1, walk_steps = 3;
}  // namespace tuned
namespace host_bytes {
inline constexpr pt::test::SameProgram fill_queue, intersect_queue, shade_and_refill, refill_queue, walk_on;
}  // namespace host_bytes
using Paths = pt::layout::aos::DevicePaths<Real>;
using Accelerator = pt::accelerator::brute_force::Traversal;
#include "variants/cuda/device/scene_in_global.cuh"
// After it: they need no more than its names.
#include "variants/cuda/device/pixels_all.cuh"
#include "variants/integrator/wavefront_refill_walks.cuh"

namespace pt::test {
namespace {

constexpr std::uint32_t samples = 3, width = 11, height = 7, total = samples * width * height;
constexpr std::uint32_t first_sample = 2;

// A queue of so many slots, and what the host's side does with it.
class RefilledQueue {
public:
    RefilledQueue(const SceneView<float>& view, Film film, std::uint32_t slots, std::uint32_t refill_every)
        : view_(view),
          film_(std::move(film)),
          slots_(slots),
          refill_every_(refill_every),
          blocks_((slots + kernel_config.block - 1) / kernel_config.block),
          records_(slots),
          store_{reinterpret_cast<unsigned char*>(records_.data()), slots},
          hits_(slots, {-1, SurfaceId{}}),
          walkers_{std::vector<unsigned char>(slots * sizeof(::Walker)),
                   std::vector<unsigned char>(slots * sizeof(::Walker))},
          order_(slots),
          keys_(slots, 12345u),
          ended_(view.longest_path()) {
        std::iota(order_.begin(), order_.end(), 0u);
        run([&] { ::fill_queue(view_, store_, &count_, slots_, supply(), ::HitCache{}, hits_.data()); });
    }

    // With the paths in order of their keys in between. Returns what the device reports when the round begins.
    std::uint64_t round(std::uint32_t number) {
        std::uint64_t report = 0;
        run([&] {
            ::intersect_queue(view_, store_, order_.data(), slots_, hits_.data(), keys_.data(), 0, 0, last_key(),
                              cuda::KeyBounds{}, supply(), cuda::ProgressReport{&report, number}, totals_.data());
        });
        sort();
        const FilmView sums = film_.view();
        const cuda::PathSupply at_once = refill_every_ == 1 ? supply() : cuda::PathSupply{};
        run([&] {
            ::shade_and_refill(view_, sums, store_, order_.data(), &count_, hits_.data(), at_once, ::HitCache{},
                               totals_.data(), ended_.data(), list(0));
        });
        walked_on_ += walker_counts_[0].waiting;
        run_blocks(2, kernel_config.block, [&] {
            ::walk_on(view_, sums, store_, hits_.data(), list(0), list(1), at_once, ::HitCache{}, totals_.data(),
                      ended_.data());
        });
        std::swap(walkers_[0], walkers_[1]);
        std::swap(walker_counts_[0], walker_counts_[1]);
        return report;
    }

    void refill() {
        run([&] { ::refill_queue(view_, store_, slots_, supply(), ::HitCache{}); });
    }

    std::uint32_t alive() const {
        const ::Paths paths(store_);
        std::uint32_t alive = 0;
        for (std::uint32_t slot = 0; slot < slots_; ++slot) {
            alive += paths.alive(slot) ? 1u : 0u;
        }
        return alive;
    }
    PathCounters counted() const {
        PathCounters sum;
        for (const cuda::Totals& copy : totals_) {
            sum.paths += copy.paths.paths;
            sum.rays += copy.paths.rays + copy.paths.connections;
            sum.connections += copy.paths.connections;
            sum.unfinished_walks += copy.paths.unfinished_walks;
        }
        return sum;
    }
    const Film& film() const { return film_; }
    // Walks that were taken on, one in two rounds twice.
    std::uint64_t walked_on() const { return walked_on_; }
    std::uint32_t handed_out() const { return next_; }
    std::uint32_t count() const { return count_; }
    // Paths by their number of segments: 1 and more.
    const std::vector<std::uint64_t>& lengths() const { return ended_; }

private:
    template <class Kernel>
    void run(const Kernel& kernel) {
        run_blocks(blocks_, kernel_config.block, kernel);
    }
    cuda::WalkerList list(int i) { return {walkers_[i].data(), &walker_counts_[i]}; }
    cuda::PathSupply supply() { return {&next_, total, first_sample}; }
    std::uint32_t last_key() const { return view_.materials.size + 1; }

    // Every position has a key, and an ended path the last one.
    void sort() {
        std::vector<std::uint32_t> positions(slots_);
        std::iota(positions.begin(), positions.end(), 0u);
        const ::Paths paths(store_);
        for (const std::uint32_t position : positions) {
            EXPECT_EQ(keys_[position] == last_key(),
                      !paths.alive(order_[position]) || hits_[order_[position]].t == cuda::on_a_walk);
            EXPECT_LE(keys_[position], last_key());
        }
        std::stable_sort(positions.begin(), positions.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return keys_[a] < keys_[b]; });
        std::vector<std::uint32_t> sorted;
        for (const std::uint32_t position : positions) {
            sorted.push_back(order_[position]);
        }
        order_ = sorted;
        std::fill(keys_.begin(), keys_.end(), 12345u);
    }

    SceneView<float> view_;
    Film film_;
    std::uint32_t slots_, refill_every_, blocks_;
    std::vector<layout::aos::Record<float>> records_;
    cuda::PathStore store_;
    std::vector<StoredHit<float>> hits_;
    std::vector<unsigned char> walkers_[2];
    cuda::ListCounts walker_counts_[2] = {};
    std::uint64_t walked_on_ = 0;
    std::vector<std::uint32_t> order_, keys_;
    std::vector<std::uint64_t> ended_;
    std::vector<cuda::Totals> totals_{cuda::counter_copies};
    std::uint32_t count_ = 0, next_ = 0;
};

// Round after round, as the host's side does: it refills until it has seen that every path was handed out, and ends
// when all have ended.
void render_all(RefilledQueue& queue, std::uint32_t slots, std::uint32_t refill_every) {
    std::uint32_t all_begun = ~0u, before = slots;
    for (std::uint32_t round = 0; queue.counted().paths < total; ++round) {
        if (before < total && round % refill_every == 0) {
            ASSERT_EQ(queue.alive(), slots) << "before round " << round;
        }
        ASSERT_EQ(queue.round(round), std::uint64_t{round} << 32 | before);
        if (before >= total && all_begun == ~0u) {
            all_begun = round;
        }
        const std::uint32_t free_slots = slots - queue.alive();
        if (refill_every > 1) {
            ASSERT_EQ(queue.handed_out(), before) << "after round " << round;
            if (all_begun == ~0u && (round + 1) % refill_every == 0) {
                queue.refill();
                ASSERT_EQ(queue.handed_out(), before + free_slots) << "after round " << round;
            }
        }
        before = queue.handed_out();
    }
    // Every path that ended asked for one, where it was replaced at once.
    if (refill_every == 1) {
        EXPECT_EQ(queue.handed_out(), slots + total);
    }
}

void expect_same(const char* name, const std::function<void(RenderSettings&)>& change) {
    const ::pt::Scene scene = find_scene(name);
    RenderSettings settings = few_pixels(scene, width, height);
    change(settings);
    const SceneBuffers<float> buffers(scene, settings);
    const SceneView<float> view = buffers.view();
    const Film film(width, height, radiance_bound(scene, settings), first_sample + samples);
    const OneByOne expected = one_by_one<::Configuration>(view, film, first_sample, samples);
    // One of the last block's warps has fewer slots than lanes, and one none; and a slot for every path.
    for (const std::uint32_t slots : {width * height, total}) {
        for (const std::uint32_t refill_every : {1u, 3u}) {
            SCOPED_TRACE(testing::Message() << name << ", " << slots << " slots, refilled every " << refill_every);
            RefilledQueue queue(view, film, slots, refill_every);
            EXPECT_EQ(queue.count(), slots);
            render_all(queue, slots, refill_every);
            EXPECT_EQ(queue.alive(), 0u);
            EXPECT_EQ(queue.film().sums(), expected.film.sums());
            EXPECT_EQ(queue.counted().paths, total);
            EXPECT_EQ(queue.counted().rays, expected.counted.rays);
            EXPECT_EQ(queue.counted().connections, expected.counted.connections);
            EXPECT_EQ(queue.counted().unfinished_walks, expected.counted.unfinished_walks);
            EXPECT_EQ(queue.lengths(), expected.lengths);
        }
    }
}

TEST(WavefrontRefill, LeavesTheSameFilm) {
    expect_same("cornell_closed_five", [](RenderSettings&) {});
    expect_same("cornell_open_five", [](RenderSettings& settings) { settings.depth = 1; });
}

TEST(WavefrontRefill, CountsConnectionsAndPathsThatRouletteEnds) {
    expect_same("cornell_closed_five", [](RenderSettings& settings) {
        settings.next_event = true;
        settings.mis_exponent = 1;
        settings.roulette_start = 2;
    });
}

}  // namespace
}  // namespace pt::test
