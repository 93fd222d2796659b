// The facts about a cell other than its samples, in the form in which the journal and the result file store them.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/fields.h"
#include "harness/render/renderer.h"

namespace pt {

enum class CellStatus { ok, failed };
// Writes a cell's status to any JSON type; without this template nlohmann would store the enum as a number.
template <class AnyJson>
void to_json(AnyJson& json, CellStatus status) {
    json = status == CellStatus::ok ? "ok" : "failed";
}
void from_json(const Json& json, CellStatus& status);

// The work counters of a cell's instrumented pass.
struct CounterFacts {
    WorkCounters work = {};

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("bounces", self.work.bounces);
        visit("cache_fills", self.work.cache_fills);
        visit("cache_hits", self.work.cache_hits);
        visit("compacted_away", self.work.compacted_away);
        visit("compactions", self.work.compactions);
        visit("connections", self.work.connections);
        visit("graph_nodes", self.work.graph_nodes);
        visit("host_waits", self.work.host_waits);
        visit("launches", self.work.launches);
        visit("loop_rounds", self.work.loop_rounds);
        visit("sorted", self.work.sorted);
        visit("sorts", self.work.sorts);
    }
};

struct KernelFacts {
    int registers = 0;             // registers of the kernel per thread
    std::size_t local_bytes = 0;   // bytes of local memory per thread
    std::size_t shared_bytes = 0;  // bytes of shared memory per thread block

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("local_bytes", self.local_bytes);
        visit("registers", self.registers);
        visit("shared_bytes", self.shared_bytes);
    }
};

// A cell's use of GPU memory and its CUDA kernels (CudaFacts in renderer.h).
struct DeviceUse {
    std::size_t device_bytes = 0, path_bytes = 0, path_state_bytes = 0;
    std::uint32_t block = 0;  // threads per block of the kernels
    double prepare_ms = 0;
    std::vector<std::string> options = {};
    std::map<std::string, KernelFacts> kernels = {};

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("block", self.block);
        visit("device_bytes", self.device_bytes);
        visit("kernels", self.kernels);
        visit("options", self.options);
        visit("path_bytes", self.path_bytes);
        visit("path_state_bytes", self.path_state_bytes);
        visit("prepare_ms", self.prepare_ms);
    }
};

struct MeshUse {
    MeshFacts facts = {};

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("build_ms", self.facts.build_ms);
        visit("encode_ms", self.facts.encode_ms);
        visit("leaf_bytes", self.facts.leaf_bytes);
        visit("level_build_ms", self.facts.level_build_ms);
        visit("level_bytes", self.facts.level_bytes);
        visit("level_nodes", self.facts.level_nodes);
        visit("node_bytes", self.facts.node_bytes);
        visit("nodes", self.facts.nodes);
        visit("sah_cost", self.facts.sah_cost);
        visit("triangles", self.facts.triangles);
    }
};

// The instrumented pass, which times stages and counts live paths; its times are never mixed with the samples' times.
struct InstrumentedFacts {
    std::vector<std::uint64_t> live_paths = {};  // [k]: number of paths that traced segment k + 1
    std::uint64_t paths = 0;
    std::uint32_t spp = 0;
    std::map<std::string, double> stage_ms = {};
    // By stage, of stages on a GPU that only move paths; absent without such a stage.
    std::optional<std::map<std::string, MemoryBound>> memory_bounds = {};
    double wall_ms = 0, unaccounted_ms = 0;
    bool stages_add_up = false;

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("live_paths", self.live_paths);
        visit("memory_bounds", self.memory_bounds);
        visit("paths", self.paths);
        visit("spp", self.spp);
        visit("stage_ms", self.stage_ms);
        visit("stages_add_up", self.stages_add_up);
        visit("unaccounted_ms", self.unaccounted_ms);
        visit("wall_ms", self.wall_ms);
    }
};

// Files with the kept images of a cell's first sample, relative to the result file.
struct ImageFacts {
    std::string reference = {};
    std::map<std::string, std::string> by_spp = {};

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("by_spp", self.by_spp);
        visit("reference", self.reference);
    }
};

// The reference of a cell with checkpoints, and the metrics and biases of its errors.
struct ConvergenceFacts {
    std::vector<std::string> biases = {};  // declared reasons why the image may be biased
    std::vector<std::uint32_t> checkpoints = {};
    double expected_mse = 0;
    std::optional<ImageFacts> images = {};
    bool independent_samples = false;
    std::map<std::string, std::string> metrics = {};  // definition of each error metric, by the metric's name
    Json reference = {};                              // the reference image, as Reference::provenance() describes it
    std::optional<std::string> shared_with = {};  // name of a cell with the same films and errors; in result files only

    std::string reference_hash() const;

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("biases", self.biases);
        visit("checkpoints", self.checkpoints);
        visit("expected_mse", self.expected_mse);
        visit("images", self.images);
        visit("independent_samples", self.independent_samples);
        visit("metrics", self.metrics);
        visit("reference", self.reference);
        visit("shared_with", self.shared_with);
    }
};

// The facts about a cell. Optional members are set once the cell has been verified, or rendered at full size.
struct CellFacts {
    CellStatus status = CellStatus::ok;
    std::string reason = {};  // why the cell failed
    std::optional<std::string> claim_check = {};
    std::optional<std::vector<std::string>> kernel_features = {};
    std::optional<std::string> specialisation_note = {};
    std::optional<std::string> film_hash = {};
    std::optional<std::array<double, 3>> mean_rgb = {};
    std::optional<std::uint64_t> nonfinite = {}, negative = {}, saturated = {}, unfinished_walks = {};
    std::optional<CounterFacts> counters = {};
    std::optional<DeviceUse> cuda = {};
    std::optional<MeshUse> meshes = {};  // facts about the acceleration trees; only for scenes with meshes
    std::optional<InstrumentedFacts> instrumented = {};
    std::optional<ConvergenceFacts> convergence = {};  // reference and error metrics; only for cells with checkpoints

    void fail(std::string why) {
        status = CellStatus::failed;
        reason = std::move(why);
    }

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("claim_check", self.claim_check);
        visit("convergence", self.convergence);
        visit("counters", self.counters);
        visit("cuda", self.cuda);
        visit("film_hash", self.film_hash);
        visit("instrumented", self.instrumented);
        visit("kernel_features", self.kernel_features);
        visit("mean_rgb", self.mean_rgb);
        visit("meshes", self.meshes);
        visit("negative", self.negative);
        visit("nonfinite", self.nonfinite);
        visit("reason", self.reason);
        visit("saturated", self.saturated);
        visit("specialisation_note", self.specialisation_note);
        visit("status", self.status);
        visit("unfinished_walks", self.unfinished_walks);
    }
};

}  // namespace pt
