// The identity of a run and its sessions, in the form in which the journal and the result file store them. (The facts
// about the machine and the program are in harness/machine/run_context.h.)
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/fields.h"

namespace pt {

// All that must be equal for a run to continue from a journal. `machine` is the context of the result file, without its
// facts about a single process.
struct RunIdentity {
    std::string backend = {};
    std::vector<std::string> cells = {};
    std::string host_name = {};
    Json machine = {};
    std::optional<int> most_repetitions = {};            // limit of samples per cell where open verdicts may get more
    std::map<std::string, std::string> references = {};  // description of the required reference, by cell
    int repetitions = 1;
    std::map<std::string, std::string> scenes = {};  // content hash of each scene, by name
    std::uint64_t seed = 0;
    std::optional<std::string> shard = {};
    std::string suite = {};

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("backend", self.backend);
        visit("cells", self.cells);
        visit(host_name_key, self.host_name);
        visit("machine", self.machine);
        visit("most_repetitions", self.most_repetitions);
        visit("references", self.references);
        visit("repetitions", self.repetitions);
        visit("scenes", self.scenes);
        visit("seed", self.seed);
        visit("shard", self.shard);
        visit("suite", self.suite);
    }
    static constexpr const char* host_name_key = "host_name";
};

// A session: a process that took samples of a run.
struct SessionFacts {
    std::string date = {};
    std::string host_name = {};
    int process = 0;                          // operating system's id of the process
    std::optional<std::size_t> samples = {};  // number of the session's samples, with retakes; in result files only

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("date", self.date);
        visit("host_name", self.host_name);
        visit("process", self.process);
        visit("samples", self.samples);
    }
    bool operator==(const SessionFacts&) const = default;
};

// The member ptbench.run of a result file: what all shards of a run have in common, and which shard this file holds.
struct RunRecord {
    std::string identity = {};  // hash of the run's identity
    std::uint64_t seed = 0;
    int repetitions = 1;
    std::map<std::string, std::string> scenes = {};  // content hash of each scene, by name
    std::string references = {};                     // hash of all required references
    std::size_t cells = 0;                           // number of cells in the whole run, all shards together
    std::string cells_hash = {};
    std::optional<int> most_repetitions = {};
    std::optional<std::string> shard = {};
    std::optional<std::vector<std::size_t>> positions = {};  // positions of a shard's cells in the whole run
    std::vector<SessionFacts> sessions = {};

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("identity", self.identity);
        visit("seed", self.seed);
        visit("repetitions", self.repetitions);
        visit("scenes", self.scenes);
        visit("references", self.references);
        visit("cells", self.cells);
        visit("cells_hash", self.cells_hash);
        visit("most_repetitions", self.most_repetitions);
        visit("shard", self.shard);
        visit("positions", self.positions);
        visit("sessions", self.sessions);
    }
};

}  // namespace pt
