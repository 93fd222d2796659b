// Writes files beside the file that --out names. An existing file is never overwritten, whoever wrote it: a new file
// takes the first free name, or the name of a file that holds the same bytes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace pt {

// Throws InputError if `content` must not replace `file`, which the option `flag` names: if this process has read
// `file` as input, or if it has other content and `overwrite` is false.
void check_replacement(const std::string& file, const std::string& content, bool overwrite,
                       const std::string& flag = "--out");

class FilesBeside {
public:
    FilesBeside() = default;  // without --out no file is written, so every name is free
    explicit FilesBeside(std::filesystem::path out) : out_(std::move(out)) {}

    // A function that gives the N-th name to try for a file, without its folder.
    using NameOf = std::function<std::string(std::size_t n)>;
    // Returns the name, in the folder of --out, under which `content` is kept: the first name from number `first` on
    // that is free or has the same content. Throws InputError if a name cannot be used.
    std::string add(const NameOf& name, std::size_t first, std::string content);

    // The contents of the files to be written beside --out, by their names.
    const std::map<std::string, std::string>& contents() const { return contents_; }

    // Writes all files beside --out, and then the file of --out with `content`, so that whoever finds that file finds
    // the ones it names. Throws MachineError if a file cannot be written, or if another command took a name meanwhile;
    // the files written so far are then removed.
    void write(const std::string& content) const;

private:
    std::filesystem::path path_of(const std::string& name) const { return out_.parent_path() / name; }
    void write_all(const std::string& content, std::vector<std::filesystem::path>& made) const;

    std::filesystem::path out_;
    std::map<std::string, std::string> contents_;
};

}  // namespace pt
