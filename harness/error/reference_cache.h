// Rendered references on disk: a JSON that says what they are, beside the halves' raw little-endian doubles.
#pragma once

#include <functional>
#include <string>

#include "harness/error/reference.h"

namespace pt {

class ReferenceCache {
public:
    ReferenceCache(std::string folder, std::function<void(const std::string&)> says)
        : folder_(std::move(folder)), says_(std::move(says)) {}

    // Fills in the halves, their spp and git_sha if there is a file for the same scene, size, depth, variant, seeds and
    // sources. One that is damaged or of something else is refused in one line.
    bool load(Reference& reference) const;
    // Writes both files under temporary names, then renames them: the doubles first, so that a JSON always finds its
    // own (which it knows by their hash). A folder that cannot be written to is said in one line.
    void store(const Reference& reference) const;

    // The path, without the ending, of a reference's JSON and of its doubles.
    std::string stem(const Reference& reference) const;

private:
    std::string folder_;
    std::function<void(const std::string&)> says_;
};

}  // namespace pt
