// What leaves a mesh on the GPU is what leaves it on the CPU, ray for ray: none of a closed one, and of one with a hole
// the same through every kernel. Skipped where there is no GPU.
#include <gtest/gtest.h>

#include "harness/cuda/backend.h"
#include "harness/rays/leak_study.h"

namespace pt::rays {
namespace {

constexpr std::uint32_t count = 1u << 18;

class LeakCountsTest : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string reason = cuda::not_available(); !reason.empty()) {
            GTEST_SKIP() << reason;
        }
    }
};

// The leaks of each class, and the ray that leaks first, by kernel.
std::map<std::string, std::vector<std::uint64_t>> leaks_on(Backend backend, const std::string& accelerator,
                                                           const RayMesh& traced, const LeakSource& source) {
    const Tree tree = make_tree(as_scene_mesh(traced, content_hash(traced.mesh)), accelerator, "sah_binned", backend);
    const auto tracer = make_tracer(tree, backend);
    tracer->take_leak_source(source);
    tracer->make_leak_rays(5, count);
    std::map<std::string, std::vector<std::uint64_t>> leaks;
    for (const std::string& kernel : tracer->kernels({"leaks", false, {}})) {
        (void)tracer->trace(kernel);
        const LeakCounts counts = tracer->leaks();
        leaks[kernel].assign(counts.leaks, counts.leaks + leak_class_count);
        leaks[kernel].insert(leaks[kernel].end(), counts.rays, counts.rays + leak_class_count);
        const std::vector<Hit> hits = tracer->hits();
        const auto first =
            std::find_if(hits.begin(), hits.end(), [](const Hit& h) { return h.primitive == no_primitive; });
        leaks[kernel].push_back(static_cast<std::uint64_t>(first - hits.begin()));
    }
    return leaks;
}

TEST_F(LeakCountsTest, AreThoseOfTheCpu) {
    const RayMesh closed = closed_mesh_for_rays("grid_sphere:32");
    const LeakSource source = leak_source(closed, 16, 3);
    RayMesh open = closed;
    open.mesh.triangles.erase(open.mesh.triangles.begin(), open.mesh.triangles.begin() + 100);
    open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 100);
    for (const char* accelerator : {"bvh2", "bvh4", "bvh8", "cwbvh"}) {
        for (const RayMesh* traced : std::initializer_list<const RayMesh*>{&closed, &open}) {
            const auto expected = leaks_on(Backend::cpu, accelerator, *traced, source).at("meet");
            EXPECT_EQ(expected[0] > 0, traced == &open) << accelerator;
            for (const auto& [kernel, found] : leaks_on(Backend::cuda, accelerator, *traced, source)) {
                EXPECT_EQ(found, expected) << accelerator << " " << kernel;
            }
        }
    }
}

}  // namespace
}  // namespace pt::rays
