#include "harness/rays/ray_study.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/bench/bootstrap.h"
#include "harness/crash.h"
#include "harness/cuda/backend.h"
#include "harness/machine/cpu_clock.h"
#include "harness/rays/cpu_batch.h"
#include "harness/rays/gpu_batch.h"
#include "harness/rays/ray_sets.h"
#include "variants/registry.h"

namespace pt::rays {
namespace {

using Json = nlohmann::ordered_json;

// A checksum of all hits that does not depend on the order of summation: the sum over rays of hash(ray, t, primitive).
std::uint64_t checksum(const std::vector<Hit>& hits) {
    std::uint64_t sum = 0;
#pragma omp parallel for reduction(+ : sum)
    for (std::size_t i = 0; i < hits.size(); ++i) {
        std::uint64_t z = (std::uint64_t{static_cast<std::uint32_t>(bits_of(hits[i].t))} << 32 | hits[i].primitive) +
                          0x9e3779b97f4a7c15ull * (i + 1);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        sum += z ^ (z >> 31);
    }
    return sum;
}

std::uint64_t count_hits(const std::vector<Hit>& hits) {
    return static_cast<std::uint64_t>(
        std::count_if(hits.begin(), hits.end(), [](const Hit& hit) { return hit.primitive != no_primitive; }));
}

// The brute-force hits of an evenly spaced subset of a ray set, as a check of the traced hits.
struct Expected {
    std::vector<std::size_t> rays;
    std::vector<Hit> hits;

    std::size_t differences(const std::vector<Hit>& found, bool any) const {
        std::size_t different = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Hit &a = found[rays[i]], &b = hits[i];
            const bool same = any ? (a.primitive == no_primitive) == (b.primitive == no_primitive) : a == b;
            different += same ? 0 : 1;
        }
        return different;
    }
};

Expected expected_of(const RaySet& set, const RayMesh& mesh, const RayStudy& study) {
    Expected expected;
    const std::size_t count = std::min<std::size_t>(study.checked, set.rays.size());
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        expected.rays.push_back((2 * i + 1) * set.rays.size() / (2 * count));
        rays.push_back(set.rays[expected.rays.back()]);
    }
    if (count > 0) {
        expected.hits = study.backend == Backend::cuda ? brute_force_on_gpu(mesh.triangles, rays)
                                                       : brute_force_on_cpu(mesh.triangles, rays);
    }
    return expected;
}

struct SetState {
    Expected expected;
    std::optional<std::uint64_t> sum;
    std::uint64_t hits = 0;
    bool agrees = true;
};

Json batch_json(const RaySet& set, const std::string& kernel, const std::vector<double>& ms,
                const std::optional<Work>& work) {
    const double rays = static_cast<double>(set.rays.size()), median = median_of(ms);
    Json json{{"class", set.name},
              {"kernel", kernel},
              {"query", set.any && kernel != "meet" ? "any" : "closest"},
              {"ms", ms},
              {"median_ms", median}};
    // The confidence interval of the median time is that of a ratio of times with a constant 1 as the baseline.
    const RatioEstimate estimate = ratio_estimate(ms, {1.0, 1.0});
    json["interval_ms"] = estimate.interval ? Json{estimate.interval->low, estimate.interval->high} : Json();
    json["grays_per_s"] = rays / median * 1e-6;
    if (work) {
        json["nodes_per_ray"] = work->nodes;
        json["boxes_per_ray"] = work->boxes;
        json["triangles_per_ray"] = work->triangles;
    }
    return json;
}

void measure_set(BatchTracer& tracer, const RaySet& set, SetState& state, int repetitions, Json& batches) {
    tracer.load(set);
    const std::optional<Work> work = tracer.count();
    for (const std::string& kernel : tracer.kernels(set)) {
        (void)tracer.trace(kernel);  // an untimed first trace, to warm the kernel up
        std::vector<double> ms;
        for (int i = 0; i < repetitions; ++i) {
            ms.push_back(tracer.trace(kernel));
        }
        const std::vector<Hit> hits = tracer.hits();
        const std::uint64_t sum = checksum(hits);
        if (!state.sum) {
            state.sum = sum;
            state.hits = count_hits(hits);
        }
        Json json = batch_json(set, kernel, ms, work);
        const std::size_t different = state.expected.differences(hits, set.any);
        json["checksum"] = fmt::format("{:016x}", sum);
        json["differ_from_brute_force"] = different;
        state.agrees = state.agrees && sum == *state.sum && different == 0;
        batches.push_back(std::move(json));
    }
}

Json tree_json(const Tree& tree, const RayMesh& mesh, const RayStudy& study) {
    const MeshTree& made = *tree.geometry.tree;
    Json json{{"accelerator", tree.accelerator}, {"builder", tree.builder.empty() ? Json() : Json(tree.builder)}};
    json["nodes"] = made.encoded.node_count;
    json["node_bytes"] = made.encoded.nodes.size() * sizeof(NodePiece);
    json["leaf_bytes"] = made.leaves.size() * sizeof(LeafTriangle);
    json["sah_cost"] = made.sah_cost;
    json["build_ms"] = made.build_ms;
    json["encode_ms"] = made.encode_ms;
    if (study.backend == Backend::cuda && has_encoder_on_gpu(tree.accelerator)) {
        const DeviceBuild device = time_device_build(tree.builder, mesh.triangles, study.repetitions);
        if (!device.build_ms.empty()) {
            json["device_build_ms"] = device.build_ms;
            json["device_encode_ms"] = device.encode_ms;
            json["device_tree_same_every_time"] = device.same_every_time;
        }
    }
    return json;
}

Json clock_now(Backend backend) {
    if (backend == Backend::cuda) {
        return cuda::measure_clock_mhz();
    }
    const std::optional<double> clock = clock_of(measure_clock_evidence());
    return clock ? Json(*clock) : Json();
}

}  // namespace

std::shared_ptr<const SceneMesh> as_scene_mesh(const RayMesh& mesh, const std::string& hash) {
    auto made = std::make_shared<SceneMesh>();
    made->source = mesh.name;
    made->triangles = mesh.triangles;
    made->hash = hash;
    for (int axis = 0; axis < 3; ++axis) {
        made->bounds.low[axis] = mesh.low[axis];
        made->bounds.high[axis] = mesh.high[axis];
    }
    return made;
}

Tree make_tree(const std::shared_ptr<const SceneMesh>& mesh, const std::string& accelerator, const std::string& builder,
               Backend backend) {
    Acceleration acceleration = Acceleration::none();
    acceleration.accelerator = accelerator;
    acceleration.accelerator_hook =
        Registry::instance().find(axes::accelerator, accelerator, backend)->hook.accelerator;
    if (backend != Backend::cpu) {
        acceleration.accelerator_hook.prepare = nullptr;
    }
    if (!builder.empty()) {
        acceleration.builder = builder;
        acceleration.builder_hook = Registry::instance().find(axes::builder, builder, backend)->hook.builder;
    }
    Tree tree{accelerator, builder, geometry_of(mesh, nullptr, acceleration), {}, nullptr};
    tree.view = tree.geometry.view();
    tree.meet = acceleration.accelerator_hook.meet_single;
    return tree;
}

std::unique_ptr<BatchTracer> make_tracer(const Tree& tree, Backend backend) {
    return backend == Backend::cuda ? make_gpu_tracer(tree.view, tree.accelerator)
                                    : make_cpu_tracer(tree.view, tree.accelerator, tree.meet);
}

std::vector<std::pair<std::string, std::string>> trees_of(const RayStudy& study) {
    std::vector<std::pair<std::string, std::string>> trees;
    for (const std::string& accelerator : study.accelerators) {
        const Choice* choice = Registry::instance().find(axes::accelerator, accelerator, study.backend);
        if (choice->hook.accelerator.encode == nullptr) {
            trees.emplace_back(accelerator, "");
            continue;
        }
        for (const std::string& builder : study.builders) {
            trees.emplace_back(accelerator, builder);
        }
    }
    return trees;
}

std::vector<RaySet> ray_sets_of(const RayMesh& mesh, BatchTracer& tracer, const RayStudy& study) {
    if (study.given.empty()) {
        return make_ray_sets(mesh, tracer, study.classes, study.log2_rays);
    }
    std::vector<RaySet> sets;
    std::copy_if(study.given.begin(), study.given.end(), std::back_inserter(sets), [&](const RaySet& set) {
        return std::find(study.classes.begin(), study.classes.end(), set.name) != study.classes.end();
    });
    return sets;
}

MeshResult measure(const RayMesh& mesh, const RayStudy& study) {
    const std::string hash = content_hash(mesh.mesh);
    const auto scene_mesh = as_scene_mesh(mesh, hash);
    MeshResult result;
    std::vector<SetState> states;
    Json trees = Json::array();
    const Json clock_before = clock_now(study.backend);
    for (const auto& [accelerator, builder] : trees_of(study)) {
        const AtWork at_work(fmt::format("accelerator={} builder={} on {}", accelerator, builder, mesh.name));
        const Tree tree = make_tree(scene_mesh, accelerator, builder, study.backend);
        const auto tracer = make_tracer(tree, study.backend);
        if (states.empty()) {
            result.sets = ray_sets_of(mesh, *tracer, study);
            for (const RaySet& set : result.sets) {
                states.push_back({expected_of(set, mesh, study), {}, 0, true});
            }
        }
        Json json = tree_json(tree, mesh, study), batches = Json::array();
        for (std::size_t i = 0; i < result.sets.size(); ++i) {
            measure_set(*tracer, result.sets[i], states[i], study.repetitions, batches);
        }
        json["batches"] = std::move(batches);
        trees.push_back(std::move(json));
    }
    Json sets = Json::array();
    for (std::size_t i = 0; i < states.size(); ++i) {
        const RaySet& set = result.sets[i];
        sets.push_back({{"class", set.name},
                        {"any", set.any},
                        {"rays", set.rays.size()},
                        {"hits", states[i].hits},
                        {"checked", states[i].expected.rays.size()},
                        {"agree", states[i].agrees}});
        result.hits.push_back(states[i].hits);
        result.agrees = result.agrees && states[i].agrees;
    }
    result.json = {{"mesh", mesh.name},
                   {"triangles", mesh.triangles.size()},
                   {"hash", hash},
                   {"clock_mhz_before", clock_before},
                   {"clock_mhz_after", clock_now(study.backend)},
                   {"ray_sets", std::move(sets)},
                   {"trees", std::move(trees)}};
    return result;
}

std::string table_of(const Json& mesh) {
    std::string text = fmt::format("{:<12} {:<12} {:<18} {:<19} {:>9}  {:<19} {:>7} {:>7} {:>9}\n", "accelerator",
                                   "builder", "rays", "kernel", "G rays/s", "95 %", "nodes", "boxes", "triangles");
    for (const Json& tree : mesh["trees"]) {
        for (const Json& batch : tree["batches"]) {
            const double rate = batch["grays_per_s"], median = batch["median_ms"];
            const Json& interval = batch["interval_ms"];
            const auto per_ray = [&](const char* key) {
                return batch.contains(key) ? fmt::format("{:.2f}", batch[key].get<double>()) : std::string("-");
            };
            text += fmt::format("{:<12} {:<12} {:<18} {:<19} {:>9.4f}  {:<19} {:>7} {:>7} {:>9}\n",
                                tree["accelerator"].get<std::string>(),
                                tree["builder"].is_null() ? "-" : tree["builder"].get<std::string>(),
                                batch["class"].get<std::string>(), batch["kernel"].get<std::string>(), rate,
                                interval.is_null()
                                    ? std::string("-")
                                    : fmt::format("[{:.4f}, {:.4f}]", rate * median / interval[1].get<double>(),
                                                  rate * median / interval[0].get<double>()),
                                per_ray("nodes_per_ray"), per_ray("boxes_per_ray"), per_ray("triangles_per_ray"));
        }
    }
    return text;
}

}  // namespace pt::rays
