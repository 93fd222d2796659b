// The loop within a CUDA graph: it takes what the paths need and no more, and leaves the film of the unrolled launches.
// Skipped where there is no GPU.
#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "harness/cuda/backend.h"
#include "harness/render/renderer.h"
#include "harness/scene/places.h"
#include "variants/cuda/runtime/graph.h"

namespace pt {
namespace {

class Loop : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string reason = cuda::not_available(); !reason.empty()) {
            GTEST_SKIP() << reason;
        }
    }

    static constexpr std::uint32_t samples = 3;

    static RenderResult rendered(const std::string& scene_name, const std::string& integrator,
                                 const std::string& compaction, const std::string& launch, std::uint32_t depth) {
        const Scene scene = find_scene(scene_name);
        RenderRequest request{.variant = expand({}, Backend::cuda).front(),
                              .backend = Backend::cuda,
                              .settings = default_settings(scene),
                              .samples = samples};
        request.settings.width = request.settings.height = 32;
        request.settings.depth = depth;
        request.variant.set("integrator", integrator);
        request.variant.set("compaction", compaction);
        request.variant.set("launch", launch);
        return render(scene, request);
    }

    static void expect_same_image(const RenderResult& looped, const RenderResult& unrolled) {
        EXPECT_EQ(looped.film.hash(), unrolled.film.hash());
        EXPECT_EQ(looped.work.rays, unrolled.work.rays);
        EXPECT_EQ(looped.work.paths, unrolled.work.paths);
        EXPECT_EQ(unrolled.work.loop_rounds, 0u);
    }
};

constexpr std::pair<const char*, const char*> loops[] = {
    {"wavefront", "gap_fill"},           {"wavefront", "cub_select_flagged"},  {"wavefront", "block_scan_append"},
    {"wavefront_fused", "gap_fill"},     {"wavefront_fused", "cub_select_if"}, {"wavefront_fused", "atomic_append"},
    {"wavefront_fused", "cub_three_way"}};

// In the open box nearly every bounce lets paths escape: 1024 paths are gone long before their 200th segment.
TEST_F(Loop, EndsWithTheLastPath) {
    constexpr std::uint32_t depth = 200;
    for (const auto& [integrator, compaction] : loops) {
        SCOPED_TRACE(std::string(integrator) + " " + compaction);
        const RenderResult looped = rendered("cornell_open", integrator, compaction, "graph_while", depth);
        expect_same_image(looped, rendered("cornell_open", integrator, compaction, "stream", depth));
        EXPECT_GE(looped.work.loop_rounds, samples);
        EXPECT_LT(looped.work.loop_rounds, samples * (depth - 2) / cuda::segments_per_round / 2);
        // The first segment, the rounds, and the one or two segments after them, the last of which is the last
        // possible.
        const std::uint64_t outside = depth - (depth - 2) / cuda::segments_per_round * cuda::segments_per_round;
        EXPECT_EQ(looped.work.bounces, samples * outside + cuda::segments_per_round * looped.work.loop_rounds);
        EXPECT_EQ(looped.work.last_bounces, samples);
    }
}

// In the closed box some path always lives: every round is taken, whether one or two segments follow them.
TEST_F(Loop, TakesEverySegmentWherePathsLive) {
    for (const std::uint32_t depth : {4u, 5u, 8u, 9u}) {
        for (const auto& [integrator, compaction] : loops) {
            SCOPED_TRACE(std::string(integrator) + " " + compaction + ", depth " + std::to_string(depth));
            const RenderResult looped = rendered("cornell_closed", integrator, compaction, "graph_while", depth);
            expect_same_image(looped, rendered("cornell_closed", integrator, compaction, "stream", depth));
            EXPECT_EQ(looped.work.loop_rounds, samples * ((depth - 2) / cuda::segments_per_round));
            EXPECT_EQ(looped.work.bounces, samples * depth);
        }
    }
}

TEST_F(Loop, IsLeftOutWhereThePathsAreTooShort) {
    for (const std::uint32_t depth : {1u, 2u, 3u}) {
        for (const auto& [integrator, compaction] : loops) {
            SCOPED_TRACE(std::string(integrator) + " " + compaction + ", depth " + std::to_string(depth));
            const RenderResult unlooped = rendered("cornell_closed", integrator, compaction, "graph_while", depth);
            expect_same_image(unlooped, rendered("cornell_closed", integrator, compaction, "stream", depth));
            EXPECT_EQ(unlooped.work.loop_rounds, 0u);
            EXPECT_EQ(unlooped.work.bounces, samples * depth);
        }
    }
}

}  // namespace
}  // namespace pt
