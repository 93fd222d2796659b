// The gate in front of the clock, on a GPU: integrators that are broken on purpose must not pass it, sound ones must,
// and a cell that does not fit into memory fails by itself. Skipped where there is no GPU.
#include <span>

#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "harness/bench/verify.h"
#include "harness/cuda/backend.h"
#include "harness/failure.h"
#include "harness/scene/places.h"
#include "variants/cuda/megakernels.h"
#define PT_PARAMETERS  // of its kernel alone
#include "variants/integrator/megakernel.cuh"

namespace pt {
namespace {

// The megakernel's code, launched wrongly.
template <class Real>
class BrokenMegakernel : public cuda::Integrator {
public:
    BrokenMegakernel(cuda::JobOf<Real>& job, const cuda::IntegratorNeeds&) : job_(job) {}
    static std::vector<cuda::KernelSignature> kernels() {
        return {cuda::kernel_of<cuda::MegakernelParameters<Real>>()};
    }

protected:
    void launch(std::uint32_t threads, std::uint32_t samples) {
        constexpr std::uint32_t stride = 1;
        job_.launch(threads, cuda::MegakernelParameters<Real>{job_.scene, job_.film, job_.first_sample, samples, stride,
                                                              job_.cache, job_.totals, job_.lengths()});
    }

    cuda::JobOf<Real>& job_;
};

template <class Real>
struct LaunchesNothing final : BrokenMegakernel<Real> {
    using BrokenMegakernel<Real>::BrokenMegakernel;
    void render() override { this->job_.work.launches += 1; }
};
template <class Real>
struct LeavesOutTheLastRows final : BrokenMegakernel<Real> {
    using BrokenMegakernel<Real>::BrokenMegakernel;
    void render() override { this->launch(this->job_.pixels * 3 / 4, this->job_.samples); }
};
template <class Real>
struct TakesASampleTwice final : BrokenMegakernel<Real> {
    using BrokenMegakernel<Real>::BrokenMegakernel;
    void render() override {
        this->launch(this->job_.pixels, this->job_.samples);
        this->launch(this->job_.pixels, 1);
    }
};
// A broken integrator that traces as many paths as there should be, but one sample twice.
template <class Real>
struct RepeatsASample final : BrokenMegakernel<Real> {
    using BrokenMegakernel<Real>::BrokenMegakernel;
    void render() override {
        for (std::uint32_t i = 0; i < this->job_.samples; ++i) {
            this->launch(this->job_.pixels, 1);
        }
    }
};

Registration broken(std::string_view name, cuda::IntegratorHook hook) {
    hook.source = "variants/integrator/megakernel.cuh";
    return {{.axis = "integrator",
             .name = name,
             .summary = "broken on purpose",
             .origin = "tests",
             .backends = on_cuda,
             .tunables = cuda::megakernel_tunables},
            {.cuda = {.integrator = hook}}};
}

const Registration registrations[] = {
    broken("test_null", cuda::integrator_hook<LaunchesNothing>()),
    broken("test_truncated", cuda::integrator_hook<LeavesOutTheLastRows>()),
    broken("test_twice", cuda::integrator_hook<TakesASampleTwice>()),
    broken("test_repeated", cuda::integrator_hook<RepeatsASample>()),
};

Scene stability_scene(const std::string& name) {
    return find_scene((home_folder() / "scenes" / "stability" / (name + ".json")).string());
}

// A scene, and what a queue that renders it is made of.
using AxisChoice = std::pair<const char*, const char*>;
using QueueCase = std::pair<const char*, std::vector<AxisChoice>>;

class Gate : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string reason = cuda::not_available(); !reason.empty()) {
            GTEST_SKIP() << reason;
        }
    }

    static Verdict verdict(const std::string& integrator) {
        const Scene scene = find_scene("cornell_open");
        Verifier verifier(scene, settings_of(scene, 32, 32), 2, Backend::cuda);
        return verifier.check(exact_variant(integrator));
    }
    static RenderSettings settings_of(const Scene& scene, std::uint32_t width, std::uint32_t height) {
        RenderSettings settings = default_settings(scene);
        settings.width = width;
        settings.height = height;
        settings.seed = 1;
        return settings;
    }
    static Variant exact_variant(const std::string& integrator) {
        Variant variant = expand({}, Backend::cuda).front();
        variant.set("arithmetic", "exact");
        variant.set("integrator", integrator);
        return variant;
    }
    static void expect_queues_pass(std::span<const QueueCase> cases, const AxisChoice& of_all,
                                   const std::pair<const char*, std::uint32_t>& tunable) {
        for (const auto& [name, choices] : cases) {
            const Scene scene = find_scene(name);
            Variant variant = exact_variant("wavefront");
            variant.set(of_all.first, of_all.second);
            for (const auto& [axis, choice] : choices) {
                variant.set(axis, choice);
            }
            variant.tuning[tunable.first] = tunable.second;
            ASSERT_EQ(why_not_applicable(variant, features_of(scene), Backend::cuda), "");
            const Verdict sound = Verifier(scene, settings_of(scene, 40, 33), 3, Backend::cuda).check(variant);
            EXPECT_TRUE(sound.holds) << variant.spelled_out() << ": " << sound.message;
        }
    }
};

TEST_F(Gate, PassesASoundIntegrator) {
    for (const char* integrator : {"megakernel", "megakernel_regen", "persistent", "regroup", "wavefront",
                                   "wavefront_fused", "wavefront_materials", "wavefront_refill"}) {
        const Verdict sound = verdict(integrator);
        EXPECT_TRUE(sound.holds) << sound.message;
        EXPECT_NE(sound.message.find("the CPU's"), std::string::npos) << sound.message;
    }
}

// Warps whose lanes take waiting paths at the first and at the last moment, and those of blocks so large that no paths
// can wait in their shared memory (variants/cuda/device/warp_items.cuh).
TEST_F(Gate, PassesWarpsWhateverTheirPathsWaitFor) {
    const Scene scene = find_scene("cornell_open_five");
    Verifier verifier(scene, settings_of(scene, 40, 33), 3, Backend::cuda);  // pixels: no whole number of strips
    const std::pair<const char*, std::uint32_t> tunings[] = {
        {"regenerate_at", 0}, {"regenerate_at", 31}, {"block", 1024}};
    for (const char* integrator : {"megakernel_regen", "persistent"}) {
        for (const auto& [tunable, value] : tunings) {
            Variant variant = exact_variant(integrator);
            variant.tuning[tunable] = value;
            const Verdict sound = verifier.check(variant);
            EXPECT_TRUE(sound.holds) << integrator << ' ' << tunable << '=' << value << ": " << sound.message;
        }
    }
}

// Queues of several chunks each, of blocks that append to one counter and to several, and one queue for all materials.
TEST_F(Gate, PassesQueuesByMaterialHoweverPathsAreAppended) {
    const Scene scene = find_scene("cornell_open_five");
    Verifier verifier(scene, settings_of(scene, 120, 99), 5, Backend::cuda);  // pixels: no whole number of blocks
    for (const char* direct_light : {"off", "nee_mis"}) {
        for (const std::uint32_t counters : {1u, 4u}) {
            for (const std::uint32_t by_material : {0u, 1u}) {
                Variant variant = exact_variant("wavefront_materials");
                variant.set("direct_light", direct_light);
                variant.tuning["append_counters"] = counters;
                variant.tuning["by_material"] = by_material;
                variant.tuning["block"] = 64;
                variant.tuning["spp_in_flight"] = 2;
                const Verdict sound = verifier.check(variant);
                EXPECT_TRUE(sound.holds) << direct_light << ' ' << counters << ' ' << by_material << ": "
                                         << sound.message;
            }
        }
    }
}

// Rays that warps which fetch take through meshes before their paths are shaded, of one batch and of several.
TEST_F(Gate, PassesQueuesByMaterialWhoseRaysGoThroughMeshes) {
    const Scene scene = find_scene("scenes/meshes/icosphere_room.json");
    Verifier verifier(scene, settings_of(scene, 120, 99), 5, Backend::cuda);
    for (const std::uint32_t in_flight : {1u, 4u}) {
        Variant variant = exact_variant("wavefront_materials");
        variant.set("accelerator", "cwbvh");
        variant.set("traversal", "persistent");
        variant.set("layout", "packed");
        variant.tuning["spp_in_flight"] = in_flight;
        const Verdict sound = verifier.check(variant);
        EXPECT_TRUE(sound.holds) << in_flight << ": " << sound.message;
    }
}

// Slots that are refilled at once, now and then, and so late that every path has ended.
TEST_F(Gate, PassesQueuesWheneverTheyAreRefilled) {
    const Scene scene = find_scene("cornell_open_five");
    Verifier verifier(scene, settings_of(scene, 40, 33), 5, Backend::cuda);  // pixels: no whole number of blocks
    for (const char* sorting : {"none", "per_material_queue"}) {
        for (const std::uint32_t rounds : {1u, 3u, 64u}) {
            Variant variant = exact_variant("wavefront_refill");
            variant.set("sorting", sorting);
            variant.tuning["refill_every"] = rounds;
            variant.tuning["spp_in_flight"] = 2;
            const Verdict sound = verifier.check(variant);
            EXPECT_TRUE(sound.holds) << sorting << " refill_every=" << rounds << ": " << sound.message;
        }
    }
}

// Keys by chunk, of a queue that has several chunks, the last one shorter; from a thread a path and from fetching
// warps.
TEST_F(Gate, PassesSortsWithinChunksOfTheQueue) {
    const QueueCase cases[] = {
        {"cornell_open_five", {{"compaction", "none"}, {"sorting", "bucket"}}},
        {"cornell_open_five", {{"compaction", "block_scan_append"}, {"sorting", "bucket"}}},
        {"cornell_open_five", {{"compaction", "block_scan_append"}, {"sorting", "cub_radix"}}},
        {"cornell_open_five", {{"compaction", "gap_fill"}, {"sorting", "cub_radix_full"}}},
        {"cornell_open_five", {{"compaction", "thrust_partition"}, {"sorting", "thrust_sort_by_key"}}},
        {"meshes/icosphere_room", {{"sorting", "bucket"}, {"accelerator", "bvh2"}, {"traversal", "persistent"}}},
    };
    expect_queues_pass(cases, {"sort_key", "chunk_material"}, {"chunk", 256});
}

// Paths and hits that a sort moves: by each layout, after lists of slot numbers and after moved paths, in a loop of a
// graph, and where paths carry a triangle or go on walks.
TEST_F(Gate, PassesSortsThatMovePaths) {
    const QueueCase cases[] = {
        {"cornell_open_five", {{"compaction", "none"}}},
        {"cornell_open_five", {{"compaction", "block_scan_append"}, {"layout", "soa"}}},
        {"cornell_open_five", {{"compaction", "block_scan_append"}, {"layout", "packed"}, {"launch", "graph_while"}}},
        {"cornell_open_five", {{"compaction", "thrust_partition"}, {"layout", "packed"}}},
        {"materials/cornell_open_walks", {{"compaction", "cub_select_if"}, {"layout", "packed"}}},
        {"meshes/icosphere_room", {{"accelerator", "cwbvh"}, {"direct_light", "nee_mis"}, {"layout", "packed"}}},
    };
    expect_queues_pass(cases, {"sorting", "bucket"}, {"sort_payload", 1});
}

// The reference has the features of its scene alone; the kernel with every feature has other code and the same film.
TEST_F(Gate, TheKernelWithEveryFeatureLeavesTheReferencesFilm) {
    for (const char* name : {"cornell_open_five", "environments/environment_sky", "meshes/icosphere_room"}) {
        const Scene scene = find_scene(name);
        RenderSettings settings = default_settings(scene);
        settings.width = settings.height = 32;
        settings.seed = 1;
        Variant variant = expand({}, Backend::cuda).front();
        variant.set("integrator", "megakernel");
        variant.set("specialisation", "generic");
        variant.set("arithmetic", "exact");
        const Verdict sound = Verifier(scene, settings, 2, Backend::cuda).check(variant);
        EXPECT_TRUE(sound.holds) << name << ": " << sound.message;
        EXPECT_EQ(sound.message, "film bits equal to megakernel arithmetic=exact room=0 and to the CPU's") << name;
    }
}

// The device's double kernels round as the CPU's do: what references are made by is the same on both.
TEST_F(Gate, DoublePrecisionHasTheCpusBits) {
    const std::pair<const char*, Scene> cases[] = {{"cornell_open", find_scene("cornell_open")},
                                                   {"cornell_closed_five", find_scene("cornell_closed_five")},
                                                   {"subsurface_box_on", find_scene("subsurface_box_on")},
                                                   {"motion_on", find_scene("motion_on")},
                                                   {"near_sphere", stability_scene("ground_view")}};
    for (const auto& [name, scene] : cases) {
        RenderRequest request{
            .variant = expand({}, Backend::cpu).front(), .settings = default_settings(scene), .samples = 4};
        request.settings.width = request.settings.height = 32;
        request.settings.seed = 1;
        request.variant.set("integrator", "depth_first");
        request.variant.set("specialisation", "generic");
        request.variant.set("precision", "double");
        const std::string expected = render(scene, request).film.hash();
        request.backend = Backend::cuda;
        for (const auto& [integrator, specialisation] :
             {std::pair{"megakernel", "generic"}, {"megakernel", "features"}, {"wavefront", "generic"}}) {
            request.variant = expand({}, Backend::cuda).front();
            request.variant.set("integrator", integrator);
            request.variant.set("specialisation", specialisation);
            request.variant.set("arithmetic", "exact");
            request.variant.set("precision", "double");
            ASSERT_EQ(why_not_applicable(request.variant, features_of(scene), Backend::cuda), "");
            EXPECT_EQ(render(scene, request).film.hash(), expected)
                << name << " " << integrator << " " << specialisation;
        }
    }
}

// A depth of 10^6 where a path has four segments or so: a wavefront without a read-back asks whether any lives.
TEST_F(Gate, WavefrontsEndWithTheirPathsNotWithTheDepth) {
    const Scene scene = stability_scene("absorbing_ball");
    RenderRequest request{.variant = expand({}, Backend::cuda).front(),
                          .backend = Backend::cuda,
                          .settings = default_settings(scene),
                          .samples = 3};
    request.variant.set("arithmetic", "exact");
    request.variant.set("integrator", "megakernel");
    const RenderResult expected = render(scene, request);
    ASSERT_GE(request.settings.depth, 100000u);
    const std::pair<const char*, const char*> queues[] = {{"wavefront", "none"},
                                                          {"wavefront", "cub_select_if"},
                                                          {"wavefront_fused", "none"},
                                                          {"wavefront_fused", "cub_select_if"},
                                                          {"wavefront_materials", "none"}};
    for (const auto& [integrator, compaction] : queues) {
        request.variant.set("integrator", integrator);
        request.variant.set("compaction", compaction);
        const RenderResult result = render(scene, request);
        EXPECT_EQ(result.film.hash(), expected.film.hash()) << integrator << " " << compaction;
        EXPECT_EQ(result.work.paths, expected.work.paths);
        EXPECT_EQ(result.work.rays, expected.work.rays);
        EXPECT_LE(result.work.bounces, 3u * 1024) << integrator << " " << compaction;
        EXPECT_GE(result.work.host_waits, 3u);
    }
    // The rounds of wavefront_refill are those of all samples together.
    request.variant.set("integrator", "wavefront_refill");
    request.variant.set("compaction", "none");
    const RenderResult refilled = render(scene, request);
    EXPECT_EQ(refilled.film.hash(), expected.film.hash());
    EXPECT_EQ(refilled.work.paths, expected.work.paths);
    EXPECT_EQ(refilled.work.rays, expected.work.rays);
    EXPECT_LE(refilled.work.bounces, 3u * 1024);
    EXPECT_GE(refilled.work.host_waits, 1u);
}

// Where the host reads the count back it need not ask, and paths that all live on must not be taken for ended.
TEST_F(Gate, AReadBackOfLongPathsTakesThemAllToTheirEnd) {
    const Scene scene = stability_scene("furnace_sphere");
    RenderRequest request{
        .variant = expand({}, Backend::cuda).front(), .backend = Backend::cuda, .settings = default_settings(scene)};
    request.settings.width = request.settings.height = 16;
    request.settings.depth = 5000;
    request.variant.set("arithmetic", "exact");
    request.variant.set("compaction", "cub_select_if");
    request.variant.tuning["read_back"] = 1;
    for (const char* integrator : {"wavefront", "wavefront_fused"}) {
        request.variant.set("integrator", integrator);
        EXPECT_EQ(render(scene, request).work.rays, 256u * 5000) << integrator;
    }
}

// Threads that count more than their block can add up do so in between.
TEST_F(Gate, PersistentThreadsCountWhatDoesNotFitIntoABlocksSum) {
    const Scene scene = stability_scene("furnace_sphere");
    RenderRequest request{.variant = expand({}, Backend::cuda).front(),
                          .backend = Backend::cuda,
                          .settings = default_settings(scene),
                          .samples = 48};
    request.settings.width = request.settings.height = 16;
    request.settings.depth = 1u << 17;
    request.variant.set("integrator", "persistent");
    request.variant.tuning["piece"] = 48;
    const std::uint64_t rays_a_thread = 48ull * request.settings.depth;
    ASSERT_GT(rays_a_thread, cuda::few_rays);
    const RenderResult result = render(scene, request);
    EXPECT_EQ(result.work.rays, 256 * rays_a_thread);
    EXPECT_EQ(result.work.paths, 256u * 48);
}

TEST_F(Gate, RefusesAKernelThatDoesNothing) {
    const Verdict nothing = verdict("test_null");
    EXPECT_FALSE(nothing.holds);
    EXPECT_NE(nothing.message.find("0 paths"), std::string::npos) << nothing.message;
}

TEST_F(Gate, RefusesATruncatedImage) {
    const Verdict truncated = verdict("test_truncated");
    EXPECT_FALSE(truncated.holds);
    EXPECT_NE(truncated.message.find("1536 paths for 1024 pixels of 2 samples"), std::string::npos)
        << truncated.message;
}

TEST_F(Gate, RefusesADoubledSample) {
    const Verdict twice = verdict("test_twice");
    EXPECT_FALSE(twice.holds);
    EXPECT_NE(twice.message.find("3072 paths"), std::string::npos) << twice.message;
    const Verdict repeated = verdict("test_repeated");  // the count is right, only the film tells
    EXPECT_FALSE(repeated.holds);
    EXPECT_NE(repeated.message.find("film differs"), std::string::npos) << repeated.message;
}

// A package's gpu_tests lets nothing run beside a suite of such a name: this one takes all of a GPU's memory.
using GateAlone = Gate;

TEST_F(GateAlone, OutOfMemoryNamesTheSizeAndLeavesTheDeviceUsable) {
    const Scene scene = find_scene("cornell_open");
    RenderRequest request{.variant = expand({}, Backend::cuda).front(),
                          .backend = Backend::cuda,
                          .settings = default_settings(scene),
                          .samples = 2};
    request.variant.set("integrator", "wavefront");
    std::size_t free_before = 0, free_after = 0, total = 0;
    PT_CUDA_CHECK(cudaMemGetInfo(&free_before, &total));
    // More paths in flight than memory holds: as many samples a pixel as it takes, up to the tunable's limit.
    request.settings.width = request.settings.height = 4096;
    request.samples = static_cast<std::uint32_t>(total / (std::size_t{4096} * 4096 * 80)) + 1;
    if (std::uint64_t{4096} * 4096 * request.samples > 0x7fffffffu) {
        request.settings.width = request.settings.height = 2048;
    }
    request.variant.tuning["spp_in_flight"] = std::min(256u, request.samples);
    try {
        (void)render(scene, request);
        GTEST_SKIP() << "this GPU's memory holds " << request.samples << " samples of every pixel";
    } catch (const MachineError& error) {
        EXPECT_NE(std::string(error.what()).find("out of device memory: asked for"), std::string::npos) << error.what();
    }
    PT_CUDA_CHECK(cudaMemGetInfo(&free_after, &total));
    EXPECT_NEAR(static_cast<double>(free_after), static_cast<double>(free_before), 64.0 * (1 << 20));
    EXPECT_TRUE(verdict("wavefront").holds);
}

}  // namespace
}  // namespace pt
