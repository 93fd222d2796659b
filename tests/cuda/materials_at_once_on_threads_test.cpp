// Kernels of integrator=wavefront_materials that connect nothing, without a GPU: paths that their hit ends are shaded
// at once and go into no queue; and queues of several chunks.
#include "tests/support/block_on_threads.h"

#include "variants/cuda/device/kernel_config.h"

inline constexpr pt::cuda::KernelConfig kernel_config{
    .features = pt::all_features & ~static_cast<pt::FeatureSet>(pt::Feature::next_event), .block = 32};
namespace tuned {
inline constexpr unsigned append_counters = 1, by_material = 1, fetch_at = 8, node_vote = 2;
}  // namespace tuned
namespace host_bytes {
inline constexpr pt::test::SameProgram trace_first, shade_and_trace, advance, intersect_meshes;
}  // namespace host_bytes
#include "tests/support/fetching_program.h"
// After it: they need no more than its names.
#include "variants/integrator/wavefront_materials.cuh"

namespace pt::test {
namespace {
constexpr std::uint32_t samples = 3, width = 17, height = 16;
}  // namespace
}  // namespace pt::test

#include "tests/support/material_queueing.h"

namespace pt::test {
namespace {

TEST(MaterialQueuesWithoutConnections, HoldNoPathThatItsHitEnds) {
    for (const char* name : {"cornell_open_five", "cornell_closed"}) {
        const Outcome outcome = expect_same(find_scene(name), [](RenderSettings&) {});
        EXPECT_EQ(outcome.ended, 0u) << name;
        EXPECT_EQ(outcome.mixed, 0u) << name;
    }
}

TEST(MaterialQueuesWithoutConnections, GoOnInAnotherChunk) {
    const Outcome outcome = expect_same(find_scene("cornell_closed_one"), [](RenderSettings&) {});
    EXPECT_GT(outcome.chunks_used, 1u);
}

}  // namespace
}  // namespace pt::test
