// integrator=wavefront_materials without a GPU: its kernels, a thread a lane (tests/support/block_on_threads.h), leave
// the film of depth_first, bit for bit. What is tested is that each path is in one queue once, in one of its kind, also
// paths that their hit ends; and that rays which enter meshes are taken through them in between.
#include "tests/support/block_on_threads.h"

#include "variants/cuda/device/kernel_config.h"

inline constexpr pt::cuda::KernelConfig kernel_config{
    .features = pt::all_features | static_cast<pt::FeatureSet>(pt::Feature::mesh), .block = 64};
namespace tuned {
inline constexpr unsigned append_counters = 2, by_material = 1, fetch_at = 8, node_vote = 2;
}  // namespace tuned
namespace host_bytes {
inline constexpr pt::test::SameProgram trace_first, shade_and_trace, advance, intersect_meshes;
}  // namespace host_bytes
#include "tests/support/fetching_program.h"
// After it: they need no more than its names.
#include "variants/integrator/wavefront_materials.cuh"

namespace pt::test {
namespace {
constexpr std::uint32_t samples = 3, width = 11, height = 7;
}  // namespace
}  // namespace pt::test

#include "tests/support/material_queueing.h"

namespace pt::test {
namespace {

TEST(MaterialQueues, LeaveTheSameFilm) {
    const Outcome outcome = expect_same(find_scene("cornell_closed_five"), [](RenderSettings&) {});
    EXPECT_EQ(outcome.through_meshes, 0u);
    EXPECT_EQ(outcome.mixed, 0u);
    EXPECT_GT(outcome.ended, 100u);
    expect_same(find_scene("cornell_open_five"), [](RenderSettings& settings) { settings.depth = 1; });
}

TEST(MaterialQueues, ConnectPathsAndWeighLightsThatTheyHit) {
    const Outcome outcome = expect_same(find_scene("cornell_open_five"), [](RenderSettings& settings) {
        settings.next_event = true;
        settings.mis_exponent = 1;
        settings.roulette_start = 2;
    });
    EXPECT_EQ(outcome.mixed, 0u);
}

TEST(MaterialQueues, WaitForRaysThatGoThroughMeshes) {
    const Outcome outcome = expect_same(find_scene("scenes/meshes/icosphere_room.json"), [](RenderSettings&) {});
    EXPECT_GT(outcome.through_meshes, 100u);
}

}  // namespace
}  // namespace pt::test
