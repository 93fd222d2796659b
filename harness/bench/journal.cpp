#include "harness/bench/journal.h"

#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "harness/error.h"

namespace pt {

namespace {

// The string under `key`, or "" if there is none.
std::string text_in(const Json& line, const char* key) {
    const auto member = line.find(key);
    return member != line.end() && member->is_string() ? member->get<std::string>() : "";
}

// The JSON of a line; null where it is none.
Json parse_line(const std::string& line, const std::string& file) {
    try {
        return parse_json(line, file);
    } catch (const InputError&) {
        return nullptr;
    }
}

}  // namespace

Journal::Journal(std::string file, const Json& identity, bool resume) : file_(std::move(file)) {
    const std::filesystem::path folder = std::filesystem::path(file_).parent_path();
    std::error_code ignored;
    if (!folder.empty()) {
        std::filesystem::create_directories(folder, ignored);
    }
    const bool exists = std::filesystem::exists(file_) && std::filesystem::file_size(file_) > 0;
    descriptor_ = std::make_unique<OpenFile>(::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644));
    if (*descriptor_ < 0) {
        throw MachineError(fmt::format("{}: cannot be written: {}", file_, std::strerror(errno)));
    }
    if (::flock(*descriptor_, LOCK_EX | LOCK_NB) != 0) {
        throw MachineError(fmt::format("{}: another run is writing it", file_));
    }
    if (exists && !resume) {
        throw InputError(
            fmt::format("{}: found an unfinished run, allowed: go on with --resume, or remove the file", file_));
    }
    if (exists) {
        read(identity);
    } else {
        append({{"type", "run"}, {"identity", identity}});
    }
}

Journal::OpenFile::~OpenFile() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
}

void Journal::read(const Json& identity) {
    const std::string text = read_file(file_);
    std::size_t start = 0;
    bool is_first = true;
    for (std::size_t end = text.find('\n'); end != std::string::npos; start = end + 1, end = text.find('\n', start)) {
        const Json line = parse_line(text.substr(start, end - start), file_);
        const std::string type = text_in(line, "type");
        const std::string cell = text_in(line, "cell");
        if (is_first) {
            if (type != "run" || line.value("identity", Json()) != identity) {
                throw InputError(file_, "line 1", "another run (machine, build, suite or settings differ)",
                                 "the run that it was started with; remove the file to start over");
            }
            is_first = false;
        } else if (type == "sample" && !cell.empty() && line.contains("sample")) {
            samples_[cell].push_back(line.at("sample"));
        } else if (type == "cell" && !cell.empty() && line.contains("facts")) {
            cells_[cell] = line.at("facts");
        } else {
            throw InputError(file_, fmt::format("byte {}", start), "a damaged line",
                             "lines that ptbench wrote; remove the file to start over");
        }
    }
    if (start != text.size() && ::ftruncate(*descriptor_, static_cast<off_t>(start)) != 0) {
        throw MachineError(fmt::format("{}: cannot be written: {}", file_, std::strerror(errno)));
    }
    if (is_first) {
        append({{"type", "run"}, {"identity", identity}});
    }
}

void Journal::append(const Json& line) {
    const std::string text = line.dump() + "\n";
    const off_t end = ::lseek(*descriptor_, 0, SEEK_END);
    // One write: a line is whole, or it is the last and cut off.
    const ssize_t written = ::write(*descriptor_, text.data(), text.size());
    if (written != static_cast<ssize_t>(text.size())) {
        std::string why = written < 0 ? std::strerror(errno) : "disk full";
        if (written > 0 && ::ftruncate(*descriptor_, end) != 0) {  // no half line in front of the next one
            why += fmt::format("; {}", std::strerror(errno));
        }
        throw MachineError(fmt::format("{}: cannot be written: {}", file_, why));
    }
}

void Journal::add_sample(const std::string& cell, const Json& sample) {
    append({{"type", "sample"}, {"cell", cell}, {"sample", sample}});
    samples_[cell].push_back(sample);
}

void Journal::set_cell(const std::string& cell, const Json& facts) {
    append({{"type", "cell"}, {"cell", cell}, {"facts", facts}});
    cells_[cell] = facts;
}

const std::vector<Json>& Journal::samples(const std::string& cell) const {
    static const std::vector<Json> none;
    const auto position = samples_.find(cell);
    return position == samples_.end() ? none : position->second;
}

const Json* Journal::cell(const std::string& cell) const {
    const auto position = cells_.find(cell);
    return position == cells_.end() ? nullptr : &position->second;
}

std::size_t Journal::sample_count() const {
    std::size_t count = 0;
    for (const auto& [cell, samples] : samples_) {
        count += samples.size();
    }
    return count;
}

void Journal::finish() {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
}

}  // namespace pt
