// The journal of a run: one JSON line a fact, written as soon as it is known, so that a killed run loses at most the
// sample in flight. The result file is made from it, and --resume goes on from it.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "harness/json_reader.h"

namespace pt {

class Journal {
public:
    // Opens `file` and locks it. A journal that is there already must be resumed (same `identity`) or is refused; a
    // last line that was cut off is dropped. Throws InputError (unfinished run, other identity), MachineError (cannot
    // write).
    Journal(std::string file, const Json& identity, bool resume);

    // One sample of a cell, in the order of its index.
    void add_sample(const std::string& cell, const Json& sample);
    // What is known of a cell besides its samples; a later call replaces an earlier one.
    void set_cell(const std::string& cell, const Json& facts);

    const std::vector<Json>& samples(const std::string& cell) const;
    const Json* cell(const std::string& cell) const;
    std::size_t sample_count() const;
    const std::string& file() const { return file_; }

    // Removes the file; call when the result file is in place.
    void finish();

private:
    void read(const Json& identity);
    void append(const Json& line);

    // Closed, and so unlocked, also where the constructor throws.
    class OpenFile {
    public:
        explicit OpenFile(int descriptor) : descriptor_(descriptor) {}
        ~OpenFile();
        OpenFile(const OpenFile&) = delete;
        OpenFile& operator=(const OpenFile&) = delete;
        operator int() const { return descriptor_; }  // NOLINT: a descriptor, for the system's calls

    private:
        int descriptor_;
    };

    std::string file_;
    std::unique_ptr<OpenFile> descriptor_;
    std::map<std::string, std::vector<Json>> samples_;
    std::map<std::string, Json> cells_;
};

}  // namespace pt
