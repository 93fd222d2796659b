// Files that a command writes beside the file that its --out names. The rule for every command: what lies there already
// stays as it is, whoever wrote it. A new file takes the first free name, or the name of a file that holds the same
// bytes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace pt {

// Throws InputError if `file`, the value of `flag` or in it, may not get this content: this call has read it, or it
// holds another and `overwrite` is false.
void check_replacement(const std::string& file, const std::string& content, bool overwrite,
                       const std::string& flag = "--out");

class FilesBeside {
public:
    FilesBeside() = default;  // nothing is written: every name is free
    explicit FilesBeside(std::filesystem::path out) : out_(std::move(out)) {}

    // A function that gives the N-th name to try for a file, without a folder.
    using NameOf = std::function<std::string(std::size_t n)>;
    // Returns the name, in the folder of --out, under which this content is kept: the first from `first` on that is
    // free or has it. Throws InputError if a name cannot be used.
    std::string add(const NameOf& name, std::size_t first, std::string content);

    // The contents of the files, by their names.
    const std::map<std::string, std::string>& contents() const { return contents_; }

    // Writes all of them, and then the file of --out with its own content: who finds that finds what it names. Throws
    // MachineError if one cannot be written, or another command took its name meanwhile; new files are removed then.
    void write(const std::string& content) const;

private:
    std::filesystem::path path_of(const std::string& name) const { return out_.parent_path() / name; }
    void write_all(const std::string& content, std::vector<std::filesystem::path>& made) const;

    std::filesystem::path out_;
    std::map<std::string, std::string> contents_;
};

}  // namespace pt
