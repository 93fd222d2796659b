// Protects existing result files: every command that writes a result checks here first whether it may overwrite one.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/facts/run.h"
#include "harness/write_file.h"

namespace pt {

bool is_complete_result(const Json& result);
// Describes a file's content: "a complete result of 2026-11-22T10:00:00+0000", "an interrupted result ..", or "a file
// that is no result of ptbench".
std::string describe_result(const Json& result);

// Throws InputError if `file` is a result file, for commands that write another kind of file.
void refuse_result(const std::string& file);

// What is known about an existing result file at the place where a run will write its own.
struct EarlierResult {
    bool is_there = false;
    bool is_of_this_run = false;
    bool is_complete = false;
    int failed_cells = 0;
    FileStamp stamp = {};
    std::vector<std::string> images = {};  // image files that the result names, relative to its folder
    std::string description;               // description of the existing result (describe_result)

    // Whether the existing result stays until the run's own result is complete. An interrupted result of the same run
    // does not stay.
    bool is_kept() const { return is_there && !(is_of_this_run && !is_complete); }
};
// Throws MachineError if another command has written the result file `file` since `stamp` was taken of it. `where` is
// the place where the run's own samples are kept, for the message.
void check_untouched(const std::string& file, const FileStamp& stamp, const std::string& where);
EarlierResult earlier_result(const std::string& file, const RunRecord& run);

// Throws InputError if the result file exists and `overwrite` is false. The overload with `earlier` is for callers that
// have parsed the earlier result already, since parsing takes seconds.
void check_overwrite(const std::string& file, bool overwrite);
void check_overwrite(const std::string& file, const EarlierResult& earlier, bool overwrite);

}  // namespace pt
