// A render on a GPU that stops at checkpoints: with every integrator and launch the film there is that of a render of
// so many samples, and the one at the end that of a render without checkpoints. Skipped where there is no GPU.
#include <chrono>
#include <stdexcept>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "harness/cuda/backend.h"
#include "harness/render/renderer.h"
#include "harness/scene/places.h"

namespace pt {
namespace {

// With four samples in flight: parts shorter than a batch, batches that end with a part and such that do not, and
// graphs that have to skip what ran by stream before them.
constexpr std::uint32_t samples = 21;
const std::vector<std::uint32_t> checkpoints{1, 2, 8, 16, samples};

Scene small_scene(const std::string& name, bool jitter) {
    Scene scene = find_scene(name);
    scene.camera.jitter = jitter;
    return scene;
}

RenderRequest request_for(const Scene& scene, const Variant& variant) {
    RenderRequest request{
        .variant = variant, .backend = Backend::cuda, .settings = default_settings(scene), .samples = samples};
    request.settings.width = 40;  // not a multiple of a warp
    request.settings.height = 24;
    request.settings.depth = 7;
    return request;
}

struct Stopped {
    RenderResult result;
    std::vector<std::uint32_t> samples;
    std::vector<std::vector<std::int64_t>> sums;
};

Stopped render_with_checkpoints(const Scene& scene, RenderRequest request) {
    std::vector<std::uint32_t> seen;
    std::vector<std::vector<std::int64_t>> sums;
    request.checkpoints = checkpoints;
    request.on_checkpoint = [&](const Checkpoint& checkpoint) {
        EXPECT_EQ(checkpoint.film.samples(), checkpoint.samples);
        seen.push_back(checkpoint.samples);
        sums.push_back(checkpoint.film.sums());
    };
    RenderResult result = render(scene, request);
    return {std::move(result), std::move(seen), std::move(sums)};
}

void expect_same_work(const WorkCounters& a, const WorkCounters& b) {
    EXPECT_EQ(a.paths, b.paths);
    EXPECT_EQ(a.rays, b.rays);
    EXPECT_EQ(a.cache_fills, b.cache_fills);
    EXPECT_EQ(a.cache_hits, b.cache_hits);
    EXPECT_EQ(a.unfinished_walks, b.unfinished_walks);
}

void expect_right_films(const Scene& scene, const RenderRequest& request) {
    const RenderResult whole = render(scene, request);
    const Stopped stopped = render_with_checkpoints(scene, request);
    EXPECT_EQ(stopped.result.film.sums(), whole.film.sums());
    EXPECT_EQ(stopped.result.film.samples(), samples);
    expect_same_work(stopped.result.work, whole.work);
    ASSERT_EQ(stopped.samples, checkpoints);
    for (std::size_t i = 0; i < checkpoints.size(); ++i) {
        RenderRequest fewer = request;
        fewer.samples = checkpoints[i];
        fewer.film_samples = samples;
        EXPECT_EQ(stopped.sums[i], render(scene, fewer).film.sums()) << "at " << checkpoints[i] << " samples";
    }
}

class CheckpointTest : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string reason = cuda::not_available(); !reason.empty()) {
            GTEST_SKIP() << reason;
        }
    }

    // Returns how many of the settings' variants apply; each was tested.
    static int expect_right_films_for(const std::string& scene_name, bool jitter, const Variant& variant,
                                      std::uint32_t in_flight) {
        const Scene scene = small_scene(scene_name, jitter);
        Variant tuned = variant;
        if (variant["integrator"] != "persistent" && variant["integrator"] != "regroup" && in_flight != 1) {
            tuned.tuning["spp_in_flight"] = in_flight;
        }
        if (!why_not_applicable(tuned, features_of(scene), Backend::cuda).empty()) {
            return 0;
        }
        SCOPED_TRACE(scene_name + " " + tuned.spelled_out());
        expect_right_films(scene, request_for(scene, tuned));
        return 1;
    }
};

struct Pipeline {
    const char* integrator;
    const char* compaction;
    const char* sorting;
    const char* layout;
};

constexpr Pipeline pipelines[] = {
    {"megakernel", "none", "none", "aos"},
    {"megakernel_regen", "none", "none", "aos"},
    {"persistent", "none", "none", "aos"},
    {"regroup", "none", "none", "aos"},
    {"wavefront", "none", "none", "soa"},
    {"wavefront", "gap_fill", "none", "aos"},
    {"wavefront", "cub_select_flagged", "bucket", "soa"},
    {"wavefront", "block_scan_append", "cub_radix", "packed"},
    {"wavefront", "thrust_partition", "none", "aos"},
    {"wavefront_fused", "none", "none", "packed"},
    {"wavefront_fused", "atomic_append", "none", "packed"},
    {"wavefront_fused", "block_scan_append", "none", "aos"},
    {"wavefront_fused", "cub_three_way", "none", "soa"},
    {"wavefront_materials", "none", "none", "packed"},
    {"wavefront_refill", "none", "none", "packed"},
    {"wavefront_refill", "none", "per_material_queue", "soa"},
};

Variant variant_of(const Pipeline& pipeline, const char* launch) {
    Variant variant = expand({}, Backend::cuda).front();
    variant.set("integrator", pipeline.integrator);
    variant.set("compaction", pipeline.compaction);
    variant.set("sorting", pipeline.sorting);
    variant.set("layout", pipeline.layout);
    variant.set("launch", launch);
    return variant;
}

TEST_F(CheckpointTest, EveryIntegratorAndLaunchShowsTheFilmOfTheSamplesSoFar) {
    int tested = 0;
    for (const Pipeline& pipeline : pipelines) {
        for (const char* const launch : {"stream", "graph", "graph_while"}) {
            for (const std::uint32_t in_flight : {1u, 4u}) {
                tested += expect_right_films_for("cornell_open", true, variant_of(pipeline, launch), in_flight);
            }
        }
    }
    // 16 by stream, 9 of the 10 with a queue and a known end by graph (Thrust waits), 6 of those with a compaction by
    // graph_while.
    EXPECT_EQ(tested, 2 * (16 + 9 + 6));
}

TEST_F(CheckpointTest, AFirstBounceCacheIsFilledOnce) {
    int tested = 0;
    for (const Pipeline& pipeline : pipelines) {
        for (const char* const launch : {"stream", "graph"}) {
            Variant variant = variant_of(pipeline, launch);
            variant.set("first_bounce", "cached");
            tested += expect_right_films_for("cornell_open", false, variant, 4);
            variant.set("first_bounce", "cached_jitters");
            for (const std::uint32_t rays : {1u, 5u, 16u, 64u}) {
                variant.tuning["jitters"] = rays;
                tested += expect_right_films_for("cornell_open", true, variant, 4);
            }
        }
    }
    EXPECT_EQ(tested, 5 * (14 + 9));
}

TEST_F(CheckpointTest, SubsurfaceWalksAndSixMaterials) {
    for (const char* const integrator : {"megakernel", "megakernel_regen", "persistent", "regroup", "wavefront",
                                         "wavefront_materials", "wavefront_refill"}) {
        const Variant variant = variant_of({integrator, "none", "none", "aos"}, "stream");
        EXPECT_EQ(expect_right_films_for("cornell_closed_five", true, variant, 4), 1);
        EXPECT_EQ(expect_right_films_for("subsurface_box_on", true, variant, 4), 1);
    }
}

TEST_F(CheckpointTest, AGraphGoesOnByItselfUnlessBatchesRanByStream) {
    const Scene scene = small_scene("cornell_open", true);
    Variant variant = variant_of({"wavefront_fused", "atomic_append", "none", "packed"}, "graph");
    RenderRequest request = request_for(scene, variant);
    const std::uint64_t whole = render(scene, request).work.launches;
    EXPECT_EQ(whole, samples);  // a graph a sample, nothing else
    EXPECT_EQ(render_with_checkpoints(scene, request).result.work.launches, whole);
}

TEST_F(CheckpointTest, InstrumentedRendersCountTheSamePaths) {
    const Scene scene = small_scene("cornell_open", true);
    for (const Pipeline& pipeline : pipelines) {
        SCOPED_TRACE(pipeline.integrator);
        RenderRequest request = request_for(scene, variant_of(pipeline, "stream"));
        request.instrument = true;
        EXPECT_EQ(render_with_checkpoints(scene, request).result.stages.live_paths,
                  render(scene, request).stages.live_paths);
    }
}

double now_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The render's clock and what the callback took are parts of the whole call that do not overlap.
TEST_F(CheckpointTest, ClocksAddUpAndLeaveOutWhatHappensAtCheckpoints) {
    const Scene scene = small_scene("cornell_open", true);
    RenderRequest request = request_for(scene, variant_of(pipelines[0], "stream"));
    double in_callback = 0;
    std::vector<Checkpoint> seen;
    request.checkpoints = checkpoints;
    request.on_checkpoint = [&](const Checkpoint& checkpoint) {
        const double start = now_ms();
        seen.push_back(checkpoint);
        while (now_ms() < start + 20) {
        }
        in_callback += now_ms() - start;
    };
    const double start = now_ms();
    const RenderResult result = render(scene, request);
    EXPECT_LE(result.wall_ms + in_callback, now_ms() - start);
    double wall = 0, device = 0;
    ASSERT_EQ(seen.size(), checkpoints.size());
    for (const Checkpoint& checkpoint : seen) {
        EXPECT_GT(checkpoint.wall_ms, wall);
        EXPECT_GT(checkpoint.device_ms, device);
        EXPECT_LE(checkpoint.device_ms, checkpoint.wall_ms);
        wall = checkpoint.wall_ms;
        device = checkpoint.device_ms;
    }
    EXPECT_EQ(wall, result.wall_ms);
    EXPECT_EQ(device, result.device_ms);
}

TEST_F(CheckpointTest, AnExceptionOfTheCallbackLeavesTheDeviceUsable) {
    const Scene scene = small_scene("cornell_open", true);
    RenderRequest request = request_for(scene, variant_of(pipelines[9], "graph"));
    const std::string hash = render(scene, request).film.hash();
    RenderRequest failing = request;
    failing.checkpoints = checkpoints;
    failing.on_checkpoint = [](const Checkpoint&) { throw std::runtime_error("enough"); };
    EXPECT_THROW((void)render(scene, failing), std::runtime_error);
    EXPECT_EQ(render(scene, request).film.hash(), hash);
}

}  // namespace
}  // namespace pt
