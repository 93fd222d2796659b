// What `ptbench inspect` says of kernels: the compiler's words, the machine code by pipe, the occupancy. No GPU is
// needed.
#include "harness/cuda/inspect.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include <cuda_occupancy.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <CLI/CLI.hpp>

#include "harness/cli/commands.h"
#include "harness/cuda/sass.h"
#include "harness/failure.h"
#include "harness/scene/places.h"
#include "tests/support/command.h"
#include "tests/support/places.h"
#include "variants/cuda/append_compaction.h"
#include "variants/cuda/runtime/compiler_report.h"
#include "variants/cuda/runtime/nvrtc.h"
#include "variants/registry.h"

namespace pt {
namespace {

using Json = nlohmann::ordered_json;

// The message of an Error; empty: none was thrown.
template <class Error, class Call>
std::string refusal(Call call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

// --- occupancy
// --------------------------------------------------------------------------------------------------------

struct OccupancyCase {
    const char* architecture;
    int registers, shared_bytes, threads;  // given
    int blocks, warps, most_warps;
    const char* limit;
};

TEST(OccupancyTest, AsComputedByHand) {
    const OccupancyCase cases[] = {
        // A partition has 16384 registers and a warp takes 56 * 32: 9 warps, 36 in all, 9 blocks of 4.
        {"sm_90", 56, 20, 128, 9, 36, 64, "registers"},
        {"sm_90", 127, 20, 128, 4, 16, 64, "registers"},
        // 33 registers a thread are given as 40: 12 warps a partition, 48 in all.
        {"sm_90", 33, 20, 64, 24, 48, 64, "registers"},
        {"sm_90", 32, 20, 256, 8, 64, 64, "warps"},
        // 100 threads fill 4 warps, not 3 and a bit.
        {"sm_90", 16, 0, 100, 16, 64, 64, "warps"},
        // 40000 + 1024 bytes in steps of 128 are 41088: 5 in 233472.
        {"sm_90", 32, 40000, 128, 5, 20, 64, "shared memory"},
        {"sm_90", 32, 20, 32, 32, 32, 64, "blocks"},
        // Half the warps of an sm_90, as many registers: these limit no more.
        {"sm_75", 56, 20, 128, 8, 32, 32, "warps"},
        {"sm_75", 32, 16384, 128, 4, 16, 32, "shared memory"},
        {"sm_75", 32, 0, 32, 16, 16, 32, "blocks"},
        {"sm_86", 40, 0, 256, 6, 48, 48, "warps"},
        {"sm_89", 16, 0, 32, 24, 24, 48, "blocks"},
    };
    for (const OccupancyCase& c : cases) {
        SCOPED_TRACE(fmt::format("{}: {} registers, {} bytes, {} threads", c.architecture, c.registers, c.shared_bytes,
                                 c.threads));
        const cuda::Occupancy held = cuda::occupancy(c.architecture, c.registers, c.shared_bytes, c.threads);
        EXPECT_EQ(held.blocks, c.blocks);
        EXPECT_EQ(held.warps, c.warps);
        EXPECT_EQ(held.most_warps, c.most_warps);
        EXPECT_EQ(held.limit, c.limit);
    }
}

// A GPU as NVIDIA's own calculator takes it.
cudaOccDeviceProp gpu(int major, int minor, int warps, int shared_kib, int reserved_shared) {
    cudaOccDeviceProp properties;
    properties.computeMajor = major;
    properties.computeMinor = minor;
    properties.maxThreadsPerBlock = 1024;
    properties.maxThreadsPerMultiprocessor = 32 * warps;
    properties.regsPerBlock = properties.regsPerMultiprocessor = 65536;
    properties.warpSize = 32;
    properties.sharedMemPerBlock = properties.sharedMemPerBlockOptin = 49152;
    properties.sharedMemPerMultiprocessor = static_cast<std::size_t>(shared_kib) * 1024;
    properties.reservedSharedMemPerBlock = static_cast<std::size_t>(reserved_shared);
    properties.numSms = 1;
    return properties;
}

const std::map<std::string, unsigned> limit_bits{{"registers", OCC_LIMIT_REGISTERS},
                                                 {"shared memory", OCC_LIMIT_SHARED_MEMORY},
                                                 {"warps", OCC_LIMIT_WARPS},
                                                 {"blocks", OCC_LIMIT_BLOCKS}};

TEST(OccupancyTest, AsTheToolkitComputesIt) {
    const std::pair<const char*, cudaOccDeviceProp> gpus[] = {
        {"sm_75", gpu(7, 5, 32, 64, 0)},       {"sm_80", gpu(8, 0, 64, 164, 1024)},
        {"sm_86", gpu(8, 6, 48, 100, 1024)},   {"sm_87", gpu(8, 7, 48, 164, 1024)},
        {"sm_89", gpu(8, 9, 48, 100, 1024)},   {"sm_90", gpu(9, 0, 64, 228, 1024)},
        {"sm_100", gpu(10, 0, 64, 228, 1024)}, {"sm_103", gpu(10, 3, 64, 228, 1024)},
        {"sm_120", gpu(12, 0, 48, 100, 1024)},
    };
    std::string names;
    for (const auto& [architecture, properties] : gpus) {
        names += (names.empty() ? "" : ", ") + std::string(architecture);
        for (const int registers : {16, 24, 32, 33, 40, 56, 64, 65, 96, 128, 129, 255}) {
            for (const int shared_bytes : {0, 20, 128, 1000, 5000, 9340, 16384, 20000, 40000, 49152}) {
                for (const int threads : {32, 64, 96, 128, 160, 256, 512, 1024}) {
                    cudaOccFuncAttributes kernel;
                    kernel.maxThreadsPerBlock = 1024;
                    kernel.numRegs = registers;
                    kernel.sharedSizeBytes = static_cast<std::size_t>(shared_bytes);
                    kernel.numBlockBarriers = 1;
                    const cudaOccDeviceState state;
                    cudaOccResult expected{};
                    ASSERT_EQ(
                        cudaOccMaxActiveBlocksPerMultiprocessor(&expected, &properties, &kernel, &state, threads, 0),
                        CUDA_OCC_SUCCESS);
                    const cuda::Occupancy held = cuda::occupancy(architecture, registers, shared_bytes, threads);
                    SCOPED_TRACE(fmt::format("{}: {} registers, {} bytes, {} threads: {}", architecture, registers,
                                             shared_bytes, threads, held.limit));
                    ASSERT_EQ(held.blocks, expected.activeBlocksPerMultiprocessor);
                    ASSERT_EQ(held.warps, held.blocks * (threads / 32));
                    ASSERT_NE(expected.limitingFactors & limit_bits.at(held.limit), 0u);
                }
            }
        }
    }
    EXPECT_EQ(cuda::known_architectures(), names);
}

TEST(OccupancyTest, AnUnknownArchitectureIsRefusedWithTheKnownOnes) {
    for (const char* unknown : {"sm_1", "sm_9", "sm_900", "90", ""}) {
        EXPECT_EQ(refusal<InputError>([&] { (void)cuda::occupancy(unknown, 32, 0, 128); }),
                  "command line: --arch: found " + std::string(unknown) +
                      ", allowed: sm_75, sm_80, sm_86, sm_87, sm_89, sm_90, sm_100, sm_103, sm_120");
    }
}

// --- reports of whole variants
// ----------------------------------------------------------------------------------------

// Sets $PTBENCH_NVDISASM for as long as it lives.
class NamedDisassembler {
public:
    explicit NamedDisassembler(const std::string& program) {
        if (const char* before = std::getenv(name); before != nullptr) {
            before_ = before;
            was_set_ = true;
        }
        ::setenv(name, program.c_str(), 1);
    }
    ~NamedDisassembler() {
        if (was_set_) {
            ::setenv(name, before_.c_str(), 1);
        } else {
            ::unsetenv(name);
        }
    }
    NamedDisassembler(const NamedDisassembler&) = delete;
    NamedDisassembler& operator=(const NamedDisassembler&) = delete;

private:
    static constexpr const char* name = "PTBENCH_NVDISASM";
    std::string before_;
    bool was_set_ = false;
};

class InspectTest : public testing::Test {
protected:
    const test::TemporaryFolder folder;

    void SetUp() override {
        if (const std::string missing = cuda::nvrtc_missing(); !missing.empty()) {
            GTEST_SKIP() << missing;
        }
        ::setenv("PTBENCH_HOME", test::source_folder().c_str(), 1);
        ::setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
    }

    static Variant megakernel(const std::string& specialisation) {
        Variant variant = Registry::instance().baseline(Backend::cuda);
        variant.set("integrator", "megakernel");
        variant.set("specialisation", specialisation);
        return variant;
    }
    static Json inspect(const Variant& variant, const std::string& architecture) {
        return cuda::inspect(find_scene("cornell_open"), variant, architecture);
    }
    // A program that says `text` whatever it is asked.
    std::string program_that_says(const std::string& text, int exit_code = 0) const {
        const std::string program = folder.file("says");
        test::write_text(folder.file("text"), text);
        test::write_text(program, fmt::format("#!/bin/sh\ncat '{}'\nexit {}\n", folder.file("text"), exit_code));
        std::filesystem::permissions(program, std::filesystem::perms::owner_all);
        return program;
    }
};

TEST_F(InspectTest, LeavingOutMakesAKernelSmaller) {
    const std::string architecture = "sm_90";  // one: a kernel with every feature takes a minute
    const Json features = inspect(megakernel("features"), architecture);
    const Json generic = inspect(megakernel("generic"), architecture);
    EXPECT_EQ(features["features"],
              Json({"sphere", "axis_box", "diffuse", "emitter", "mirror", "jitter", "enclosure"}));
    EXPECT_EQ(features["left_out"], Json({"ellipsoid",
                                          "oriented_box",
                                          "quad",
                                          "motion",
                                          "mix",
                                          "dielectric",
                                          "rough_conductor",
                                          "rough_dielectric",
                                          "principled",
                                          "subsurface",
                                          "emission",
                                          "absorption",
                                          "subsurface_boundary",
                                          "multiple_scattering",
                                          "environment",
                                          "lens",
                                          "final_bounce",
                                          "next_event",
                                          "multiple_importance",
                                          "area_sampling",
                                          "projected_sampling",
                                          "automatic_sampling",
                                          "power_selection",
                                          "tree_selection",
                                          "one_sample",
                                          "environment_map",
                                          "russian_roulette",
                                          "adjoint_roulette",
                                          "near_sphere",
                                          "textures",
                                          "shading_normals"}));
    EXPECT_EQ(generic["features"].size(), 37u);
    EXPECT_EQ(generic["left_out"], Json::array());
    EXPECT_LT(features["code_bytes"], generic["code_bytes"]);
    for (const Json& report : {features, generic}) {
        EXPECT_EQ(report["scene"], "cornell_open");
        EXPECT_EQ(report["architecture"], architecture);
        ASSERT_EQ(report["kernels"].size(), 1u);
        const Json& kernel = report["kernels"][0];
        EXPECT_EQ(kernel["name"], "megakernel");
        EXPECT_GT(kernel["registers"], 0);
        EXPECT_EQ(kernel["threads_per_block"], 128);
        const cuda::Occupancy held = cuda::occupancy(architecture, kernel["registers"], kernel["shared_bytes"], 128);
        EXPECT_EQ(kernel["blocks_per_multiprocessor"], held.blocks);
        EXPECT_EQ(kernel["warps_per_multiprocessor"], held.warps);
        EXPECT_EQ(kernel["occupancy"], static_cast<double>(held.warps) / held.most_warps);
        EXPECT_EQ(kernel["occupancy_limit"], held.limit);
    }
    const Json& kernel = features["kernels"][0];
    EXPECT_LT(kernel["registers"], generic["kernels"][0]["registers"]);
    EXPECT_EQ(kernel["spill_store_bytes"], 0);
    EXPECT_EQ(kernel["spill_load_bytes"], 0);
    if (!cuda::find_nvdisasm().empty()) {
        EXPECT_EQ(features["disassembler"], cuda::find_nvdisasm());
        EXPECT_LT(kernel["instructions"]["total"], generic["kernels"][0]["instructions"]["total"]);
        EXPECT_LT(kernel["instructions_in_loop"]["total"], kernel["instructions"]["total"]);
        EXPECT_GT(kernel["instructions_in_loop"]["fma"], 0);
    }
}

// --- what a queue's stages launch ---

// A compaction of this test, whose source it writes where those that ptbench embeds are unpacked.
const Registration written_here(
    {.axis = "compaction",
     .name = "test_written",
     .summary = "as atomic_append, or as a test has it",
     .origin = "this test",
     .traits = CompactionTraits{.payload_contiguous = false},
     .backends = on_cuda},
    {.cuda = {
         .compaction = [](const cuda::CellContext& context) -> std::unique_ptr<cuda::Compaction> {
             return std::make_unique<cuda::AppendCompaction>(context);
         },
         .kernels = {cuda::kernel_of<cuda::AppendSlotsParameters>(), cuda::kernel_of<cuda::AppendPathsParameters>()}}});

class InspectStagesTest : public InspectTest {
protected:
    static void write_source(const std::string& append) {
        const std::filesystem::path file = std::filesystem::path(cuda::kernel_cache_folder()) /
                                           ("include-" + cuda::kernel_source_hash()) /
                                           "variants/compaction/test_written.cuh";
        std::filesystem::create_directories(file.parent_path());
        test::write_text(file.string(),
                         "#pragma once\n#include \"variants/cuda/device/append.cuh\"\n"
                         "__device__ inline std::uint32_t append(std::uint32_t* count, bool keep) {\n"
                         "    return " +
                             append +
                             "(count, keep);\n"
                             "}\n#include \"variants/cuda/device/append_kernels.cuh\"\n");
    }
    static Variant variant(const std::string& integrator, const std::string& compaction, const std::string& sorting) {
        Variant variant = Registry::instance().baseline(Backend::cuda);
        variant.set("integrator", integrator);
        variant.set("compaction", compaction);
        variant.set("sorting", sorting);
        return variant;
    }
    // Names and choices, "append_slots of compaction=test_written".
    static std::vector<std::string> listed(const Json& report) {
        std::vector<std::string> found;
        for (const Json& kernel : report["kernels"]) {
            EXPECT_GT(kernel["registers"], 0);
            found.push_back(kernel["name"].get<std::string>() + " of " + kernel["of"].get<std::string>() +
                            (kernel.value("launched", true) ? "" : ", not launched"));
        }
        std::sort(found.begin(), found.end());
        return found;
    }
};

TEST_F(InspectStagesTest, KernelsOfACompactionAreCompiledAndLibrariesNamed) {
    write_source("pt::cuda::append_by_warp");
    Variant queue = variant("wavefront", "test_written", "cub_radix");
    queue.tuning["block"] = 64;
    const Json report = inspect(queue, "sm_90");
    const std::vector<std::string> expected{
        "advance of integrator=wavefront",         "append_paths of compaction=test_written",
        "append_slots of compaction=test_written", "generate_paths of integrator=wavefront",
        "intersect_paths of integrator=wavefront", "shade_paths of integrator=wavefront",
        "write_ray_keys of integrator=wavefront"};
    EXPECT_EQ(listed(report), expected);
    EXPECT_EQ(report["library_calls"], Json({"sorting=cub_radix"}));
    for (const Json& kernel : report["kernels"]) {
        const bool is_stage = kernel["of"] == "compaction=test_written";
        EXPECT_EQ(kernel["threads_per_block"], is_stage ? cuda::stage_block : 64u) << kernel["name"];
    }
}

TEST_F(InspectStagesTest, WhatTheIntegratorsKernelDoesIsCompiledAndNotLaunched) {
    const Json report = inspect(variant("wavefront_fused", "atomic_append", "none"), "sm_90");
    const std::vector<std::string> kernels = listed(report);
    EXPECT_EQ(std::count(kernels.begin(), kernels.end(), "append_slots of compaction=atomic_append, not launched"), 1);
    EXPECT_EQ(std::count(kernels.begin(), kernels.end(), "next_bounce of integrator=wavefront_fused"), 1);
    EXPECT_EQ(report["library_calls"], Json::array());
}

// The command as `ptbench` has it, for a compaction that no program has.
TEST_F(InspectStagesTest, AnUndeclaredNameInACompactionFailsTheCommand) {
    write_source("append_by_nobody");
    const std::string out = folder.file("report.json");
    CLI::App app;
    const Command command = add_inspect_command(app);
    app.parse(
        "inspect --scene cornell_open --axis integrator=wavefront --axis compaction=test_written --arch sm_90 --out " +
        out);
    testing::internal::CaptureStderr();
    EXPECT_EQ(command(), exit_check_failed);
    const std::string told = testing::internal::GetCapturedStderr();
    EXPECT_NE(told.find("compaction=test_written: variants/compaction/test_written.cuh does not compile for sm_90"),
              std::string::npos)
        << told;
    EXPECT_NE(told.find("variants/compaction/test_written.cuh(4): error: identifier \"append_by_nobody\" is undefined"),
              std::string::npos)
        << told;
    EXPECT_FALSE(std::filesystem::exists(out));
}

// Of several architectures a table: each kernel once by its name, and a line for each architecture.
TEST_F(InspectTest, SeveralArchitecturesAreATable) {
    const std::string out = folder.file("report.json");
    CLI::App app;
    const Command command = add_inspect_command(app);
    app.parse(
        "inspect --scene cornell_open --axis integrator=wavefront --axis compaction=gap_fill --arch sm_75,sm_90 "
        "--out " +
        out);
    testing::internal::CaptureStdout();
    EXPECT_EQ(command(), exit_good);
    const std::string told = testing::internal::GetCapturedStdout();
    const Json reports = Json::parse(test::content_of(out));
    ASSERT_EQ(reports.size(), 2u);
    const std::size_t kernels = reports[0]["kernels"].size();
    EXPECT_GT(kernels, 4u);
    // The variant, what the columns mean, and two lines a kernel.
    EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), static_cast<std::ptrdiff_t>(2 + 2 * kernels)) << told;
    for (const Json& kernel : reports[0]["kernels"]) {
        std::string block, name = kernel["name"].get<std::string>() + " (" + kernel["of"].get<std::string>() + ")";
        for (const Json& report : reports) {
            for (const Json& own : report["kernels"]) {
                if (own["name"] == kernel["name"]) {
                    block +=
                        fmt::format("\n  {:<44} {:<7} {:>9} {:>11} {:>12} {:>7}  {} ({:.0f} %)", name,
                                    report["architecture"].get<std::string>(), own["registers"].get<int>(),
                                    own["spill_store_bytes"].get<int>() + own["spill_load_bytes"].get<int>(),
                                    own["shared_bytes"].get<int>(), own["threads_per_block"].get<int>(),
                                    own["warps_per_multiprocessor"].get<int>(), 100 * own["occupancy"].get<double>());
                    const std::size_t at = told.find(block);
                    ASSERT_NE(at, std::string::npos) << block << "\n" << told;
                    block = told.substr(at, told.find('\n', at + block.size()) - at);  // to the line's end
                    name = "";
                }
            }
        }
    }
    EXPECT_EQ(reports[0]["architecture"], "sm_75");
    EXPECT_EQ(reports[1]["architecture"], "sm_90");
}

TEST_F(InspectTest, TheBlockIsTheVariants) {
    Variant variant = megakernel("features");
    variant.tuning["block"] = 64;
    const Json kernel = inspect(variant, "sm_75")["kernels"][0];
    EXPECT_EQ(kernel["threads_per_block"], 64);
    EXPECT_EQ(kernel["warps_per_multiprocessor"], 2 * kernel["blocks_per_multiprocessor"].get<int>());
}

TEST_F(InspectTest, WithoutADisassemblerThereAreNoInstructionCounts) {
    const NamedDisassembler none("/nonexistent");
    EXPECT_EQ(cuda::find_nvdisasm(), "");
    const Json report = inspect(megakernel("features"), "sm_90");
    EXPECT_EQ(report["disassembler"], "not found: no instruction counts (set PTBENCH_NVDISASM)");
    for (const Json& kernel : report["kernels"]) {
        EXPECT_FALSE(kernel.contains("instructions"));
        EXPECT_FALSE(kernel.contains("instructions_in_loop"));
        EXPECT_GT(kernel["registers"], 0);
    }
}

TEST_F(InspectTest, InstructionCountsAreThoseOfTheKernelOfTheSameName) {
    const NamedDisassembler named(program_that_says(R"(
.text.another:
        /*0000*/                   EXIT ;
.text.megakernel:
.L_x_0:
        /*0000*/                   FADD R1, R2, R3 ;
        /*0010*/                   MUFU.RCP R1, R2 ;
        /*0020*/               @P0 BRA `(.L_x_0) ;
        /*0030*/                   EXIT ;
)"));
    const Json kernel = inspect(megakernel("features"), "sm_90")["kernels"][0];
    EXPECT_EQ(kernel["instructions"], Json({{"total", 4}, {"control", 2}, {"fma", 1}, {"xu", 1}}));
    EXPECT_EQ(kernel["instructions_in_loop"], Json({{"total", 3}, {"control", 1}, {"fma", 1}, {"xu", 1}}));
}

TEST_F(InspectTest, ADisassemblerThatFailsIsTheMachinesFault) {
    const NamedDisassembler named(program_that_says("no such architecture\nand more\n", 1));
    EXPECT_EQ(refusal<MachineError>([] { (void)inspect(megakernel("features"), "sm_90"); }),
              folder.file("says") + " failed: no such architecture");
}

TEST_F(InspectTest, RefusesAnUnknownArchitecture) {
    EXPECT_EQ(refusal<InputError>([] { (void)inspect(megakernel("features"), "sm_1"); }),
              "command line: --arch: found sm_1, allowed: " + cuda::known_architectures());
}

TEST_F(InspectTest, RefusesAVariantThatDoesNotApply) {
    Variant variant = megakernel("features");
    variant.set("layout", "soa");
    EXPECT_NE(refusal<InputError>([&] {
                  (void)inspect(variant, "sm_90");
              }).find("integrator=megakernel keeps one path in registers, no array of paths: needs layout=aos"),
              std::string::npos);
}

}  // namespace
}  // namespace pt
