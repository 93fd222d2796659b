// What a run of error against time knows of its references and of the errors of its films: films with the same bits
// have one error, computed once.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "harness/bench/facts/cell.h"
#include "harness/bench/facts/sample.h"
#include "harness/bench/suite.h"
#include "harness/error/reference.h"

namespace pt {

// The state of a render at one of its checkpoints, copied.
struct Snapshot {
    std::uint32_t samples;
    double wall_ms, device_ms, cpu_ms;
    Film film;
};

// The part of the smallest expected mse that a reference's own noise may add to mse_dual (ReferenceNoise::dual_error).
// mse_dual is right in the mean whatever the reference's noise (docs/numerics.md 1.2); only this spread is left.
inline constexpr double allowed_reference_error = 0.05;

class ErrorBook {
public:
    // Collects the reference tasks of the plan's cells. Of several for the same reference the most demanding counts.
    ErrorBook(const Plan& plan, ReferenceMaker maker);

    // Makes or loads every reference, to its task's variance. If that fails, reference() throws with the reason.
    void make_references();
    // Renders a reference on until its error is no more than `dual_error`, or it has the task's most_spp.
    void improve(const std::string& name, double dual_error);
    // The reference of a cell. Throws std::runtime_error that says why there is none.
    const Reference& reference(const Cell& cell) const;

    // The error (mse_dual) that the cell is expected to have at its spp, extrapolated as 1/spp from a film of fewer
    // samples.
    double expected_mse(const Cell& cell, const Film& film) const;
    // Why the reference is too noisy for a cell with this expected mse, with the spp that would do; empty: it is not.
    std::string refusal(const Cell& cell, double expected_mse) const;

    // The facts of a cell in a result file besides its errors.
    // Their `expected_mse` is left open.
    ConvergenceFacts cell_facts(const Cell& cell) const;
    // The checkpoints of a sample, without `shared`, which the result file adds.
    std::vector<CheckpointFacts> rows(const Cell& cell, const std::vector<Snapshot>& snapshots);

private:
    // A film with its hash: that of all samples so far or, where it was kept, of their first half.
    struct Hashed {
        const Snapshot* snapshot = nullptr;
        std::string hash;
    };
    std::optional<Errors> errors_at(const Cell& cell, const Hashed& whole, const Hashed& half);

    ReferenceMaker maker_;
    std::map<std::string, ReferenceTask> tasks_;  // by reference
    std::map<std::string, Reference> references_;
    std::map<std::string, std::string> failures_;
    std::map<std::string, std::optional<Errors>> known_;  // by reference, samples and film
};

// The folder of a result's images, beside the result. While an earlier result is kept, the images go to a second
// folder, which replace_images empties into the first.
std::string images_folder(const std::string& result_file, bool keeps_earlier);
// Puts the images in the second folder into the first, in place of those that an earlier result names, relative to its
// own folder. Whatever else lies there stays.
void replace_images(const std::string& result_file, const std::vector<std::string>& earlier);
// Writes a sample's images at its checkpoints and the reference as .pfm to a folder that images_folder named. Returns
// the images' names by spp and the reference's, relative to the result file, as they are after replace_images.
ImageFacts write_images(const std::string& images_folder, const Cell& cell, const Reference& reference,
                        const std::vector<Snapshot>& snapshots);

}  // namespace pt
