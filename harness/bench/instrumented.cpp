#include "harness/bench/instrumented.h"

#include <cmath>

#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json

namespace pt {

namespace {

DeviceUse device_use(const CudaFacts& facts) {
    DeviceUse use{.device_bytes = facts.device_bytes,
                  .path_bytes = facts.path_bytes,
                  .path_state_bytes = facts.path_state_bytes,
                  .block = facts.threads,
                  .prepare_ms = facts.prepare_ms,
                  .options = facts.options};
    for (const CudaFacts::Kernel& kernel : facts.kernels) {
        use.kernels[kernel.name] = {kernel.registers, kernel.local_bytes, kernel.shared_bytes};
    }
    return use;
}

InstrumentedFacts pass_of(const Cell& cell, const RenderResult& result) {
    InstrumentedFacts pass{.live_paths = result.stages.live_paths,
                           .paths = result.work.paths,
                           .spp = cell.samples_to_prepare(),
                           .wall_ms = result.wall_ms};
    for (const auto& [stage, bound] : result.stages.memory_bounds) {
        if (!pass.memory_bounds) {
            pass.memory_bounds.emplace();
        }
        (*pass.memory_bounds)[std::string(stage)] = bound;
    }
    double staged = 0;
    for (const auto& [stage, ms] : result.stages.milliseconds) {
        pass.stage_ms[std::string(stage)] = ms;
        staged += ms;
    }
    pass.unaccounted_ms = result.wall_ms - staged;
    pass.stages_add_up = std::abs(pass.unaccounted_ms) <= limits::stages_add_up_within * result.wall_ms;
    return pass;
}

}  // namespace

void add_facts(CellFacts& facts, const Cell& cell, const RenderResult& result) {
    const Vec3d mean = result.film.mean();
    facts.film_hash = result.film.hash();
    facts.mean_rgb = {mean.x, mean.y, mean.z};
    facts.nonfinite = result.film.faults().nonfinite;
    facts.negative = result.film.faults().negative;
    facts.saturated = result.film.faults().saturated;
    facts.unfinished_walks = result.work.unfinished_walks;
    facts.counters = CounterFacts{result.work};
    if (cell.backend == Backend::cuda) {
        facts.cuda = device_use(result.cuda);
    }
    if (result.meshes.triangles != 0) {
        facts.meshes = MeshUse{result.meshes};
    }
    facts.instrumented = pass_of(cell, result);
}

}  // namespace pt
