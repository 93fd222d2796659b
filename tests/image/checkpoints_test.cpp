// A render that stops at checkpoints: its film's bits there, the bits at the end, what is counted, and its clocks.
#include <chrono>
#include <ctime>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/render/checkpoints.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

constexpr std::uint32_t samples = 11;
const std::vector<std::uint32_t> octaves{1, 2, 4, 8, samples};

// A lamp over a diffuse and a mirror ball, with jitter; 20x16.
Scene lit_balls() {
    test::SceneBuilder builder;
    builder.image(20, 16, 60, true).depth(4).environment(0.125);
    const std::uint32_t white = builder.diffuse(Vec3d(0.75, 0.5, 0.25));
    const std::uint32_t metal = builder.mirror(Vec3d(0.875));
    const std::uint32_t lamp = builder.emitter(Vec3d(8, 6, 4));
    builder.sphere(white, {0.6, -0.5, 4}, 1.5);
    builder.sphere(metal, {-0.8, -0.4, 4.5}, 1.5);
    builder.quad(lamp, {0, 2, 4}, 2, 2);
    builder.quad(white, {0, -1.3, 4}, 8, 8);
    return builder.scene;
}

struct Seen {
    std::uint32_t samples;
    std::uint64_t film_samples;
    std::vector<std::int64_t> sums;
    Vec3d mean;
    double wall_ms, device_ms, cpu_ms;
};

struct Stopped {
    RenderResult result;
    std::vector<Seen> seen;
};

RenderRequest request_for(const Scene& scene, const Variant& variant) {
    RenderRequest request;
    request.variant = variant;
    request.settings = default_settings(scene);
    request.samples = samples;
    return request;
}

Stopped render_with_checkpoints(const Scene& scene, RenderRequest request, std::vector<std::uint32_t> checkpoints) {
    std::vector<Seen> seen;
    request.checkpoints = std::move(checkpoints);
    request.on_checkpoint = [&](const Checkpoint& checkpoint) {
        const Film& film = checkpoint.film;
        seen.push_back({checkpoint.samples, film.samples(), film.sums(), film.mean(), checkpoint.wall_ms,
                        checkpoint.device_ms, checkpoint.cpu_ms});
    };
    RenderResult result = render(scene, request);
    return {std::move(result), std::move(seen)};
}

// Each integrator, a queue that moves its paths, and both caches; the cache of 4 rays fills from part to part.
std::vector<Variant> variants() {
    std::vector<Variant> all;
    for (const char* const integrator : {"depth_first", "wavefront"}) {
        for (const char* const first_bounce : {"off", "cached", "cached_jitters"}) {
            Variant variant = Registry::instance().baseline();
            variant.set("integrator", integrator);
            variant.set("first_bounce", first_bounce);
            if (first_bounce == std::string("cached_jitters")) {
                variant.tuning["jitters"] = 4;
            }
            all.push_back(variant);
        }
    }
    Variant packet = Registry::instance().baseline();
    packet.set("integrator", "packet");
    all.push_back(packet);
    Variant compacting = Registry::instance().baseline();
    compacting.set("integrator", "wavefront");
    compacting.set("compaction", "thrust_partition");
    compacting.set("sorting", "bucket");
    all.push_back(compacting);
    return all;
}

// `cached` asks for a scene without jitter.
Scene scene_for(const Variant& variant) {
    Scene scene = lit_balls();
    scene.camera.jitter = variant["first_bounce"] != "cached";
    return scene;
}

void expect_same_work(const WorkCounters& a, const WorkCounters& b) {
    EXPECT_EQ(a.paths, b.paths);
    EXPECT_EQ(a.rays, b.rays);
    EXPECT_EQ(a.bounces, b.bounces);
    EXPECT_EQ(a.compactions, b.compactions);
    EXPECT_EQ(a.compacted_away, b.compacted_away);
    EXPECT_EQ(a.sorted, b.sorted);
    EXPECT_EQ(a.cache_fills, b.cache_fills);
    EXPECT_EQ(a.cache_hits, b.cache_hits);
}

class VariantCheckpointsTest : public testing::TestWithParam<Variant> {};

TEST_P(VariantCheckpointsTest, ChangeNeitherTheFilmNorTheWork) {
    const Scene scene = scene_for(GetParam());
    const RenderRequest request = request_for(scene, GetParam());
    ASSERT_EQ(why_not_applicable(GetParam(), features_of(scene)), "");
    const RenderResult whole = render(scene, request);
    const Stopped stopped = render_with_checkpoints(scene, request, octaves);
    EXPECT_EQ(stopped.result.film.sums(), whole.film.sums());
    EXPECT_EQ(stopped.result.film.samples(), samples);
    EXPECT_EQ(stopped.result.film.mean(), whole.film.mean());
    expect_same_work(stopped.result.work, whole.work);
}

TEST_P(VariantCheckpointsTest, ShowTheFilmOfTheSamplesSoFar) {
    const Scene scene = scene_for(GetParam());
    const RenderRequest request = request_for(scene, GetParam());
    const Stopped stopped = render_with_checkpoints(scene, request, octaves);
    ASSERT_EQ(stopped.seen.size(), octaves.size());
    for (std::size_t i = 0; i < octaves.size(); ++i) {
        const Seen& seen = stopped.seen[i];
        SCOPED_TRACE(octaves[i]);
        RenderRequest fewer = request;
        fewer.samples = octaves[i];
        fewer.film_samples = samples;
        const RenderResult expected = render(scene, fewer);
        EXPECT_EQ(seen.samples, octaves[i]);
        EXPECT_EQ(seen.film_samples, octaves[i]);
        EXPECT_EQ(seen.sums, expected.film.sums());
        EXPECT_EQ(expected.film.samples(), samples);  // its mean is over those that were announced
        const double dimmed = static_cast<double>(samples) / octaves[i];
        for (int channel = 0; channel < 3; ++channel) {
            EXPECT_NEAR(seen.mean[channel], expected.film.mean()[channel] * dimmed, 1e-12);
        }
    }
}

TEST_P(VariantCheckpointsTest, FillTheCacheOnce) {
    const Scene scene = scene_for(GetParam());
    const std::uint32_t rays =
        Registry::instance().at("first_bounce", GetParam()).hook.first_bounce(GetParam(), Backend::cpu);
    const Stopped stopped = render_with_checkpoints(scene, request_for(scene, GetParam()), octaves);
    const std::uint64_t pixels = 20 * 16;
    EXPECT_EQ(stopped.result.work.cache_fills, pixels * rays);
    EXPECT_EQ(stopped.result.work.cache_hits, rays == 0 ? 0 : pixels * (samples - rays));
}

INSTANTIATE_TEST_SUITE_P(All, VariantCheckpointsTest, testing::ValuesIn(variants()), [](const auto& variant_info) {
    const Variant& variant = variant_info.param;
    return variant["integrator"] + "_" + variant["compaction"] + "_" + variant["first_bounce"];
});

TEST(CheckpointsTest, PartOfALargerRenderStopsLikeAWholeOne) {
    const Scene scene = lit_balls();
    RenderRequest request = request_for(scene, Registry::instance().baseline());
    request.first_sample = 100;
    request.samples = 4;
    request.film_samples = 64;
    const Stopped stopped = render_with_checkpoints(scene, request, {3, 4});
    EXPECT_EQ(stopped.seen[1].film_samples, 4u);
    EXPECT_EQ(stopped.result.film.samples(), 64u);
    EXPECT_EQ(stopped.result.film.sums(), render(scene, request).film.sums());
    request.samples = 3;
    EXPECT_EQ(stopped.seen[0].sums, render(scene, request).film.sums());
}

TEST(CheckpointsTest, InstrumentedRendersCountTheSamePaths) {
    const Scene scene = lit_balls();
    for (const char* const integrator : {"depth_first", "packet", "wavefront"}) {
        Variant variant = Registry::instance().baseline();
        variant.set("integrator", integrator);
        RenderRequest request = request_for(scene, variant);
        request.instrument = true;
        EXPECT_EQ(render_with_checkpoints(scene, request, octaves).result.stages.live_paths,
                  render(scene, request).stages.live_paths);
    }
}

double cpu_ms() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double now_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Holds on a loaded machine too: what the render's clocks show and what the callback took are parts of the whole call
// that do not overlap.
TEST(CheckpointsTest, ClocksLeaveOutWhatHappensAtCheckpoints) {
    const Scene scene = lit_balls();
    RenderRequest request = request_for(scene, Registry::instance().baseline());
    double callback_wall = 0, callback_cpu = 0;
    std::vector<Checkpoint> checkpoints;
    request.checkpoints = octaves;
    request.on_checkpoint = [&](const Checkpoint& checkpoint) {
        const double wall = now_ms(), cpu = cpu_ms();
        checkpoints.push_back(checkpoint);
        while (cpu_ms() < cpu + 20) {
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        callback_cpu += cpu_ms() - cpu;
        callback_wall += now_ms() - wall;
    };
    const double wall = now_ms(), cpu = cpu_ms();
    const RenderResult result = render(scene, request);
    const double whole_wall = now_ms() - wall, whole_cpu = cpu_ms() - cpu;
    EXPECT_LE(result.wall_ms + callback_wall, whole_wall);
    EXPECT_LE(result.cpu_ms + callback_cpu, whole_cpu);
    ASSERT_EQ(checkpoints.size(), octaves.size());
    double before = 0;
    for (const Checkpoint& checkpoint : checkpoints) {
        EXPECT_GT(checkpoint.wall_ms, before);
        EXPECT_EQ(checkpoint.device_ms, checkpoint.wall_ms);
        before = checkpoint.wall_ms;
    }
    EXPECT_EQ(checkpoints.back().wall_ms, result.wall_ms);
    EXPECT_EQ(checkpoints.back().cpu_ms, result.cpu_ms);
}

TEST(CheckpointsTest, WithoutACallbackRenderAsWell) {
    const Scene scene = lit_balls();
    RenderRequest request = request_for(scene, Registry::instance().baseline());
    const RenderResult whole = render(scene, request);
    request.checkpoints = octaves;
    EXPECT_EQ(render(scene, request).film.sums(), whole.film.sums());
    // And a callback without checkpoints is not called.
    request.checkpoints = {};
    request.on_checkpoint = [](const Checkpoint&) { FAIL() << "no checkpoint was asked for"; };
    EXPECT_EQ(render(scene, request).film.sums(), whole.film.sums());
}

TEST(CheckpointsTest, ThatDoNotIncreaseOrEndElsewhereAreRefused) {
    const Scene scene = lit_balls();
    const auto refusal = [&](std::vector<std::uint32_t> checkpoints) -> std::string {
        try {
            (void)render_with_checkpoints(scene, request_for(scene, Registry::instance().baseline()), checkpoints);
            return "";
        } catch (const std::logic_error& error) {
            return error.what();
        }
    };
    EXPECT_EQ(refusal({1, 2, 2, 11}), "checkpoints at 1, 2, 2, 11 samples do not increase");
    EXPECT_EQ(refusal({4, 2, 11}), "checkpoints at 4, 2, 11 samples do not increase");
    EXPECT_EQ(refusal({0, 11}), "checkpoints at 0, 11 samples do not increase");
    EXPECT_EQ(refusal({1, 2, 10}), "the last checkpoint is at 10 of the render's 11 samples");
    EXPECT_EQ(refusal({1, 2, 12}), "the last checkpoint is at 12 of the render's 11 samples");
    EXPECT_EQ(refusal({11}), "");
}

// What a callback throws ends the render and comes out as it is; running out of memory there is said in one line.
TEST(CheckpointsTest, ExceptionsOfTheCallbackComeOut) {
    const Scene scene = lit_balls();
    RenderRequest request = request_for(scene, Registry::instance().baseline());
    int calls = 0;
    request.checkpoints = octaves;
    request.on_checkpoint = [&](const Checkpoint&) {
        calls += 1;
        throw std::runtime_error("enough");
    };
    EXPECT_THROW((void)render(scene, request), std::runtime_error);
    EXPECT_EQ(calls, 1);
    request.on_checkpoint = [&](const Checkpoint&) { throw std::bad_alloc(); };
    EXPECT_THROW((void)render(scene, request), MachineError);
    // The next render finds the queue as it needs it.
    request.on_checkpoint = {};
    const RenderResult after = render(scene, request);
    request.checkpoints = {};
    EXPECT_EQ(after.film.sums(), render(scene, request).film.sums());
}

// Sums in single precision begin anew at each stop; those of the others are integers.
TEST(CheckpointsTest, StopsChangeNoFilmButThoseThatSayIt) {
    Scene scene = lit_balls();
    scene.environment = Vec3d(0.1);  // whose sums are rounded
    for (const std::string robustness : {"robust", "naive"}) {
        Variant variant = Registry::instance().baseline();
        variant.set("integrator", "depth_first");
        variant.set("robustness", robustness);
        const RenderRequest request = request_for(scene, variant);
        const bool differs =
            render_with_checkpoints(scene, request, octaves).result.film.hash() != render(scene, request).film.hash();
        EXPECT_EQ(differs, stops_change_film(variant, Backend::cpu)) << robustness;
    }
    Variant by_position = Registry::instance().baseline();
    by_position.set("sampler", "minstd_by_position");
    EXPECT_TRUE(stops_change_film(by_position, Backend::cpu));
}

}  // namespace
}  // namespace pt
