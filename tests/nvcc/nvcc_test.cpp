// The kernels compile under nvcc, for host and device, without a warning; and they include nothing that NVRTC lacks.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/places.h"

namespace {

namespace fs = std::filesystem;

const fs::path source = pt::test::source_folder();

// An image's texels lie in memory in single precision whatever the kernel computes in: what reads and widens them,
// which is exact. A constant in single precision would be read by another instruction: of a named memory.
bool widens_what_memory_holds(const std::string& line) {
    return line.find("\tld.f32") != std::string::npos || line.find("\tcvt.f64.f32") != std::string::npos;
}

// Counts the instructions in a PTX text on numbers of one type (".f32") in the kernels whose name has `part`, but for
// those that only widen.
int instructions(const std::string& ptx, const std::string& part, const std::string& type) {
    std::istringstream lines(ptx);
    bool is_counted = false;
    int count = 0;
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind(".visible .entry ", 0) == 0) {
            is_counted = line.find(part) != std::string::npos;
        }
        const bool is_instruction = line.find(type) != std::string::npos && line.find(".reg") == std::string::npos;
        count += is_counted && is_instruction && !widens_what_memory_holds(line) ? 1 : 0;
    }
    return count;
}

#ifdef PTBENCH_NVCC
// The PTX of tests/nvcc/`name`.cu, which is compiled for host and device without a warning. To PTX: assembling it takes
// three times as long, and compile_test.cpp assembles what NVRTC makes of these sources. CUDA_VERSION: GLM 0.9.9 asks
// for it where only nvcc's own macros are set. 20012: GLM marks its defaulted members host and device, which nvcc
// reports as superfluous. Relaxed constexpr: std::numeric_limits in device code.
std::string compiled_to_ptx(const std::string& name, const std::string& options) {
    const fs::path folder = fs::path(testing::TempDir()) / ("ptbench_nvcc_" + std::to_string(std::random_device()()));
    fs::create_directories(folder);
    const std::string object = (folder / (name + ".o")).string(), log = (folder / "log").string();
    const std::string command =
        std::string("\"" PTBENCH_NVCC "\" -std=c++20 -gencode arch=compute_90,code=compute_90 ") + options +
        " -Werror all-warnings --expt-relaxed-constexpr -diag-suppress 20012 -DGLM_FORCE_CUDA -DCUDA_VERSION=13000 " +
        "-I\"" + source.string() + "\" -I\"" PTBENCH_GLM_INCLUDE "\" --keep --keep-dir \"" + folder.string() +
        "\" -c \"" + (source / "tests/nvcc" / (name + ".cu")).string() + "\" -o \"" + object + "\" > \"" + log +
        "\" 2>&1";
    const int status = std::system(command.c_str());
    std::ostringstream messages;
    messages << std::ifstream(log).rdbuf();
    EXPECT_EQ(status, 0) << command << "\n" << messages.str();
    EXPECT_TRUE(fs::exists(object));
    std::ostringstream ptx;
    ptx << std::ifstream(folder / (name + ".ptx")).rdbuf();
    fs::remove_all(folder);
    return ptx.str();
}
#endif

TEST(NvccTest, EveryStageCompilesForHostAndDevice) {
#ifndef PTBENCH_NVCC
    GTEST_SKIP() << "nvcc was not found when CMake ran";
#else
    const std::string ptx = compiled_to_ptx("kernels", "--fmad=false");
    // Double precision throughout means throughout: no literal, function or constant in single precision. And no kernel
    // in single precision takes a detour over double, but for the film's rare samples.
    const auto count = [&](const char* stage, const char* real, const char* type) {
        return instructions(ptx, std::string(stage) + "INS_6ConfigI" + real, type);
    };
    for (const char* stage : {"generate_paths", "intersect_paths", "shade_paths", "accumulate_paths"}) {
        EXPECT_EQ(count(stage, "d", ".f32"), 0) << stage;
        EXPECT_GT(count(stage, "d", ".f64"), 0) << stage;
        EXPECT_GT(count(stage, "f", ".f32"), 0) << stage;
        if (stage != std::string("accumulate_paths")) {
            EXPECT_EQ(count(stage, "f", ".f64"), 0) << stage;
        }
    }
#endif
}

// Whether a closed mesh lets rays through must not depend on what a compiler fuses: two triangles that share an edge
// agree about it only where a product and its mirror image are rounded alike.
TEST(NvccTest, NoArithmeticFusesWhatWatertightnessRestsOn) {
#ifndef PTBENCH_NVCC
    GTEST_SKIP() << "nvcc was not found when CMake ran";
#else
    for (const char* options : {"", "--use_fast_math"}) {
        const std::string ptx = compiled_to_ptx("triangle", options);
        // A product without a rounding of its own in PTX is one that the assembler may fuse.
        const auto fusible = [&](const char* kernel) {
            int count = 0;
            for (const char* product : {"fma.", "mul.f32", "mul.ftz.f32", "mul.f64"}) {
                count += instructions(ptx, kernel, product);
            }
            return count;
        };
        for (const char* kernel : {"meet", "take_in", "bound", "move"}) {
            EXPECT_GT(instructions(ptx, kernel, "mul.rn"), 0) << kernel;
            EXPECT_EQ(fusible(kernel), 0) << kernel << " " << options;
        }
        EXPECT_EQ(fusible("may_be_fused"), 4) << options;
    }
#endif
}

TEST(NvccTest, ListNamesEveryKernelHeader) {
    std::ostringstream text;
    text << std::ifstream(source / "tests/nvcc/kernels.cu").rdbuf();
    for (const fs::directory_entry& entry : fs::directory_iterator(source / "kernels")) {
        if (entry.path().extension() == ".h") {
            EXPECT_NE(text.str().find("\"kernels/" + entry.path().filename().string() + "\""), std::string::npos)
                << entry.path() << " is not in tests/nvcc/kernels.cu";
        }
    }
}

// NVRTC has no standard library: the runtime compiler is given stand-ins for exactly these.
TEST(NvccTest, KernelsIncludeOnlyWhatNvrtcCanHave) {
    const std::set<std::string> allowed{"<cmath>", "<cstdint>", "<limits>", "<glm/vec3.hpp>"};
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(source / "kernels")) {
        std::ifstream file(entry.path());
        for (std::string line; std::getline(file, line);) {
            if (line.rfind("#include ", 0) == 0) {
                const std::string name = line.substr(9);
                EXPECT_TRUE(name.rfind("\"kernels/", 0) == 0 || name.rfind("PT_SHAPE_FILE(", 0) == 0 ||
                            name.rfind("PT_MATERIAL_FILE(", 0) == 0 || name.rfind("PT_SAMPLER_FILE(", 0) == 0 ||
                            allowed.count(name) == 1)
                    << entry.path() << ": " << line;
            }
        }
    }
}

}  // namespace
