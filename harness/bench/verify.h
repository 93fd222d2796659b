// Verifies claims of variants: bitwise variants must match the reference variant's film, statistical ones its mean.
#pragma once

#include <optional>
#include <string>

#include "harness/render/renderer.h"

namespace pt {

// The first pixel, sample and bounce at which two variants differ whose films should be equal.
struct Difference {
    std::uint32_t x = 0, y = 0;
    std::optional<std::uint32_t> sample;  // first sample that differs; none if only the sums over samples do
    std::optional<std::uint32_t> bounce;  // smallest path depth at which this sample differs between the variants
    std::string text() const;
};

struct Verdict {
    bool holds = true;
    std::string film_hash;
    std::string message;  // what the film was compared with, or why the variant failed
};

// Verifies variants on one scene at one size, and keeps the films of reference variants.
class Verifier {
public:
    Verifier(const Scene& scene, const RenderSettings& settings, std::uint32_t spp, Backend backend = Backend::cpu)
        : scene_(scene), settings_(settings), spp_(spp), backend_(backend) {}

    // Checks a variant's film for faults, that every choice did its work, and its claim. On CUDA the reference's film
    // is also compared with the CPU's. If a variant rounds freely, its exact twin must match the reference bit for bit,
    // and the variant's mean the twin's mean. Precondition: the variant applies to the scene.
    Verdict check(const Variant& variant);
    // Checks a variant at a large size for faults, bits and work counts only, without means and without the CPU's film.
    // If the variant rounds freely, the bits and counts are those of its exact twin.
    Verdict check_film(const Variant& variant);

private:
    Verdict check_bits(const Variant& variant);
    Verdict check_freely_rounded(const Variant& variant);
    const RenderResult& reference(const Variant& reference_variant);
    struct CpuCheck {
        bool is_made = false;      // whether the CPU backend has the variant
        std::string failure = {};  // how the CPU's film differs from CUDA's; empty if it is equal
    };
    // Compares a reference variant's film on CUDA with the film of the CPU's own reference.
    const CpuCheck& against_cpu(const Variant& reference_variant);
    RenderResult render_part(const Variant& variant, std::uint32_t first, std::uint32_t count) const;

    struct MeanCheck {
        std::string failure = {};  // which mean of an image or block differs, and how; empty if none does
        double detectable = 0;     // smallest relative bias of the image mean that would fail
        double effect = 0;         // largest relative change of a channel's mean by the variant's choices
    };
    MeanCheck check_statistical(const Variant& variant);
    const MeanCheck& mean_check(const Variant& variant);

    const Scene& scene_;
    RenderSettings settings_;
    std::uint32_t spp_;
    Backend backend_;
    std::map<Variant, RenderResult> references_;
    std::map<Variant, MeanCheck> statistical_;
    std::map<Variant, CpuCheck> against_cpu_;  // comparisons with the CPU's film by reference variant
    std::map<Variant, Verdict> bits_;          // verdicts on the exact twins of variants that round freely
};

// Finds the first pixel, sample and bounce at which two variants differ. Precondition: their films differ.
Difference first_difference(const Scene& scene, const RenderSettings& settings, std::uint32_t spp,
                            const Variant& reference, const Variant& variant, Backend backend = Backend::cpu);

}  // namespace pt
