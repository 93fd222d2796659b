#include "harness/mesh/mesh_warnings.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/failure.h"

namespace pt {

void MeshWarnings::add(std::string_view place, std::string_view text) {
    const auto known =
        std::find_if(kept_.begin(), kept_.end(), [&](const Warning& warning) { return warning.text == text; });
    if (known != kept_.end()) {
        known->count += 1;
    } else if (kept_.size() < most_kept) {
        kept_.push_back({std::string(place), std::string(text), 1});
    } else {
        not_kept_ += 1;
    }
}

std::vector<std::string> MeshWarnings::messages() const {
    std::vector<std::string> messages;
    for (const auto& [place, text, count] : kept_) {
        const std::string more = count == 1 ? "" : fmt::format(" (and {} more of these)", count - 1);
        messages.push_back(one_line(fmt::format("{}: {}{}", place, text, more)));
    }
    if (not_kept_ > 0) {
        messages.push_back(fmt::format("{} more warnings of other kinds", not_kept_));
    }
    return messages;
}

}  // namespace pt
