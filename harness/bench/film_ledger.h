// Compares films and work counts of a run's cells with those of the reference variant, sample by sample. Sample i has
// the same seed in all cells, so cells of a bitwise group must leave equal films. The film that came first is not taken
// as right: the reference variant is rendered to know the right one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "harness/bench/imprint.h"
#include "harness/bench/journal.h"
#include "harness/bench/suite.h"

namespace pt {

// The variant whose film a cell must match bit for bit. A cell that rounds freely (relaxed floating point) is its own
// reference: its film must be the same every time.
Variant bitwise_reference(const Cell& cell);

std::string sample_in_words(std::size_t index, std::uint64_t seed);

// A cell whose film or work count is wrong, and the reason.
struct FailedCell {
    const Cell* cell = nullptr;
    std::string reason;
};

class FilmLedger {
public:
    // Renders `variant` at a cell's resolution and with the cell's checkpoints, and returns the imprint (film hash and
    // work counts). Throws what a render throws.
    using Render =
        std::function<Imprint(const Cell& cell, const Variant& variant, std::uint32_t samples, std::uint64_t seed)>;

    // A ledger of films that begins with the samples in the journal: earlier processes took them, and they are checked
    // like all others. `plan` must outlive the ledger. Sample i has the seed `first_seed` + i.
    FilmLedger(const Plan& plan, const Journal& journal, std::uint64_t first_seed, Render render = render_imprint);

    // Records the imprint (film hash, work counts) of a cell's sample and returns the cells found wrong, this or
    // earlier ones. The reference is rendered once for each seed of a bitwise group; for long cells (spp above
    // Cell::prepared_spp) only if films of the group differ. Throws std::runtime_error if it cannot be rendered.
    std::vector<FailedCell> note_sample(const Cell& cell, std::size_t index, const Imprint& found);
    // Records the imprint of a preparatory render (first seed, samples_to_prepare() samples), which is always compared
    // with the reference. Returns the cells that are wrong.
    std::vector<FailedCell> note_preparation(const Cell& cell, const Imprint& found);
    // Records a preparatory render of the exact twin of a cell that rounds freely, because only the twin's bits can be
    // compared with the reference. Returns the cells that are wrong.
    std::vector<FailedCell> note_twin(const Cell& cell, const Imprint& found);

private:
    struct Seen {
        const Cell* cell;
        Imprint imprint;
    };
    struct Entry {
        std::optional<Imprint> right = {};
        Variant reference = {};  // reference variant whose render the member `right` describes
        std::string of = {};     // name of the reference variant
        std::vector<Seen> seen = {};
    };
    static Imprint render_imprint(const Cell& cell, const Variant& variant, std::uint32_t samples, std::uint64_t seed);
    static bool differ(const Entry& entry);
    void settle(Entry& entry, const Cell& cell, const Variant& reference, std::uint32_t samples, std::uint64_t seed);
    std::vector<FailedCell> judge(Entry& entry, const Cell& cell, std::uint32_t samples, std::uint64_t seed,
                                  const std::string& place);
    std::vector<FailedCell> note_prepared(const Cell& rendered, const Variant& reference, const Cell& blamed,
                                          const Imprint& found);

    std::uint64_t first_seed_;
    Render render_;
    std::map<std::pair<std::string, std::size_t>, Entry> entries_;  // seen films by bitwise group and sample index
};

}  // namespace pt
