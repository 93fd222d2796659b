#include "harness/interchange/import_findings.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/failure.h"

namespace pt {

void ImportFindings::add(std::size_t line, const std::string& text) {
    count_ += 1;
    const auto after = std::upper_bound(listed_.begin(), listed_.end(), line,
                                        [](std::size_t number, const ImportFinding& f) { return number < f.line; });
    if (after == listed_.end() && listed_.size() == most_listed) {
        return;
    }
    listed_.insert(after, {line, one_line(text)});
    listed_.resize(std::min(listed_.size(), most_listed));
}

std::vector<std::string> ImportFindings::messages(const std::string& file, const std::string& kind) const {
    const std::string start = kind.empty() ? "" : kind + ": ";
    const std::string safe_file = one_line(file);
    std::vector<std::string> messages;
    for (const ImportFinding& finding : listed_) {
        const std::string place = finding.line == 0 ? "" : fmt::format("{}:", finding.line);
        messages.push_back(fmt::format("{}:{} {}{}", safe_file, place, start, finding.text));
    }
    if (count_ > listed_.size()) {
        messages.push_back(fmt::format("{}: {}and {} more", safe_file, start, count_ - listed_.size()));
    }
    return messages;
}

}  // namespace pt
