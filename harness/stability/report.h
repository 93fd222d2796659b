// The result file of a stability run. The file is written after every case to a temporary name and renamed, so that a
// killed run loses at most the case in flight and can be resumed.
#pragma once

#include <set>

#include "harness/stability/evaluate.h"
#include "harness/write_file.h"

namespace pt::stability {

struct RunDescription {
    std::string command_line;
    Backend backend = Backend::cpu;
    bool is_quick = false;
    std::uint64_t seed = 1;
    std::uint64_t paths = 0;  // paths per rendering; 0: as many as the cases ask for
};

class Report {
public:
    // What happens to an existing file. `resume_or_overwrite` resumes an unfinished file and overwrites a complete one.
    enum class IfThere { refuse, resume, overwrite, resume_or_overwrite };

    // Opens a report; if `file` is empty, nothing is written. If the file exists, `resume` keeps its rows, and
    // `overwrite` leaves it in place until this report is finished: meanwhile rows go to `file`.unfinished, which can
    // be resumed. Throws InputError if an existing file is refused or is of another machine, build, backend or run.
    Report(std::string file, RunDescription description, IfThere if_there);

    bool has(const Task& task) const;
    // Adds the rows of a task, as made by to_json.
    void add(const Task& task, const Json& rows);
    void save() const { write("interrupted"); }
    void finish() const;

    std::size_t passed() const { return count("passed", false); }
    std::size_t must_pass_failures() const { return count("failed", true) + count("broken", true); }
    std::string summary() const;

private:
    void write(const std::string& status) const;
    void keep_rows(const Json& old);
    std::size_t count(std::string_view status, bool must_pass_only) const;

    std::string file_;
    std::string growing_;      // the file written after every case: file_, or file_ + ".unfinished"
    mutable FileStamp stamp_;  // stamp of file_ when this report last read or wrote it
    bool is_changed_ = true;   // whether rows were added, so that the file must be written
    RunDescription description_;
    Json variants_ = Json::object();  // name and choices of each variant with a row, by identity
    Json rows_ = Json::array();
    std::set<std::string> done_;  // keys of the tasks whose rows the report has
};

// Describes a task, as "lamp a=0.1 albedo=0.5 depth=9 [nee, double]": case, point, choices that are not the plainest.
std::string label(const Task& task, const Variant& plainest);
// Describes a row, as "mean radiance 0.0099010 (exact 0.0099010): off by 1.2e-8, allowed 5.3e-8".
std::string in_words(const Row& row);

// Names and contents of the scene files of a case at its first point; none for a direct check.
std::vector<std::pair<std::string, std::string>> scene_files(const Case& stiff_case);

}  // namespace pt::stability
