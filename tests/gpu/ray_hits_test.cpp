// What rays of a batch meet on the GPU is what they meet on the CPU by brute force, through every accelerator and
// kernel: of batches too that leave lanes of a warp, and whole warps, without a ray. Skipped where there is no GPU.
#include <gtest/gtest.h>

#include "harness/cuda/backend.h"
#include "harness/rays/gpu_batch.h"
#include "harness/rays/ray_sets.h"
#include "harness/rays/ray_study.h"

namespace pt::rays {
namespace {

// 1292 triangles: a sphere in a box.
constexpr const char* small_mesh = "icosphere:3";
constexpr std::uint32_t log2_rays = 12;
constexpr std::size_t batch_sizes[] = {1, 31, 33, 1000, std::size_t{1} << log2_rays};

class RayHitsTest : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string reason = cuda::not_available(); !reason.empty()) {
            GTEST_SKIP() << reason;
        }
    }

    Tree tree_of(const std::string& accelerator, Backend backend, const std::string& builder = "sah_binned") const {
        return make_tree(as_scene_mesh(mesh_, content_hash(mesh_.mesh)), accelerator,
                         accelerator == "brute_force" ? "" : builder, backend);
    }

    const RayMesh mesh_ = mesh_for_rays(small_mesh);
};

// The first `size` rays of each class.
std::vector<RaySet> cut(std::vector<RaySet> sets, std::size_t size) {
    for (RaySet& set : sets) {
        set.rays.resize(size);
    }
    return sets;
}

std::size_t hits_among(const std::vector<Hit>& hits) {
    return static_cast<std::size_t>(
        std::count_if(hits.begin(), hits.end(), [](const Hit& hit) { return hit.primitive != no_primitive; }));
}

TEST_F(RayHitsTest, AreThoseOfTheCpu) {
    const Tree reference_tree = tree_of("brute_force", Backend::cpu);
    const auto reference = make_tracer(reference_tree, Backend::cpu);
    const std::vector<RaySet> all = make_ray_sets(mesh_, *reference, ray_classes(), log2_rays);
    ASSERT_EQ(all.size(), ray_classes().size());
    for (const std::string& accelerator : gpu_accelerators()) {
        const Tree tree = tree_of(accelerator, Backend::cuda);
        const auto tracer = make_tracer(tree, Backend::cuda);
        for (const std::size_t size : batch_sizes) {
            for (const RaySet& set : cut(all, size)) {
                reference->load(set);
                (void)reference->trace(reference->kernels(set).front());
                const std::vector<Hit> expected = reference->hits();
                EXPECT_TRUE(size < 1000 || hits_among(expected) > 0) << set.name;
                tracer->load(set);
                for (const std::string& kernel : tracer->kernels(set)) {
                    (void)tracer->trace(kernel);
                    EXPECT_TRUE(tracer->hits() == expected)
                        << accelerator << " " << kernel << " " << set.name << " " << size;
                }
            }
        }
    }
}

// Trees that the GPU builds: each primitive in one leaf, and the same tree every time.
TEST_F(RayHitsTest, AreThoseOfTheCpuThroughTreesOfTheGpu) {
    const Tree reference_tree = tree_of("brute_force", Backend::cpu);
    const auto reference = make_tracer(reference_tree, Backend::cpu);
    const std::vector<RaySet> sets = make_ray_sets(mesh_, *reference, ray_classes(), log2_rays);
    for (const char* builder : {"hploc", "lbvh_gpu"}) {
        for (const char* accelerator : {"bvh2", "bvh8", "cwbvh"}) {
            const Tree tree = tree_of(accelerator, Backend::cuda, builder);
            EXPECT_EQ(tree.geometry.tree->leaves.size(), mesh_.triangles.size());
            EXPECT_GT(tree.geometry.tree->sah_cost, 0);
            const auto tracer = make_tracer(tree, Backend::cuda);
            for (const RaySet& set : sets) {
                reference->load(set);
                (void)reference->trace(reference->kernels(set).front());
                tracer->load(set);
                (void)tracer->trace("plain");
                EXPECT_TRUE(tracer->hits() == reference->hits()) << builder << " " << accelerator << " " << set.name;
            }
        }
        const DeviceBuild build = time_device_build(builder, mesh_.triangles, 3);
        EXPECT_EQ(build.build_ms.size(), 3u);
        EXPECT_TRUE(build.same_every_time) << builder;
    }
    EXPECT_TRUE(time_device_build("sah_binned", mesh_.triangles, 3).build_ms.empty());
}

TEST_F(RayHitsTest, AreFoundByTheWorkOfTheCpu) {
    const Tree reference_tree = tree_of("brute_force", Backend::cpu);
    const auto reference = make_tracer(reference_tree, Backend::cpu);
    const std::vector<RaySet> sets = make_ray_sets(mesh_, *reference, ray_classes(), log2_rays);
    for (const std::string& accelerator : gpu_accelerators()) {
        const Tree here = tree_of(accelerator, Backend::cpu), there = tree_of(accelerator, Backend::cuda);
        const auto on_cpu = make_tracer(here, Backend::cpu), on_gpu = make_tracer(there, Backend::cuda);
        for (const RaySet& set : sets) {
            on_cpu->load(set);
            on_gpu->load(set);
            const Work expected = on_cpu->count().value(), found = on_gpu->count().value();
            EXPECT_EQ(found.nodes, expected.nodes) << accelerator << " " << set.name;
            EXPECT_EQ(found.boxes, expected.boxes) << accelerator << " " << set.name;
            EXPECT_EQ(found.triangles, expected.triangles) << accelerator << " " << set.name;
        }
    }
}

// Every kernel there is is among those that are held to the CPU.
TEST_F(RayHitsTest, KernelsOfCwbvhAreThree) {
    const Tree tree = tree_of("cwbvh", Backend::cuda);
    EXPECT_EQ(make_tracer(tree, Backend::cuda)->kernels({"primary", false, {}}),
              (std::vector<std::string>{"persistent", "persistent_no_vote", "plain"}));
}

}  // namespace
}  // namespace pt::rays
