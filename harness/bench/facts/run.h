// What makes a run the run that it is, and who took its samples, as the journal and the result file hold it. (What is
// said of the machine and the program stands in harness/machine/run_context.h.)
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/fields.h"

namespace pt {

// All that must be equal for a run to go on with a journal. The machine is the result's context less the process's own.
struct RunIdentity {
    std::string backend = {};
    std::vector<std::string> cells = {};
    std::string host_name = {};
    Json machine = {};
    std::optional<int> most_repetitions = {};            // where a cell may have more than `repetitions`
    std::map<std::string, std::string> references = {};  // what is asked of each cell's, by cell
    int repetitions = 1;
    std::map<std::string, std::string> scenes = {};  // hashes by name
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

// A process that took samples.
struct SessionFacts {
    std::string date = {};
    std::string host_name = {};
    int process = 0;                          // its number
    std::optional<std::size_t> samples = {};  // that it took, those again too; not in a line of a journal

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("date", self.date);
        visit("host_name", self.host_name);
        visit("process", self.process);
        visit("samples", self.samples);
    }
    bool operator==(const SessionFacts&) const = default;
};

// The result's ptbench.run: what the parts of one run share, and which part this is.
struct RunRecord {
    std::string identity = {};  // hash
    std::uint64_t seed = 0;
    int repetitions = 1;
    std::map<std::string, std::string> scenes = {};  // hashes by name
    std::string references = {};                     // hash
    std::size_t cells = 0;                           // of the whole run
    std::string cells_hash = {};
    std::optional<int> most_repetitions = {};
    std::optional<std::string> shard = {};
    std::optional<std::vector<std::size_t>> positions = {};  // of a shard's cells in the whole run
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
