// Calls that are wrong: exit code 2 (or 3 where it is the machine that fails), one line on stderr that says what is
// wrong, nothing on stdout, nothing left behind.
#include <filesystem>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "harness/exr.h"
#include "tests/support/backends.h"
#include "tests/support/command.h"

namespace pt::test {
namespace {

using Arguments = std::vector<std::string>;

std::string joined(const Arguments& arguments) {
    std::string text;
    for (const std::string& argument : arguments) {
        text += argument + " ";
    }
    return text;
}

// `message`: how the line goes on after "ptbench: ".
void expect_refusal(const Arguments& arguments, int exit_code, const std::string& message) {
    SCOPED_TRACE(joined(arguments));
    const TemporaryFolder folder;
    const CommandResult result = ptbench(arguments, {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, exit_code);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err.find("ptbench: " + message), 0u) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(result.err.ends_with('\n'));
    EXPECT_EQ(folder.content(), Arguments());
}

// A render call that is right but for the arguments that are added.
Arguments render_with(const Arguments& added) {
    Arguments arguments{"render", "--scene", "cornell_open", "--resolution", "4x3", "--spp", "1", "--out", "image.png"};
    arguments.insert(arguments.end(), added.begin(), added.end());
    return arguments;
}

Arguments run_with(const Arguments& added) {
    Arguments arguments{"run", "--resolution", "4x3", "--spp", "1", "--repetitions", "1", "--out", "result.json"};
    arguments.insert(arguments.end(), added.begin(), added.end());
    return arguments;
}

TEST(BadCallsTest, Subcommands) {
    expect_refusal(
        {}, 2,
        "command line: subcommand: found none, allowed: list, run, merge, render, verify, inspect, autotune, import, "
        "export, generate, machine");
    expect_refusal({"frob"}, 2, "The following argument was not expected: frob (see ptbench --help)\n");
    expect_refusal({"--frob"}, 2, "The following argument was not expected: --frob (see ptbench --help)\n");
    expect_refusal({"list", "--frob"}, 2, "The following argument was not expected: --frob");
    expect_refusal({"list", "extra"}, 2, "list: argument: found \"extra\", allowed: an axis (integrator, ");
    expect_refusal({"list", "layout", "extra"}, 2, "The following argument was not expected: extra");
    expect_refusal({"list", "--names", "extra"}, 2, "--names: argument: found \"extra\", allowed: axes, scenes, ");
    expect_refusal({"list", "--names", "axes", "--json"}, 2, "--json excludes --names");
    expect_refusal({"completion", "fish"}, 2, "completion: argument: found \"fish\", allowed: bash (for zsh too), ");
    expect_refusal(render_with({"--frob"}), 2, "The following argument was not expected: --frob");
    expect_refusal(render_with({"extra"}), 2, "The following argument was not expected: extra");
    expect_refusal({"verify", "--scene", "cornell_open", "--frob=1"}, 2,
                   "The following argument was not expected: --frob=1");
    expect_refusal({"run", "--scene", "cornell_open", "--frob"}, 2,
                   "command line: argument: found \"--frob\", allowed: ");
}

TEST(BadCallsTest, MissingValues) {
    expect_refusal({"render"}, 2, "--scene is required");
    expect_refusal({"render", "--scene", "cornell_open"}, 2, "--out is required");
    expect_refusal({"render", "--out", "image.png", "--scene"}, 2, "--scene: 1 required TEXT missing");
    expect_refusal(render_with({"--axis"}), 2, "--axis: 1 required TEXT missing");
    expect_refusal({"verify"}, 2, "--scene is required");
    expect_refusal({"import"}, 2, "FILE is required");
    expect_refusal({"import", "scene.txt"}, 2, "--out is required");
    expect_refusal({"run", "--suite"}, 2, "--suite: 1 required TEXT missing");
    expect_refusal({"merge", "--out", "all.json"}, 2, "shards is required");
    expect_refusal({"merge", "shard.json"}, 2, "--out is required");
    expect_refusal(run_with({"--scene", "cornell_open", "--other-host"}), 2, "--other-host requires --resume");
    expect_refusal(run_with({"--scene", "cornell_open", "--shard", "3/2"}), 2,
                   "--shard: argument: found \"3/2\", allowed: I/N, the I-th of N parts, I from 1 to N\n");
}

TEST(BadCallsTest, SceneOrSuite) {
    expect_refusal({"run", "--axis", "layout=all"}, 2,
                   "command line: options: found neither --suite nor --scene, allowed: one of them\n");
    expect_refusal({"run", "--suite", "quick", "--scene", "cornell_open"}, 2,
                   "command line: options: found both --suite and --scene, allowed: one of them\n");
}

TEST(BadCallsTest, UnknownNames) {
    const std::string scenes = "--scene: name: found \"nope\", allowed: a file that ends in .json, or one of ";
    expect_refusal({"render", "--scene", "nope", "--out", "image.png"}, 2, scenes);
    expect_refusal({"verify", "--scene", "cornell_open,nope"}, 2, scenes);
    expect_refusal({"list", "--scene", "nope"}, 2, scenes);
    expect_refusal(run_with({"--scene", "nope"}), 2, scenes);
    expect_refusal(run_with({"--suite", "nope"}), 2,
                   "--suite: name: found \"nope\", allowed: a file that ends in .json, or one of ");
    expect_refusal({"render", "--scene", "nope.json", "--out", "image.png"}, 2,
                   "nope.json: the file: found no such file, ");
    expect_refusal(run_with({"--suite", "nope.json"}), 2, "nope.json: the file: found no such file, ");
    expect_refusal({"import", "nope.txt", "--out", "scene.json"}, 2, "nope.txt: the file: found no such file, ");
    for (const std::string empty : {",", "cornell_open,", "a,,b"}) {
        const std::string message =
            "--scene: argument: found \"" + empty + "\", allowed: names or files with a comma between them\n";
        expect_refusal(run_with({"--scene", empty}), 2, message);
        expect_refusal({"verify", "--scene", empty}, 2, message);
        expect_refusal({"list", "--scene", empty}, 2, message);
    }
}

TEST(BadCallsTest, ThreadsOfTheEnvironment) {
    for (const std::string wrong : {"abc", "0", "-1", "2,0", ""}) {
        const TemporaryFolder folder;
        const CommandResult result =
            ptbench({"machine"}, {.folder = folder.path(), .environment = {{"OMP_NUM_THREADS", wrong}}});
        EXPECT_EQ(result.exit_code, 2);
        // Before there is a program, the OpenMP library may say a line of its own: GNU's does, LLVM's does not.
        const std::size_t own = result.err.find("ptbench: ");
        ASSERT_NE(own, std::string::npos) << result.err;
        EXPECT_TRUE(own == 0 || result.err[own - 1] == '\n') << result.err;
        EXPECT_EQ(result.err.substr(own), "ptbench: the environment: OMP_NUM_THREADS: found \"" + wrong +
                                              "\", allowed: a number of threads from 1, or none: unset it for one a "
                                              "processor\n");
    }
    EXPECT_TRUE(ptbench({"machine"}, {.environment = {{"OMP_NUM_THREADS", " 3 , 2"}}}).out.ends_with("-3-threads\n"));
}

TEST(BadCallsTest, Backends) {
    const std::string unknown = "--backend: argument: found \"abacus\", allowed: cpu, cuda\n";
    expect_refusal(run_with({"--scene", "cornell_open", "--backend", "abacus"}), 2, unknown);
    expect_refusal(render_with({"--backend", "abacus"}), 2, unknown);
    expect_refusal({"verify", "--scene", "cornell_open", "--backend", "abacus"}, 2, unknown);
}

// The machine's fault, with the reason that `list` gives too.
TEST(BadCallsTest, CudaWithoutADevice) {
    const std::string listed = ptbench({"list", "--scene", "cornell_open"}).out;
    const std::size_t start = listed.rfind("not available (");
    ASSERT_NE(start, std::string::npos) << listed;
    const std::string message = "cuda: " + listed.substr(start);
    EXPECT_TRUE(message.ends_with(")\n")) << message;
    EXPECT_GT(message.size(), std::string("cuda: not available ()\n").size());
    expect_refusal(run_with({"--scene", "cornell_open", "--backend", "cuda"}), 3, message);
    expect_refusal(run_with({"--suite", "quick", "--backend=cuda"}), 3, message);
    expect_refusal(render_with({"--backend", "cuda"}), 3, message);
    expect_refusal({"verify", "--scene", "cornell_open", "--backend", "cuda"}, 3, message);
    if (!cuda_is_built()) {
        expect_refusal(run_with({"--scene", "cornell_open", "--backend", "cuda", "--dry-run"}), 3, message);
        return;
    }
    // A call that is wrong anyway is wrong before it is the machine's fault.
    expect_refusal(render_with({"--backend", "cuda", "--axis", "integrator=depth_first"}), 2,
                   "n/a: depth_first on "
                   "cornell_open: "
                   "integrator=depth_first is not there on the backend cuda\n");
}

TEST(BadCallsTest, Tunables) {
    const std::pair<std::string, std::string> cases[] = {
        {"jitters", "--tune: argument: found \"jitters\", allowed: NAME=VALUE or NAME=VALUE,VALUE\n"},
        {"=4", "--tune: argument: found \"=4\", allowed: NAME=VALUE or NAME=VALUE,VALUE\n"},
        {"jitters=four", "--tune: argument.jitters: found \"jitters=four\", allowed: whole numbers, comma-separated\n"},
        {"jitters=4,", "--tune: argument.jitters: found \"jitters=4,\", allowed: whole numbers, comma-separated\n"},
        {"jitters=0", "--tune: argument.jitters: found 0, allowed: a whole number from 1 to 4096\n"},
        {"jitters=4,4", "--tune: argument.jitters: found 4 twice, allowed: once\n"},
        {"colour=4", "--tune: argument.colour: found tunable \"colour\", allowed: " + tunable_names() + "\n"},
    };
    for (const auto& [argument, message] : cases) {
        expect_refusal(render_with({"--tune", argument}), 2, message);
        expect_refusal(run_with({"--scene", "cornell_open", "--tune", argument}), 2, message);
        expect_refusal({"verify", "--scene", "cornell_open", "--tune", argument}, 2, message);
    }
    expect_refusal(render_with({"--tune"}), 2, "--tune: 1 required TEXT missing");
    const std::string several = ", allowed: one choice an axis and one value a tunable for render\n";
    expect_refusal(render_with({"--axis", "first_bounce=cached_jitters", "--tune", "jitters=4,8"}), 2,
                   "--axis: argument: found 2 variants" + several);
    expect_refusal(render_with({"--tune", "jitters=4"}), 2,
                   "n/a: wavefront jitters=4 on "
                   "cornell_open: jitters=4 tunes none of the variant's choices\n");
    expect_refusal(run_with({"--scene", "cornell_open", "--tune", "jitters=4"}), 2,
                   "the run has no cell: n/a: jitters=4 tunes none of the variant's choices\n");
}

TEST(BadCallsTest, Axes) {
    const std::pair<std::string, std::string> cases[] = {
        {"compaction", "--axis: argument: found \"compaction\", allowed: NAME=CHOICE or NAME=CHOICE,CHOICE\n"},
        {"=none", "--axis: argument: found \"=none\", allowed: NAME=CHOICE or NAME=CHOICE,CHOICE\n"},
        {"compaction=", "--axis: argument: found \"compaction=\", allowed: NAME=CHOICE or NAME=CHOICE,CHOICE\n"},
        {"compaction=none,", "--axis: argument.compaction: found \"\", allowed: " + choice_names("compaction") + "\n"},
        {"compaction=magic",
         "--axis: argument.compaction: found \"magic\", allowed: " + choice_names("compaction") + "\n"},
        {"colour=red", "--axis: argument: found axis \"colour\", allowed: integrator, compaction, "},
    };
    for (const auto& [argument, message] : cases) {
        expect_refusal(render_with({"--axis", argument}), 2, message);
        expect_refusal(run_with({"--scene", "cornell_open", "--axis", argument}), 2, message);
        expect_refusal({"verify", "--scene", "cornell_open", "--axis", argument}, 2, message);
    }
    expect_refusal(render_with({"--axis", "layout=aos,soa"}), 2,
                   "--axis: argument: found 2 variants, allowed: one choice an axis and one value a tunable for "
                   "render\n");
    expect_refusal(render_with({"--axis", "launch=graph"}), 2,
                   "n/a: wavefront launch=graph on cornell_open: "
                   "launch=graph is not there on the backend cpu\n");
    expect_refusal(run_with({"--scene", "cornell_open", "--axis", "launch=graph"}), 2,
                   "the run has no cell: n/a: launch=graph is not there on the backend cpu\n");
    expect_refusal({"render", "--scene", "jitter_off", "--axis", "first_bounce=cached_jitters", "--out", "image.png"},
                   2,
                   "n/a: wavefront first_bounce=cached_jitters on "
                   "jitter_off: first_bounce=cached_jitters needs jitter, a lens or motion; without them "
                   "first_bounce=cached is it\n");
    expect_refusal(render_with({"--axis", "first_bounce=cached"}), 2,
                   "n/a: wavefront first_bounce=cached on "
                   "cornell_open: "
                   "first_bounce=cached needs jitter off "
                   "(camera.jitter is true in the scene)\n");
    expect_refusal(
        run_with({"--scene", "cornell_open", "--axis", "first_bounce=cached"}), 2,
        "the run has no cell: n/a: first_bounce=cached needs jitter off (camera.jitter is true in the scene)\n");
}

TEST(BadCallsTest, Devices) {
    const std::string allowed = ", allowed: 1, 2, 3, 4, 5, 6, 7, 8\n";
    const std::pair<std::string, std::string> cases[] = {
        {"0", "--devices: argument.devices: found \"0\"" + allowed},
        {"two", "--devices: argument.devices: found \"two\"" + allowed},
        {"1,", "--devices: argument.devices: found \"\"" + allowed},
        {"2,2", "--devices: argument.devices: found \"2\" twice, allowed: once\n"},
    };
    for (const auto& [argument, message] : cases) {
        expect_refusal(render_with({"--devices", argument}), 2, message);
        expect_refusal(run_with({"--scene", "cornell_open", "--devices", argument}), 2, message);
        expect_refusal({"verify", "--scene", "cornell_open", "--devices", argument}, 2, message);
    }
    expect_refusal(render_with({"--devices", "1", "--axis", "devices=1"}), 2,
                   "--devices: argument: found devices twice, allowed: once, with commas between its choices\n");
    expect_refusal(render_with({"--devices", "1,2"}), 2,
                   "--axis: argument: found 2 variants, allowed: one choice an axis and one value a tunable for "
                   "render\n");
    expect_refusal(render_with({"--devices", "2", "--backend", "cpu"}), 2,
                   "n/a: wavefront devices=2 on cornell_open: devices=2 is not there on the backend cpu\n");
    expect_refusal(run_with({"--scene", "cornell_open", "--devices", "2", "--backend", "cpu"}), 2,
                   "the run has no cell: n/a: devices=2 is not there on the backend cpu\n");
}

Arguments inspect_with(const Arguments& added) {
    Arguments arguments{"inspect", "--scene", "cornell_open"};
    arguments.insert(arguments.end(), added.begin(), added.end());
    return arguments;
}

TEST(BadCallsTest, Inspect) {
    expect_refusal({"inspect"}, 2, "--scene is required");
    expect_refusal({"inspect", "--scene", "nope"}, 2, "--scene: name: found \"nope\", allowed: ");
    expect_refusal(inspect_with({"--backend=cuda"}), 2, "The following argument was not expected: --backend=cuda");
    expect_refusal(inspect_with({"--counters", "--arch", "sm_90"}), 2,
                   "command line: --counters: found --arch sm_90, allowed: no --arch: counters come from this "
                   "machine's GPU\n");
    if (!cuda_is_built()) {
        expect_refusal(inspect_with({"--arch", "sm_90"}), 3, "cuda: ");
        return;
    }
    expect_refusal(inspect_with({"--arch", "sm_90", "--axis", "compaction=magic"}), 2,
                   "--axis: argument.compaction: found \"magic\", allowed: " + choice_names("compaction") + "\n");
    expect_refusal(inspect_with({"--arch", "sm_1"}), 2,
                   "command line: --arch: found sm_1, allowed: sm_75, sm_80, sm_86, sm_87, sm_89, sm_90, ");
    expect_refusal(inspect_with({"--arch", "sm_90,sm_1"}), 2, "command line: --arch: found sm_1, allowed: sm_75, ");
    expect_refusal(inspect_with({"--arch", "sm_90,"}), 2, "--arch: argument: found \"sm_90,\", allowed: ");
    expect_refusal({"list", "--scene", "cornell_open", "--arch", "sm_1"}, 2, "command line: --arch: found sm_1, ");
    const CommandResult without_device = ptbench(inspect_with({"--counters"}));
    EXPECT_EQ(without_device.exit_code, 3);
    EXPECT_EQ(without_device.out, "");
    EXPECT_NE(without_device.err.find(": name an architecture with --arch (sm_75, "), std::string::npos)
        << without_device.err;
}

// A choice that only the CPU has, alone and with one that only CUDA has: there is no variant, and the line says why.
TEST(BadCallsTest, InspectWithoutAVariantThatApplies) {
    if (!cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    for (const char* launch : {"launch=stream", "launch=graph"}) {
        const CommandResult result =
            ptbench(inspect_with({"--arch", "sm_90", "--axis", "integrator=depth_first", "--axis", launch}));
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_EQ(result.out, "");
        EXPECT_NE(result.err.find("integrator=depth_first is not there on the backend cuda"), std::string::npos)
            << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
}

TEST(BadCallsTest, Autotune) {
    const auto autotune = [](const Arguments& added) {
        Arguments arguments{"autotune", "--scene",      "cornell_open", "--backend", "cpu",        "--spp",
                            "1",        "--resolution", "4x3",          "--out",     "tuning.json"};
        arguments.insert(arguments.end(), added.begin(), added.end());
        return arguments;
    };
    expect_refusal({"autotune"}, 2, "--scene is required");
    expect_refusal({"autotune", "--scene", "cornell_open", "--backend", "abacus"}, 2,
                   "--backend: argument: found \"abacus\", allowed: cpu, cuda\n");
    expect_refusal(autotune({"--axis", "layout=aos,soa"}), 2,
                   "--axis: argument: found 2 variants, allowed: one choice an axis for autotune\n");
    expect_refusal(autotune({"--axis", "first_bounce=cached"}), 2,
                   "n/a: wavefront first_bounce=cached on "
                   "cornell_open: "
                   "first_bounce=cached needs jitter off (camera.jitter is true in the scene)\n");
    expect_refusal(autotune({"--passes=0"}), 2, "--passes: Value 0 not in range 1 to 100");
    expect_refusal(autotune({"--tune=room=0"}), 2, "The following argument was not expected: --tune=room=0");
    expect_refusal({"autotune", "--scene", "cornell_open", "--backend", "cuda"}, 3, "cuda: not available (");
}

// A search takes minutes: that its outcome cannot be kept is said before it.
TEST(BadCallsTest, AutotuneIntoAFileThatIsNoTuning) {
    const TemporaryFolder folder;
    const std::string file = folder.file("tuning.json");
    write_text(file, "{");
    expect_refusal({"autotune", "--scene", "cornell_open", "--backend", "cpu", "--spp", "1", "--resolution", "4x3",
                    "--passes", "1", "--out", file},
                   2, file + ": not valid JSON: ");
    EXPECT_EQ(content_of(file), "{");
}

TEST(BadCallsTest, Numbers) {
    for (const std::string resolution : {"5", "5x", "x5", "0x5", "5x0", "5x5x5", "-5x5", "5.5x5", "5X5", "5x5 ",
                                         "65537x1", "65536x65536", "99999999999x1"}) {
        const std::string message =
            "--resolution: argument: found \"" + resolution + "\", allowed: WxH with sides from 1 to 65536";
        const std::string argument = "--resolution=" + resolution;
        expect_refusal({"run", "--scene", "cornell_open", "--out", "result.json", argument}, 2, message);
        expect_refusal({"render", "--scene", "cornell_open", "--out", "image.png", argument}, 2, message);
        expect_refusal({"verify", "--scene", "cornell_open", argument}, 2, message);
    }
    for (const std::string value : {"0", "-1", "1.5", "many", "99999999999"}) {
        for (const std::string option : {"--spp", "--depth"}) {
            const std::string message = option + ": Value " + value + " not in range 1 to ";

            expect_refusal({"render", "--scene", "cornell_open", "--out", "image.png", option + "=" + value}, 2,
                           message);
            expect_refusal({"verify", "--scene", "cornell_open", option + "=" + value}, 2, message);
            for (const std::string& list : {value, "2," + value}) {
                expect_refusal(
                    {"run", "--scene", "cornell_open", "--out", "result.json", option + "=" + list}, 2,
                    option + ": argument: found \"" + list + "\", allowed: whole numbers from 1 to 1000000 ");
            }
        }
        expect_refusal({"run", "--scene", "cornell_open", "--out", "result.json", "--repetitions=" + value}, 2,
                       "--repetitions: Value " + value + " not in range 1 to 10000");
    }
    for (const std::string seed : {"-1", "1.5", "x", "18446744073709551616"}) {
        expect_refusal({"render", "--scene", "cornell_open", "--out", "image.png", "--seed=" + seed}, 2,
                       "--seed: Value " + seed + " not a whole number from 0 to 2^64 - 1");
    }
    expect_refusal({"run", "--scene", "cornell_open", "--benchmark_repetitions=0"}, 2,
                   "--benchmark_repetitions: argument: found ");
    expect_refusal(run_with({"--scene", "cornell_open", "--benchmark_filter=("}), 2,
                   "--benchmark_filter: argument: found \"(\", allowed: a regular expression\n");
    expect_refusal(run_with({"--scene", "cornell_open", "--benchmark_filter=nothing"}), 2,
                   "the run has no cell: the filter matches none\n");
    expect_refusal(run_with({"--scene", "cornell_open", "--dry-run", "--benchmark_filter=("}), 2,
                   "--benchmark_filter: argument: found \"(\", allowed: a regular expression\n");
    expect_refusal(
        run_with({"--scene", "cornell_open", "--benchmark_frob=1"}), 2,
        "command line: flag: found \"--benchmark_frob=1\", allowed: Google Benchmark's --benchmark_* flags\n");
    // Google Benchmark itself shows how it is used, and ends with exit code 0.
    const auto wrong_flag = [](const std::string& flag, const std::string& message) {
        expect_refusal(run_with({"--scene", "cornell_open", "--backend", "cpu", "--benchmark_" + flag}), 2, message);
    };
    for (const std::string flag : {"format", "out_format"}) {
        wrong_flag(flag + "=xml", "--benchmark_" + flag + ": argument: found \"xml\", allowed: console, json or csv\n");
        wrong_flag(flag, "--benchmark_" + flag + ": argument: found no value, allowed: console, json or csv\n");
    }
    wrong_flag("time_unit=h", "--benchmark_time_unit: argument: found \"h\", allowed: ns, us, ms or s\n");
    wrong_flag("color=", "--benchmark_color: argument: found \"\", allowed: auto, true or false\n");
    wrong_flag("context=key", "--benchmark_context: argument: found \"key\", allowed: KEY=VALUE, ");
    wrong_flag("counters_tabular=maybe", "--benchmark_counters_tabular: argument: found \"maybe\", allowed: true or ");
    wrong_flag("min_time=long", "--benchmark_min_time: argument: found \"long\", allowed: seconds\n");
    wrong_flag("min_warmup_time=1", "command line: flag: found \"--benchmark_min_warmup_time=1\", allowed: none: ");
    wrong_flag("list_tests", "command line: flag: found \"--benchmark_list_tests\", allowed: --dry-run, ");
    wrong_flag("repetitions", "--benchmark_repetitions: argument: found no value, allowed: a whole number from 1\n");
    expect_refusal({"run", "--scene", "cornell_open", "--resolution", "4x3", "--out", "/tmp"}, 2,
                   "--out: file name: found \"/tmp\", a folder, allowed: a file, new or regular\n");
}

TEST(BadCallsTest, OutputFiles) {
    const std::string allowed = has_openexr() ? ".png, .pfm or .exr\n" : ".png or .pfm\n";
    for (const std::string name : {"image.jpg", "image", ".png", "png", "image.PNG"}) {
        expect_refusal({"render", "--scene", "cornell_open", "--resolution", "4x3", "--out", name}, 2,
                       "--out: file name: found \"" + name + "\", allowed: a name that ends in " + allowed);
    }
    // A folder cannot be made below a file.
    expect_refusal(
        {"render", "--scene", "cornell_open", "--resolution", "4x3", "--spp", "1", "--out", "/proc/version/image.png"},
        2, "--out: file name: found \"/proc/version/image.png\", a path through a file that is no folder, allowed: ");
    expect_refusal({"run", "--scene", "cornell_open", "--resolution", "4x3", "--out", "/proc/version/result.json"}, 2,
                   "--out: file name: found \"/proc/version/result.json\", a path through a file that is no folder, ");
}

// A root user's rename would put a file in the place of the device.
TEST(BadCallsTest, DevicesPipesAndFoldersAreNoOutputFiles) {
    const TemporaryFolder folder;
    const std::string pipe = folder.file("pipe"), image_pipe = folder.file("pipe.png");
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    ASSERT_EQ(::mkfifo(image_pipe.c_str(), 0600), 0);
    const std::string source = folder.file("box.txt");
    write_text(source, "CAMERA\n");
    const std::string device = "no regular file (a device, a pipe or a socket)";
    for (const auto& [file, what] : std::vector<std::pair<std::string, std::string>>{
             {"/dev/full", device}, {pipe, device}, {folder.path().string(), "a folder"}}) {
        const std::string message = "--out: file name: found \"" + file + "\", " + what;
        for (const Arguments& call :
             std::vector<Arguments>{{"run", "--scene", "cornell_open", "--backend", "cpu", "--resolution", "4x3"},
                                    {"stability", "--quick", "--case", "S1", "--backend", "cpu"},
                                    {"autotune", "--scene", "cornell_open", "--backend", "cpu"},
                                    {"import", source},
                                    {"merge", source}}) {
            Arguments with_out = call;
            with_out.insert(with_out.end(), {"--out", file});
            expect_refusal(with_out, 2, message);
        }
    }
    expect_refusal({"render", "--scene", "cornell_open", "--out", image_pipe}, 2,
                   "--out: file name: found \"" + image_pipe + "\", " + device);
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
    EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

// A pipe would be waited for, a device never ends.
TEST(BadCallsTest, InputsThatAreNoFiles) {
    const TemporaryFolder folder;
    const std::string pipe = folder.file("pipe.json"), zero = folder.file("zero.json"),
                      large = folder.file("large.json");
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    std::filesystem::create_symlink("/dev/zero", zero);
    write_text(large, "");
    std::filesystem::resize_file(large, std::uintmax_t{65} << 20);
    std::filesystem::create_directory(folder.file("folder.json"));
    const std::string device = "no regular file (a device, a pipe or a socket)";
    for (const auto& [file, what] :
         std::vector<std::pair<std::string, std::string>>{{pipe, device},
                                                          {zero, device},
                                                          {large, "68157440 bytes, too large"},
                                                          {folder.file("folder.json"), "a folder"},
                                                          {folder.file("none.json"), "no such file"}}) {
        const std::string message = file + ": the file: found " + what + ", allowed: a regular file of at most ";
        expect_refusal(run_with({"--scene", file}), 2, message);
        expect_refusal(run_with({"--suite", file}), 2, message);
        expect_refusal({"verify", "--scene", file}, 2, message);
        expect_refusal({"import", file, "--out", folder.file("out.json")}, 2, message);
        expect_refusal({"merge", file, "--out", folder.file("out.json")}, 2, file == large ? large : message);
    }
}

TEST(BadCallsTest, WhatStandsTwice) {
    const std::string once = ", allowed: once";
    expect_refusal(run_with({"--scene", "cornell_open", "--axis", "layout=aos", "--axis", "layout=soa"}), 2,
                   "--axis: argument: found layout twice" + once);
    expect_refusal(render_with({"--axis", "layout=aos", "--axis", "layout=soa"}), 2,
                   "--axis: argument: found layout twice" + once);
    expect_refusal({"verify", "--scene", "cornell_open", "--tune", "jitters=1", "--tune", "jitters=2"}, 2,
                   "--tune: argument: found jitters twice" + once);
    expect_refusal(run_with({"--scene", "cornell_open", "--depth", "2,3,2"}), 2,
                   "--depth: argument: found 2 twice" + once);
    expect_refusal({"run", "--scene", "cornell_open", "--resolution", "8x6,8x6"}, 2,
                   "--resolution: argument: found \"8x6\" twice" + once);
    expect_refusal(run_with({"--scene", "cornell_open,cornell_open"}), 2,
                   "--scene: argument: found \"cornell_open\" twice" + once);
    expect_refusal({"stability", "--case", "lamp", "--set", "a=0.1", "--set", "a=0.2"}, 2,
                   "--set: argument: found a twice" + once);
    // The case is named by its name and by its number in the catalogue.
    for (const char* again : {"lamp", "S5"}) {
        expect_refusal({"stability", "--case", "lamp", "--case", again}, 2,
                       "--case: argument: found \"lamp\" twice" + once);
    }
    expect_refusal({"stability", "--family", "cavities", "--family", "cavities"}, 2,
                   "--family: argument: found \"cavities\" twice" + once);
    for (const std::string flag : {"--depth", "--spp", "--seed", "--repetitions"}) {
        expect_refusal({"run", "--scene", "cornell_open", flag, "2", flag, "3"}, 2, flag + ": found it 2 times" + once);
    }
    expect_refusal(run_with({"--scene", "cornell_open", "--benchmark_filter=a", "--benchmark_filter=b"}), 2,
                   "command line: flag: found --benchmark_filter twice" + once);
}

TEST(BadCallsTest, NamesThatAreNearlyRight) {
    expect_refusal({"rnu"}, 2, "The following argument was not expected: rnu (did you mean \"run\"?)");
    expect_refusal(run_with({"--sceen", "cornell_open"}), 2,
                   "command line: argument: found \"--sceen\", allowed: the options of `ptbench run --help` and "
                   "--benchmark_* flags (did you mean \"--scene\"?)");
    const auto refused = [](const Arguments& arguments) { return ptbench(arguments).err; };
    EXPECT_TRUE(refused({"verify", "--scene", "cornel_open"}).ends_with("(did you mean \"cornell_open\"?)\n"));
    EXPECT_TRUE(refused({"run", "--suite", "quik"}).ends_with("(did you mean \"quick\"?)\n"));
    EXPECT_TRUE(refused({"stability", "--case", "lampp"}).ends_with("(did you mean \"lamp\"?)\n"));
    EXPECT_TRUE(refused({"verify", "--sceen", "x"}).find("found --sceen (did you mean \"--scene\"?)") !=
                std::string::npos);
}

// Google Benchmark empties its output file when it begins, whatever it is.
TEST(BadCallsTest, BenchmarkOutIsANewFile) {
    const TemporaryFolder folder;
    const std::string result = folder.file("result.json");
    write_text(result, "somebody's");
    for (const std::string& file : {result, std::string("/dev/full"), folder.file("none/file.json")}) {
        expect_refusal(run_with({"--scene", "cornell_open", "--backend", "cpu", "--benchmark_out=" + file}), 2,
                       "--benchmark_out: file name: found \"" + file + "\", ");
    }
    EXPECT_EQ(content_of(result), "somebody's");
}

TEST(BadCallsTest, OnlyResultsTakeAResultsPlace) {
    const TemporaryFolder folder;
    const std::string result = folder.file("result.json"), source = folder.file("box.txt");
    const std::string text = R"({"context": {"ptbench.status": "completed", "date": "today"}})";
    write_text(result, text);
    write_text(source, "");
    expect_refusal({"import", source, "--out", result}, 2,
                   result + ": output file: found a complete result of today, allowed: another name");
    EXPECT_EQ(content_of(result), text);
}

TEST(BadCallsTest, NamesOfOutputFiles) {
    const std::string long_name(300, 'x');
    expect_refusal({"run", "--scene", "cornell_open", "--out", ""}, 2, "--out: found an empty name");
    expect_refusal({"stability", "--case", "lamp", "--out", ""}, 2, "--out: found an empty name");
    expect_refusal({"stability", "--case", "lamp", "--overwrite"}, 2, "--overwrite requires --out");
    expect_refusal({"run", "--scene", "cornell_open", "--backend", "cpu", "--out", long_name}, 2,
                   "--out: file name: found \"" + long_name + "\", a name of more than 200 bytes");
    for (const std::string name : {"t\x1b[31mx.json", "bad\xff.json"}) {
        expect_refusal({"run", "--scene", "cornell_open", "--backend", "cpu", "--out", name}, 2,
                       "--out: file name: found \"");
    }
}

// A terminal obeys what it is sent.
TEST(BadCallsTest, RawBytesAreNotEchoed) {
    for (const std::string name : {"\x1b[31mred", "\xff\xfe", "\xc2\x9b", "a\nb"}) {
        for (const Arguments& call : std::vector<Arguments>{{"verify", "--scene", name + ".json"},
                                                            {"verify", "--scene", name},
                                                            {"run", "--scene", "cornell_open", "--" + name},
                                                            {name}}) {
            const CommandResult result = ptbench(call);
            EXPECT_EQ(result.exit_code, 2);
            ASSERT_FALSE(result.err.empty());
            EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
            for (const char byte : result.err.substr(0, result.err.size() - 1)) {
                EXPECT_TRUE(byte >= 0x20 && byte < 0x7f) << result.err;
            }
        }
    }
}

TEST(BadCallsTest, MalformedScenesAndSuites) {
    const TemporaryFolder folder;
    const std::string scene = folder.file("scene.json"), suite = folder.file("suite.json");
    for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
             {"{", ": not valid JSON: "},
             {"{\"name\": \"a\", \"colour\": 1}",
              ": $: found unknown key \"colour\", allowed: name, description, max_depth, "},
             {"{\"name\": \"a\", \"max_depth\": 0}",
              ": $.max_depth: found 0, allowed: a whole number from 1 to 1000000\n"},
         }) {
        write_text(scene, text);
        expect_refusal({"render", "--scene", scene, "--out", "image.png"}, 2, scene + message);
        expect_refusal({"verify", "--scene", scene}, 2, scene + message);
        expect_refusal(run_with({"--scene", scene}), 2, scene + message);
    }
    write_text(suite,
               R"({"name": "s", "studies": [{"name": "a", "scenes": ["cornell_open"], "axes": {"colour": ["red"]}}]})");
    expect_refusal(run_with({"--suite", suite}), 2, suite + ": $.studies[0].axes: found axis \"colour\", allowed: ");
    write_text(
        suite,
        R"({"name": "s", "studies": [{"name": "a", "scenes": ["cornell_open"], "tunables": {"jitters": [4, 0]}}]})");
    expect_refusal(run_with({"--suite", suite}), 2,
                   suite + ": $.studies[0].tunables.jitters[1]: found 0, allowed: a whole number from 1 to 4096\n");
}

TEST(BadCallsTest, AHomeWithoutScenes) {
    const TemporaryFolder home;
    const CommandResult result = run_command(ptbench_arguments({"list"}),
                                             {.folder = "", .environment = {{"PTBENCH_HOME", home.path().string()}}});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, "ptbench: no folder scenes/ in " + home.path().string() +
                              ": set PTBENCH_HOME to the folder that holds it\n");
}

// `run` alone looks into every suite and its scenes before it reads them.
TEST(BadCallsTest, AHomeWithABadSuiteOrScene) {
    const TemporaryFolder home;
    std::filesystem::create_directories(home.path() / "scenes" / "suites");
    const std::string suite = home.file("scenes/suites/s.json"), scene = home.file("scenes/m.json");
    const auto expect_line = [&](const std::string& file, const std::string& text, const std::string& message) {
        write_text(file, text);
        const CommandResult result = run_command(ptbench_arguments({"run", "--backend", "cpu"}),
                                                 {.folder = "", .environment = {{"PTBENCH_HOME", home.path()}}});
        EXPECT_EQ(result.exit_code, 2) << text;
        EXPECT_TRUE(result.err.starts_with("ptbench: " + file + message)) << text << ": " << result.err;
        EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << text << ": " << result.err;
    };
    expect_line(suite, "", ": not valid JSON: ");
    expect_line(suite, "{", ": not valid JSON: ");
    expect_line(suite, "[]", ": $: found [], allowed: an object");
    expect_line(suite, R"({"name": "s", "studies": {}})", ": $.studies: found an object, allowed: an array");
    expect_line(suite, R"({"name": "s", "studies": [3]})", ": $.studies[0]: found 3, allowed: an object");
    expect_line(suite, R"({"name": "s", "studies": [{"name": "a", "scenes": 7}]})",
                ": $.studies[0].scenes: found 7, allowed: an array");
    expect_line(suite, R"({"name": "s", "studies": [{"name": "a", "scenes": [7]}]})",
                ": $.studies[0].scenes[0]: found 7, allowed: a string");
    write_text(suite, R"({"name": "s", "studies": [{"name": "a", "scenes": ["m"]}]})");
    expect_line(scene, "{", ": not valid JSON: ");
    expect_line(scene, "[]", ": $: found [], allowed: an object");
    expect_line(scene, R"({"name": "m", "objects": {"a": {"shape": "mesh"}}})", ": $");
}

TEST(BadCallsTest, HelpIsGood) {
    for (const Arguments& arguments :
         {Arguments{"--help"}, Arguments{"render", "--help"}, Arguments{"run", "--help"}}) {
        const CommandResult result = ptbench(arguments);
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_EQ(result.err, "");
        EXPECT_NE(result.out.find("Usage: "), std::string::npos);
    }
}

}  // namespace
}  // namespace pt::test
