// The reference images of a convergence study (error against time) and the errors of its films. Films with the same
// bits have the same error, which is computed once.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "harness/bench/facts/cell.h"
#include "harness/bench/facts/sample.h"
#include "harness/bench/suite.h"
#include "harness/error/reference.h"

namespace pt {

// A copy of a render's film and times at a checkpoint.
struct Snapshot {
    std::uint32_t samples;
    double wall_ms, device_ms, cpu_ms;
    Film film;
};

// The largest standard error that a noisy reference image may add to mse_dual (ReferenceNoise::dual_error), as a share
// of the smallest expected mse. The noise biases nothing, it only spreads mse_dual (docs/numerics.md 1.2).
inline constexpr double allowed_reference_error = 0.05;

class ErrorBook {
public:
    // Collects the reference images that a plan needs; shared ones get the lowest variance and highest most_spp.
    ErrorBook(const Plan& plan, ReferenceMaker maker);

    // Renders every reference image up to its task's variance or loads it (cache). Failures are thrown by reference().
    void make_references();
    // Adds samples to a reference image until its dual_error is at most `dual_error`, or it has the task's most_spp.
    void improve(const std::string& name, double dual_error);
    // The reference image of a cell. Throws std::runtime_error that says why there is none.
    const Reference& reference(const Cell& cell) const;

    // The mse_dual to expect of a cell at its full spp, extrapolated as 1/spp from a film with fewer samples.
    double expected_mse(const Cell& cell, const Film& film) const;
    // Says why a cell's reference is too noisy for an error of `expected_mse`, and what spp would be enough; else "".
    std::string refusal(const Cell& cell, double expected_mse) const;

    // What a result file says about a cell's reference and metrics; `expected_mse` is not set.
    ConvergenceFacts cell_facts(const Cell& cell) const;
    // The times and errors of a sample at its checkpoints. `shared` is not set; the result file adds it.
    std::vector<CheckpointFacts> rows(const Cell& cell, const std::vector<Snapshot>& snapshots);

private:
    // A film with its hash, either of all samples so far or of their first half.
    struct Hashed {
        const Snapshot* snapshot = nullptr;
        std::string hash;
    };
    std::optional<Errors> errors_at(const Cell& cell, const Hashed& whole, const Hashed& half);

    ReferenceMaker maker_;
    std::map<std::string, ReferenceTask> tasks_;  // how to make each reference image, by the image's name
    std::map<std::string, Reference> references_;
    std::map<std::string, std::string> failures_;
    std::map<std::string, std::optional<Errors>> known_;  // errors of films, by reference, sample count and film hash
};

// The folder for the images of a result, beside the result file. While an earlier result is kept, images are written to
// a second folder, which replace_images later moves into the first.
std::string images_folder(const std::string& result_file, bool keeps_earlier);
// Moves a run's images from their temporary folder into the result's folder, and removes the images that an earlier
// result names (paths relative to its folder). Other files in the folder stay.
void replace_images(const std::string& result_file, const std::vector<std::string>& earlier);
// Writes a sample's images at its checkpoints and the reference image as .pfm to the folder that images_folder named.
// Returns file names by spp and that of the reference, relative to the result file, as they are after replace_images.
ImageFacts write_images(const std::string& images_folder, const Cell& cell, const Reference& reference,
                        const std::vector<Snapshot>& snapshots);

}  // namespace pt
