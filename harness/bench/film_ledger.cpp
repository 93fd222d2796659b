#include "harness/bench/film_ledger.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "harness/render/checkpoints.h"
#include "variants/registry.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

bool stops_matter(const Cell& cell) { return cell.convergence && stops_change_film(cell.variant, cell.backend); }

// The name of a bitwise group: the cells whose films must be equal bit for bit.
std::string bitwise_group(const Cell& cell) {
    std::string name = setting_in(cell.name);
    if (cell.convergence && !stops_matter(cell)) {
        name.erase(name.rfind('/'));
    }
    // The group's name contains the reference variant, so that a variant that rounds freely has a group of its own: it
    // is its own reference, and need not agree with others.
    return bitwise_reference(cell).spelled_out() + name;
}

bool is_its_own_reference(const Cell& cell) { return bitwise_reference(cell) == cell.variant; }

// The reference variant to render for each seed of a cell. On meshes it uses an acceleration tree, because testing
// every triangle would take hours.
Variant quick_reference(const Cell& cell) {
    return is_its_own_reference(cell) ? cell.variant : fast_reference_on(*cell.scene, cell.variant, cell.backend);
}

}  // namespace

Variant bitwise_reference(const Cell& cell) {
    return fp_relaxed(cell.variant, cell.backend) ? cell.variant
                                                  : reference_on(*cell.scene, cell.variant, cell.backend);
}

std::string sample_in_words(std::size_t index, std::uint64_t seed) {
    return fmt::format("sample {} (seed {})", index, seed);
}

FilmLedger::FilmLedger(const Plan& plan, const Journal& journal, std::uint64_t first_seed, Render render)
    : first_seed_(first_seed), render_(std::move(render)) {
    for (const Cell& cell : plan.cells) {
        const std::vector<Sample>& samples = journal.samples(cell.name);
        for (std::size_t index = 0; index < samples.size(); ++index) {
            entries_[{bitwise_group(cell), index}].seen.push_back({&cell, imprint_of(samples[index])});
        }
    }
}

Imprint FilmLedger::render_imprint(const Cell& cell, const Variant& variant, std::uint32_t samples,
                                   std::uint64_t seed) {
    RenderRequest request{.variant = variant, .backend = cell.backend, .settings = cell.settings, .samples = samples};
    request.settings.seed = seed;
    if (stops_matter(cell) && samples == cell.spp) {
        request.checkpoints = cell.convergence->checkpoints;
        request.on_checkpoint = [](const Checkpoint&) {};
    }
    return imprint_of(render_named(*cell.scene, request));
}

void FilmLedger::settle(Entry& entry, const Cell& cell, const Variant& reference, std::uint32_t samples,
                        std::uint64_t seed) {
    const std::string name = shown_name(reference, cell.backend);
    try {
        entry.right = render_(cell, reference, samples, seed);
    } catch (const std::exception& error) {
        throw std::runtime_error(
            fmt::format("its reference, {}, cannot be rendered with seed {}: {}", name, seed, error.what()));
    }
    entry.reference = reference;
    entry.of = name;
}

bool FilmLedger::differ(const Entry& entry) {
    const Imprint& right = entry.right ? *entry.right : entry.seen.front().imprint;
    return std::any_of(entry.seen.begin(), entry.seen.end(),
                       [&](const Seen& seen) { return !(seen.imprint == right); });
}

// Compares a group's films with the reference's. A cell is found wrong only if the slow plain reference says so too.
std::vector<FailedCell> FilmLedger::judge(Entry& entry, const Cell& cell, std::uint32_t samples, std::uint64_t seed,
                                          const std::string& place) {
    if (const Variant plain = bitwise_reference(cell); differ(entry) && !(entry.reference == plain)) {
        settle(entry, cell, plain, samples, seed);
    }
    std::vector<FailedCell> failed;
    std::erase_if(entry.seen, [&](const Seen& seen) {
        const std::string differs = difference(seen.imprint, *entry.right);
        if (!differs.empty()) {
            failed.push_back({seen.cell, fmt::format("{}: {} of {}", place, differs, entry.of)});
        }
        return !differs.empty();
    });
    return failed;
}

std::vector<FailedCell> FilmLedger::note_sample(const Cell& cell, std::size_t index, const Imprint& found) {
    Entry& entry = entries_[{bitwise_group(cell), index}];
    entry.seen.push_back({&cell, found});
    const std::uint64_t seed = first_seed_ + index;
    const bool is_quick = cell.samples_to_prepare() >= cell.spp && !is_its_own_reference(cell);
    if (!entry.right && (is_quick || differ(entry))) {
        settle(entry, cell, quick_reference(cell), cell.spp, seed);
    }
    return entry.right ? judge(entry, cell, cell.spp, seed, sample_in_words(index, seed)) : std::vector<FailedCell>();
}

std::vector<FailedCell> FilmLedger::note_preparation(const Cell& cell, const Imprint& found) {
    return note_prepared(cell, bitwise_reference(cell), cell, found);
}

std::vector<FailedCell> FilmLedger::note_twin(const Cell& cell, const Imprint& found) {
    Cell twin = cell;
    twin.variant = exact_twin(cell.variant, cell.backend);
    return note_prepared(twin, quick_reference(twin), cell, found);
}

std::vector<FailedCell> FilmLedger::note_prepared(const Cell& rendered, const Variant& reference, const Cell& blamed,
                                                  const Imprint& found) {
    const std::uint32_t spp = rendered.samples_to_prepare();
    // Where checkpoints change the film (stops_matter), films with checkpoints are not compared with films without.
    const std::string part = spp != rendered.spp || stops_matter(rendered) ? fmt::format("/first:{}", spp) : "";
    Entry& entry = entries_[{bitwise_group(rendered) + part, 0}];
    if (!entry.right) {
        settle(entry, rendered, reference, spp, first_seed_);
    }
    entry.seen.push_back({&blamed, found});
    return judge(entry, rendered, spp, first_seed_, fmt::format("at full size, {} spp, seed {}", spp, first_seed_));
}

}  // namespace pt
