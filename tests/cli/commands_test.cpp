// render, verify and machine as a user calls them.
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "harness/machine/machine.h"
#include "harness/render/renderer.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt::test {
namespace {

using nlohmann::json;

// ---- render ----

struct Rendered {
    CommandResult command;
    json summary;
    std::string image;
};

Rendered render_image(const std::vector<std::string>& added, const std::string& name = "image.pfm") {
    const TemporaryFolder folder;
    std::vector<std::string> arguments{"render", "--scene", "cornell_open",   "--resolution",
                                       "13x7",   "--out",   folder.file(name)};
    arguments.insert(arguments.end(), added.begin(), added.end());
    Rendered rendered{ptbench(arguments), {}, content_of(folder.file(name))};
    EXPECT_EQ(rendered.command.exit_code, 0) << rendered.command.err;
    EXPECT_EQ(rendered.command.err, "");
    EXPECT_EQ(folder.content(), std::vector<std::string>{name});
    rendered.summary = json::parse(rendered.command.out);
    return rendered;
}

TEST(RenderCommandTest, SaysHowManyTrianglesWithoutAreaItLeftOut) {
    const TemporaryFolder folder;
    write_text(folder.file("s.json"),
               R"({"name": "s", "max_depth": 1, "camera": {"eye": [0, 0, 5], "look_at": [0, 0, 0], "up": [0, 1, 0],
                   "vertical_fov_degrees": 40, "resolution": [2, 2]}, "materials": {"white": {"type": "diffuse",
                   "albedo": [1, 1, 1]}}, "objects": [{"shape": "mesh", "material": "white", "vertices": [[0, 0, 0],
                   [1, 0, 0], [0, 1, 0], [2, 0, 0]], "triangles": [[0, 1, 2], [0, 1, 1], [0, 1, 3]]}]})");
    const CommandResult result = ptbench(
        {"render", "--scene", folder.file("s.json"), "--spp", "1", "--backend", "cpu", "--out", folder.file("s.pfm")});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "note: scene s: mesh of the scene file: 2 triangles without area left out\n");
}

TEST(RenderCommandTest, SaysWhatItPassesOverInAMeshFile) {
    const TemporaryFolder folder;
    write_text(folder.file("s.json"),
               R"({"name": "s", "max_depth": 1, "camera": {"eye": [0, 0, 5], "look_at": [0, 0, 0], "up": [0, 1, 0],
                   "vertical_fov_degrees": 40, "resolution": [2, 2]}, "materials": {"white": {"type": "diffuse",
                   "albedo": [1, 1, 1]}}, "objects": [{"shape": "mesh", "material": "white", "file": "a.obj"},
                   {"shape": "mesh", "material": "white", "file": "a.obj", "translate": [5, 0, 0]},
                   {"shape": "mesh", "material": "white", "vertices": [[500000.123, 4649776.42, 0],
                   [500001.123, 4649776.42, 0], [500000.123, 4649777.42, 0]], "triangles": [[0, 1, 2]]}]})");
    write_text(folder.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\n");
    const CommandResult result = ptbench(
        {"render", "--scene", folder.file("s.json"), "--spp", "1", "--backend", "cpu", "--out", folder.file("s.pfm")});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err,
              "warning: scene s: mesh a.obj: line 5: p or l is passed over: points and lines have no area\n"
              "warning: scene s: mesh of the scene file: $.objects[2].vertices[0]: coordinates with more digits than "
              "single precision has: vertices are moved by up to 0.08, of a mesh 1 across whose edges are 1.1 long on "
              "average; take an origin such as (500001, 4649777, 0) from them, and give it to the object as its "
              "\"translate\"\n");
}

TEST(RenderTest, TheSummaryHasTheFixedKeys) {
    const json summary = render_image({"--spp", "3"}).summary;
    ASSERT_EQ(summary.at("mean_rgb").size(), 3u);
    for (const json& mean : summary.at("mean_rgb")) {
        EXPECT_GT(mean.get<double>(), 0);
    }
    EXPECT_EQ(summary.at("film_hash").get<std::string>().size(), 16u);
    EXPECT_EQ(summary.at("nonfinite"), 0);
    EXPECT_EQ(summary.at("negative"), 0);
    EXPECT_EQ(summary.at("paths"), 13 * 7 * 3);
    EXPECT_GE(summary.at("rays").get<int>(), 13 * 7 * 3);
    EXPECT_EQ(summary.at("unfinished_walks"), 0);
    EXPECT_GT(summary.at("seconds").get<double>(), 0);
    EXPECT_EQ(summary.at("resolution"), json({13, 7}));
    EXPECT_EQ(summary.at("spp"), 3);
    EXPECT_EQ(summary.at("depth"), 8);  // the scene's
    EXPECT_EQ(summary.at("seed"), 1);
    EXPECT_EQ(summary.at("backend"), "cpu");
    EXPECT_EQ(summary.at("kernel"), "exact");
    EXPECT_EQ(summary.at("device_seconds"), summary.at("render_seconds"));
    EXPECT_EQ(summary.at("compile_seconds"), 0);  // of kernels at run time: there are none on the CPU
    EXPECT_EQ(summary.at("variant"), "packet");
}

// A repeated render has the film of a single one, and a time for each render after it.
TEST(RenderTest, RepeatsARenderForItsTimes) {
    const json once = render_image({"--spp", "3"}).summary;
    EXPECT_FALSE(once.contains("repetitions"));
    const json summary = render_image({"--spp", "3", "--repetitions", "2"}).summary;
    EXPECT_EQ(summary.at("film_hash"), once.at("film_hash"));
    ASSERT_EQ(summary.at("repetitions").size(), 2u);
    for (const json& one : summary.at("repetitions")) {
        EXPECT_GT(one.at("render_seconds").get<double>(), 0);
        EXPECT_EQ(one.at("device_seconds"), one.at("render_seconds"));
        EXPECT_TRUE(one.contains("foreign_cpu_seconds"));
    }
}

// The fastest integrator that goes with the scene and with what the call names; never another film.
TEST(RenderTest, TakesTheFastestIntegratorThatApplies) {
    const auto rendered = [](const std::vector<std::string>& axes) {
        std::vector<std::string> added{"--spp", "2", "--backend", "cpu"};
        for (const std::string& axis : axes) {
            added.insert(added.end(), {"--axis", axis});
        }
        return render_image(added).summary;
    };
    const json fastest = rendered({});
    EXPECT_EQ(fastest.at("variant"), "packet");
    EXPECT_EQ(fastest.at("chosen_by"), "ptbench: the fastest integrator known that goes with the scene and the call");
    const json named = rendered({"integrator=wavefront"});
    EXPECT_EQ(named.at("variant"), "wavefront");
    EXPECT_EQ(named.at("chosen_by"), "the call");
    EXPECT_EQ(rendered({"compaction=thrust_remove_if"}).at("variant"), "wavefront compaction=thrust_remove_if");
    EXPECT_EQ(rendered({"specialisation=generic", "precision=double"}).at("variant"),
              "depth_first specialisation=generic precision=double");
    const json connected = rendered({"direct_light=nee"});
    EXPECT_EQ(connected.at("variant"), "packet direct_light=nee light_sampling=auto");
    EXPECT_EQ(connected.at("chosen_by"),
              fastest.at("chosen_by").get<std::string>() + "; light_sampling=auto for its connections");
    const json all_named = rendered({"integrator=depth_first", "direct_light=nee", "light_sampling=solid_angle"});
    EXPECT_EQ(all_named.at("variant"), "depth_first direct_light=nee");
    EXPECT_EQ(all_named.at("chosen_by"), "the call");
    EXPECT_EQ(fastest.at("film_hash"), named.at("film_hash"));
}

// People who look on are told which variant it was, where the file is, and how to open it. (A log has the summary: no
// test here has a word on standard error.)
TEST(RenderTest, OnATerminalItSaysWhereTheFileIs) {
    const TemporaryFolder folder;
    const CommandResult shown = run_command(
        {"/usr/bin/script", "-qec",
         test::program_file() + " render --scene cornell_open --backend cpu --resolution 4x3 --spp 1 --out image.png",
         "/dev/null"},
        in_repository({.folder = folder.path()}));
    EXPECT_EQ(shown.exit_code, 0);
    const std::string file = std::filesystem::canonical(folder.path() / "image.png").string();
    EXPECT_NE(shown.out.find("rendered with packet on cpu, chosen by ptbench: the fastest integrator known that goes "
                             "with the scene and the call\r\nwritten: " +
                             file + "\r\nopen it: xdg-open '" + file + "'\r\n"),
              std::string::npos)
        << shown.out;
}

TEST(RenderTest, PngHasTheSizeThatWasAskedFor) {
    const std::string png = render_image({"--spp", "1"}, "image.png").image;
    ASSERT_GT(png.size(), 33u);
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
    // IHDR: width, height, 8 bits a channel, RGB.
    EXPECT_EQ(png.substr(12, 14), std::string("IHDR\0\0\0\x0d\0\0\0\x07\x08\x02", 14));
    EXPECT_EQ(png.substr(png.size() - 8, 4), "IEND");
}

TEST(RenderTest, PfmHasTheExactBytesOfTheFilm) {
    const std::string pfm = render_image({"--spp", "2", "--seed", "5"}).image;
    const Scene scene = load_scene(test::in_source("scenes/cornell_open.json"));
    RenderSettings settings = default_settings(scene);
    settings.width = 13;
    settings.height = 7;
    settings.seed = 5;
    const Film film =
        render(scene, {.variant = Registry::instance().baseline(), .settings = settings, .samples = 2}).film;
    std::string expected = "PF\n13 7\n-1.0\n";
    const std::vector<float> values = film.radiance();
    for (int y = 6; y >= 0; --y) {  // from bottom to top
        expected.append(reinterpret_cast<const char*>(&values[static_cast<std::size_t>(y) * 13 * 3]),
                        13 * 3 * sizeof(float));
    }
    EXPECT_TRUE(pfm == expected);
}

TEST(RenderTest, TheSeedDecidesTheFilm) {
    const auto hash = [](const std::vector<std::string>& added) {
        return render_image(added).summary.at("film_hash").get<std::string>();
    };
    const std::string first = hash({"--spp", "2", "--seed", "1"});
    EXPECT_EQ(hash({"--spp", "2"}), first);  // the default
    EXPECT_EQ(hash({"--spp", "2", "--seed", "1", "--axis", "integrator=depth_first"}), first);
    EXPECT_EQ(hash({"--spp", "2", "--axis", "compaction=thrust_remove_if", "--axis", "layout=soa"}), first);
    EXPECT_NE(hash({"--spp", "2", "--seed", "2"}), first);
    EXPECT_NE(hash({"--spp", "2", "--seed", "18446744073709551615"}), first);
}

TEST(RenderTest, HonoursItsTunables) {
    const auto rendered = [](const std::vector<std::string>& added) {
        std::vector<std::string> arguments{"--spp", "3", "--backend", "cpu"};
        arguments.insert(arguments.end(), added.begin(), added.end());
        return render_image(arguments).summary;
    };
    const json off = rendered({});
    const json standard = rendered({"--axis", "first_bounce=cached_jitters"});
    const json one = rendered({"--axis", "first_bounce=cached_jitters", "--tune", "jitters=1"});
    const std::string kept = "depth_first first_bounce=cached_jitters";
    EXPECT_EQ(standard.at("variant"), kept);
    EXPECT_EQ(one.at("variant"), kept + " jitters=1");
    EXPECT_EQ(rendered({"--axis", "first_bounce=cached_jitters", "--tune", "jitters=16"}).at("variant"), kept);
    // A ray for each of the three samples is the film of no cache; one for all of them is another.
    EXPECT_EQ(standard.at("film_hash"), off.at("film_hash"));
    EXPECT_NE(one.at("film_hash"), off.at("film_hash"));
    EXPECT_LT(one.at("rays"), off.at("rays"));  // two camera rays of a pixel were not traced
}

TEST(RenderTest, HonoursItsSettings) {
    const json shallow = render_image({"--spp", "4", "--depth", "1"}).summary;
    EXPECT_EQ(shallow.at("depth"), 1);
    EXPECT_EQ(shallow.at("paths"), 13 * 7 * 4);
    EXPECT_EQ(shallow.at("rays"), shallow.at("paths"));  // one segment a path
    const json deep = render_image({"--spp", "4", "--depth", "3"}).summary;
    EXPECT_GT(deep.at("rays").get<int>(), shallow.at("rays").get<int>());
    EXPECT_LE(deep.at("rays").get<int>(), 3 * shallow.at("rays").get<int>());
    const json lit = render_image({"--spp", "4", "--axis", "direct_light=final_bounce"}).summary;
    EXPECT_EQ(lit.at("variant"), "packet direct_light=final_bounce");
    EXPECT_EQ(render_image({}).summary.at("spp"), 16);
}

// Times are not what a render is for: beside other jobs its threads must not spin (results/*/waiting.txt).
TEST(RenderTest, ThreadsThatWaitDoNotSpin) {
    const TemporaryFolder folder;
    const std::string script = R"(
        env -u OMP_WAIT_POLICY -u GOMP_SPINCOUNT "$0" render --scene cornell_open --backend cpu --spp 100000 --out "$1" &
        until tr '\0' '\n' </proc/$!/environ | grep GOMP_SPINCOUNT; do kill -0 $! || exit 1; sleep 0.01; done
        kill $!)";
    EXPECT_EQ(
        run_command({"/bin/bash", "-c", script, test::program_file(), folder.file("image.png")}, in_repository()).out,
        "GOMP_SPINCOUNT=0\n");
}

TEST(RenderTest, ReplacesAnImageAndLeavesItWhereItFails) {
    const TemporaryFolder folder;
    const std::string image = folder.file("image.pfm");
    write_text(image, "an older image");
    EXPECT_EQ(ptbench({"render", "--scene", "cornell_open", "--axis", "first_bounce=cached", "--out", image}).exit_code,
              2);
    EXPECT_EQ(content_of(image), "an older image");
    EXPECT_EQ(
        ptbench({"render", "--scene", "cornell_open", "--resolution", "4x3", "--spp", "1", "--out", image}).exit_code,
        0);
    EXPECT_EQ(content_of(image).substr(0, 7), "PF\n4 3\n");
}

// The test's hook makes each phase as if it took long.
TEST(RenderTest, APhaseThatTakesLongIsTold) {
    const TemporaryFolder folder;
    const CommandResult rendered = ptbench({"render", "--scene", "cornell_open", "--backend", "cpu", "--resolution",
                                            "8x8", "--spp", "2", "--out", "image.png"},
                                           {.folder = folder.path(), .environment = {{"PTBENCH_PATIENCE", "0"}}});
    EXPECT_EQ(rendered.exit_code, 0);
    EXPECT_EQ(rendered.err,
              "render: reading the scene: 0:00 so far\nrender: getting ready: 0:00 so far\n"
              "render: rendering: 0:00 so far\nrender: writing image.png: 0:00 so far\n");
}

// 20 times 4 to the size triangles: 80, and 320.
TEST(RenderTest, OverAFewHundredTrianglesATreeIsTaken) {
    const TemporaryFolder folder;
    const auto rendered = [&](int size, const std::vector<std::string>& axes) {
        write_text(folder.file("ball.json"), R"({"name": "ball", "max_depth": 3, "environment": [1, 1, 1],
            "camera": {"eye": [0, 0, 4], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40, "resolution": [16, 16]},
            "materials": {"white": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]}},
            "objects": [{"shape": "mesh", "generate": {"mesh": "icosphere", "size": )" +
                                                 std::to_string(size) + R"(}, "material": "white"}]})");
        std::vector<std::string> call{"render", "--scene", "ball.json", "--backend", "cpu",
                                      "--spp",  "2",       "--out",     "a.png"};
        for (const std::string& axis : axes) {
            call.insert(call.end(), {"--axis", axis});
        }
        const CommandResult result = ptbench(call, {.folder = folder.path()});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return json::parse(result.out);
    };
    const std::string fastest = "ptbench: the fastest integrator known that goes with the scene and the call";
    const json few = rendered(1, {});
    EXPECT_EQ(few.at("axes").at("accelerator"), "brute_force");
    EXPECT_EQ(few.at("chosen_by"), fastest);
    const json many = rendered(2, {});
    EXPECT_EQ(many.at("axes").at("accelerator"), "bvh8");
    EXPECT_EQ(many.at("chosen_by"), fastest + "; accelerator=bvh8 for its 320 triangles");
    const json named = rendered(2, {"integrator=wavefront"});
    EXPECT_EQ(named.at("axes").at("accelerator"), "bvh8");
    EXPECT_EQ(named.at("chosen_by"), "the call; ptbench: accelerator=bvh8 for its 320 triangles");
    const json brute = rendered(2, {"accelerator=brute_force"});
    EXPECT_EQ(brute.at("axes").at("accelerator"), "brute_force");
    EXPECT_EQ(brute.at("chosen_by"), fastest);
    EXPECT_EQ(brute.at("film_hash"), many.at("film_hash"));
    const CommandResult run = ptbench({"run", "--scene", "ball.json", "--backend", "cpu", "--resolution", "8x8",
                                       "--repetitions", "1", "--spp", "1", "--quiet", "--out", "r.json"},
                                      {.folder = folder.path()});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err, "ball: accelerator=bvh8 for its 320 triangles\n");
}

// So few samples a pixel that none is spent on finding out how long the others take.
TEST(RenderTest, ALargeRenderSaysWhatItIsAndASmallOneNothing) {
    const TemporaryFolder folder;
    const auto rendered = [&](const std::string& resolution) {
        return ptbench({"render", "--scene", "cornell_open", "--backend", "cpu", "--resolution", resolution, "--depth",
                        "1", "--axis", "integrator=packet", "--spp", "8", "--out", folder.file("image.png")});
    };
    const CommandResult small = rendered("64x64");
    EXPECT_EQ(small.exit_code, 0);
    EXPECT_EQ(small.err, "");
    const CommandResult large = rendered("1024x1024");
    EXPECT_EQ(large.exit_code, 0);
    EXPECT_EQ(large.err.find("render: 1024x1024, 8 spp, packet"), 0u) << large.err;
    EXPECT_NE(large.err.find("[8/8] render: "), std::string::npos) << large.err;
    EXPECT_NE(large.err.find("8 of 8 spp"), std::string::npos) << large.err;
}

TEST(RenderTest, WorksFromAnotherFolderAndWithAnotherHome) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "home" / "scenes" / "suites");
    std::filesystem::create_directories(folder.path() / "work");
    std::filesystem::copy_file(test::in_source("scenes/ball_glass.json"),
                               folder.path() / "home" / "scenes" / "mine.json");
    const CommandOptions options{.folder = folder.file("work"), .environment = {{"PTBENCH_HOME", folder.file("home")}}};
    const std::vector<std::string> call{"render", "--scene", "mine",  "--resolution", "4x3",
                                        "--spp",  "1",       "--out", "new/image.png"};
    const CommandResult result = run_command(ptbench_arguments(call), options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(std::filesystem::exists(folder.file("work/new/image.png")));
    // And a scene by a path relative to the folder of the call.
    std::filesystem::copy_file(test::in_source("scenes/ball_glass.json"), folder.path() / "work" / "here.json");
    EXPECT_EQ(run_command(ptbench_arguments({"render", "--scene", "here.json", "--resolution", "4x3", "--spp", "1",
                                             "--out", "b.png"}),
                          options)
                  .exit_code,
              0);
}

// A packaged or built binary finds the scenes beside itself or one folder up, wherever it is called from.
TEST(RenderTest, FindsTheScenesFromWhereTheBinaryLies) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "build");
    std::filesystem::create_directories(folder.path() / "elsewhere");
    std::filesystem::copy_file(test::program_file(), folder.path() / "build" / "ptbench");
    std::filesystem::create_directory_symlink(test::in_source("scenes"), folder.path() / "scenes");
    const CommandOptions options{.folder = folder.file("elsewhere"), .environment = {{"PTBENCH_HOME", ""}}};
    const CommandResult result =
        run_command({folder.file("build/ptbench"), "list", "--scene", "cornell_open"}, options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::filesystem::remove(folder.path() / "scenes");
    std::filesystem::create_directory_symlink(test::in_source("scenes"), folder.path() / "build" / "scenes");
    EXPECT_EQ(run_command({folder.file("build/ptbench"), "list", "--scene", "cornell_open"}, options).exit_code, 0);
}

// ---- verify ----

TEST(VerifyCommandTest, PrintsAHashAVariantAndTheTally) {
    const CommandResult result =
        ptbench({"verify", "--scene", "cornell_open,ball_glass", "--resolution", "8x6", "--spp", "2", "--axis",
                 "compaction=none,thrust_partition", "--axis", "direct_light=off", "--axis", "specialisation=features",
                 "--axis", "sorting=none", "--axis", "precision=float", "--axis", "integrator=wavefront,depth_first"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    // A scene: wavefront, 2 compactions, 2 layouts; depth_first; each with the first bounce off and with camera rays
    // kept; packet without. The rest (cached, depth_first and packet with a queue) does not apply.
    EXPECT_NE(result.out.find(
                  "20 held, 0 failed, 28 not applicable on cpu; 8x6 at 2 spp, scenes: cornell_open, ball_glass\n"),
              std::string::npos)
        << result.out;
    EXPECT_NE(result.out.find(" wavefront compaction=thrust_partition layout=soa on ball_glass: ok, film bits equal "
                              "to depth_first specialisation=generic\n"),
              std::string::npos)
        << result.out;
    // What does not apply is told by its reason, once a scene.
    EXPECT_NE(result.out.find("n/a              "
                              "wavefront first_bounce=cached and 4 more on cornell_open: first_bounce=cached needs "
                              "jitter off (camera.jitter is true in the scene)\n"),
              std::string::npos)
        << result.out;
    EXPECT_LT(std::count(result.out.begin(), result.out.end(), '\n'), 20 + 28);
    // Every hash of a scene is the same: 16 camera rays are kept of the 2 that are traced.
    std::set<std::string> hashes;
    for (std::size_t at = result.out.find(" on cornell_open: ok"); at != std::string::npos;
         at = result.out.find(" on cornell_open: ok", at + 1)) {
        hashes.insert(result.out.substr(result.out.rfind('\n', at) + 1, 16));
    }
    EXPECT_EQ(hashes.size(), 1u);
}

TEST(VerifyCommandTest, SeveralProcessesPrintWhatOnePrints) {
    std::vector<std::string> arguments{"verify",
                                       "--scene",
                                       "cornell_open,ball_glass",
                                       "--backend",
                                       "cpu",
                                       "--resolution",
                                       "8x6",
                                       "--axis",
                                       "direct_light=off,nee",
                                       "--axis",
                                       "first_bounce=off,cached",
                                       "--jobs",
                                       "1"};
    const CommandResult alone = ptbench(arguments);
    EXPECT_EQ(alone.exit_code, 0) << alone.err;
    arguments.back() = "3";
    const CommandResult at_once = ptbench(arguments);
    EXPECT_EQ(at_once.exit_code, 0) << at_once.err;
    EXPECT_GT(std::count(alone.out.begin(), alone.out.end(), '\n'), 50);
    EXPECT_EQ(at_once.out, alone.out);
}

TEST(VerifyCommandTest, QuietPrintsTheTallyOnly) {
    const CommandResult result = ptbench({"verify", "--scene", "jitter_off", "--resolution", "6x4", "--spp", "1",
                                          "--depth", "2", "--seed", "9", "--quiet"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    // 29 variants with a queue or without in 2 kernels and one in double, with 4 kinds of direct light, the first
    // bounce off and cached: 529; more in which roulette and samplers meet them, as many as it takes, and every way to
    // draw lights with every estimator that connects.
    EXPECT_GT(std::stoi(result.out), 529);
    const std::size_t text = result.out.find(' ');
    ASSERT_NE(text, std::string::npos);
    EXPECT_EQ(result.out.substr(text),
              " held, 0 failed, 15595 not applicable on cpu; 6x4 at 1 spp, scenes: jitter_off\n");
}

TEST(VerifyCommandTest, NothingHeldIsNoSuccess) {
    const CommandResult result = ptbench(
        {"verify", "--scene", "cornell_open", "--resolution", "4x3", "--axis", "first_bounce=cached", "--quiet"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.out, "0 held, 0 failed, 5400 not applicable on cpu; 4x3 at 4 spp, scenes: cornell_open\n");
}

// ---- verify --statistical ----

CommandResult statistical(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"verify", "--statistical", "--resolution", "16x12", "--spp", "8", "--runs", "8"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return ptbench(arguments);
}

TEST(VerifyCommandTest, StatisticalTestsEachImageThatClaimsAMeanOnce) {
    const CommandResult result = statistical({"--scene", "cornell_open", "--depth", "3"});
    EXPECT_EQ(result.exit_code, 0) << result.err << result.out;
    const std::string baseline = "same mean as depth_first specialisation=generic";
    EXPECT_NE(result.out.find(
                  "ok      depth_first direct_light=final_bounce specialisation=generic on cornell_open at depth 3: " +
                  baseline + " at depth 4: p image "),
              std::string::npos)
        << result.out;
    EXPECT_NE(result.out.find("ok      depth_first specialisation=matrix on cornell_open at depth 3: " + baseline +
                              " at depth 3: p image "),
              std::string::npos)
        << result.out;
    EXPECT_NE(
        result.out.find("n/a              depth_first first_bounce=cached_jitters specialisation=generic and 1 more "
                        "on cornell_open: claims no mean (--against"),
        std::string::npos)
        << result.out;
    EXPECT_NE(result.out.find(" means held, 0 failed, "), std::string::npos) << result.out;
    EXPECT_NE(result.out.find(" not applicable on cpu; 8 runs of 8 spp a side, 16x12\n"), std::string::npos)
        << result.out;
}

// One camera ray a pixel for all samples of a run: every run has another image.
TEST(VerifyCommandTest, AgainstTestsWhatIsDeclaredBiased) {
    const CommandResult result =
        ptbench({"verify", "--statistical", "--scene", "motion_on", "--spp", "32", "--against", "first_bounce=off",
                 "--axis", "first_bounce=off,cached_jitters", "--axis", "direct_light=off", "--axis",
                 "specialisation=generic", "--tune", "jitters=1"});
    EXPECT_EQ(result.exit_code, 1) << result.err << result.out;
    EXPECT_EQ(
        result.out.find(
            "FAILED  depth_first first_bounce=cached_jitters specialisation=generic jitters=1 on motion_on at depth 8: "
            "samples are not independent, tested with depth_first specialisation=generic at depth 8: independence "
            "(excess variance of a run): p image "),
        0u)
        << result.out;
}

TEST(VerifyCommandTest, StatisticalRefusesWhatItCannotDo) {
    const auto expect = [](const CommandResult& result, const std::string& message) {
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
    };
    expect(statistical({"--scene", "cornell_open", "--against", "first_bounce=off,cached"}),
           "--against: argument: found \"first_bounce=off,cached\", allowed: one choice an axis\n");
    expect(statistical({"--scene", "cornell_open", "--against", "layout=aos", "--against", "layout=soa"}),
           "--against: argument: found \"layout=soa\", allowed: one choice an axis\n");
    expect(ptbench({"verify", "--scene", "cornell_open", "--against", "layout=aos"}),
           "--against requires --statistical");
    expect(ptbench({"verify", "--scene", "cornell_open", "--runs", "8"}), "--runs requires --statistical");
    expect(ptbench({"verify", "--scene", "cornell_open", "--statistical", "--runs", "2"}), "--runs");
    expect(ptbench({"verify", "--scene", "cornell_open", "--statistical", "--spp", "1"}),
           "--spp: argument: found 1, allowed: with --statistical at least 2");
}

TEST(VerifyCommandTest, HoldsEveryValueOfATunable) {
    const CommandResult result = ptbench({"verify",
                                          "--scene",
                                          "cornell_open",
                                          "--resolution",
                                          "8x6",
                                          "--spp",
                                          "3",
                                          "--backend",
                                          "cpu",
                                          "--axis",
                                          "first_bounce=cached_jitters",
                                          "--axis",
                                          "integrator=wavefront,depth_first",
                                          "--axis",
                                          "compaction=none",
                                          "--axis",
                                          "sorting=none",
                                          "--axis",
                                          "layout=aos",
                                          "--axis",
                                          "direct_light=off",
                                          "--axis",
                                          "specialisation=features",
                                          "--axis",
                                          "precision=float",
                                          "--tune",
                                          "jitters=1,2,16"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("6 held, 0 failed, 0 not applicable on cpu; "), std::string::npos) << result.out;
    for (const char* tuning : {" jitters=1", " jitters=2", ""}) {
        EXPECT_NE(result.out.find(" wavefront first_bounce=cached_jitters" + std::string(tuning) +
                                  " on cornell_open: ok, film bits equal to depth_first first_bounce=cached_jitters "
                                  "specialisation=generic" +
                                  tuning + "\n"),
                  std::string::npos)
            << result.out;
    }
}

// ---- machine ----

TEST(MachineCommandTest, IsTheCpuWhereThereIsNoGpu) {
    const CommandResult result = ptbench({"machine"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, machine_name() + "\n");
}

// A line that finds no room is no fault of the program: short and long output alike.
TEST(MachineCommandTest, OutputThatDoesNotFitIsSaid) {
    for (const char* command : {" machine", " list"}) {
        const CommandResult result =
            run_command({"/bin/sh", "-c", program_file() + command + " > /dev/full"}, in_repository());
        EXPECT_EQ(result.exit_code, 3);
        EXPECT_EQ(result.err, "ptbench: standard output: cannot be written: No space left on device\n");
    }
}

}  // namespace
}  // namespace pt::test
