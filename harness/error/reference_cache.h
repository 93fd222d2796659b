// The cache of rendered references on disk: for each a JSON file with its identity, and a file with the raw
// little-endian doubles of both halves.
#pragma once

#include <functional>
#include <string>

#include "harness/error/reference.h"

namespace pt {

class ReferenceCache {
public:
    ReferenceCache(std::string folder, std::function<void(const std::string&)> says)
        : folder_(std::move(folder)), says_(std::move(says)) {}

    // Loads a reference's halves, their spp and git_sha from the file for the same scene, size, depth, variant, seeds
    // and source code, if there is one. A file that is damaged or has another identity is refused with a line of text.
    bool load(Reference& reference) const;
    // Writes a reference's two files under temporary names and renames them, the file of doubles first, so that its
    // JSON file, which has the doubles' hash, never exists without it. A failure is reported as a line of text.
    void store(const Reference& reference) const;

    // The path of a reference's files without the suffixes .json and .f64.
    std::string stem(const Reference& reference) const;

private:
    std::string folder_;
    std::function<void(const std::string&)> says_;
};

}  // namespace pt
