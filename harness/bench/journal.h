// The journal of a run: one JSON line a fact, written as soon as it is known, so that a killed run loses at most the
// sample in flight. The result file is made from it, and --resume goes on from it. Each line has a checksum.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "harness/bench/facts/cell.h"
#include "harness/bench/facts/run.h"
#include "harness/bench/facts/sample.h"
#include "harness/bench/line_seal.h"
#include "harness/json_reader.h"
#include "harness/locked_file.h"

namespace pt {

class Journal {
public:
    // Opens `file` and locks it. A journal that is there already must be resumed (same `identity`, but for the keys
    // `that_may_differ`) or is refused; a last line that was cut off is dropped. Throws InputError (unfinished run,
    // damaged line, other identity: what differs), MachineError (cannot write).
    Journal(std::string file, const Json& identity, bool resume, const std::vector<std::string>& that_may_differ = {});

    // Adds one sample of a cell; samples come in the order of their index.
    void add_sample(const std::string& cell, const Sample& sample);
    // A sample again: it takes the place of the cell's sample with its seed, which retaken() has from then on.
    // Precondition: there is one.
    void retake_sample(const std::string& cell, const Sample& sample);
    // Sets the facts that are known of a cell besides its samples; a later call replaces an earlier one.
    void set_cell(const std::string& cell, const CellFacts& facts);
    // Begins a session: facts about the process that takes the samples that follow.
    void add_session(const SessionFacts& facts);

    const std::vector<Sample>& samples(const std::string& cell) const;
    // The samples whose places later ones took, in the order in which those came.
    const std::vector<Sample>& retaken(const std::string& cell) const;
    const CellFacts* cell(const std::string& cell) const;
    // Whether the facts that are known of the cell say that it is good, or that it failed; a cell that nothing is known
    // of is neither.
    bool is_ok(const std::string& cell) const;
    bool has_failed(const std::string& cell) const;
    // Each session with the number of the samples that it took, those again too.
    const std::vector<SessionFacts>& sessions() const { return sessions_; }
    std::size_t sample_count() const;
    const std::string& file() const { return file_; }
    // The size of the last line, which a kill had cut off, so that it was dropped; 0: there was none.
    std::size_t dropped_bytes() const { return dropped_bytes_; }

    // The file's descriptor, and the text of these lines if they were added next, for a crash handler, which can write
    // a text that is there and no more.
    int descriptor() const { return locked_.descriptor(); }
    std::string next_lines(const std::vector<Json>& lines) const;
    static Json session_line(const SessionFacts& facts);
    static Json cell_line(const std::string& cell, const CellFacts& facts);

    // Removes the file; call when the result file is in place.
    void finish();

private:
    void read(const Json& identity, const std::vector<std::string>& that_may_differ);
    void check_identity(const Json& line, const Json& identity, const std::vector<std::string>& that_may_differ) const;
    void read_line(const Json& line, std::size_t number);
    void keep_line(const Json& line, std::size_t number);
    void append(const Json& line);
    void keep_sample(const std::string& cell, const Sample& sample);
    void keep_retake(const std::string& cell, const Sample& sample);
    void count_sample();
    // The cell's sample that has the seed of `sample`, or null.
    Sample* taken_before(const std::string& cell, const Sample& sample);
    void keep_session(SessionFacts facts);

    std::string file_;
    LockedFile locked_;
    LineSeal seal_;  // of the last line in the file
    std::size_t dropped_bytes_ = 0;
    std::map<std::string, std::vector<Sample>> samples_, retaken_;
    std::map<std::string, CellFacts> cells_;
    std::vector<SessionFacts> sessions_;
};

// Gives a journal that is there another name, so that a run can start over and nothing is lost; returns that name.
// Throws MachineError if another run is writing it.
std::string set_journal_aside(const std::string& file);

// What differs between two identities, key by key, "seed: 1, here 2; ..": at most three things and the number of the
// others. Empty: nothing does.
std::string difference(const Json& there, const Json& here);

}  // namespace pt
