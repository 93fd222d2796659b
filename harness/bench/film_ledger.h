// Holds the films of a run's cells, and the work that they took, to those of the reference variant, sample by sample.
// Sample i has the same seed in all cells, so all cells of a bitwise group must leave the same. Whoever comes first is
// not the truth: what the reference leaves is, and it is rendered to know it.
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

// The variant whose bits the cell's film must have. One that rounds freely is held to itself: its film must be the same
// every time.
Variant bitwise_reference(const Cell& cell);

// A sample in words, as "sample 2 (seed 3)".
std::string sample_in_words(std::size_t index, std::uint64_t seed);

// A cell whose film or work is found wrong, and why.
struct FailedCell {
    const Cell* cell = nullptr;
    std::string reason;
};

class FilmLedger {
public:
    // Renders `variant` at the cell's own size and with its checkpoints, and returns the imprint. Throws what a render
    // throws.
    using Render =
        std::function<Imprint(const Cell& cell, const Variant& variant, std::uint32_t samples, std::uint64_t seed)>;

    // Starts with the samples that are in the journal: seen in an earlier process, and believed no more than others.
    // `plan` must outlive it. Sample i has the seed `first_seed` + i.
    FilmLedger(const Plan& plan, const Journal& journal, std::uint64_t first_seed, Render render = render_imprint);

    // Notes what a cell's sample left. Returns the cells that turn out wrong, each once for a sample: this one, or
    // others that were noted before. The reference is rendered for each seed of a group; for a cell of more samples
    // than are prepared (Cell::prepared_spp), whose renders take long, only where two of its group differ. Throws
    // std::runtime_error where the reference cannot be rendered.
    std::vector<FailedCell> note_sample(const Cell& cell, std::size_t index, const Imprint& found);
    // Notes a render with the first sample's seed and samples_to_prepare(), which is always held to the reference.
    // Returns the cells that failed by it.
    std::vector<FailedCell> note_preparation(const Cell& cell, const Imprint& found);
    // Notes such a render of the exact twin of a cell that rounds freely; only the twin's bits can be held to the
    // reference. Returns the cells that failed by it.
    std::vector<FailedCell> note_twin(const Cell& cell, const Imprint& found);

private:
    struct Seen {
        const Cell* cell;
        Imprint imprint;
    };
    struct Entry {
        std::optional<Imprint> right = {};
        Variant reference = {};  // which left it
        std::string of = {};     // its name
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
    std::map<std::pair<std::string, std::size_t>, Entry> entries_;  // by group and index of the sample
};

}  // namespace pt
