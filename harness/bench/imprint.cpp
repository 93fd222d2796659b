#include "harness/bench/imprint.h"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pt {

Imprint imprint_of(const RenderResult& result) {
    return {result.film.hash(), result.work.paths, result.work.rays + result.work.cache_hits, result.work.connections};
}

Imprint imprint_of(const Sample& sample) {
    return {sample.film_hash, sample.paths, sample.rays + sample.cache_hits, sample.connections};
}

std::string difference(const Imprint& found, const Imprint& right) {
    std::vector<std::string> parts;
    if (found.film != right.film) {
        parts.push_back(fmt::format("film {}, not {}", found.film, right.film));
    }
    const auto compare = [&](std::uint64_t here, std::uint64_t there, const char* what) {
        if (here != there) {
            parts.push_back(fmt::format("{} {}, not {}", here, what, there));
        }
    };
    compare(found.paths, right.paths, "paths");
    compare(found.rays, right.rays, "rays");
    compare(found.connections, right.connections, "connections to lights");
    return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace pt
