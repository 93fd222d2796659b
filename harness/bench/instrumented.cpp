#include "harness/bench/instrumented.h"

#include <cmath>

namespace pt {

namespace {

Json cuda_json(const CudaFacts& facts) {
    Json kernels = Json::object();
    for (const CudaFacts::Kernel& kernel : facts.kernels) {
        kernels[kernel.name] = {{"registers", kernel.registers},
                                {"local_bytes", kernel.local_bytes},
                                {"shared_bytes", kernel.shared_bytes}};
    }
    return {{"device_bytes", facts.device_bytes},
            {"path_bytes", facts.path_bytes},
            {"path_state_bytes", facts.path_state_bytes},
            {"block", facts.threads},
            {"prepare_ms", facts.prepare_ms},
            {"options", facts.options},
            {"kernels", kernels}};
}

Json meshes_json(const MeshFacts& facts) {
    return {{"triangles", facts.triangles},     {"nodes", facts.nodes},
            {"node_bytes", facts.node_bytes},   {"leaf_bytes", facts.leaf_bytes},
            {"build_ms", facts.build_ms},       {"encode_ms", facts.encode_ms},
            {"sah_cost", facts.sah_cost},       {"level_nodes", facts.level_nodes},
            {"level_bytes", facts.level_bytes}, {"level_build_ms", facts.level_build_ms}};
}

}  // namespace

Json facts_of(const Cell& cell, const RenderResult& result) {
    Json facts = Json::object();
    const Vec3d mean = result.film.mean();
    facts["film_hash"] = result.film.hash();
    facts["mean_rgb"] = {mean.x, mean.y, mean.z};
    facts["nonfinite"] = result.film.faults().nonfinite;
    facts["negative"] = result.film.faults().negative;
    facts["saturated"] = result.film.faults().saturated;
    facts["unfinished_walks"] = result.work.unfinished_walks;
    facts["counters"] = {{"bounces", result.work.bounces},
                         {"compactions", result.work.compactions},
                         {"compacted_away", result.work.compacted_away},
                         {"sorts", result.work.sorts},
                         {"sorted", result.work.sorted},
                         {"cache_fills", result.work.cache_fills},
                         {"cache_hits", result.work.cache_hits},
                         {"connections", result.work.connections},
                         {"launches", result.work.launches},
                         {"graph_nodes", result.work.graph_nodes},
                         {"loop_rounds", result.work.loop_rounds},
                         {"host_waits", result.work.host_waits}};
    if (cell.backend == Backend::cuda) {
        facts["cuda"] = cuda_json(result.cuda);
    }
    if (result.meshes.triangles != 0) {
        facts["meshes"] = meshes_json(result.meshes);
    }
    Json stages = Json::object();
    double staged = 0;
    for (const auto& [stage, ms] : result.stages.milliseconds) {
        stages[std::string(stage)] = ms;
        staged += ms;
    }
    facts["instrumented"] = {{"live_paths", result.stages.live_paths},
                             {"paths", result.work.paths},
                             {"spp", cell.samples_to_prepare()},
                             {"stage_ms", stages},
                             {"wall_ms", result.wall_ms},
                             {"unaccounted_ms", result.wall_ms - staged},
                             {"stages_add_up", std::abs(result.wall_ms - staged) <= 0.05 * result.wall_ms}};
    return facts;
}

}  // namespace pt
