// The stability engine: what it calls passed, failed, known or broken; its parameters; the catalogue; its result file.
#include <cmath>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/json_reader.h"
#include "harness/scene/places.h"
#include "harness/stability/report.h"
#include "harness/write_file.h"

namespace pt::stability {
namespace {

Variant plainest() { return Registry::instance().reference(Registry::instance().baseline()); }

Json furnace_text() {
    SceneText scene("furnace");
    scene.image(4, 4, 90, true).depth(2);
    scene.sphere(scene.diffuse(Vec3d(0.5), Vec3d(0.5)), {0, 0, 0}, 2);
    return scene.json();
}

// Half of the sphere's inside is lit: an estimate with noise, of mean 0.5.
Json half_lit_text() {
    SceneText scene("half_lit");
    scene.image(1, 1, 90, false).depth(2);
    scene.quad(scene.diffuse(Vec3d(1.0)), {0, 0, 1}, 10, 10, {90, 0, 0});
    scene.box(scene.emitter(Vec3d(1.0)), {500, 0, -500}, {1000, 10000, 1000});
    return scene.json();
}

Case synthetic(const Json& scene, double exact, Tolerance tolerance, bool is_estimate) {
    Case stiff_case;
    stiff_case.name = "synthetic";
    stiff_case.catalogue = "P99";
    stiff_case.family = "own";
    stiff_case.renderings = [=](const Values&) {
        return std::vector<Rendering>{{.scene = scene,
                                       .quick_paths = 1u << 14,
                                       .full_paths = 1u << 14,
                                       .quantities = {{.name = "mean",
                                                       .of = mean_radiance,
                                                       .exact = exact,
                                                       .tolerance = tolerance,
                                                       .is_estimate = is_estimate}}}};
    };
    return stiff_case;
}

Row only_row(const Case& stiff_case, const Variant& variant = plainest()) {
    const std::vector<Row> rows = evaluate({&stiff_case, {}, Backend::cpu, variant, 1, true});
    EXPECT_EQ(rows.size(), 1u);
    return rows.at(0);
}

TEST(StabilityTest, ExactNumbersPassAndOthersFail) {
    const Tolerance tolerance{1e-6, 1e-6, "test"};
    const Row right = only_row(synthetic(furnace_text(), 0.75, tolerance, false));
    EXPECT_EQ(right.status, Status::passed);
    EXPECT_EQ(right.error, 0);
    const Row wrong = only_row(synthetic(furnace_text(), 0.75 + 2e-6, tolerance, false));
    EXPECT_EQ(wrong.status, Status::failed);
    EXPECT_NEAR(wrong.error_over_allowed(), 2, 1e-6);
}

TEST(StabilityTest, EstimatesHaveFourStandardErrorsAndASecondLook) {
    const Row right = only_row(synthetic(half_lit_text(), 0.5, {}, true));
    EXPECT_EQ(right.status, Status::passed) << right.measurement.measured;
    EXPECT_GT(right.measurement.standard_error, 0);
    EXPECT_EQ(right.allowed, 4 * right.measurement.standard_error);
    const Row wrong = only_row(synthetic(half_lit_text(), 0.55, {}, true));
    EXPECT_EQ(wrong.status, Status::failed);
    EXPECT_EQ(wrong.looks, 2);
    EXPECT_GT(wrong.paths, 3 * right.paths);
}

TEST(StabilityTest, KnownLimitsAreNotFailuresAndSayWhy) {
    Case stiff_case = synthetic(furnace_text(), 0.5, {}, false);
    stiff_case.known_limit = [](const Values&, const VariantTraits& variant) {
        return variant.precision.is_single() ? std::string("float has 24 bits; double would do") : std::string();
    };
    const Row row = only_row(stiff_case);
    EXPECT_EQ(row.status, Status::known_limit);
    EXPECT_EQ(row.reason, "float has 24 bits; double would do");
    Variant in_double = plainest();
    in_double.set("precision", "double");
    EXPECT_EQ(only_row(stiff_case, in_double).status, Status::failed);
}

TEST(StabilityTest, WhatGivesNoNumberIsBrokenAndWhatCannotBeAskedNotApplicable) {
    Case broken = synthetic(furnace_text(), 0.75, {}, false);
    broken.renderings = [](const Values&) -> std::vector<Rendering> { throw InputError("no such scene"); };
    EXPECT_EQ(only_row(broken).status, Status::broken);
    EXPECT_EQ(only_row(broken).reason, "no such scene");
    Case missing = broken;
    missing.missing_feature = "ptbench has no triangles";
    EXPECT_EQ(only_row(missing).status, Status::not_applicable);
    Case nan = synthetic(furnace_text(), 0.75, {1, 1, "test"}, false);
    nan.renderings = nullptr;
    nan.direct = [](const Values&, const DirectSetting&) {
        return std::vector<Measurement>{
            {.quantity = "x", .measured = std::nan(""), .exact = 0, .tolerance = {1, 1, ""}}};
    };
    EXPECT_EQ(only_row(nan).status, Status::failed);
}

TEST(StabilityTest, OnlyRobustKernelsWithoutFastArithmeticMustPass) {
    Variant variant = plainest();
    EXPECT_TRUE(must_pass(variant, Backend::cpu));
    variant.set("robustness", "naive");
    EXPECT_FALSE(must_pass(variant, Backend::cpu));
}

TEST(StabilityTest, ParametersHaveRanges) {
    Case stiff_case = synthetic(furnace_text(), 0.75, {}, false);
    stiff_case.parameters = {{"a", 0.1, 0.01, 1, "radius"}, {"n", 4, 1, 9, "count", true}};
    EXPECT_EQ(values_of(stiff_case, {})["a"], 0.1);
    EXPECT_EQ(values_of(stiff_case, {{"a", 0.5}})["a"], 0.5);
    EXPECT_THROW(values_of(stiff_case, {{"a", 2}}), InputError);
    EXPECT_THROW(values_of(stiff_case, {{"a", std::nan("")}}), InputError);
    EXPECT_THROW(values_of(stiff_case, {{"n", 2.5}}), InputError);
    EXPECT_THROW(values_of(stiff_case, {{"b", 1}}), InputError);
}

TEST(StabilityCatalogueTest, EveryCaseOfTheCatalogueIsThereAndSaysWhatItIs) {
    std::set<std::string> names;
    std::set<std::string> numbers;
    for (const Case& stiff_case : catalogue()) {
        EXPECT_TRUE(names.insert(stiff_case.name).second) << stiff_case.name;
        numbers.insert(stiff_case.catalogue);
        EXPECT_FALSE(stiff_case.title.empty() || stiff_case.stiff.empty() || stiff_case.formula.empty())
            << stiff_case.name;
        const int ways = (stiff_case.renderings ? 1 : 0) + (stiff_case.twins ? 1 : 0) + (stiff_case.direct ? 1 : 0) +
                         (stiff_case.missing_feature.empty() ? 0 : 1);
        EXPECT_EQ(ways, 1) << stiff_case.name;
        for (const auto& points : {stiff_case.points, stiff_case.quick_points}) {
            for (const auto& point : points) {
                EXPECT_NO_THROW(values_of(stiff_case, point)) << stiff_case.name;
            }
        }
    }
    for (int number = 1; number <= 48; ++number) {
        if (number != 23) {  // malformed input: tests/fuzz
            EXPECT_TRUE(numbers.contains("S" + std::to_string(number))) << "S" << number;
        }
    }
    int own = 0;
    for (const std::string& number : numbers) {
        own += number[0] == 'P' ? 1 : 0;
    }
    EXPECT_GE(own, 6);
}

TEST(StabilityCatalogueTest, ShippedScenesAreThoseOfTheCases) {
    const std::filesystem::path folder = home_folder() / "scenes" / "stability";
    std::set<std::string> expected;
    for (const Case& stiff_case : catalogue()) {
        for (const auto& [name, text] : scene_files(stiff_case)) {
            expected.insert(name + ".json");
            EXPECT_EQ(read_file((folder / (name + ".json")).string()), text)
                << "ptbench stability --write-scenes scenes/stability";
        }
    }
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        EXPECT_TRUE(expected.contains(entry.path().filename().string())) << entry.path();
    }
}

class ReportTest : public testing::Test {
protected:
    std::string file() const {
        return (std::filesystem::path(testing::TempDir()) / "stability_report_test.json").string();
    }
    ~ReportTest() override { std::filesystem::remove(file()); }
};

TEST_F(ReportTest, IsReadBackToGoOnAndRefusesWhatIsNotItsOwn) {
    const Case stiff_case = synthetic(furnace_text(), 0.75, {1e-6, 1e-6, "test"}, false);
    const Task task{&stiff_case, {}, Backend::cpu, plainest(), 1, true};
    const RunDescription description{"ptbench stability", Backend::cpu, true, 1};
    {
        Report report(file(), description, Report::IfThere::refuse);
        EXPECT_FALSE(report.has(task));
        report.add(task, to_json(task, evaluate(task)));
        report.save();
        EXPECT_TRUE(report.has(task));
        EXPECT_EQ(report.passed(), 1u);
        EXPECT_EQ(report.must_pass_failures(), 0u);
    }
    const Json written = Json::parse(read_file(file()));
    EXPECT_EQ(written["context"]["ptbench.status"], "interrupted");
    EXPECT_EQ(written["rows"][0]["measured"], 0.75);
    EXPECT_EQ(written["rows"][0]["status"], "passed");
    Report resumed(file(), description, Report::IfThere::resume);
    EXPECT_TRUE(resumed.has(task));
    EXPECT_EQ(resumed.passed(), 1u);
    EXPECT_THROW(Report(file(), description, Report::IfThere::refuse), InputError);
    RunDescription other_seed = description;
    other_seed.seed = 2;
    EXPECT_THROW(Report(file(), other_seed, Report::IfThere::resume), InputError);
    Json other_build = written;
    other_build["context"]["ptbench.program_hash"] = "0";
    write_file(file(), other_build.dump());
    EXPECT_THROW(Report(file(), description, Report::IfThere::resume), InputError);
    write_file(file(), "{}");
    EXPECT_THROW(Report(file(), description, Report::IfThere::resume), InputError);
}

TEST_F(ReportTest, AnEarlierOneStaysUntilTheNewOneIsFinished) {
    const Case stiff_case = synthetic(furnace_text(), 0.75, {1e-6, 1e-6, "test"}, false);
    const Task task{&stiff_case, {}, Backend::cpu, plainest(), 1, true};
    const RunDescription description{"ptbench stability", Backend::cpu, true, 1};
    const std::string beside = file() + ".unfinished";
    const std::string earlier = "what was there";
    write_file(file(), earlier);
    {
        Report report(file(), description, Report::IfThere::overwrite);
        report.add(task, to_json(task, evaluate(task)));
        report.save();  // as after an interrupt
    }
    EXPECT_EQ(read_file(file()), earlier);
    EXPECT_TRUE(std::filesystem::exists(beside));
    EXPECT_THROW(Report(file(), description, Report::IfThere::overwrite), InputError);
    Report resumed(file(), description, Report::IfThere::resume);
    EXPECT_TRUE(resumed.has(task));
    resumed.finish();
    EXPECT_FALSE(std::filesystem::exists(beside));
    EXPECT_EQ(Json::parse(read_file(file()))["context"]["ptbench.status"], "completed");
}

TEST(SceneTextTest, ScalesBrightensAndMovesWhatHasAUnit) {
    SceneText text("all");
    text.camera({1, 2, 3}, {1, 2, 4}).lens(0.5, 2);
    text.sphere(text.subsurface(Vec3d(4.0), Vec3d(2.0)), {1, 0, 0}, 3).velocity({1, 0, 0});
    text.quad(text.emitter(Vec3d(8.0)), {0, 4, 0}, 1, 2);
    const Json twice = scaled(text.json(), 2);
    EXPECT_EQ(twice["camera"]["eye"], Json({2.0, 4.0, 6.0}));
    EXPECT_EQ(twice["camera"]["aperture_radius"], 1.0);
    EXPECT_EQ(twice["objects"][0]["scale"], 6.0);
    EXPECT_EQ(twice["objects"][0]["velocity"], Json({2.0, 0.0, 0.0}));
    EXPECT_EQ(twice["materials"]["subsurface_0"]["sigma_s"], Json({2.0, 2.0, 2.0}));
    EXPECT_EQ(twice["materials"]["emitter_1"]["radiance"], Json({8.0, 8.0, 8.0}));
    EXPECT_EQ(brightened(text.json(), 2)["materials"]["emitter_1"]["radiance"], Json({16.0, 16.0, 16.0}));
    EXPECT_EQ(moved(text.json(), {0, 0, 1})["objects"][1]["translate"], Json({0.0, 4.0, 1.0}));
    EXPECT_NO_THROW(parse_scene(twice.dump(), "twice"));
}

}  // namespace
}  // namespace pt::stability
