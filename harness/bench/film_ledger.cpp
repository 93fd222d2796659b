#include "harness/bench/film_ledger.h"

#include <fmt/format.h>

#include "harness/render/checkpoints.h"
#include "variants/registry.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

// All cells whose films must be equal bit for bit.
std::string bitwise_group(const Cell& cell) {
    std::string name = setting_in(cell.name);
    if (cell.convergence && !stops_change_film(cell.variant, cell.backend)) {
        name.erase(name.rfind('/'));
    }
    // Two kernels that round freely need not agree: each is a group of its own.
    return bitwise_reference(cell).spelled_out() + name;
}

}  // namespace

Variant bitwise_reference(const Cell& cell) {
    return fp_relaxed(cell.variant, cell.backend) ? cell.variant
                                                  : reference_on(*cell.scene, cell.variant, cell.backend);
}

FilmLedger::FilmLedger(const Plan& plan, const Journal& journal) {
    for (const Cell& cell : plan.cells) {
        const std::vector<Json>& samples = journal.samples(cell.name);
        for (std::size_t index = 0; index < samples.size(); ++index) {
            films_.try_emplace({bitwise_group(cell), index},
                               Entry{samples[index].at("film_hash").get<std::string>(), cell.name});
        }
    }
}

std::string FilmLedger::note_sample(const Cell& cell, std::size_t index, const std::string& hash) {
    const auto [position, is_first] = films_.try_emplace({bitwise_group(cell), index}, Entry{hash, cell.name});
    const Entry& known = position->second;
    return is_first || known.hash == hash
               ? ""
               : fmt::format("film {} of sample {} differs from {} of {}", hash, index, known.hash, known.of);
}

const std::string& FilmLedger::film_to_prepare(const Cell& cell, const std::function<std::string()>& render) {
    const std::uint32_t spp = cell.samples_to_prepare();
    const std::string part = spp != cell.spp ? fmt::format("/first:{}", spp) : "";
    const std::pair<std::string, std::size_t> key{bitwise_group(cell) + part, 0};
    const auto known = films_.find(key);
    if (known != films_.end()) {
        return known->second.hash;
    }
    return films_.try_emplace(key, Entry{render(), shown_name(bitwise_reference(cell), cell.backend)})
        .first->second.hash;
}

}  // namespace pt
