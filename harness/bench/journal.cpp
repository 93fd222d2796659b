#include "harness/bench/journal.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "harness/failure.h"

namespace pt {

namespace {

// The string member `key` of a journal line; "" if there is none.
std::string text_in(const Json& line, const char* key) {
    const auto member = line.find(key);
    return member != line.end() && member->is_string() ? member->get<std::string>() : "";
}

// Parses a journal line; null if it is no JSON.
Json parse_line(const std::string& line, const std::string& file) {
    try {
        return parse_json(line, file);
    } catch (const InputError&) {
        return nullptr;
    }
}

std::string shown(const Json* value) {
    // An error message shows cell names in full: they may differ at any position, but describe() shortens them.
    const bool is_name = value != nullptr && value->is_string();
    return value == nullptr ? "none"
           : is_name        ? value->dump(-1, ' ', false, Json::error_handler_t::replace)
                            : describe(*value);
}

const Json* member(const Json& object, const std::string& key) {
    const auto position = object.find(key);
    return position == object.end() ? nullptr : &*position;
}

std::string list_difference(const Json& there, const Json& here) {
    std::size_t same = 0;
    while (same < there.size() && same < here.size() && there[same] == here[same]) {
        ++same;
    }
    const auto element = [&](const Json& list) { return same < list.size() ? shown(&list[same]) : "none"; };
    return fmt::format("{} of them, here {}; number {} is {}, here {}", there.size(), here.size(), same + 1,
                       element(there), element(here));
}

void collect(const std::string& name, const Json* there, const Json* here, std::vector<std::string>& found) {
    if (there != nullptr && here != nullptr && *there == *here) {
        return;
    }
    if (there != nullptr && here != nullptr && there->is_object() && here->is_object()) {
        std::vector<std::string> keys;
        for (const Json* object : {there, here}) {
            for (const auto& [key, value] : object->items()) {
                if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
                    keys.push_back(key);
                }
            }
        }
        for (const std::string& key : keys) {
            collect(name.empty() ? key : name + " " + key, member(*there, key), member(*here, key), found);
        }
        return;
    }
    const bool are_lists = there != nullptr && here != nullptr && there->is_array() && here->is_array();
    const std::string prefix = name.empty() ? "" : name + ": ";
    found.push_back(
        prefix + (are_lists ? list_difference(*there, *here) : fmt::format("{}, here {}", shown(there), shown(here))));
}

Json without(Json object, const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
        if (object.is_object()) {
            object.erase(key);
        }
    }
    return object;
}

// The error for a damaged line of the journal, which says how to keep the lines before it.
InputError damaged(const std::string& file, std::size_t line, const std::string& found) {
    const std::string keep =
        line == 1 ? "" : fmt::format("keep the {} before it (head -n {}) to go on from there, or ", line - 1, line - 1);
    return InputError(file, fmt::format("line {}", line), found,
                      fmt::format("lines as ptbench wrote them; {}remove the file to start over", keep));
}

}  // namespace

std::string difference(const Json& there, const Json& here) {
    constexpr std::size_t most = 3;
    std::vector<std::string> found;
    collect("", &there, &here, found);
    const std::size_t others = found.size() - std::min(found.size(), most);
    found.resize(found.size() - others);
    return fmt::format("{}{}", fmt::join(found, "; "), others == 0 ? "" : fmt::format("; and {} more", others));
}

Journal::Journal(std::string file, const Json& identity, bool resume, const std::vector<std::string>& that_may_differ)
    : file_(std::move(file)), locked_(file_) {
    if (locked_.size() == 0) {
        append({{"type", "run"}, {"identity", identity}});
    } else if (resume) {
        read(identity, that_may_differ);
    } else {
        throw InputError(fmt::format(
            "{}: found an unfinished run, allowed: --resume, which goes on, or --overwrite, which starts over", file_));
    }
}

void Journal::read(const Json& identity, const std::vector<std::string>& that_may_differ) {
    const std::string text = read_file(file_, largest_result);
    std::size_t start = 0, number = 0;
    for (std::size_t end = text.find('\n'); end != std::string::npos; start = end + 1, end = text.find('\n', start)) {
        const std::string line = text.substr(start, end - start);
        number += 1;
        if (const std::string fault = seal_.fault(line); !fault.empty()) {
            throw damaged(file_, number, fault);
        }
        if (number == 1) {
            check_identity(parse_line(line, file_), identity, that_may_differ);
        } else {
            read_line(parse_line(line, file_), number);
        }
    }
    dropped_bytes_ = text.size() - start;
    if (dropped_bytes_ != 0 && ::ftruncate(locked_.descriptor(), static_cast<off_t>(start)) != 0) {
        throw MachineError(fmt::format("{}: cannot be written: {}", file_, std::strerror(errno)));
    }
    if (number == 0) {
        append({{"type", "run"}, {"identity", identity}});
    }
}

void Journal::check_identity(const Json& line, const Json& identity,
                             const std::vector<std::string>& that_may_differ) const {
    if (text_in(line, "type") != "run" || !line.contains("identity")) {
        throw InputError(file_, "line 1", "no line of a run",
                         "the line with which ptbench begins; remove the file to start over");
    }
    const std::string other =
        difference(without(line.at("identity"), that_may_differ), without(identity, that_may_differ));
    if (!other.empty()) {
        throw InputError(file_, "line 1", "another run (" + other + ")",
                         "the run that it was started with; remove the file to start over");
    }
}

void Journal::read_line(const Json& line, std::size_t number) {
    try {
        keep_line(line, number);
    } catch (const WrongFact& wrong) {
        throw damaged(file_, number, fmt::format("a {} with {}", text_in(line, "type"), wrong.what()));
    }
}

void Journal::keep_line(const Json& line, std::size_t number) {
    const std::string type = text_in(line, "type");
    const std::string cell = text_in(line, "cell");
    if (type == "sample" && !cell.empty() && line.contains("sample")) {
        keep_sample(cell, line.at("sample"));
    } else if (type == "retake" && line.contains("sample") && taken_before(cell, line.at("sample")) != nullptr) {
        keep_retake(cell, line.at("sample"));
    } else if (type == "cell" && !cell.empty() && line.contains("facts")) {
        cells_[cell] = line.at("facts");
    } else if (type == "session" && line.contains("facts")) {
        keep_session(line.at("facts"));
    } else {
        throw damaged(file_, number, "no line of a session, a cell or a sample");
    }
}

std::string Journal::next_lines(const std::vector<Json>& lines) const {
    LineSeal seal = seal_;
    std::string text;
    for (const Json& line : lines) {
        text += seal.seal(line.dump()) + "\n";
    }
    return text;
}

Json Journal::cell_line(const std::string& cell, const CellFacts& facts) {
    return {{"type", "cell"}, {"cell", cell}, {"facts", facts}};
}

Json Journal::session_line(const SessionFacts& facts) { return {{"type", "session"}, {"facts", facts}}; }

void Journal::append(const Json& line) {
    LineSeal seal = seal_;
    const std::string text = seal.seal(line.dump()) + "\n";
    const off_t end = ::lseek(locked_.descriptor(), 0, SEEK_END);
    // A single write call for each journal line ensures that only the file's last line can be incomplete.
    const ssize_t written = ::write(locked_.descriptor(), text.data(), text.size());
    if (written != static_cast<ssize_t>(text.size())) {
        std::string why = written < 0 ? std::strerror(errno) : "disk full";
        if (written > 0 &&
            ::ftruncate(locked_.descriptor(), end) != 0) {  // no line of the journal may follow an incomplete one
            why += fmt::format("; {}", std::strerror(errno));
        }
        throw MachineError(
            fmt::format("{}: cannot be written: {} (what it holds is kept; go on with --resume)", file_, why));
    }
    seal_ = seal;
}

void Journal::keep_sample(const std::string& cell, const Sample& sample) {
    samples_[cell].push_back(sample);
    count_sample();
}

void Journal::keep_retake(const std::string& cell, const Sample& sample) {
    retaken_[cell].push_back(std::exchange(*taken_before(cell, sample), sample));
    count_sample();
}

void Journal::count_sample() {
    if (!sessions_.empty()) {
        sessions_.back().samples = sessions_.back().samples.value_or(0) + 1;
    }
}

Sample* Journal::taken_before(const std::string& cell, const Sample& sample) {
    const auto taken = samples_.find(cell);
    if (taken == samples_.end()) {
        return nullptr;
    }
    const auto before = std::find_if(taken->second.begin(), taken->second.end(),
                                     [&](const Sample& other) { return other.seed == sample.seed; });
    return before == taken->second.end() ? nullptr : &*before;
}

void Journal::keep_session(SessionFacts facts) {
    facts.samples = 0;
    sessions_.push_back(std::move(facts));
}

void Journal::add_sample(const std::string& cell, const Sample& sample) {
    append({{"type", "sample"}, {"cell", cell}, {"sample", sample}});
    keep_sample(cell, sample);
}

void Journal::retake_sample(const std::string& cell, const Sample& sample) {
    append({{"type", "retake"}, {"cell", cell}, {"sample", sample}});
    keep_retake(cell, sample);
}

void Journal::set_cell(const std::string& cell, const CellFacts& facts) {
    append(cell_line(cell, facts));
    cells_[cell] = facts;
}

void Journal::add_session(const SessionFacts& facts) {
    append(session_line(facts));
    keep_session(facts);
}

namespace {

const std::vector<Sample>& of_cell(const std::map<std::string, std::vector<Sample>>& all, const std::string& cell) {
    static const std::vector<Sample> none;
    const auto position = all.find(cell);
    return position == all.end() ? none : position->second;
}

}  // namespace

const std::vector<Sample>& Journal::samples(const std::string& cell) const { return of_cell(samples_, cell); }

const std::vector<Sample>& Journal::retaken(const std::string& cell) const { return of_cell(retaken_, cell); }

const CellFacts* Journal::cell(const std::string& cell) const {
    const auto position = cells_.find(cell);
    return position == cells_.end() ? nullptr : &position->second;
}

bool Journal::is_ok(const std::string& name) const {
    const CellFacts* const facts = cell(name);
    return facts != nullptr && facts->status == CellStatus::ok;
}

bool Journal::has_failed(const std::string& name) const {
    const CellFacts* const facts = cell(name);
    return facts != nullptr && facts->status == CellStatus::failed;
}

std::size_t Journal::sample_count() const {
    std::size_t count = 0;
    for (const auto& [cell, samples] : samples_) {
        count += samples.size();
    }
    return count;
}

void Journal::finish() { locked_.remove(); }

std::string set_journal_aside(const std::string& file) {
    const LockedFile mine(file);
    std::string aside;
    for (int number = 1; aside.empty() || std::filesystem::exists(aside); ++number) {
        aside = fmt::format("{}.{}", file, number);
    }
    std::error_code error;
    std::filesystem::rename(file, aside, error);
    if (error) {
        throw MachineError(fmt::format("{}: cannot be renamed to {}: {}", file, aside, error.message()));
    }
    return aside;
}

}  // namespace pt
