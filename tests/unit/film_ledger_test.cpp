// Who is blamed where films or work differ: whoever differs from the reference, however late and in whatever order, and
// nobody else. References are made up here; real ones render in runner_test and wrong_variants_test.
#include "harness/bench/film_ledger.h"

#include <gtest/gtest.h>

#include "harness/bench/convergence_study.h"
#include "tests/support/command.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

constexpr std::uint64_t first_seed = 5;
const Imprint right{.film = "right", .paths = 100, .rays = 300, .connections = 40};
const Imprint brighter{.film = "brighter", .paths = 100, .rays = 300, .connections = 40};

class FilmLedgerTest : public testing::Test {
protected:
    test::TemporaryFolder folder;
    Journal journal{folder.file("journal"), Json{{"cells", 3}}, false};
    Plan plan;
    std::vector<std::string> rendered;  // "VARIANT's integrator SPP SEED"

    FilmLedgerTest() {
        const auto scene = std::make_shared<const Scene>(test::SceneBuilder().scene);
        for (const char* compaction : {"thrust_partition", "none", "thrust_remove_if"}) {
            Cell cell;
            cell.name = std::string(compaction) + "/scene:s/backend:cpu/1x1/depth:1/spp:4";
            cell.scene = scene;
            cell.variant = Registry::instance().baseline(Backend::cpu);
            cell.variant.set("compaction", compaction);
            cell.spp = 4;
            plan.cells.push_back(cell);
        }
    }
    // Prepares cells as those whose renders take long, with 2 of their 4 spp: the reference of 4 spp is then rendered
    // only when films differ.
    void prepare_less() {
        for (Cell& cell : plan.cells) {
            cell.prepared_spp = 2;
        }
    }
    FilmLedger ledger() {
        return {plan, journal, first_seed,
                [this](const Cell&, const Variant& variant, std::uint32_t samples, std::uint64_t seed) {
                    rendered.push_back(fmt::format("{} {} {}", variant["integrator"], samples, seed));
                    return right;
                }};
    }
    void add_sample(const Cell& cell, const Imprint& imprint) {
        journal.add_sample(cell.name, {.paths = imprint.paths,
                                       .rays = imprint.rays - 1,
                                       .connections = imprint.connections,
                                       .cache_hits = 1,
                                       .film_hash = imprint.film});
    }
};

// The failed cells in words: "COMPACTION: REASON".
std::vector<std::string> told(const std::vector<FailedCell>& failed) {
    std::vector<std::string> texts;
    for (const FailedCell& one : failed) {
        texts.push_back(one.cell->variant["compaction"] + ": " + one.reason);
    }
    return texts;
}

using Texts = std::vector<std::string>;
const std::string of_reference = " of depth_first specialisation=generic";

TEST_F(FilmLedgerTest, TheFirstIsHeldToTheReference) {
    FilmLedger films = ledger();
    EXPECT_EQ(told(films.note_sample(plan.cells[0], 2, brighter)),
              Texts{"thrust_partition: sample 2 (seed 7): film brighter, not right" + of_reference});
    EXPECT_EQ(told(films.note_sample(plan.cells[1], 2, right)), Texts{});
    EXPECT_EQ(told(films.note_sample(plan.cells[2], 2, right)), Texts{});
    EXPECT_EQ(rendered, Texts{"depth_first 4 7"});  // once a seed
}

TEST_F(FilmLedgerTest, AllThatAgreeMayBeWrong) {
    FilmLedger films = ledger();
    EXPECT_EQ(films.note_sample(plan.cells[0], 0, brighter).size(), 1u);
    EXPECT_EQ(films.note_sample(plan.cells[1], 0, brighter).size(), 1u);
}

TEST_F(FilmLedgerTest, WorkIsHeldToTheReferences) {
    FilmLedger films = ledger();
    const auto with = [](std::uint64_t Imprint::*counter, std::uint64_t value) {
        Imprint changed = right;
        changed.*counter = value;
        return changed;
    };
    const auto reason = [&](const Imprint& found) {
        const std::vector<FailedCell> failed = films.note_sample(plan.cells[0], 0, found);
        return failed.size() == 1 ? failed[0].reason : "";
    };
    EXPECT_EQ(reason(with(&Imprint::rays, 297)), "sample 0 (seed 5): 297 rays, not 300" + of_reference);
    EXPECT_EQ(reason(with(&Imprint::paths, 99)), "sample 0 (seed 5): 99 paths, not 100" + of_reference);
    EXPECT_EQ(reason(with(&Imprint::connections, 41)),
              "sample 0 (seed 5): 41 connections to lights, not 40" + of_reference);
    EXPECT_EQ(reason(right), "");
}

// Who was noted as good before, and who was suspected.
TEST_F(FilmLedgerTest, AnEarlierSampleTurnsOutWrong) {
    prepare_less();
    FilmLedger films = ledger();
    EXPECT_EQ(told(films.note_sample(plan.cells[0], 0, brighter)), Texts{});
    EXPECT_EQ(rendered, Texts{});
    EXPECT_EQ(told(films.note_sample(plan.cells[1], 0, right)),
              Texts{"thrust_partition: sample 0 (seed 5): film brighter, not right" + of_reference});
    EXPECT_EQ(told(films.note_sample(plan.cells[2], 0, brighter)),
              Texts{"thrust_remove_if: sample 0 (seed 5): film brighter, not right" + of_reference});
    EXPECT_EQ(rendered, Texts{"depth_first 4 5"});
}

TEST_F(FilmLedgerTest, SamplesOfAnEarlierProcessAreBelievedNoMoreThanOthers) {
    prepare_less();
    add_sample(plan.cells[0], brighter);
    add_sample(plan.cells[0], brighter);
    add_sample(plan.cells[1], right);
    FilmLedger films = ledger();
    // Both of sample 0 are there already, and differ.
    EXPECT_EQ(told(films.note_sample(plan.cells[2], 0, right)),
              Texts{"thrust_partition: sample 0 (seed 5): film brighter, not right" + of_reference});
    EXPECT_EQ(told(films.note_sample(plan.cells[1], 1, right)),
              Texts{"thrust_partition: sample 1 (seed 6): film brighter, not right" + of_reference});
    EXPECT_EQ(told(films.note_sample(plan.cells[2], 1, right)), Texts{});
}

TEST_F(FilmLedgerTest, AnEarlierProcessMayBeRightAboutAWrongOneNow) {
    add_sample(plan.cells[1], right);
    FilmLedger films = ledger();
    EXPECT_EQ(told(films.note_sample(plan.cells[0], 0, brighter)),
              Texts{"thrust_partition: sample 0 (seed 5): film brighter, not right" + of_reference});
}

TEST_F(FilmLedgerTest, ARenderBeforeTheTimedOnesIsHeldToTheReferenceAlways) {
    prepare_less();
    FilmLedger films = ledger();
    EXPECT_EQ(told(films.note_preparation(plan.cells[0], brighter)),
              Texts{"thrust_partition: at full size, 2 spp, seed 5: film brighter, not right" + of_reference});
    EXPECT_EQ(told(films.note_preparation(plan.cells[1], right)), Texts{});
    EXPECT_EQ(rendered, Texts{"depth_first 2 5"});
    EXPECT_EQ(told(films.note_sample(plan.cells[1], 0, right)), Texts{});  // of more samples a pixel: another film
    EXPECT_EQ(told(films.note_sample(plan.cells[2], 0, brighter)),
              Texts{"thrust_remove_if: sample 0 (seed 5): film brighter, not right" + of_reference});
    EXPECT_EQ(rendered, (Texts{"depth_first 2 5", "depth_first 4 5"}));
}

TEST_F(FilmLedgerTest, AReferenceThatCannotBeRenderedIsNamed) {
    FilmLedger films(plan, journal, first_seed,
                     [](const Cell&, const Variant&, std::uint32_t, std::uint64_t) -> Imprint {
                         throw std::runtime_error("out of luck");
                     });
    std::string message;
    try {
        films.note_sample(plan.cells[0], 0, right);
    } catch (const std::runtime_error& error) {
        message = error.what();
    }
    EXPECT_EQ(message,
              "its reference, depth_first specialisation=generic, cannot be rendered with seed 5: out of luck");
}

}  // namespace
}  // namespace pt
