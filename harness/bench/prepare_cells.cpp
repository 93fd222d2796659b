#include "harness/bench/prepare_cells.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "harness/bench/instrumented.h"
#include "harness/bench/short_names.h"
#include "harness/bench/verify.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

// The size at which a cell is verified: at most 48 pixels on the longer side, enough to see every object, and quick.
RenderSettings verification_settings(RenderSettings settings) {
    const double shrink = std::min(1.0, 48.0 / std::max(settings.width, settings.height));
    settings.width = std::max(1u, static_cast<std::uint32_t>(std::lround(settings.width * shrink)));
    settings.height = std::max(1u, static_cast<std::uint32_t>(std::lround(settings.height * shrink)));
    return settings;
}

constexpr std::uint32_t verification_spp = 2;

// What an error message calls a preparatory render in which a cell has failed.
constexpr const char* the_preparation = "a render before the timed ones";

// The expected duration of a cell's preparation relative to other cells', for the estimate of the remaining time.
double size_of(const Cell& cell) {
    return static_cast<double>(cell.settings.width) * cell.settings.height * cell.samples_to_prepare();
}

// Prepares cells, with one Verifier for all cells with the same scene, size and depth.
class CellPreparer {
public:
    CellPreparer(std::uint64_t seed, FilmLedger& films, ErrorBook& errors)
        : seed_(seed), films_(films), errors_(errors) {}

    struct Prepared {
        CellFacts facts;                      // facts about the prepared cell, for the journal
        std::vector<FailedCell> others = {};  // other cells that this preparation showed to be wrong
    };

    // Prepares a cell; an exception fails the cell, not the run.
    Prepared prepare(const Cell& cell) {
        Verifier& verifier = verifier_of(cell);
        Prepared prepared;
        try {
            prepared.facts = verified(cell, verifier);
            if (prepared.facts.status == CellStatus::ok) {
                add_instrumented_pass(cell, prepared);
            }
        } catch (const std::exception& exception) {
            prepared.facts = {};
            prepared.facts.fail(fmt::format("{}: {}", the_preparation, exception.what()));
        }
        return prepared;
    }

private:
    Verifier& verifier_of(const Cell& cell) {
        const RenderSettings small = verification_settings(cell.settings);
        const std::string key = fmt::format("{}/{}x{}/{}", cell.scene->name, small.width, small.height, small.depth);
        return verifiers_.try_emplace(key, *cell.scene, small, verification_spp, cell.backend).first->second;
    }

    static CellFacts verified(const Cell& cell, Verifier& verifier) {
        const Verdict verdict = verifier.check(cell.variant);
        const KernelChoice kernel = choose_kernel(*cell.scene, cell.variant, cell.backend);
        CellFacts facts{.claim_check = verdict.message,
                        .kernel_features = feature_names(kernel.compiled),
                        .specialisation_note = kernel.note()};
        if (!verdict.holds) {
            facts.fail(verdict.message);
        }
        return facts;
    }

    void add_instrumented_pass(const Cell& cell, Prepared& prepared) {
        // A first render grows queues and touches pages, which the stage times of the instrumented render must not
        // include.
        (void)render_named(*cell.scene,
                           request(cell, cell.variant, traits_of(cell.variant, cell.backend).devices.count));
        RenderRequest instrumented = request(cell, cell.variant, cell.samples_to_prepare());
        instrumented.instrument = true;
        const RenderResult result = render_named(*cell.scene, instrumented);
        if (!has_the_bits(cell, result, prepared)) {
            return;
        }
        add_facts(prepared.facts, cell, result);
        if (cell.convergence) {
            prepared.facts.convergence = errors_.cell_facts(cell);
            prepared.facts.convergence->expected_mse = errors_.expected_mse(cell, result.film);
        }
    }

    // Compares a cell's film and work at full size with the reference's, also those of the exact twin if it has one.
    bool has_the_bits(const Cell& cell, const RenderResult& result, Prepared& prepared) {
        std::vector<FailedCell> failed = films_.note_preparation(cell, imprint_of(result));
        if (fp_relaxed(cell.variant, cell.backend)) {
            const Variant twin = exact_twin(cell.variant, cell.backend);
            const RenderResult exact = render_named(*cell.scene, request(cell, twin, cell.samples_to_prepare()));
            for (FailedCell& of_twin : films_.note_twin(cell, imprint_of(exact))) {
                of_twin.reason = fmt::format("its twin {}, {}", shown_name(twin, cell.backend), of_twin.reason);
                failed.push_back(std::move(of_twin));
            }
        }
        for (FailedCell& wrong : failed) {
            if (wrong.cell == &cell) {
                prepared.facts.fail(wrong.reason);
            } else {
                prepared.others.push_back(std::move(wrong));
            }
        }
        return prepared.facts.status == CellStatus::ok;
    }

    RenderRequest request(const Cell& cell, const Variant& variant, std::uint32_t samples) const {
        RenderRequest request{
            .variant = variant, .backend = cell.backend, .settings = cell.settings, .samples = samples};
        request.settings.seed = seed_;
        return request;
    }

    std::uint64_t seed_;
    FilmLedger& films_;
    ErrorBook& errors_;
    std::map<std::string, Verifier> verifiers_;  // verifiers by scene, size and depth
};

std::vector<const Cell*> unknown_cells(const Plan& plan, const Journal& journal) {
    std::vector<const Cell*> unknown;
    for (const Cell& cell : plan.cells) {
        if (journal.cell(cell.name) == nullptr) {
            unknown.push_back(&cell);
        }
    }
    return unknown;
}

void add_compilations(const Cell& cell, std::vector<CompileTask>& tasks) {
    tasks.push_back({.scene = cell.scene.get(), .variant = cell.variant});
    // The reference variants that samples are compared with (FilmLedger) are compiled too.
    const Variant twin = exact_twin(cell.variant, cell.backend);
    tasks.push_back({.scene = cell.scene.get(), .variant = fast_reference_on(*cell.scene, twin, cell.backend)});
}

void compile_kernels(const std::vector<const Cell*>& cells) {
    std::vector<CompileTask> tasks;
    for (const Cell* const cell : cells) {
        if (cell->backend == Backend::cuda) {
            add_compilations(*cell, tasks);
        }
    }
    compile_ahead(tasks);
}

}  // namespace

std::vector<CompileTask> compilations_of(const Plan& plan) {
    std::vector<CompileTask> tasks;
    for (const Cell& cell : plan.cells) {
        add_compilations(cell, tasks);
    }
    return tasks;
}

void prepare_cells(const Plan& plan, std::uint64_t seed, RunJournal& journal, FilmLedger& films, ErrorBook& errors,
                   const Interrupt& interrupt, Progress::Lines lines) {
    const std::vector<const Cell*> cells = unknown_cells(plan, journal.known());
    compile_kernels(cells);
    TimeLeft time_left;
    for (const Cell* const cell : cells) {
        time_left.expect(cell->name, 1, size_of(*cell));
    }
    Progress progress("verify", cells.size(), lines);
    const ShortNames names(plan);
    CellPreparer preparer(seed, films, errors);
    for (const Cell* const cell : cells) {
        if (interrupt.requested()) {
            return;
        }
        progress.begin(names.of(*cell));
        const double start = steady_seconds();
        const AtWork at_work(cell->name + ", before it is timed");
        const CellPreparer::Prepared prepared = [&] {
            const LastLine last_line = journal.fails_if_crashed(*cell, the_preparation);
            return preparer.prepare(*cell);
        }();
        if (prepared.facts.status == CellStatus::failed) {
            say_below_progress(fmt::format("failed: {}: {}", cell->name, prepared.facts.reason));
        }
        journal.set_cell(*cell, prepared.facts);
        for (const FailedCell& other : prepared.others) {
            journal.fail(*other.cell, other.reason);
        }
        time_left.took(cell->name, steady_seconds() - start);
        progress.step(names.of(*cell), [&] { return time_left.seconds(); });
    }
}

}  // namespace pt
