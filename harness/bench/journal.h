// The journal of a run: a JSON line for every fact, written at once, so that a killed run loses at most the sample in
// flight. The result file is made from the journal, and --resume continues from it. Each line carries a checksum.
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
    // Opens and locks the journal `file`. An existing journal must be resumed, with an equal `identity` except for the
    // keys in `that_may_differ`; an incomplete last line is dropped. Throws InputError (unfinished run, damaged line,
    // or another identity, with the difference) and MachineError (cannot write).
    Journal(std::string file, const Json& identity, bool resume, const std::vector<std::string>& that_may_differ = {});

    // Appends a sample of a cell; samples are added in the order of their index.
    void add_sample(const std::string& cell, const Sample& sample);
    // Replaces the cell's sample with the same seed; retaken() then returns the replaced one. Precondition: the journal
    // has such a sample.
    void retake_sample(const std::string& cell, const Sample& sample);
    // Sets the facts about a cell other than its samples, in place of any that were set before.
    void set_cell(const std::string& cell, const CellFacts& facts);
    // Begins a session: the process that takes all samples that follow.
    void add_session(const SessionFacts& facts);

    const std::vector<Sample>& samples(const std::string& cell) const;
    // The samples of a cell that retakes replaced, in the order of the retakes.
    const std::vector<Sample>& retaken(const std::string& cell) const;
    const CellFacts* cell(const std::string& cell) const;
    // Whether the journal says that the cell is good, or has failed. Both are false for a cell that it does not know.
    bool is_ok(const std::string& cell) const;
    bool has_failed(const std::string& cell) const;
    // All sessions, each with the number of samples that it took, retakes included.
    const std::vector<SessionFacts>& sessions() const { return sessions_; }
    std::size_t sample_count() const;
    const std::string& file() const { return file_; }
    // The size in bytes of an incomplete last line that was dropped on opening; 0 if there was none.
    std::size_t dropped_bytes() const { return dropped_bytes_; }

    // The journal's file descriptor, and the text with which JSON lines would be appended to the journal next. A crash
    // handler needs both beforehand, since it can make no text itself.
    int descriptor() const { return locked_.descriptor(); }
    std::string next_lines(const std::vector<Json>& lines) const;
    static Json session_line(const SessionFacts& facts);
    static Json cell_line(const std::string& cell, const CellFacts& facts);

    // Removes the journal file; to be called when the result file is complete.
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
    // The sample that the journal has of a cell with the seed of `sample`; null if there is none.
    Sample* taken_before(const std::string& cell, const Sample& sample);
    void keep_session(SessionFacts facts);

    std::string file_;
    LockedFile locked_;
    LineSeal seal_;  // checksum of the journal's last line, for sealing the next one
    std::size_t dropped_bytes_ = 0;
    std::map<std::string, std::vector<Sample>> samples_, retaken_;
    std::map<std::string, CellFacts> cells_;
    std::vector<SessionFacts> sessions_;
};

// Renames an existing journal, so that a run can start over and nothing is lost; returns the new name. Throws
// MachineError if another process is writing the journal.
std::string set_journal_aside(const std::string& file);

// Lists how two identities differ, key by key, as "seed: 1, here 2; ..": at most three differences and the number of
// further ones. Empty if they are equal.
std::string difference(const Json& there, const Json& here);

}  // namespace pt
