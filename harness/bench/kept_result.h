// A result that is there already is not lost: who writes a result file asks here first.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/facts/run.h"
#include "harness/write_file.h"

namespace pt {

bool is_complete_result(const Json& result);
// What a file holds, in words: "a complete result of 2026-11-22T10:00:00+0000", "an interrupted result ..", or "a file
// that is no result of ptbench".
std::string describe_result(const Json& result);

// Throws InputError if `file` is a result, for commands that write something else.
void refuse_result(const std::string& file);

// What an earlier result at `file` is to a run of this `run`.
struct EarlierResult {
    bool is_there = false;
    bool is_of_this_run = false;
    bool is_complete = false;
    int failed_cells = 0;
    FileStamp stamp = {};
    std::vector<std::string> images = {};  // that it names, relative to its folder
    std::string description;               // describe_result of it

    // Whether the earlier result stays until the run's own is complete; what this very run left when it was interrupted
    // does not.
    bool is_kept() const { return is_there && !(is_of_this_run && !is_complete); }
};
// Throws MachineError if another command wrote `file` since it had this stamp. `where` says where the run's own samples
// are.
void check_untouched(const std::string& file, const FileStamp& stamp, const std::string& where);
EarlierResult earlier_result(const std::string& file, const RunRecord& run);

// Throws InputError if `file` is there and the call does not say that it may be overwritten. The second form is for
// callers who have read the earlier result, since a result takes seconds to parse.
void check_overwrite(const std::string& file, bool overwrite);
void check_overwrite(const std::string& file, const EarlierResult& earlier, bool overwrite);

}  // namespace pt
