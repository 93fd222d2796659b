// The kernels that a shipped scene can ask for compile, for every GPU that ptbench supports. No GPU is needed: NVRTC
// compiles for any. With all its optimisations it takes seconds a program and a minute for one with every feature;
// nearly without (compile_quickly) it refuses the same programs, with the assembler's limits of shared and constant
// memory among the reasons. So a few programs of every source are optimised, as they are for a render (add_optimised),
// and the others are not. Not every combination is tried:
// - sm_90 gets every choice that changes a program, one at a time, with one or two integrators, which change from
// choice
//   to choice, on the scene with every material; the direct lights and the cache, on a scene whose first hits can be
//   cached, likewise; and every stage in every layout and in both precisions.
// - The others together get every scene once, with an integrator and a direct light that change from scene to
//   scene; each gets every second stage in one layout and one specialisation, which change from GPU to GPU. Nothing in
//   the sources depends on the scene and the GPU at once.
// - The scenes of scenes/stability are run with the generic kernels.
// What has compiled is kept in the user's cache folder, so a second run takes seconds, in another clone of the same
// sources too: a program is kept by its text, the sources, the options, and the versions of NVRTC and CCCL.
#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "cccl_version.h"
#include "harness/bench/compile_ahead.h"
#include "harness/bench/suite.h"
#include "harness/cuda/backend.h"
#include "harness/cuda/kernel_request.h"
#include "harness/scene/places.h"
#include "harness/write_file.h"
#include "supported_architectures.h"
#include "tests/support/places.h"
#include "variants/cuda/runtime/nvrtc.h"
#include "variants/cuda/runtime/sources.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view full_architecture = "sm_90";

// Raised by hand where compile_quickly changes what it refuses.
constexpr int checks = 1;

// Beside what ptbench itself keeps; where that cannot be written, in the build folder.
void use_cache_of_tests() {
    static const fs::path folder = [] {
        const fs::path kept = fs::path(cuda::kernel_cache_folder()).parent_path() / "ptbench-compile-test" /
                              fmt::format("cccl-{}-{}", PTBENCH_CCCL_VERSION, checks);
        std::error_code refused;
        fs::create_directories(kept, refused);
        return ::access(kept.c_str(), W_OK) == 0 ? kept : fs::path(test::program_file()).parent_path() / "kernel-cache";
    }();
    ::setenv("XDG_CACHE_HOME", folder.c_str(), 1);
}

Variant baseline_with(const std::map<std::string, std::string>& choices) {
    Variant variant = Registry::instance().baseline(Backend::cuda);
    for (const auto& [axis, choice] : choices) {
        variant.set(axis, choice);
    }
    return variant;
}

std::vector<std::string> choices_of(std::string_view axis) {
    std::vector<std::string> names;
    for (const Choice* choice : Registry::instance().choices(axis, Backend::cuda)) {
        names.emplace_back(choice->descriptor.name);
    }
    return names;
}

// The programs of one GPU, each once.
class Programs {
public:
    struct Program {
        cuda::ModuleRequest request;
        std::string asked_for_by;  // the first of them
        bool is_optimised = false;

        fs::path mark() const {
            return fs::path(cuda::kernel_cache_folder()) / (cuda::module_key(request) + ".checked");
        }
        bool is_compiled() const { return is_optimised ? cuda::is_cached(request) : fs::exists(mark()); }
        void compile() const {
            if (is_optimised) {
                (void)cuda::build_module(request);
                return;
            }
            (void)cuda::compile_quickly(request);
            write_file(mark().string(), "");
        }
    };

    explicit Programs(std::string architecture) : architecture_(std::move(architecture)) {}

    // What is added from here on is optimised; a program that was added before stays as it is.
    void optimise(bool optimises) { optimises_ = optimises; }

    // The integrator's program, if the variant applies to the scene; whether it does.
    bool add(const Scene& scene, const Variant& variant) {
        const bool applies = why_not_applicable(variant, features_of(scene), Backend::cuda).empty();
        if (applies) {
            add(cuda::module_request(scene, variant, architecture_), scene.name + " " + variant.spelled_out());
            for (const std::string_view axis : axis_names) {
                choices_.emplace(axis, variant[axis]);
            }
        }
        return applies;
    }
    void add_stage(const Choice& stage, const Variant& variant) {
        add(cuda::stage_request(variant, stage, architecture_), variant.spelled_out());
    }

    const std::map<std::string, Program>& by_key() const { return programs_; }
    bool has(const std::string& axis, const std::string& choice) const { return choices_.contains({axis, choice}); }

private:
    void add(const cuda::ModuleRequest& request, const std::string& asked_for_by) {
        programs_.try_emplace(cuda::module_key(request), Program{request, asked_for_by, optimises_});
    }

    std::string architecture_;
    bool optimises_ = false;
    std::map<std::string, Program> programs_;
    std::set<std::pair<std::string, std::string>> choices_;  // of integrators' programs, by axis
};

// The scenes whose kernels differ: those with the same features and numbers of objects share them.
std::vector<Scene> scenes_by_program() {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(home_folder() / "scenes")) {
        if (entry.path().extension() == ".json") {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    std::vector<Scene> scenes;
    std::set<std::string> seen;
    for (const fs::path& file : files) {
        const Scene scene = load_scene(file.string());
        if (seen.insert(cuda::module_key(cuda::module_request(scene, baseline_with({}), "sm_90"))).second) {
            scenes.push_back(scene);
        }
    }
    return scenes;
}

// The compactions and sorts that have kernels of their own which NVRTC compiles.
std::vector<const Choice*> stages() {
    std::vector<const Choice*> all;
    for (const char* axis : {"compaction", "sorting"}) {
        for (const Choice* choice : Registry::instance().choices(axis, Backend::cuda)) {
            if (!choice->hook.cuda.kernels.empty()) {
                all.push_back(choice);
            }
        }
    }
    return all;
}

// Every source once, and what else has a memory or a code of its own.
void add_optimised(Programs& programs) {
    programs.optimise(true);
    const Scene five = find_scene("cornell_open_five"), room = find_scene("meshes/icosphere_room");
    for (const std::string& integrator : choices_of("integrator")) {
        programs.add(five, baseline_with({{"integrator", integrator}}));
    }
    ASSERT_EQ(programs.by_key().size(), choices_of("integrator").size());
    for (const std::string& layout : choices_of("layout")) {
        programs.add(five, baseline_with({{"layout", layout}}));
    }
    for (const Choice* stage : stages()) {
        programs.add_stage(*stage, baseline_with({}));
    }
    programs.add(five, baseline_with({{"specialisation", "baked"}, {"arithmetic", "fast"}}));
    programs.add(five, baseline_with({{"precision", "double"}, {"direct_light", "nee_mis"}}));
    for (const std::string& stack : choices_of("traversal_stack")) {
        programs.add(room, baseline_with({{"accelerator", "cwbvh"}, {"traversal_stack", stack}}));
    }
    programs.add(room, baseline_with({{"accelerator", "bvh8"}, {"traversal_stack", "short_restart"}}));
    programs.add(room, baseline_with({{"accelerator", "bvh2"}, {"traversal", "persistent"}}));
    programs.optimise(false);
}

void add_every_choice(Programs& programs) {
    add_optimised(programs);
    const std::vector<std::string> integrators = choices_of("integrator");
    // With every step-th integrator, other ones for the next. Where the choices go with none of those, with the first
    // after them that they go with.
    std::size_t turn = 0;
    const auto add_by_turns = [&](const Scene& scene, std::map<std::string, std::string> choices, std::size_t step) {
        const auto applies_with = [&](std::size_t i) {
            choices["integrator"] = integrators[i % integrators.size()];
            return programs.add(scene, baseline_with(choices));
        };
        bool has_program = false;
        for (std::size_t i = turn % step; i < integrators.size(); i += step) {
            has_program = applies_with(i) || has_program;
        }
        for (std::size_t i = 0; i < integrators.size() && !has_program; ++i) {
            has_program = applies_with(turn + i);
        }
        ++turn;
    };
    using Choices = std::initializer_list<std::pair<const char*, const char*>>;
    const Scene five = find_scene("cornell_open_five");
    for (const auto& [axis, choice] : Choices{{"layout", "soa"},
                                              {"layout", "packed"},
                                              {"arithmetic", "exact"},
                                              {"arithmetic", "fast"},
                                              {"specialisation", "baked"},
                                              {"first_bounce", "cached_jitters"}}) {
        add_by_turns(five, {{axis, choice}}, 6);
    }
    for (const auto& [axis, choice] :
         Choices{{"precision", "double"}, {"precision", "double_intersection"}, {"robustness", "naive"}}) {
        add_by_turns(five, {{axis, choice}}, 6);
    }
    for (const char* everything : {"generic", "matrix"}) {
        add_by_turns(five, {{"specialisation", everything}}, integrators.size());
    }
    for (const char* compaction : {"atomic_append", "block_scan_append"}) {
        programs.add(five, baseline_with({{"integrator", "wavefront_fused"}, {"compaction", compaction}}));
    }
    for (const char* key : {"chunk_material", "material_hit", "ray"}) {
        programs.add(five, baseline_with({{"sorting", "cub_radix"}, {"sort_key", key}}));
    }
    const Scene room = find_scene("meshes/icosphere_room");
    for (const std::string& accelerator : choices_of("accelerator")) {
        add_by_turns(room, {{"accelerator", accelerator}}, 6);
    }
    for (const auto& [axis, choice] : Choices{{"layout", "soa"}, {"layout", "packed"}, {"specialisation", "baked"}}) {
        add_by_turns(room, {{"accelerator", "bvh2"}, {axis, choice}}, 6);
    }
    for (const std::string& levels : choices_of("levels")) {
        for (const char* accelerator : {"bvh2", "cwbvh"}) {
            add_by_turns(room, {{"accelerator", accelerator}, {"levels", levels}}, integrators.size());
        }
        programs.add(room, baseline_with({{"levels", levels},
                                          {"accelerator", "bvh4"},
                                          {"specialisation", "generic"},
                                          {"precision", "double"},
                                          {"integrator", "megakernel"}}));
    }
    add_by_turns(room, {{"specialisation", "generic"}, {"precision", "double"}, {"direct_light", "nee_mis"}}, 6);
    for (const std::string& sampling : choices_of("light_sampling")) {
        add_by_turns(five, {{"light_sampling", sampling}, {"direct_light", "nee_mis"}}, integrators.size());
        add_by_turns(five, {{"light_sampling", sampling}, {"direct_light", "nee"}, {"precision", "double"}},
                     integrators.size());
    }
    add_by_turns(five, {{"direct_light", "nee_one_sample"}, {"light_selection", "light_tree"}}, integrators.size());
    add_by_turns(five, {{"subsurface_sampling", "dwivedi"}}, integrators.size());
    add_by_turns(five, {{"subsurface_sampling", "dwivedi"}, {"precision", "double"}, {"specialisation", "generic"}}, 6);
    for (const std::string& selection : choices_of("light_selection")) {
        add_by_turns(five, {{"light_selection", selection}, {"direct_light", "nee_mis"}}, integrators.size());
        add_by_turns(room, {{"light_selection", selection}, {"direct_light", "nee"}, {"precision", "double"}},
                     integrators.size());
    }
    // Every second of the triples, so that each pair is in some.
    const std::vector<std::string> accelerators = choices_of("accelerator"), traversals = choices_of("traversal"),
                                   stacks = choices_of("traversal_stack");
    for (std::size_t a = 0; a < accelerators.size(); ++a) {
        for (std::size_t t = 0; t < traversals.size(); ++t) {
            for (std::size_t s = (a + t) % 2; s < stacks.size(); s += 2) {
                const std::map<std::string, std::string> choices{
                    {"accelerator", accelerators[a]}, {"traversal", traversals[t]}, {"traversal_stack", stacks[s]}};
                if (traits_of(baseline_with(choices), Backend::cuda).traversal.needs_own_kernel) {
                    programs.add(room, baseline_with(choices));
                } else {
                    add_by_turns(room, choices, integrators.size());
                }
            }
        }
    }
    for (const auto& [axis, choice] : Choices{
             {"precision", "double"}, {"layout", "soa"}, {"first_bounce", "cached"}, {"specialisation", "generic"}}) {
        programs.add(room, baseline_with({{"accelerator", "cwbvh"},
                                          {"traversal", "persistent"},
                                          {"traversal_stack", "shared"},
                                          {axis, choice}}));
    }
    for (const char* const name : {"textures/textures", "textures/roughness_map", "textures/shading_normals"}) {
        for (const auto& [axis, choice] : Choices{{"layout", "soa"},
                                                  {"arithmetic", "exact"},
                                                  {"precision", "double"},
                                                  {"specialisation", "baked"},
                                                  {"direct_light", "nee_mis"}}) {
            add_by_turns(find_scene(name), {{axis, choice}}, 6);
        }
    }
    const Scene still = find_scene("cornell_open_unjittered");
    add_by_turns(still, {{"first_bounce", "cached"}}, 6);
    add_by_turns(still, {{"first_bounce", "cached"}, {"devices", "2"}, {"partition", "tiles"}}, 6);
    add_by_turns(room, {{"accelerator", "cwbvh"}, {"devices", "2"}, {"partition", "tiles"}}, 6);
    add_by_turns(still, {{"direct_light", "final_bounce"}}, 6);
    add_by_turns(still, {{"direct_light", "nee_mis"}, {"russian_roulette", "throughput"}, {"sampler", "sobol_owen"}},
                 4);
    add_by_turns(room, {{"russian_roulette", "adjoint"}}, 6);
    for (const char* integrator : {"megakernel", "persistent"}) {
        programs.add(five, baseline_with({{"integrator", integrator}, {"russian_roulette", "adjoint_splitting"}}));
    }
    ASSERT_GE(stages().size(), 5u);
    for (const Choice* stage : stages()) {
        for (const std::string& layout : choices_of("layout")) {
            programs.add_stage(*stage, baseline_with({{"layout", layout}}));
        }
        programs.add_stage(*stage, baseline_with({{"precision", "double"}}));
    }
}

void add_pairs(Programs& programs, const std::vector<Scene>& scenes, std::size_t turn) {
    const std::vector<std::string> integrators = choices_of("integrator");
    const std::vector<std::string> lights = choices_of("direct_light");
    const std::vector<std::string> specialisations = choices_of("specialisation");
    programs.optimise(true);
    programs.add(scenes.front(), baseline_with({{"integrator", integrators[turn % integrators.size()]}}));
    programs.optimise(false);
    programs.add(scenes.front(), baseline_with({{"integrator", integrators[turn % integrators.size()]},
                                                {"specialisation", specialisations[turn % specialisations.size()]}}));
    for (std::size_t i = turn; i < scenes.size(); i += std::size(supported_architectures) - 1) {
        const std::string& integrator = integrators[(i + 1) % integrators.size()];
        programs.add(scenes[i], baseline_with({{"integrator", integrator},
                                               {"direct_light", lights[(i / integrators.size()) % lights.size()]}}));
    }
    const std::vector<const Choice*> all = stages();
    for (std::size_t i = turn % 2; i < all.size(); i += 2) {
        programs.add_stage(*all[i], baseline_with({}));
    }
}

// No choice that changes an integrator's program is without one.
void expect_every_choice(const Programs& programs) {
    for (const char* const axis :
         {"integrator", "direct_light", "layout", "accelerator", "traversal", "traversal_stack", "levels",
          "light_sampling", "light_selection", "first_bounce", "specialisation", "arithmetic", "precision",
          "robustness", "russian_roulette", "subsurface_sampling"}) {
        for (const std::string& choice : choices_of(axis)) {
            EXPECT_TRUE(programs.has(axis, choice)) << axis << "=" << choice;
        }
    }
}

class CompileTest : public testing::TestWithParam<const char*> {
protected:
    // Everything at once: NVRTC compiles one program at a time in a process, so this is where the time goes.
    static void SetUpTestSuite() {
        ::setenv("PTBENCH_HOME", test::source_folder().c_str(), 1);
        use_cache_of_tests();
        ASSERT_EQ(cuda::nvrtc_missing(), "");
        const std::vector<Scene> scenes = scenes_by_program();
        ASSERT_GE(scenes.size(), 10u);
        std::size_t turn = 0;
        for (const char* architecture : supported_architectures) {
            Programs& programs = all().try_emplace(architecture, architecture).first->second;
            if (architecture == full_architecture) {
                add_every_choice(programs);
                expect_every_choice(programs);
            } else {
                add_pairs(programs, scenes, turn++);
            }
        }
        remove_what_others_left();
        cuda::ProgramsToCompile missing;
        for (const auto& [architecture, programs] : all()) {
            for (const auto& [key, program] : programs.by_key()) {
                if (!program.is_compiled()) {
                    missing.emplace(fmt::format("{} {} {}", architecture, program.request.name, key),
                                    cuda::ProgramToCompile{[&program = program] { program.compile(); },
                                                           std::popcount(program.request.config.features)});
                }
            }
        }
        compile_programs(missing);
    }

    static std::map<std::string, Programs>& all() {
        static std::map<std::string, Programs> programs;
        return programs;
    }

    // Programs of earlier sources would fill the disk. Another clone may be at those of today.
    static void remove_what_others_left() {
        std::set<std::string> names{"include-" + cuda::kernel_source_hash()};
        for (const auto& [architecture, programs] : all()) {
            for (const auto& [key, program] : programs.by_key()) {
                names.insert(key + ".cubin");
                names.insert(program.mark().filename().string());
            }
        }
        std::error_code ignored;
        const fs::file_time_type now = fs::file_time_type::clock::now();
        for (const auto& entry : fs::directory_iterator(cuda::kernel_cache_folder(), ignored)) {
            if (names.contains(entry.path().filename().string())) {
                fs::last_write_time(entry.path(), now, ignored);
            } else if (entry.last_write_time(ignored) < now - std::chrono::hours(24)) {
                fs::remove_all(entry.path(), ignored);
            }
        }
    }
};

// What is not in the cache by now is compiled once more, for the compiler's words.
TEST_P(CompileTest, EveryProgram) {
    const Programs& programs = all().at(GetParam());
    int failures = 0;
    for (const auto& [key, program] : programs.by_key()) {
        if (program.is_compiled()) {
            continue;
        }
        failures += 1;
        if (failures > 3) {
            continue;
        }
        try {
            program.compile();
            EXPECT_TRUE(program.is_compiled()) << program.asked_for_by;
            failures -= 1;  // the process that should have compiled it did not get to it
        } catch (const std::exception& error) {
            ADD_FAILURE() << program.asked_for_by << ": " << error.what();
        }
    }
    EXPECT_EQ(failures, 0) << "of " << programs.by_key().size() << " programs";
    RecordProperty("programs", static_cast<int>(programs.by_key().size()));
    std::printf("%zu programs\n", programs.by_key().size());
}

INSTANTIATE_TEST_SUITE_P(, CompileTest, testing::ValuesIn(supported_architectures),
                         [](const auto& instance) { return std::string(instance.param); });

// Also what only the assembler finds.
TEST(CudaCompileTest, WithoutOptimisationWhatDoesNotCompileIsRefused) {
    if (!cuda::nvrtc_missing().empty()) {
        GTEST_SKIP() << cuda::nvrtc_missing();
    }
    use_cache_of_tests();
    const auto checked = [](const std::string& prelude) {
        cuda::ModuleRequest request;
        request.name = "tests/prelude";
        request.prelude = prelude;
        request.architecture = "sm_90";
        (void)cuda::compile_quickly(request);
    };
    EXPECT_NO_THROW(checked("extern \"C\" __global__ void kernel(float* x) { *x = 1; }\n"));
    for (const char* wrong : {"float f( {",
                              "__device__ float f(float);\n"
                              "extern \"C\" __global__ void kernel(float* x) { *x = f(*x); }\n",
                              "extern \"C\" __global__ void kernel(float* x) { asm(\"none.f32 %0;\" : \"+f\"(*x)); }\n",
                              "extern \"C\" __global__ void kernel(float* x) {\n"
                              "__shared__ float y[12289]; y[threadIdx.x] = *x; __syncthreads(); *x = y[7]; }\n",
                              "__constant__ float c[16385];\n"
                              "extern \"C\" __global__ void kernel(float* x) { *x = c[threadIdx.x]; }\n"}) {
        EXPECT_THROW(checked(wrong), cuda::CompileError) << wrong;
    }
}

// ptxas drops what nothing depends on, whatever the source says: the injected cost must be in the code.
TEST(CudaCompileTest, InjectedCostIsInTheCode) {
    if (!cuda::nvrtc_missing().empty()) {
        GTEST_SKIP() << cuda::nvrtc_missing();
    }
    ::setenv("PTBENCH_HOME", test::source_folder().c_str(), 1);
    use_cache_of_tests();
    const Scene scene = find_scene("cornell_open");
    Variant costly = baseline_with({{"integrator", "megakernel"}});
    const std::size_t without = cuda::compile(scene, costly, "sm_90");
    costly.tuning["shading_fmas"] = 4096;
    const std::size_t with_cost = cuda::compile(scene, costly, "sm_90");
    // Four multiply-adds of the unrolled loop are the least that it can be: 16 bytes each.
    EXPECT_GE(with_cost, without + 4 * 16);
}

}  // namespace
}  // namespace pt
