// Holds variants that do not claim bits to the image they claim to converge to, by independent runs of both sides. The
// gate before a timing (verify.h) compares the same claim at equal seeds, where what two variants share cancels; this
// test shares nothing, so it also compares estimators that have nothing in common.
#pragma once

#include <map>
#include <string>

#include "harness/error/same_mean.h"
#include "harness/render/renderer.h"
#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json

namespace pt {

// A variant, and the other one whose image it is said to have.
struct MeanClaim {
    Variant tested, baseline;
    std::uint32_t depth = 0, baseline_depth = 0;  // at which they have it
    bool same_sampling = true;                    // SameMeanOptions
};

// The claim that a variant's choices make (Descriptor::mean_of). The baseline is the reference variant in which each
// choice that claims another one's mean is replaced by that one, at the depth that has the same expectation.
MeanClaim claim_of_mean(const Variant& variant, std::uint32_t depth, Backend backend);
// The claim that `variant` has the image of `baseline`, each at the depth that has the same expectation.
MeanClaim claim_against(const Variant& variant, const Variant& baseline, std::uint32_t depth, Backend backend);

struct MeanVerdict {
    bool holds = true;
    std::string message;
};

class StatisticalVerifier {
public:
    struct Effort {
        std::uint32_t runs = 16;
        std::uint32_t spp = 64;  // of a run, at least 2
        double family_error = limits::family_error;
    };

    // A verifier whose runs have the seeds settings.seed, settings.seed + 1, .. and, of baselines, those after them.
    StatisticalVerifier(const Scene& scene, const RenderSettings& settings, const Effort& effort, Backend backend)
        : scene_(scene), settings_(settings), effort_(effort), backend_(backend) {}

    // Checks a claim of a mean. Precondition: both variants apply to the scene.
    MeanVerdict check(const MeanClaim& claim);

private:
    ImageRuns render_runs(const Variant& variant, std::uint32_t depth, std::uint64_t first_seed) const;
    const ImageRuns& baseline_runs(const Variant& variant, std::uint32_t depth);

    const Scene& scene_;
    RenderSettings settings_;
    Effort effort_;
    Backend backend_;
    std::map<std::pair<Variant, std::uint32_t>, ImageRuns> baselines_;
};

}  // namespace pt
