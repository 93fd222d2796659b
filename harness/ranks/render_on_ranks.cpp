#include "harness/ranks/render_on_ranks.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "harness/ranks/machine_context.h"
#include "harness/ranks/mpi.h"
#include "harness/ranks/ranks.h"
#include "harness/ranks/task.h"
#include "harness/render/checkpoints.h"
#include "harness/render/device_shares.h"
#include "harness/render/process_clock.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

// The scene of a render task from rank 0, loaded once per process.
const Scene& scene_in(const Json& task) {
    static std::map<std::string, Scene> scenes;
    const std::string file = task.at("scene");
    const std::string hash = task.at("scene_hash");
    if (scenes.contains(file) && scenes.at(file).hash != hash) {
        scenes.erase(file);
    }
    if (!scenes.contains(file)) {
        scenes.emplace(file, load_scene(file));
    }
    if (scenes.at(file).hash != hash) {
        throw InputError(file, "the scene", "content " + scenes.at(file).hash, "rank 0's, " + hash);
    }
    return scenes.at(file);
}

// The part of a render's samples that this rank renders; rank 0 always has some.
RenderRequest share_of(RenderRequest request) {
    const SampleRange share =
        equal_share({request.first_sample, request.samples}, static_cast<std::uint32_t>(ranks().rank),
                    static_cast<std::uint32_t>(ranks().count));
    request.first_sample = share.first;
    request.samples = share.count;
    return request;
}

RenderResult render_and_check(const Scene& scene, const RenderRequest& share) {
    RenderResult result = render(scene, share);
    if (const std::string fault = check_counters(share.variant, result.work, share.samples, share.backend);
        !fault.empty()) {
        throw std::runtime_error(fault);
    }
    return result;
}

struct Share {
    std::optional<RenderResult> result;  // result of this rank; none without samples or if it failed
    std::vector<std::int64_t> sums;      // radiance sums of this rank's film
    Json facts;
};

template <class SceneOf>
Share render_share(const SceneOf& scene, const RenderRequest& whole) {
    const double cpu_start = process_cpu_ms();
    Share share;
    const auto failed = [&](const char* kind, const std::exception& error) {
        share.facts = {{"failed", kind}, {"message", error.what()}};
    };
    try {
        const RenderRequest request = share_of(whole);
        share.sums.resize(std::size_t{3} * whole.settings.width * whole.settings.height);
        if (request.samples > 0) {
            share.result = render_and_check(scene(), request);
            share.sums = share.result->film.sums();
            const FilmFaults& faults = share.result->film.faults();
            share.facts = {{"wall_ms", share.result->wall_ms},
                           {"device_ms", share.result->device_ms},
                           {"cpu_ms", share.result->cpu_ms},
                           {"work", json_of(share.result->work)},
                           {"faults", {faults.nonfinite, faults.negative, faults.saturated}}};
        }
    } catch (const InputError& error) {
        failed("input", error);
    } catch (const MachineError& error) {
        failed("machine", error);
    } catch (const std::bad_alloc&) {
        failed("machine", MachineError("out of memory"));
    } catch (const std::exception& error) {
        failed("render", error);
    }
    share.facts["process_cpu_ms"] = process_cpu_ms() - cpu_start;
    return share;
}

// Rethrows on rank 0 the exception of the first rank that failed, with the rank's number and host.
void throw_failure(const std::vector<Json>& all) {
    for (std::size_t rank = 0; rank < all.size(); ++rank) {
        const std::string kind = all[rank].value("failed", "");
        if (kind.empty()) {
            continue;
        }
        const std::string message = fmt::format("rank {} of {} on {}: {}", rank, all.size(), ranks().hosts.at(rank),
                                                all[rank].at("message").get<std::string>());
        if (kind == "input") {
            throw InputError(message);
        }
        if (kind == "machine") {
            throw MachineError(message);
        }
        throw std::runtime_error(message);
    }
}

// Collects every rank's facts about its render on rank 0, and tells all ranks whether one failed, before any goes on.
std::optional<std::vector<Json>> agree(const Share& share) {
    std::vector<Json> all;
    for (const std::string& text : mpi::gather(share.facts.dump())) {
        all.push_back(Json::parse(text));
    }
    const bool has_failed =
        std::any_of(all.begin(), all.end(), [](const Json& facts) { return facts.contains("failed"); });
    if (mpi::broadcast(has_failed ? "failed" : "") == "failed") {
        throw_failure(all);
        return std::nullopt;
    }
    return all;
}

// Adds the films of all ranks on rank 0 and returns the elapsed milliseconds.
double reduce_ms(std::vector<std::int64_t>& sums) {
    mpi::barrier();
    const auto start = std::chrono::steady_clock::now();
    mpi::add_to_rank_0(sums);
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

FilmFaults faults_in(const Json& list) { return {list.at(0), list.at(1), list.at(2)}; }

// Adds the times, work and film faults of the other ranks to rank 0's result, and sets the sum of all films.
void add_ranks(RankedRender& mine, const std::vector<Json>& all, std::vector<std::int64_t> sums, double reduction_ms) {
    RenderResult& result = mine.result;
    mine.ranks = {.count = static_cast<int>(all.size()),
                  .slowest_ms = result.wall_ms,
                  .fastest_ms = result.wall_ms,
                  .reduce_ms = reduction_ms};
    FilmFaults faults = result.film.faults();
    for (std::size_t rank = 1; rank < all.size(); ++rank) {
        const Json& facts = all[rank];
        if (ranks().hosts.at(rank) == ranks().hosts.at(0)) {
            mine.ranks.neighbours_cpu_ms += facts.at("process_cpu_ms").get<double>();
        }
        if (!facts.contains("work")) {
            continue;
        }
        const double wall = facts.at("wall_ms");
        mine.ranks.slowest_ms = std::max(mine.ranks.slowest_ms, wall);
        mine.ranks.fastest_ms = std::min(mine.ranks.fastest_ms, wall);
        result.device_ms = std::max(result.device_ms, facts.at("device_ms").get<double>());
        result.cpu_ms += facts.at("cpu_ms").get<double>();
        result.work += work_in(facts.at("work"));
        faults += faults_in(facts.at("faults"));
    }
    result.wall_ms = mine.ranks.slowest_ms + reduction_ms;
    result.device_ms += reduction_ms;
    result.film.set(std::move(sums), faults);
}

// Renders the part between two checkpoints on all ranks.
RankedRender render_part(const Scene& scene, const RenderRequest& request) {
    (void)mpi::broadcast(task_of(scene, request).dump());
    Share share = render_share([&]() -> const Scene& { return scene; }, request);
    const std::vector<Json> all = agree(share).value();
    const double reduction_ms = reduce_ms(share.sums);
    RankedRender mine{std::move(*share.result), {}};
    add_ranks(mine, all, std::move(share.sums), reduction_ms);
    return mine;
}

void serve_part(const Json& task) {
    const RenderRequest request = request_in(task);
    Share share = render_share([&]() -> const Scene& { return scene_in(task); }, request);
    if (agree(share)) {
        (void)reduce_ms(share.sums);
    }
}

// Adds the next part of a render, between two checkpoints, to the parts before it.
void append(RankedRender& so_far, const RankedRender& next) {
    RenderResult& result = so_far.result;
    std::vector<std::int64_t> sums = result.film.sums();
    std::transform(sums.begin(), sums.end(), next.result.film.sums().begin(), sums.begin(), std::plus<>());
    FilmFaults faults = result.film.faults();
    faults += next.result.film.faults();
    result.film.set(std::move(sums), faults);
    result.work += next.result.work;
    result.wall_ms += next.result.wall_ms;
    result.device_ms += next.result.device_ms;
    result.cpu_ms += next.result.cpu_ms;
    so_far.ranks.slowest_ms += next.ranks.slowest_ms;
    so_far.ranks.fastest_ms += next.ranks.fastest_ms;
    so_far.ranks.reduce_ms += next.ranks.reduce_ms;
    so_far.ranks.neighbours_cpu_ms += next.ranks.neighbours_cpu_ms;
}

}  // namespace

std::string why_not_split(const Variant& variant, Backend backend) {
    if (depends_on_order(variant, backend)) {
        return "its numbers follow the order of the samples";
    }
    return contains(features_asked(variant, backend), Feature::naive)
               ? "it rounds sums of samples, so they depend on how samples are split"
               : "";
}

RankedRender render_on_ranks(const Scene& scene, const RenderRequest& request) {
    if (ranks().count == 1) {
        return {render(scene, request), {}};
    }
    if (const std::string reason = why_not_split(request.variant, request.backend); !reason.empty()) {
        throw InputError(shown_name(request.variant, request.backend), "ranks", std::to_string(ranks().count),
                         "one: " + reason);
    }
    std::optional<RankedRender> whole;
    for (const RenderPart& part : parts_of(request)) {
        RenderRequest next = request;
        next.checkpoints = {};
        next.on_checkpoint = {};
        next.film_samples = request.film_samples != 0 ? request.film_samples : request.samples;
        next.first_sample += part.done;
        next.samples = part.samples;
        RankedRender rendered = render_part(scene, next);
        if (whole) {
            append(*whole, rendered);
        } else {
            whole = std::move(rendered);
        }
        report_checkpoint(request, part, whole->result);
    }
    return std::move(*whole);
}

namespace {

Json machine_of_rank(Backend backend) {
    try {
        return {{"machine", Json(machine_context(backend))}};
    } catch (const std::exception& error) {
        return {{"message", error.what()}};
    }
}

}  // namespace

void require_equal_machines(Backend backend) {
    if (ranks().count == 1) {
        return;
    }
    (void)mpi::broadcast(Json{{"do", "machine"}, {"cuda", backend == Backend::cuda}}.dump());
    const Json mine = machine_of_rank(backend);
    const std::vector<std::string> all = mpi::gather(mine.dump());
    for (std::size_t rank = 0; rank < all.size(); ++rank) {
        const Json other = Json::parse(all[rank]);
        const std::string place = fmt::format("rank {} on {}", rank, ranks().hosts.at(rank));
        if (!other.contains("machine")) {
            throw InputError(place + ": " + other.at("message").get<std::string>());
        }
        for (const auto& [key, value] : mine.at("machine").items()) {
            if (other.at("machine").value(key, Json()) != value) {
                throw InputError(place, key, other.at("machine").value(key, Json()).dump(),
                                 "rank 0's, " + value.dump());
            }
        }
    }
}

int serve_rank_0() {
    while (true) {
        const Json task = Json::parse(mpi::broadcast(""));
        const std::string what = task.at("do");
        if (what == "end") {
            return task.at("exit_code");
        }
        if (what == "machine") {
            (void)mpi::gather(machine_of_rank(task.at("cuda").get<bool>() ? Backend::cuda : Backend::cpu).dump());
        } else {
            serve_part(task);
        }
    }
}

void end_ranks(int exit_code) { (void)mpi::broadcast(Json{{"do", "end"}, {"exit_code", exit_code}}.dump()); }

}  // namespace pt
