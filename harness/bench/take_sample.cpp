#include "harness/bench/take_sample.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "harness/bench/progress.h"
#include "harness/crash.h"
#include "harness/cuda/backend.h"
#include "harness/machine/cpu_clock.h"
#include "harness/machine/cpu_quota.h"
#include "harness/machine/machine.h"
#include "harness/ranks/ranks.h"
#include "harness/ranks/render_on_ranks.h"

namespace pt {

namespace {

// The clock of the backend's processor in MHz; none if it cannot be measured.
std::optional<double> clock_mhz(Backend backend) {
    return backend == Backend::cuda ? cuda::measure_clock_mhz() : clock_of(measure_clock_evidence());
}

struct TimedRender {
    RankedRender rendered;
    double end_to_end_ms = 0;
    std::optional<double> clock_before, clock_after;
    ForeignLoad foreign;
    Throttling throttled;
};

TimedRender time_render(const Scene& scene, const RenderRequest& request) {
    static const CpuGroups groups = CpuGroups::of_this_process();
    const std::optional<double> clock_before = clock_mhz(request.backend);
    const ForeignLoad load_before = ForeignLoad::now();
    const Throttling throttled_before = groups.throttling();
    const auto begin = std::chrono::steady_clock::now();
    RankedRender rendered = render_on_ranks(scene, request);
    const double end_to_end =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    ForeignLoad foreign = ForeignLoad::now() - load_before;
    foreign.cpu_ms -= rendered.ranks.neighbours_cpu_ms;
    const Throttling throttled = groups.throttling() - throttled_before;
    const std::optional<double> clock_after = clock_mhz(request.backend);
    return {std::move(rendered), end_to_end, clock_before, clock_after, foreign, throttled};
}

Sample facts_of_sample(const RenderRequest& request, const TimedRender& timed, std::uint64_t order) {
    const RenderResult& result = timed.rendered.result;
    const bool has_clock = timed.clock_before && timed.clock_after;
    Sample sample{.wall_ms = result.wall_ms,
                  .cpu_ms = result.cpu_ms,
                  .device_ms = result.device_ms,
                  .end_to_end_ms = timed.end_to_end_ms,
                  .seed = request.settings.seed,
                  .spp = request.samples,
                  .paths = result.work.paths,
                  .rays = result.work.rays,
                  .connections = result.work.connections,
                  .cache_hits = result.work.cache_hits,
                  .rays_per_second = static_cast<double>(result.work.rays) / (1e-3 * result.wall_ms),
                  .launches = result.work.launches,
                  .graph_nodes = result.work.graph_nodes,
                  .loop_rounds = result.work.loop_rounds,
                  .host_waits = result.work.host_waits,
                  .order = order,
                  .timestamp = seconds_since_1970(),
                  .clock_unknown = has_clock ? 0 : 1,
                  .foreign_cpu_ms = timed.foreign.cpu_ms,
                  .involuntary_switches = timed.foreign.involuntary_switches,
                  .throttled_periods = timed.throttled.periods,
                  .throttled_ms = timed.throttled.ms,
                  .film_hash = result.film.hash()};
    if (has_clock) {
        sample.clock_mhz_before = timed.clock_before;
        sample.clock_mhz_after = timed.clock_after;
    }
    if (const RankFacts& ranked = timed.rendered.ranks; ranked.count > 1) {
        sample.ranks = ranked.count;
        sample.slowest_rank_ms = ranked.slowest_ms;
        sample.fastest_rank_ms = ranked.fastest_ms;
        sample.reduce_ms = ranked.reduce_ms;
    } else if (result.devices.count > 1) {
        sample.devices = result.devices.count;
        sample.own_device_ms = result.devices.own_ms;
        sample.slowest_device_ms = result.devices.slowest_ms;
        sample.device_reduce_ms = result.devices.reduce_ms;
    }
    return sample;
}

}  // namespace

SampleTaker::SampleTaker(const Plan& plan, const Journal& journal, std::uint64_t first_seed, FilmLedger& films,
                         ErrorBook& errors)
    : first_seed_(first_seed), films_(films), errors_(errors) {
    for (const Cell& cell : plan.cells) {
        for (const std::vector<Sample>* samples : {&journal.samples(cell.name), &journal.retaken(cell.name)}) {
            for (const Sample& sample : *samples) {
                order_ = std::max(order_, sample.order + 1);
            }
        }
    }
}

TakenSample SampleTaker::take(const Cell& cell, std::size_t index) {
    try {
        const AtWork at_work(fmt::format("{}, {}", cell.name, place_of(index)));
        return render_sample(cell, index);
    } catch (const std::exception& exception) {
        return {.error = fmt::format("{}: {}", place_of(index), exception.what())};
    }
}

TakenSample SampleTaker::render_sample(const Cell& cell, std::size_t index) {
    RenderRequest request{
        .variant = cell.variant, .backend = cell.backend, .settings = cell.settings, .samples = cell.spp};
    request.settings.seed = first_seed_ + index;
    warm_up(cell, request);
    TakenSample sample;
    if (cell.convergence) {
        request.checkpoints = cell.convergence->checkpoints;
        request.on_checkpoint = [&](const Checkpoint& c) {
            sample.snapshots.push_back({c.samples, c.wall_ms, c.device_ms, c.cpu_ms, c.film});
        };
    }
    const TimedRender timed = time_render(*cell.scene, request);
    const RenderResult& result = timed.rendered.result;
    sample.error = fault(cell, index, result, sample.others);
    if (!sample.error.empty()) {
        return sample;
    }
    sample.facts = facts_of_sample(request, timed, order_);
    if (cell.convergence) {
        sample.facts.checkpoints = errors_.rows(cell, sample.snapshots);
    }
    order_ += 1;
    return sample;
}

void SampleTaker::warm_up(const Cell& cell, RenderRequest request) {
    if (warm_.insert(cell.name).second) {
        // The warm-up takes one sample for each device of each rank.
        request.samples =
            static_cast<std::uint32_t>(ranks().count) * traits_of(cell.variant, cell.backend).devices.count;
        (void)render_on_ranks(*cell.scene, request);
    }
}

// Says what is wrong with the film or the work counters of a timed render; empty if nothing is.
std::string SampleTaker::fault(const Cell& cell, std::size_t index, const RenderResult& result,
                               std::vector<FailedCell>& others) {
    // A sample on several MPI ranks is not checked here, since each rank has checked its own counters.
    if (const std::string missing = check_counters(cell.variant, result.work, cell.spp, cell.backend);
        ranks().count == 1 && !missing.empty()) {
        return fmt::format("{}: {}", place_of(index), missing);
    }
    // Every variant must trace one path per pixel and sample, even if it rounds freely and its rays are not compared.
    const std::uint64_t paths = std::uint64_t{cell.settings.width} * cell.settings.height * cell.spp;
    if (result.work.paths != paths) {
        return fmt::format("{}: {} paths, not {}", place_of(index), result.work.paths, paths);
    }
    // Films and work counts of a bitwise group must be equal for each seed, at full size too.
    std::string wrong;
    for (FailedCell& failed : films_.note_sample(cell, index, imprint_of(result))) {
        if (failed.cell == &cell) {
            wrong = std::move(failed.reason);
        } else {
            others.push_back(std::move(failed));
        }
    }
    // Where errors are measured, non-finite samples do not fail the cell: they are counted, and the errors are null.
    FilmFaults faults = result.film.faults();
    faults.nonfinite = cell.convergence ? 0 : faults.nonfinite;
    return !wrong.empty() || faults.none() ? wrong : fmt::format("{}: {}", place_of(index), faults_text(faults));
}

}  // namespace pt
