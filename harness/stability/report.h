// The result file of a stability run: written after every case to a temporary name and renamed, so that a killed run
// loses the case in flight at most, and can go on.
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
    std::uint64_t paths = 0;  // of a rendering; 0: as many as the cases ask for
};

class Report {
public:
    // What becomes of a file that is there. With `resume_or_overwrite` what is unfinished is resumed, what is complete
    // overwritten.
    enum class IfThere { refuse, resume, overwrite, resume_or_overwrite };

    // `file` empty: nothing is written. A file that is there: with `resume` its rows are kept; with `overwrite` it
    // stays until this report is finished, which grows beside it, in `file`.unfinished, and can be resumed. Throws
    // InputError if it is refused, or another machine's, build's, backend's or run's.
    Report(std::string file, RunDescription description, IfThere if_there);

    bool has(const Task& task) const;
    // Adds a task's rows, which are what to_json makes of them.
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
    std::string growing_;      // written after every case: file_, or beside it
    mutable FileStamp stamp_;  // of file_, as this report knows it
    bool is_changed_ = true;   // since it was read; a complete one that nothing is added to stays as it is
    RunDescription description_;
    Json variants_ = Json::object();  // by identity: the name and the choices of every variant that a row is of
    Json rows_ = Json::array();
    std::set<std::string> done_;  // keys of tasks
};

// A task in words, as "lamp a=0.1 albedo=0.5 depth=9 [nee, double]": the case, its point and what differs from the
// plainest variant.
std::string label(const Task& task, const Variant& plainest);
// A row in words, as "mean radiance 0.0099010 (exact 0.0099010): off by 1.2e-8 of 5.3e-8 allowed".
std::string in_words(const Row& row);

// Name and text of the scene files that show a case, at its first point; none for a direct check.
std::vector<std::pair<std::string, std::string>> scene_files(const Case& stiff_case);

}  // namespace pt::stability
