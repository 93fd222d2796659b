// The host side of the CUDA backend as far as it goes without a device.
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/bench/compile_ahead.h"
#include "harness/cuda/backend.h"
#include "harness/cuda/device_scene.h"
#include "harness/cuda/kernel_request.h"
#include "harness/error/reference.h"
#include "harness/failure.h"
#include "harness/machine/run_context.h"
#include "harness/scene/places.h"
#include "harness/stability/evaluate.h"
#include "tests/support/command.h"
#include "tests/support/places.h"
#include "variants/cuda/runtime/arena.h"
#include "variants/cuda/runtime/sources.h"
#include "variants/variant_name.h"

namespace pt {
namespace {

// Before the runtime is first called: no device is seen, so that the outcome is the same with a GPU and without.
class NoDevice : public testing::Environment {
public:
    void SetUp() override {
        ::setenv("CUDA_VISIBLE_DEVICES", "-1", 1);
        ::setenv("PTBENCH_HOME", test::source_folder().c_str(), 1);
        ::setenv("XDG_CACHE_HOME", cache_.path().c_str(), 1);
    }

private:
    test::TemporaryFolder cache_;
};
const testing::Environment* const no_device = testing::AddGlobalTestEnvironment(new NoDevice);

Variant baseline() { return Registry::instance().baseline(Backend::cuda); }

Variant with(const std::string& axis, const std::string& choice) {
    Variant variant = baseline();
    variant.set(axis, choice);
    return variant;
}

std::string render_failure(const std::function<void()>& call) {
    try {
        call();
    } catch (const MachineError& error) {
        return error.what();
    }
    return "no MachineError";
}

// --- the backend is not available
// -------------------------------------------------------------------------------------

TEST(WithoutDeviceTest, SaysWhy) {
    const std::string reason = cuda::not_available();
    EXPECT_FALSE(reason.empty());
    EXPECT_EQ(reason.find('\n'), std::string::npos) << reason;
    EXPECT_EQ(cuda::not_available(), reason);
    EXPECT_FALSE(cuda::context());
}

TEST(WithoutDeviceTest, ARenderFailsWithTheReason) {
    const Scene scene = find_scene("cornell_open");
    RenderRequest request;
    request.variant = baseline();
    request.backend = Backend::cuda;
    request.settings = default_settings(scene);
    const std::string expected = "cuda: not available (" + cuda::not_available() + ")";
    EXPECT_EQ(render_failure([&] { cuda::render(scene, request); }), expected);
    EXPECT_EQ(render_failure([&] { render(scene, request); }), expected);
}

TEST(WithoutDeviceTest, BadCheckpointsAreRefusedBeforeTheDeviceIsLookedFor) {
    const Scene scene = find_scene("cornell_open");
    RenderRequest request;
    request.variant = baseline();
    request.backend = Backend::cuda;
    request.settings = default_settings(scene);
    request.samples = 4;
    request.checkpoints = {1, 2};
    EXPECT_THROW(render(scene, request), std::logic_error);
}

TEST(WithoutDeviceTest, NothingIsCompiledAheadForADeviceThatIsNotThere) {
    const Scene scene = find_scene("cornell_open");
    cuda::ProgramsToCompile programs;
    cuda::collect_programs(scene, baseline(), "", false, programs);
    EXPECT_TRUE(programs.empty());
    compile_ahead({{&scene, baseline()}});
    EXPECT_FALSE(std::filesystem::exists(cuda::kernel_cache_folder()));
}

// --- compiling ahead for a GPU that is elsewhere
// ----------------------------------------------------------------------

TEST(WithoutDeviceTest, CompilesAheadForAnArchitecture) {
    const Scene scene = find_scene("cornell_open");
    const auto missing = [&](const std::string& architecture) {
        cuda::ProgramsToCompile programs;
        cuda::collect_programs(scene, baseline(), architecture, false, programs);
        std::vector<std::string> names;
        for (const auto& [name, compile] : programs) {
            names.push_back(name.substr(0, name.find(' ')));
        }
        return names;
    };
    // The integrators of the variant, of its exact twin and of the reference.
    const Variant reference = Registry::instance().reference(exact_twin(baseline(), Backend::cuda), Backend::cuda);
    std::vector<std::string> expected{cuda::integrator_source(baseline()), cuda::integrator_source(baseline()),
                                      cuda::integrator_source(reference)};
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(missing("sm_86"), expected);
    // The second task needs nothing that the first does not.
    compile_ahead({{&scene, baseline(), "sm_86"}, {&scene, with("launch", "graph"), "sm_86"}});
    EXPECT_EQ(missing("sm_86"), std::vector<std::string>());
    EXPECT_EQ(missing("sm_80"), expected);
}

TEST(WithoutDeviceTest, CompilesAheadWhatAClaimOfAMeanIsHeldTo) {
    const Scene scene = find_scene("cornell_open");
    const Variant variant = with("direct_light", "nee_mis");  // rounds freely, so the twin is held to bits
    const Variant twin = exact_twin(variant, Backend::cuda);
    const Variant reference = reference_on(scene, twin, Backend::cuda);
    const Variant means[] = {variant_of_mean(variant, Backend::cuda), variant_of_mean(reference, Backend::cuda)};
    EXPECT_EQ(shown_name(means[0], Backend::cuda), "wavefront arithmetic=exact");
    EXPECT_EQ(shown_name(means[1], Backend::cuda), "megakernel arithmetic=exact room=0");
    std::set<std::string> expected;
    for (const Variant& needed : {variant, twin, reference, means[0], means[1]}) {
        const cuda::ModuleRequest request = cuda::module_request(scene, needed, "sm_87");
        expected.insert(request.name + " " + cuda::module_key(request));
    }
    cuda::ProgramsToCompile programs;
    cuda::collect_programs(scene, variant, "sm_87", false, programs);
    std::set<std::string> found;
    for (const auto& [name, compile] : programs) {
        found.insert(name);
    }
    EXPECT_EQ(found, expected);
}

TEST(WithoutDeviceTest, AProgramThatFailsLeavesTheOthersAlone) {
    cuda::ProgramsToCompile programs;
    test::TemporaryFolder folder;
    for (int i = 0; i < 8; ++i) {
        programs["program " + std::to_string(i)] = {[&folder, i] {
            if (i % 3 == 0) {
                throw std::runtime_error("does not compile");
            }
            test::write_text(folder.file(std::to_string(i)), "compiled");
        }};
    }
    compile_programs(programs);
    EXPECT_EQ(folder.content(), (std::vector<std::string>{"1", "2", "4", "5", "7"}));
}

// --- what is asked of the compiler
// ------------------------------------------------------------------------------------

bool is_embedded(const std::string& name) {
    const auto sources = cuda::embedded_sources();
    return std::any_of(sources.begin(), sources.end(), [&](const auto& source) { return source.name == name; });
}

TEST(ModuleRequestTest, EveryIntegratorsSourceIsEmbedded) {
    for (const Choice* integrator : Registry::instance().choices("integrator", Backend::cuda)) {
        const Variant variant = with("integrator", std::string(integrator->descriptor.name));
        EXPECT_TRUE(is_embedded(cuda::integrator_source(variant))) << cuda::integrator_source(variant);
    }
    for (const char* header :
         {"kernels/shade.h", "variants/cuda/device/device.cuh", "variants/layout/soa.cuh", "glm/vec3.hpp"}) {
        EXPECT_TRUE(is_embedded(header)) << header;
    }
}

TEST(ModuleRequestTest, HoldsWhatTheVariantAsksFor) {
    const Scene scene = find_scene("cornell_open_five");
    Variant variant = baseline();
    variant.set("layout", "soa");
    variant.set("sort_key", "material_hit");
    variant.set("sorting", "cub_radix");
    variant.set("arithmetic", "exact");
    variant.tuning["block"] = 128;
    variant.tuning["shading_fmas"] = 64;
    const cuda::ModuleRequest request = cuda::module_request(scene, variant, "sm_89");
    // The scene has a subsurface body, so its walks' kernel is part of the program.
    EXPECT_EQ(request.includes,
              (std::vector<std::string>{"variants/integrator/wavefront.cuh", "variants/cuda/device/walk_paths.cuh"}));
    EXPECT_EQ(request.config.features, features_of(scene) | shortcuts_of(scene));
    EXPECT_EQ(request.real, "float");
    EXPECT_EQ(request.layout, "soa");
    EXPECT_EQ(request.sort_key, "material_hit");
    EXPECT_EQ(request.architecture, "sm_89");
    EXPECT_EQ(request.options, std::vector<std::string>{"--fmad=false"});
    EXPECT_EQ(request.config.block, 128u);
    EXPECT_EQ(request.config.shading_fmas, 64u);
    EXPECT_FALSE(request.config.keeps_first_hits);
    variant.tuning["min_blocks"] = 6;
    EXPECT_EQ(cuda::module_request(scene, variant, "sm_89").config.min_blocks, 6u);
    variant.set("precision", "double");
    variant.set("sorting", "none");
    variant.set("sort_key", "material");
    EXPECT_EQ(cuda::module_request(scene, variant, "sm_89").config.min_blocks, 3u);  // registers of twice the size
}

TEST(ModuleRequestTest, HasAPartOnlyWhereItsKernelHasSomethingToDo) {
    using Sources = std::vector<std::string>;
    const Sources alone{"variants/integrator/wavefront.cuh"};
    const Scene walks = find_scene("cornell_open_five"), mesh = find_scene("scenes/meshes/icosphere_room.json");
    const auto sources = [](const Scene& scene, const Variant& variant) {
        return cuda::module_request(scene, variant, "sm_90").includes;
    };
    Variant variant = baseline();
    EXPECT_EQ(sources(find_scene("cornell_open"), variant), alone);
    variant.tuning["walks_apart"] = 0;
    EXPECT_EQ(sources(walks, variant), alone);
    variant.tuning.clear();
    variant.set("accelerator", "cwbvh");
    EXPECT_EQ(sources(mesh, variant), alone);
    variant.set("traversal", "persistent");
    EXPECT_EQ(sources(mesh, variant), (Sources{alone.front(), "variants/integrator/wavefront_fetching.cuh"}));
}

TEST(ModuleRequestTest, CountsAreConstantsWhereTheKernelIsTheScenes) {
    const Scene scene = find_scene("cornell_open_five");
    const SceneBuffers<float> buffers(scene, default_settings(scene));
    const cuda::ModuleRequest own = cuda::module_request(scene, baseline(), "sm_90");
    EXPECT_TRUE(own.config.has_fixed_counts);
    EXPECT_EQ(own.config.counts.spheres, buffers.view().spheres.size);
    EXPECT_EQ(own.config.counts.quads, buffers.view().quads.size);
    EXPECT_EQ(own.config.counts.objects(), object_count(buffers.view()));
    EXPECT_EQ(own.config.counts.walls, buffers.view().enclosure.walls);
    ASSERT_EQ(buffers.view().lights.size, 1u);
    EXPECT_EQ(own.config.counts.one_light, buffers.view().lights[0].object);
    EXPECT_EQ(cuda::module_request(find_scene("many_lights"), baseline(), "sm_90").config.counts.one_light,
              cuda::FixedCounts::none);
    EXPECT_EQ(own.scene, "in_constant");
    const cuda::ModuleRequest generic = cuda::module_request(scene, with("specialisation", "generic"), "sm_90");
    EXPECT_EQ(generic.config.features, all_features);
    EXPECT_FALSE(generic.config.has_fixed_counts);
    EXPECT_EQ(generic.config.counts.one_light, cuda::FixedCounts::none);
    EXPECT_EQ(cuda::module_request(scene, with("specialisation", "baked"), "sm_90").scene, "baked");
}

// The kernel that every verification waits for has what the scene and the estimator need and nothing else, whatever
// the kernel is that is verified.
TEST(ModuleRequestTest, TheReferencesKernelHasNoFeatureForNothing) {
    for (const char* name :
         {"cornell_open", "cornell_open_five", "meshes/icosphere_room", "environments/environment_sky"}) {
        const Scene scene = find_scene(name);
        for (const char* light : {"off", "nee_mis"}) {
            for (const char* specialisation : {"features", "baked", "generic"}) {
                SCOPED_TRACE(fmt::format("{} {} {}", name, light, specialisation));
                Variant variant = with("specialisation", specialisation);
                variant.set("direct_light", light);
                const Variant reference = reference_on(scene, exact_twin(variant, Backend::cuda), Backend::cuda);
                EXPECT_EQ(reference["specialisation"], "features");
                const cuda::KernelConfig config = cuda::module_request(scene, reference, "sm_90").config;
                EXPECT_EQ(config.features, features_of(scene) | features_asked(variant, Backend::cuda));
                EXPECT_EQ(config.features & shortcuts, no_features);
            }
        }
        const cuda::ModuleRequest generic = cuda::module_request(scene, with("specialisation", "generic"), "sm_90");
        EXPECT_TRUE(is_superset(generic.config.features, all_features)) << name;
    }
}

TEST(ModuleRequestTest, ReferencesOfErrorsHaveNoFeatureForNothing) {
    ReferenceTask task;
    task.scene = std::make_shared<const Scene>(find_scene("cornell_open"));
    task.backend = Backend::cuda;
    const Variant variant = reference_variant(task);
    EXPECT_EQ(shown_name(variant, Backend::cuda), "megakernel sampler=philox arithmetic=exact precision=double room=0");
    EXPECT_EQ(cuda::module_request(*task.scene, variant, "sm_90").config.features,
              features_of(*task.scene) | Feature::philox);
}

// Hundreds of scenes are rendered by one kernel.
TEST(ModuleRequestTest, CasesOfStabilityHaveTheKernelWithEveryFeature) {
    const Variant plainest = stability::plainest_variant(Backend::cuda);
    EXPECT_EQ(shown_name(plainest, Backend::cuda), "megakernel specialisation=generic arithmetic=exact");
    EXPECT_EQ(with_every_feature(with("specialisation", "matrix"), Backend::cuda), with("specialisation", "matrix"));
    Variant without_room = baseline();
    without_room.tuning["room"] = 0;
    EXPECT_EQ(with_every_feature(without_room, Backend::cuda), with("specialisation", "generic"));
}

TEST(ModuleRequestTest, ACacheOfFirstHitsIsAnotherKernel) {
    const Scene scene = find_scene("cornell_open_unjittered");
    const cuda::ModuleRequest request = cuda::module_request(scene, with("first_bounce", "cached"), "sm_90");
    EXPECT_TRUE(request.config.keeps_first_hits);
    EXPECT_EQ(request.kernels.back().name, std::string("fill_cache"));
}

TEST(ModuleRequestTest, StagesNeedNeitherFeaturesNorArithmetic) {
    const auto request_of = [](const Variant& variant) {
        return cuda::stage_request(variant, *Registry::instance().find("sorting", "bucket", Backend::cuda), "sm_90");
    };
    const cuda::ModuleRequest request = request_of(baseline());
    EXPECT_EQ(request.includes, std::vector<std::string>{"variants/sorting/bucket.cuh"});
    EXPECT_EQ(request.kernels.size(), 4u);
    EXPECT_EQ(request.config.features, no_features);
    EXPECT_TRUE(request.options.empty());
    EXPECT_EQ(cuda::module_key(request), cuda::module_key(request_of(with("arithmetic", "fast"))));
    EXPECT_NE(cuda::module_key(request), cuda::module_key(request_of(with("layout", "packed"))));
    EXPECT_NE(cuda::module_key(request), cuda::module_key(request_of(with("precision", "double"))));
}

// Padding bytes hold what lay in memory before: in the text, and so in the cache's key, they would change from run to
// run.
TEST(ModuleRequestTest, TheBakedTextHoldsNoPadding) {
    const Scene scene = find_scene("cornell_open");
    const SceneBuffers<double> buffers(scene, default_settings(scene));
    using Enclosure = AxisAlignedEnclosure<double>;
    constexpr std::size_t used = offsetof(Enclosure, open_sides) + sizeof(std::uint32_t);
    static_assert(used < sizeof(Enclosure), "no padding to look at");
    std::set<std::string> texts;
    for (const unsigned char left_over : {0x00, 0x55, 0xff}) {
        SceneView<double> view = buffers.view();
        std::memset(reinterpret_cast<unsigned char*>(&view.enclosure) + used, left_over, sizeof(Enclosure) - used);
        texts.insert(cuda::baked_text(view));
    }
    EXPECT_EQ(texts.size(), 1u);
}

// The configuration as a program reads it is that which the host wrote.
TEST(ModuleRequestTest, AProgramReadsTheConfigurationThatTheHostWrote) {
    cuda::KernelConfig config{.features = 0x8000000000000001ull,
                              .block = 96,
                              .min_blocks = 3,
                              .keeps_first_hits = true,
                              .shading_fmas = 7,
                              .constant_scene_bytes = 64,
                              .has_fixed_counts = true};
    config.counts.quads = 5;
    config.counts.spheres = 2;
    config.counts.walls = 9;
    config.counts.high_sides[2] = 0xffffffffu;
    EXPECT_EQ(cuda::text_of(config),
              "{.features = 9223372036854775809ull, .block = 96u, .min_blocks = 3u, .keeps_first_hits = true, "
              ".shading_fmas = 7u, .constant_scene_bytes = 64u, .has_fixed_counts = true, .counts = {.spheres = 2u, "
              ".ellipsoids = 0u, .axis_boxes = 0u, .oriented_boxes = 0u, .quads = 5u, .meshes = 0u, .walls = 9u, "
              ".lamps = 0u, .open_sides = 0u, .low_sides = {0u, 0u, 0u}, .high_sides = {0u, 0u, 4294967295u}, "
              ".one_light = 4294967295u}}");
}

// What a kernel's parameters are is held by their struct's members (kernel_parameters.h).
struct TwoMembers {
    static constexpr const char* kernel = "two";
    FilmView film;
    const std::uint32_t* count;
};
static_assert(cuda::is_kernel_of<TwoMembers, void(FilmView, const std::uint32_t*)>("two"));
static_assert(!cuda::is_kernel_of<TwoMembers, void(FilmView, const std::uint32_t*)>("tw"));
static_assert(!cuda::is_kernel_of<TwoMembers, void(FilmView, std::uint32_t*)>("two"));
static_assert(!cuda::is_kernel_of<TwoMembers, void(FilmView)>("two"));
static_assert(!cuda::is_kernel_of<TwoMembers, void(const std::uint32_t*, FilmView)>("two"));

// --- memory
// -----------------------------------------------------------------------------------------------------------

TEST(ArenaTest, MeasuresPiecesOn256ByteBorders) {
    cuda::Arena arena;
    EXPECT_TRUE(arena.is_measuring());
    EXPECT_EQ(arena.used(), 0u);
    EXPECT_EQ(arena.take<char>(0), nullptr);
    EXPECT_EQ(arena.used(), 0u);
    EXPECT_EQ(arena.take<char>(1), nullptr);
    EXPECT_EQ(arena.used(), 256u);
    EXPECT_EQ(arena.take<double>(32), nullptr);  // 256 bytes exactly
    EXPECT_EQ(arena.used(), 512u);
    EXPECT_EQ(arena.take<std::uint32_t>(65), nullptr);  // 260 bytes
    EXPECT_EQ(arena.used(), 1024u);
    EXPECT_EQ(arena.take_bytes(std::size_t{1} << 40), nullptr);  // measuring takes nothing
    EXPECT_EQ(arena.used(), 1024u + (std::size_t{1} << 40));
}

TEST(ArenaTest, WithoutADeviceThereIsNoMemory) { EXPECT_THROW(cuda::Arena(1 << 20), cuda::Error); }

TEST(OutOfMemoryTest, SaysHowMuchWasAskedFor) {
    EXPECT_STREQ(cuda::OutOfMemory(std::size_t{3} << 30, std::size_t{1} << 30).what(),
                 "out of device memory: asked for 3072 MiB, free are 1024 MiB");
}

}  // namespace
}  // namespace pt
