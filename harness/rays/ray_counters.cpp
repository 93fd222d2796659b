#include "harness/rays/ray_counters.h"

#include <fmt/format.h>

#include "harness/cuda/backend.h"

namespace pt::rays {
namespace {

using Json = nlohmann::ordered_json;

// The name of a batch kernel's function in gpu_batch.cu, by which ncu reports it.
std::string function_of(const std::string& kernel) { return kernel == "plain" ? "trace_plain" : "closest_hits"; }

std::size_t rays_of(const Json& mesh, const std::string& name) {
    for (const Json& set : mesh["ray_sets"]) {
        if (set["class"] == name) {
            return set["rays"];
        }
    }
    return 0;
}

template <class Meshes, class Visit>
void for_each_batch(Meshes& meshes, const Visit& visit) {
    for (auto& mesh : meshes) {
        for (auto& tree : mesh["trees"]) {
            for (auto& batch : tree["batches"]) {
                visit(mesh, batch);
            }
        }
    }
}

}  // namespace

void trace_counted(const RayMesh& mesh, const RayStudy& study) {
    const auto scene_mesh = as_scene_mesh(mesh, content_hash(mesh.mesh));
    std::vector<RaySet> sets;
    for (const auto& [accelerator, builder] : trees_of(study)) {
        const Tree tree = make_tree(scene_mesh, accelerator, builder, study.backend);
        const auto tracer = make_tracer(tree, study.backend);
        if (sets.empty()) {
            sets = ray_sets_of(mesh, *tracer, study);
        }
        for (const RaySet& set : sets) {
            tracer->load(set);
            for (const std::string& kernel : tracer->kernels(set)) {
                (void)tracer->trace(kernel);
                cuda::switch_counting(true);
                (void)tracer->trace(kernel);
                cuda::switch_counting(false);
            }
        }
    }
}

std::vector<std::pair<std::string, double>> counted_batches(const Json& meshes) {
    std::vector<std::pair<std::string, double>> batches;
    for_each_batch(meshes, [&](const Json& mesh, const Json& batch) {
        batches.emplace_back(function_of(batch["kernel"]), static_cast<double>(rays_of(mesh, batch["class"])));
    });
    return batches;
}

void add_counters(Json& meshes, const Json& launches) {
    std::size_t next = 0;
    for_each_batch(meshes, [&](const Json&, Json& batch) { batch["counters"] = launches.at(next++); });
}

std::string counters_table_of(const Json& mesh) {
    std::string text = fmt::format("{:<12} {:<12} {:<18} {:<19} {:>5} {:>9} {:>8} {:>6} {:>6} {:>6} {:>6}  {}\n",
                                   "accelerator", "builder", "rays", "kernel", "lanes", "instr/ray", "bytes/ray",
                                   "issue", "L1", "L2", "memory", "nearest ceiling");
    const auto percent = [](const Json& share) { return fmt::format("{:.0f} %", 100 * share.get<double>()); };
    for (const Json& tree : mesh["trees"]) {
        for (const Json& batch : tree["batches"]) {
            const Json &counters = batch["counters"], &of = counters["of_ceiling"];
            const std::string bound = counters["bound"];
            text += fmt::format(
                "{:<12} {:<12} {:<18} {:<19} {:>5.1f} {:>9.0f} {:>8.1f} {:>6} {:>6} {:>6} {:>6}  {} {}\n",
                tree["accelerator"].get<std::string>(),
                tree["builder"].is_null() ? "-" : tree["builder"].get<std::string>(), batch["class"].get<std::string>(),
                batch["kernel"].get<std::string>(), counters["active_lanes"].get<double>(),
                counters["thread_instructions_per_ray"].get<double>(), counters["memory_bytes_per_ray"].get<double>(),
                percent(of["issue"]), percent(of["l1"]), percent(of["l2"]), percent(of["memory"]), bound,
                percent(of[bound]));
        }
    }
    return text;
}

}  // namespace pt::rays
