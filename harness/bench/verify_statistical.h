// Tests whether variants that claim no bits converge to the image that they claim, by independent runs of both sides.
// The check before a timing (verify.h) tests the same claim at equal seeds, where common errors cancel; this test
// shares no random numbers, so it can also compare unrelated estimators.
#pragma once

#include <map>
#include <string>

#include "harness/error/same_mean.h"
#include "harness/render/renderer.h"
#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json

namespace pt {

// The claim that a tested variant converges to the image of a baseline variant.
struct MeanClaim {
    Variant tested, baseline;
    std::uint32_t depth = 0, baseline_depth = 0;  // path depths at which the two have equal expectations
    bool same_sampling = true;                    // whether pixels of both are black equally often (SameMeanOptions)
};

// The claim that a variant's choices make: it has the mean image of the reference variant in which each choice that
// claims another choice's mean (Descriptor::mean_of) is replaced by that choice, at the depth with equal expectation.
MeanClaim claim_of_mean(const Variant& variant, std::uint32_t depth, Backend backend);
// The claim that `variant` has the mean image of a given `baseline`, each at the depth with the same expectation.
MeanClaim claim_against(const Variant& variant, const Variant& baseline, std::uint32_t depth, Backend backend);

struct MeanVerdict {
    bool holds = true;
    std::string message;
};

class StatisticalVerifier {
public:
    struct Effort {
        std::uint32_t runs = 16;
        std::uint32_t spp = 64;  // samples per pixel of a run, at least 2
        double family_error = limits::family_error;
    };

    // A verifier whose tested runs have the seeds settings.seed, settings.seed + 1, ..; baselines have the seeds after
    // them.
    StatisticalVerifier(const Scene& scene, const RenderSettings& settings, const Effort& effort, Backend backend)
        : scene_(scene), settings_(settings), effort_(effort), backend_(backend) {}

    // Tests a claim of equal means. Precondition: both variants apply to the scene.
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
