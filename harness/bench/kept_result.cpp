#include "harness/bench/kept_result.h"

#include <filesystem>

#include "harness/files_read.h"
#include "harness/machine/run_context.h"

namespace pt {

namespace {

// Parses a file as JSON; if the file is no JSON, is_discarded() of the returned value is true.
Json parsed(const std::string& file) { return Json::parse(read_earlier_output(file, largest_result), nullptr, false); }

const std::string status_place = std::string("/context/") + CallContext::status_key;

// The string at a JSON pointer of a document; "" if there is none.
std::string text_at(const Json& document, const std::string& pointer) {
    const Json::json_pointer place(pointer);
    return document.is_object() && document.contains(place) && document.at(place).is_string()
               ? document.at(place).get<std::string>()
               : "";
}

[[noreturn]] void refuse_overwrite(const std::string& file, const std::string& description) {
    throw InputError(file, "result file", description,
                     "--overwrite, which replaces it when the new one is complete, or another --out");
}

void add_images(std::vector<std::string>& names, const Json& cell) {
    const Json::json_pointer place("/convergence/images");
    if (!cell.is_object() || !cell.contains(place)) {
        return;
    }
    const Json flat = cell.at(place).flatten();  // named, because items() only refers to the flattened object
    for (const auto& [key, name] : flat.items()) {
        if (name.is_string()) {
            names.push_back(name.get<std::string>());
        }
    }
}

}  // namespace

bool is_complete_result(const Json& result) { return text_at(result, status_place) == "completed"; }

std::string describe_result(const Json& result) {
    const std::string status = text_at(result, status_place);
    if (status.empty()) {
        return "a file that is no result of ptbench";
    }
    return fmt::format("{} result of {}", is_complete_result(result) ? "a complete" : "an interrupted",
                       text_at(result, "/context/date"));
}

void check_overwrite(const std::string& file, bool overwrite) {
    if (!overwrite && std::filesystem::exists(file)) {
        refuse_overwrite(file, describe_result(parsed(file)));
    }
}

void check_overwrite(const std::string& file, const EarlierResult& earlier, bool overwrite) {
    if (!overwrite && earlier.is_there) {
        refuse_overwrite(file, earlier.description);
    }
}

void refuse_result(const std::string& file) {
    if (!std::filesystem::is_regular_file(file)) {
        return;
    }
    const Json there = parsed(file);
    if (!text_at(there, status_place).empty()) {
        throw InputError(file, "output file", describe_result(there),
                         "another name: only a result may take a result's place");
    }
}

void check_untouched(const std::string& file, const FileStamp& stamp, const std::string& where) {
    if (stamp_of(file) != stamp) {
        throw MachineError(fmt::format("{}: another command wrote it meanwhile, and it stays; {}", file, where));
    }
}

EarlierResult earlier_result(const std::string& file, const RunRecord& run) {
    EarlierResult earlier;
    earlier.stamp = stamp_of(file);
    earlier.is_there = earlier.stamp.exists;
    if (!earlier.is_there) {
        return earlier;
    }
    const Json result = parsed(file);
    earlier.is_complete = is_complete_result(result);
    earlier.description = describe_result(result);
    earlier.is_of_this_run = text_at(result, "/ptbench/run/identity") == run.identity &&
                             text_at(result, "/ptbench/run/shard") == run.shard.value_or("");
    const Json::json_pointer cells("/ptbench/cells");
    if (result.is_object() && result.contains(cells) && result.at(cells).is_array()) {
        for (const Json& cell : result.at(cells)) {
            earlier.failed_cells += text_at(cell, "/status") == "failed" ? 1 : 0;
            add_images(earlier.images, cell);
        }
    }
    return earlier;
}

}  // namespace pt
