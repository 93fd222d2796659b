#include "harness/stability/report.h"

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/bench/journal.h"
#include "harness/bench/kept_result.h"
#include "harness/bench/result_file.h"
#include "harness/json_reader.h"
#include "harness/machine/machine.h"
#include "harness/ranks/machine_context.h"
#include "harness/variant_json.h"
#include "harness/write_file.h"
#include "variants/variant_name.h"

namespace pt::stability {

namespace {

constexpr const char* schema = "ptbench-stability-1";

// The facts of a run that must agree for rows to be added to an existing result file.
Json identity(const RunDescription& description) {
    Json json(machine_context(description.backend));
    add_fields(json, CallContext{.backend = std::string(pt::to_string(description.backend))});
    json["quick"] = description.is_quick;
    json["seed"] = description.seed;
    json["paths"] = description.paths;
    return json;
}

std::string key_of(const std::string& name, const Json& point, const std::string& variant) {
    return name + point.dump() + variant;
}

std::string key_of(const Task& task) {
    return key_of(task.stiff_case->name, to_json(task.values), variant_id(task.variant, task.backend));
}

}  // namespace

Report::Report(std::string file, RunDescription description, IfThere if_there)
    : file_(std::move(file)), growing_(file_), description_(std::move(description)) {
    if (file_.empty()) {
        return;
    }
    check_output_file(file_);
    stamp_ = stamp_of(file_);
    const std::string beside = file_ + ".unfinished";
    const bool is_beside = std::filesystem::exists(beside);
    const bool resumes = if_there == IfThere::resume || if_there == IfThere::resume_or_overwrite;
    if (is_beside && !resumes) {
        throw InputError(beside, "the file", "an unfinished run", "go on with --resume, or remove the file");
    }
    if (if_there == IfThere::refuse) {
        check_overwrite(file_, false);
    }
    if (is_beside) {
        growing_ = beside;
    }
    if (resumes && (is_beside || stamp_.exists)) {
        const Json old = parse_json(read_file(growing_, largest_result), growing_);
        const bool is_complete = is_complete_result(old);
        if (if_there == IfThere::resume || !is_complete || is_beside) {
            keep_rows(old);
            is_changed_ = is_beside || !is_complete;
            return;
        }
    }
    if (if_there != IfThere::resume && stamp_.exists) {
        growing_ = beside;
    }
}

void Report::keep_rows(const Json& old) {
    if (!old.is_object() || old.value("schema", "") != schema || !old.contains("rows") || !old.contains("context")) {
        throw InputError(growing_, "file", "no result of ptbench stability", "one, to go on with");
    }
    Json there = old["context"];
    for (const char* own : {CallContext::command_line_key, CallContext::status_key, CallContext::date_key}) {
        if (there.is_object()) {
            there.erase(own);
        }
    }
    if (const std::string other = difference(there, identity(description_)); !other.empty()) {
        const bool is_complete = is_complete_result(old);
        throw InputError(
            growing_, "context",
            (is_complete ? std::string("the complete result of another run (") : std::string("another run (")) + other +
                ")",
            is_complete ? "--overwrite, which replaces it when the new one is complete, or another --out"
                        : "the run that it was started with; remove the file to start over");
    }
    if (!old.contains("variants") || !old["variants"].is_object()) {
        throw InputError(growing_, "file", "no variants: a result of an older ptbench stability", "one, to go on with");
    }
    variants_ = old["variants"];
    rows_ = old["rows"];
    for (const Json& row : rows_) {
        done_.insert(key_of(row["case"], row["point"], row["variant_id"]));
    }
}

bool Report::has(const Task& task) const { return done_.contains(key_of(task)); }

void Report::add(const Task& task, const Json& rows) {
    is_changed_ = true;
    variants_[variant_id(task.variant, task.backend)] = {{"variant", shown_name(task.variant, task.backend)},
                                                         {"axes", axes_json(task.variant)}};
    rows_.insert(rows_.end(), rows.begin(), rows.end());
    done_.insert(key_of(task));
}

void Report::write(const std::string& status) const {
    if (file_.empty() || !is_changed_) {
        return;
    }
    check_untouched(file_, stamp_, "the rows of this run that it did not have are lost");
    Json context = identity(description_);
    add_fields(context, CallContext{.command_line = description_.command_line, .status = status, .date = iso_date()});
    Json cases = Json::array();
    for (const Case& stiff_case : catalogue()) {
        cases.push_back(to_json(stiff_case));
    }
    write_file(growing_, rows_on_lines({{"schema", schema},
                                        {"context", std::move(context)},
                                        {"cases", std::move(cases)},
                                        {"variants", variants_},
                                        {"rows", rows_}}) +
                             "\n");
    stamp_ = stamp_of(file_);
}

void Report::finish() const {
    write("completed");
    std::error_code failed;
    if (growing_ != file_) {
        check_untouched(file_, stamp_, "the result is " + growing_);
        std::filesystem::rename(growing_, file_, failed);
    }
    if (failed) {
        throw MachineError(file_ + ": cannot be replaced: " + failed.message() + " (the result is " + growing_ + ")");
    }
}

std::size_t Report::count(std::string_view status, bool must_pass_only) const {
    std::size_t n = 0;
    for (const Json& row : rows_) {
        n += row["status"] == status && (row["must_pass"] == true || !must_pass_only) ? 1u : 0u;
    }
    return n;
}

std::string Report::summary() const {
    return fmt::format(
        "{} passed, {} failed or broke that must pass, {} known limits, {} failed or broke in naive kernels or fast "
        "arithmetic, {} not applicable",
        passed(), must_pass_failures(), count("known limit", false),
        count("failed", false) + count("broken", false) - must_pass_failures(), count("n/a", false));
}

std::string label(const Task& task, const Variant& plainest) {
    std::string text = task.stiff_case->name;
    for (const auto& [name, value] : task.values.all()) {
        text += fmt::format(" {}={:g}", name, value);
    }
    std::vector<std::string> choices;
    for (const std::string_view axis : axis_names) {
        if (task.variant[axis] != plainest[axis]) {
            choices.push_back(task.variant[axis]);
        }
    }
    return text + fmt::format(" [{}]", fmt::join(choices, ", "));
}

std::string in_words(const Row& row) {
    if (row.measurement.quantity.empty()) {
        return row.reason;
    }
    const Measurement& m = row.measurement;
    const char* relation = m.relation == Relation::equal     ? "exact"
                           : m.relation == Relation::at_most ? "at most"
                                                             : "at least";
    return fmt::format("{} {:.10g} ({} {:.10g}): off by {:.2g}, allowed {:.2g}{}{}", m.quantity, m.measured, relation,
                       m.exact, row.error, row.allowed, row.reason.empty() ? "" : "; ", row.reason);
}

std::vector<std::pair<std::string, std::string>> scene_files(const Case& stiff_case) {
    std::vector<Json> scenes;
    const Values values =
        values_of(stiff_case, stiff_case.points.empty() ? std::map<std::string, double>{} : stiff_case.points.front());
    if (stiff_case.renderings) {
        for (const Rendering& rendering : stiff_case.renderings(values)) {
            scenes.push_back(rendering.scene);
        }
    } else if (stiff_case.twins) {
        scenes.push_back(stiff_case.twins(values).front().reference);
    }
    std::vector<std::pair<std::string, std::string>> files;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const std::string name = stiff_case.name + (i == 0 ? "" : fmt::format("_{}", i + 1));
        scenes[i]["name"] = name;
        scenes[i]["description"] = fmt::format("{} {}: {}.", stiff_case.catalogue, stiff_case.title, stiff_case.stiff);
        files.emplace_back(name, scenes[i].dump(1) + "\n");
    }
    return files;
}

}  // namespace pt::stability
