#include "harness/files_beside.h"

#include "harness/failure.h"
#include "harness/files_read.h"
#include "harness/write_file.h"

namespace pt {

namespace {

namespace fs = std::filesystem;

// Whether a file of any kind has this name; a dangling symbolic link counts.
bool is_taken(const fs::path& path) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
}

bool holds(const fs::path& path, const std::string& content) {
    std::error_code failed;
    if (!fs::is_regular_file(path, failed) || fs::file_size(path, failed) != content.size() || failed) {
        return false;
    }
    try {
        return read_earlier_output(path.string(), content.size()) == content;
    } catch (const InputError&) {  // an unreadable file does not hold `content`
        return false;
    }
}

}  // namespace

void check_replacement(const std::string& file, const std::string& content, bool overwrite, const std::string& flag) {
    check_output_file(file, flag);
    refuse_source(file, flag);
    if (!overwrite && is_taken(file) && !holds(file, content)) {
        throw InputError(file, "output file", "a file that is there and holds something else",
                         "--overwrite, which replaces it, or another " + flag);
    }
}

std::string FilesBeside::add(const NameOf& name, std::size_t first, std::string content) {
    for (std::size_t n = first;; ++n) {
        std::string candidate = name(n);
        const auto own = contents_.find(candidate);
        if (own != contents_.end()
                ? own->second != content
                : !out_.empty() && is_taken(path_of(candidate)) && !holds(path_of(candidate), content)) {
            continue;
        }
        if (!out_.empty()) {
            check_output_file(path_of(candidate).string());
        }
        contents_.insert_or_assign(candidate, std::move(content));
        return candidate;
    }
}

void FilesBeside::write_all(const std::string& content, std::vector<fs::path>& made) const {
    for (const auto& [name, bytes] : contents_) {
        const fs::path path = path_of(name);
        if (holds(path, bytes)) {
            continue;
        }
        if (is_taken(path)) {
            throw MachineError(path.string() + ": another command wrote it meanwhile, and it stays");
        }
        write_file(path.string(), bytes);
        made.push_back(path);
    }
    write_file(out_.string(), content);
}

void FilesBeside::write(const std::string& content) const {
    std::vector<fs::path> made;
    try {
        write_all(content, made);
    } catch (const MachineError&) {
        for (const fs::path& path : made) {
            std::error_code ignored;
            fs::remove(path, ignored);
        }
        throw;
    }
}

}  // namespace pt
