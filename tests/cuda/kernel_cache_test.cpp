// Compiled kernels on disk: what is there is used, what is damaged is made again, two processes do not disturb each
// other, and what does not compile says why. No GPU is needed.
#include "variants/cuda/runtime/module.h"

#include <regex>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/cuda/kernel_request.h"
#include "harness/scene/places.h"
#include "tests/support/command.h"
#include "tests/support/places.h"
#include "variants/registry.h"

namespace pt {
namespace {

namespace fs = std::filesystem;
using cuda::ModuleRequest;

Variant baseline() { return Registry::instance().baseline(Backend::cuda); }

// A small program: NVRTC takes less than a second.
ModuleRequest small_request() {
    return cuda::stage_request(baseline(), *Registry::instance().find("compaction", "atomic_append", Backend::cuda),
                               "sm_90");
}

// What came of a build through the kernel cache.
struct Built {
    std::string outcome;  // "compiled", "cached", "compile error", "error", or how its process ended
    std::string key;
    std::string text;  // the image, or the message
};

// build_module() in a process of its own, as another run of ptbench: what a process keeps in memory is not shared.
class BuildProcess {
public:
    BuildProcess(const ModuleRequest& request, const fs::path& cache_home) : process_(::fork()) {
        if (process_ == 0) {
            ::setenv("XDG_CACHE_HOME", cache_home.c_str(), 1);
            build(request);
            ::_exit(0);
        }
    }

    Built wait() {
        int status = 0;
        ::waitpid(process_, &status, 0);
        Built built{test::content_of(files_.file("outcome")), test::content_of(files_.file("key")),
                    test::content_of(files_.file("text"))};
        if (!WIFEXITED(status) || built.outcome.empty()) {
            built.outcome = fmt::format("ended with status {}", status);
        }
        return built;
    }

private:
    void build(const ModuleRequest& request) {
        Built built;
        try {
            const cuda::ModuleImage image = cuda::build_module(request);
            built = {image.from_cache ? "cached" : "compiled", image.key, image.cubin};
        } catch (const cuda::CompileError& error) {
            built = {"compile error", "", error.what()};
        } catch (const std::exception& error) {
            built = {"error", "", error.what()};
        }
        test::write_text(files_.file("key"), built.key);
        test::write_text(files_.file("text"), built.text);
        test::write_text(files_.file("outcome"), built.outcome);
    }

    test::TemporaryFolder files_;
    pid_t process_;
};

class KernelCacheTest : public testing::Test {
protected:
    const test::TemporaryFolder cache;

    Built build(const ModuleRequest& request) { return BuildProcess(request, cache.path()).wait(); }
    fs::path entry(const ModuleRequest& request) const {
        return cache.path() / "ptbench" / (cuda::module_key(request) + ".cubin");
    }
    // Files in the cache but for the unpacked sources.
    std::vector<std::string> entries() const {
        std::vector<std::string> names = cache.content();
        std::erase_if(
            names, [](const std::string& name) { return name == "ptbench" || name.starts_with("ptbench/include-"); });
        return names;
    }
};

void expect_image(const Built& built, const std::string& outcome) {
    EXPECT_EQ(built.outcome, outcome) << built.text.substr(0, 2000);
    EXPECT_TRUE(
        built.text.starts_with("\x7f"
                               "ELF"))
        << "no image";
}

TEST_F(KernelCacheTest, TheSecondBuildComesFromTheCache) {
    const ModuleRequest request = small_request();
    const Built first = build(request);
    expect_image(first, "compiled");
    EXPECT_EQ(first.key, cuda::module_key(request));
    const Built second = build(request);
    expect_image(second, "cached");
    EXPECT_TRUE(second.text == first.text);
    EXPECT_EQ(second.key, first.key);
    EXPECT_EQ(entries(), std::vector<std::string>{"ptbench/" + first.key + ".cubin"});
}

TEST_F(KernelCacheTest, ADamagedEntryIsMadeAgain) {
    const ModuleRequest request = small_request();
    const Built first = build(request);
    expect_image(first, "compiled");
    const std::string sound = test::content_of(entry(request).string());
    ASSERT_GT(sound.size(), first.text.size());
    std::string flipped = sound;
    flipped[sound.size() / 2] ^= 1;
    std::string wrong_end = sound;
    wrong_end.back() = wrong_end.back() == '0' ? '1' : '0';
    const std::pair<const char*, std::string> damages[] = {
        {"a flipped bit", flipped},
        {"another checksum", wrong_end},
        {"cut in half", sound.substr(0, sound.size() / 2)},
        {"the last byte lost", sound.substr(0, sound.size() - 1)},
        {"nothing but the checksum", sound.substr(sound.size() - 16)},
        {"longer", sound + "0"},
        {"empty", ""},
    };
    for (const auto& [what, damaged] : damages) {
        SCOPED_TRACE(what);
        test::write_text(entry(request).string(), damaged);
        const Built again = build(request);
        expect_image(again, "compiled");
        EXPECT_TRUE(again.text == first.text);
        EXPECT_TRUE(test::content_of(entry(request).string()) == sound);
        expect_image(build(request), "cached");
    }
}

TEST_F(KernelCacheTest, ADamagedSourceIsUnpackedAgain) {
    expect_image(build(small_request()), "compiled");
    const fs::path source = cache.path() / "ptbench" / ("include-" + cuda::kernel_source_hash()) / "kernels/config.h";
    const std::string sound = test::content_of(source.string());
    ASSERT_FALSE(sound.empty());
    test::write_text(source.string(), sound.substr(0, sound.size() / 2));
    fs::remove(entry(small_request()));
    expect_image(build(small_request()), "compiled");
    EXPECT_TRUE(test::content_of(source.string()) == sound);
}

TEST_F(KernelCacheTest, ProcessesThatBuildAtOnceDoNotDisturbEachOther) {
    const ModuleRequest request = small_request();
    std::vector<std::unique_ptr<BuildProcess>> processes;
    for (int i = 0; i < 4; ++i) {
        processes.push_back(std::make_unique<BuildProcess>(request, cache.path()));
    }
    std::set<std::string> images;
    for (const auto& process : processes) {
        const Built built = process->wait();
        EXPECT_TRUE(built.outcome == "compiled" || built.outcome == "cached") << built.outcome << built.text;
        images.insert(built.text);
    }
    ASSERT_EQ(images.size(), 1u);
    EXPECT_TRUE(
        images.begin()->starts_with("\x7f"
                                    "ELF"));
    const Built later = build(request);
    expect_image(later, "cached");
    EXPECT_TRUE(later.text == *images.begin());
    EXPECT_EQ(entries(), std::vector<std::string>{"ptbench/" + later.key + ".cubin"});
    for (const std::string& name : cache.content()) {
        EXPECT_EQ(name.find(".partial"), std::string::npos) << name;
    }
}

// --- a cache that cannot be written
// -----------------------------------------------------------------------------------

void expect_one_line_naming(const fs::path& folder, const Built& built) {
    EXPECT_EQ(built.outcome, "error");
    EXPECT_NE(built.text.find(folder.string()), std::string::npos) << built.text;
    EXPECT_NE(built.text.find("XDG_CACHE_HOME"), std::string::npos) << built.text;
    EXPECT_EQ(built.text.find('\n'), std::string::npos) << built.text;
}

TEST_F(KernelCacheTest, AFolderThatCannotBeMadeIsNamed) {
    test::write_text(cache.file("file"), "no folder");
    const fs::path home = cache.path() / "file";
    expect_one_line_naming(home / "ptbench", BuildProcess(small_request(), home).wait());
    EXPECT_EQ(test::content_of(cache.file("file")), "no folder");
}

TEST_F(KernelCacheTest, AFolderThatMayNotBeWrittenIsNamed) {
    if (::geteuid() == 0) {
        GTEST_SKIP() << "root may write everywhere";
    }
    fs::permissions(cache.path(), fs::perms::owner_read | fs::perms::owner_exec);
    const Built built = build(small_request());
    fs::permissions(cache.path(), fs::perms::owner_all);
    expect_one_line_naming(cache.path() / "ptbench", built);
}

TEST_F(KernelCacheTest, AnEntryThatCannotBeWrittenIsDoneWithout) {
    fs::create_directories(entry(small_request()) / "in the way");
    expect_image(build(small_request()), "compiled");
    expect_image(build(small_request()), "compiled");
    EXPECT_TRUE(fs::is_directory(entry(small_request())));
    for (const std::string& name : entries()) {
        EXPECT_EQ(name.find(".partial"), std::string::npos) << name;
    }
}

// --- keys
// -------------------------------------------------------------------------------------------------------------

TEST(KernelKeyTest, EverythingThatChangesTheCodeChangesTheKey) {
    const ModuleRequest base = small_request();
    const auto changed = [&](auto change) {
        ModuleRequest request = base;
        change(request);
        return cuda::module_key(request);
    };
    const std::vector<std::string> keys{
        cuda::module_key(base),
        changed([](ModuleRequest& r) { r.config.features = all_features; }),
        changed([](ModuleRequest& r) { r.config.features = no_features | Feature::sphere; }),
        changed([](ModuleRequest& r) { r.real = "double"; }),
        changed([](ModuleRequest& r) { r.options = {"--fmad=false"}; }),
        changed([](ModuleRequest& r) { r.options = {"--use_fast_math"}; }),
        changed([](ModuleRequest& r) { r.architecture = "sm_80"; }),
        changed([](ModuleRequest& r) { r.architecture = "sm_120"; }),
        changed([](ModuleRequest& r) { r.layout = "soa"; }),
        changed([](ModuleRequest& r) { r.sort_key = "ray"; }),
        changed([](ModuleRequest& r) { r.includes = {"variants/compaction/gap_fill.cuh"}; }),
        changed([](ModuleRequest& r) { r.includes.push_back("variants/compaction/gap_fill.cuh"); }),
        changed([](ModuleRequest& r) { r.includes.clear(); }),
        changed([](ModuleRequest& r) { r.scene = "in_constant"; }),
        changed([](ModuleRequest& r) { r.config.block = 128; }),
        changed([](ModuleRequest& r) { r.config.min_blocks = 1; }),
        changed([](ModuleRequest& r) { r.config.keeps_first_hits = true; }),
        changed([](ModuleRequest& r) { r.config.shading_fmas = 1; }),
        changed([](ModuleRequest& r) { r.config.constant_scene_bytes = 32; }),
        changed([](ModuleRequest& r) { r.config.has_fixed_counts = true; }),
        changed([](ModuleRequest& r) { r.config.counts.quads = 1; }),
        changed([](ModuleRequest& r) { r.config.counts.low_sides[1] = 1; }),
        changed([](ModuleRequest& r) { r.config.counts.one_light = 0; }),
        changed([](ModuleRequest& r) {
            r.constants = {{"more", 1}};
        }),
        changed([](ModuleRequest& r) {
            r.constants = {{"more", 12}};
        }),
        changed([](ModuleRequest& r) {
            r.constants = {{"other", 1}};
        }),
        changed([](ModuleRequest& r) { r.kernels.front().parameter_bytes += 8; }),
        changed([](ModuleRequest& r) { r.prelude = " "; }),
    };
    EXPECT_EQ(std::set<std::string>(keys.begin(), keys.end()).size(), keys.size());
    EXPECT_EQ(cuda::module_key(small_request()), keys.front());
    // What a program is called in messages is not part of it.
    EXPECT_EQ(changed([](ModuleRequest& r) { r.name = "another"; }), keys.front());
}

TEST(KernelKeyTest, VariantsShareProgramsWhereTheCodeIsTheSame) {
    ::setenv("PTBENCH_HOME", test::source_folder().c_str(), 1);
    const Scene scene = find_scene("cornell_open");
    const auto key = [&](const char* axis, const char* choice) {
        Variant variant = baseline();
        variant.set(axis, choice);
        return cuda::module_key(cuda::module_request(scene, variant, "sm_90"));
    };
    const std::string base = cuda::module_key(cuda::module_request(scene, baseline(), "sm_90"));
    EXPECT_EQ(key("compaction", "thrust_remove_if"), base);
    EXPECT_EQ(key("sorting", "cub_radix"), base);
    EXPECT_EQ(key("launch", "graph"), base);
    EXPECT_NE(key("layout", "soa"), base);
    EXPECT_NE(key("arithmetic", "exact"), base);
    EXPECT_NE(key("precision", "double"), base);
    EXPECT_NE(key("direct_light", "final_bounce"), base);
    EXPECT_NE(key("direct_light", "nee"), key("direct_light", "final_bounce"));
    EXPECT_NE(key("direct_light", "nee_mis"), key("direct_light", "nee"));
    EXPECT_NE(key("russian_roulette", "throughput"), base);
    EXPECT_NE(key("russian_roulette", "adjoint"), key("russian_roulette", "throughput"));
    EXPECT_NE(key("sampler", "philox"), base);
    EXPECT_NE(key("specialisation", "generic"), base);
    EXPECT_NE(key("integrator", "megakernel"), base);
}

// --- what does not compile
// --------------------------------------------------------------------------------------------

class CompileErrorTest : public KernelCacheTest {
protected:
    // The message of a build that must not compile, with a line of this form and the options in it.
    std::string failure(const ModuleRequest& request, const std::string& line, const std::string& option) {
        const Built built = build(request);
        EXPECT_EQ(built.outcome, "compile error") << built.text.substr(0, 2000);
        EXPECT_TRUE(built.text.starts_with(request.name + " does not compile for " + request.architecture))
            << built.text;
        EXPECT_TRUE(std::regex_search(built.text, std::regex(line))) << built.text;
        EXPECT_NE(built.text.find(option), std::string::npos) << built.text;
        EXPECT_NE(built.text.find("--gpu-architecture=sm_90"), std::string::npos) << built.text;
        EXPECT_EQ(entries(), std::vector<std::string>()) << "a failure is not kept";
        return built.text;
    }
};

TEST_F(CompileErrorTest, NamesTheFileAndTheLineOfABadSource) {
    ModuleRequest request = small_request();
    request.real = "nonsense";
    const std::string text = failure(request, R"(atomic_append\.cuh\.cu\(4\): error)", "using Real = nonsense;");
    EXPECT_NE(text.find("identifier \"nonsense\" is undefined"), std::string::npos) << text;
}

// The host and the kernel must agree on the parameters' size.
TEST_F(CompileErrorTest, NamesTheLineOfAKernelThatIsLaunchedWithOtherParameters) {
    ModuleRequest request = small_request();
    request.kernels.front().parameter_bytes += 8;
    (void)failure(request, R"(/variants/[a-z_/]+\.cuh\([0-9]+\): error: static assertion failed)",
                  "using Real = float;");
}

TEST_F(CompileErrorTest, NamesASourceThatIsNotThere) {
    ModuleRequest request = small_request();
    request.includes.push_back("variants/compaction/no_such.cuh");
    (void)failure(
        request,
        R"(atomic_append\.cuh\.cu\([0-9]+\): .*error: cannot open source file "variants/compaction/no_such\.cuh")",
        "using Real = float;");
}

TEST_F(CompileErrorTest, NamesAnArchitectureThatTheCompilerDoesNotKnow) {
    ModuleRequest request = small_request();
    request.architecture = "sm_1";
    const Built built = build(request);
    EXPECT_EQ(built.outcome, "compile error");
    EXPECT_NE(built.text.find("sm_1"), std::string::npos) << built.text;
    EXPECT_NE(built.text.find("invalid value for --gpu-architecture"), std::string::npos) << built.text;
}

}  // namespace
}  // namespace pt
