// integrator=regroup without a GPU: its kernel, a thread a lane (tests/support/block_on_threads.h), leaves the film of
// depth_first, bit for bit. What is tested is who hands which path to whom, and that none is lost or traced twice.
// Races: built with -fsanitize=thread, the program tells of none; without the fences, or a __syncwarp, it does.
#include "tests/support/block_on_threads.h"

#include <algorithm>
#include <functional>

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
// Few threads, and a pool in which warps are short of paths of one kind.
inline constexpr pt::cuda::KernelConfig kernel_config{.features = pt::all_features, .block = 64};
namespace tuned {
inline constexpr unsigned pool = 96, walk_until = 4, stay_at = 8, by_material = 1;
}
namespace host_bytes {
inline constexpr pt::test::SameProgram regroup;
}
using Paths = pt::layout::aos::DevicePaths<Real>;
using Accelerator = pt::accelerator::brute_force::Traversal;
#include "variants/cuda/device/scene_in_global.cuh"
// After it: they need no more than its names.
#include "variants/cuda/device/pixels_all.cuh"
#include "variants/integrator/regroup.cuh"

namespace pt::test {
namespace {

struct Rendered {
    Film film;
    PathCounters counted;
};

constexpr std::uint32_t samples = 3;

Rendered regrouped(const SceneView<float>& view, Film film, std::uint32_t samples_per_piece) {
    Rendered rendered{std::move(film), {}};
    const FilmView sums = rendered.film.view();
    std::vector<cuda::Totals> totals(cuda::counter_copies);
    std::uint64_t next_piece = 0;
    run_blocks(2, kernel_config.block, [&] {
        ::regroup(view, sums, 0, samples, ::HitCache{}, totals.data(), nullptr, samples_per_piece, &next_piece);
    });
    for (const cuda::Totals& copy : totals) {
        rendered.counted.paths += copy.paths.paths;
        rendered.counted.rays += copy.paths.rays;
        rendered.counted.connections += copy.paths.connections;
        rendered.counted.unfinished_walks += copy.paths.unfinished_walks;
    }
    return rendered;
}

void expect_same(const char* name, const std::function<void(RenderSettings&)>& change) {
    const ::pt::Scene scene = find_scene(name);
    // Strips of 32 pixels lie over several rows, and the last one is short.
    RenderSettings settings = few_pixels(scene, 11, 7);
    change(settings);
    const SceneBuffers<float> buffers(scene, settings);
    const Film film(settings.width, settings.height, radiance_bound(scene, settings), samples);
    const OneByOne expected = one_by_one<::Configuration>(buffers.view(), film, 0, samples);
    for (const std::uint32_t samples_per_piece : {1u, 2u}) {
        const Rendered rendered = regrouped(buffers.view(), film, samples_per_piece);
        EXPECT_EQ(rendered.film.sums(), expected.film.sums()) << name;
        EXPECT_EQ(rendered.counted.paths, 11u * 7 * samples) << name;
        EXPECT_EQ(rendered.counted.rays, expected.counted.rays) << name;
        EXPECT_EQ(rendered.counted.connections, expected.counted.connections) << name;
        EXPECT_EQ(rendered.counted.unfinished_walks, expected.counted.unfinished_walks) << name;
    }
}

TEST(Regroup, LeavesTheSameFilm) {
    expect_same("cornell_closed_five", [](RenderSettings&) {});
    expect_same("cornell_open_five", [](RenderSettings& settings) { settings.depth = 1; });
}

TEST(Regroup, CountsConnectionsAndPathsThatRouletteEnds) {
    expect_same("cornell_closed_five", [](RenderSettings& settings) {
        settings.next_event = true;
        settings.mis_exponent = 1;
        settings.roulette_start = 2;
    });
}

// Slots are handed back under kinds in a fixed order, a slot after the other in its own, and retire after so many
// turns.
TEST(PathPool, HandsOutWhatItWasGivenUnderOneKindAndOnce) {
    constexpr std::uint32_t turns = 20;
    static ::PathPool pool;
    std::vector<std::atomic<int>> held(::PathPool::slots);
    std::vector<std::uint32_t> taken_before(::PathPool::slots);
    std::atomic<int> wrong = 0;
    std::atomic<bool> was_full = false;
    const auto kind_of = [](std::uint32_t slot, std::uint32_t turn) {
        return turn == 0       ? ::Kinds::over
               : turn == turns ? ::Kinds::retired
                               : (7 * slot + 3 * turn * turn) % ::Kinds::lists;
    };
    run_blocks(1, kernel_config.block, [&] {
        pool.fill();
        ::Taken taken = pool.exchange(0, ::Kinds::nothing);
        while (!taken.finished) {
            std::uint32_t kind = ::Kinds::nothing;
            if (cuda::lane() < taken.count) {
                const bool is_alone = held[taken.slot].fetch_add(1) == 0;
                wrong += is_alone && taken.kind == kind_of(taken.slot, taken_before[taken.slot]) ? 0 : 1;
                was_full = was_full || taken.count == 32;
                kind = kind_of(taken.slot, ++taken_before[taken.slot]);
                held[taken.slot] -= 1;
            }
            taken = pool.exchange(taken.slot, kind);
        }
    });
    EXPECT_EQ(wrong, 0);
    EXPECT_TRUE(was_full);
    EXPECT_EQ(taken_before, std::vector<std::uint32_t>(::PathPool::slots, turns));
}

}  // namespace
}  // namespace pt::test
