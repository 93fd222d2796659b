// Holds variants to their claims: bitwise ones to the reference variant's film, statistical ones to its mean.
#pragma once

#include <optional>
#include <string>

#include "harness/render/renderer.h"

namespace pt {

// The first place at which two variants differ that should agree.
struct Difference {
    std::uint32_t x = 0, y = 0;
    std::optional<std::uint32_t> sample;  // none: each sample alone agrees, so it is in how samples are put together
    std::optional<std::uint32_t> bounce;  // the first number of segments at which the sample differs
    std::string text() const;
};

struct Verdict {
    bool holds = true;
    std::string film_hash;
    std::string message;  // what was compared with what, or what failed
};

// Renders variants of one scene at one size and remembers the references.
class Verifier {
public:
    Verifier(const Scene& scene, const RenderSettings& settings, std::uint32_t spp, Backend backend = Backend::cpu)
        : scene_(scene), settings_(settings), spp_(spp), backend_(backend) {}

    // Checks the film's faults, that every choice did its work, and the variant's claim. On CUDA the reference's film
    // is also held to the CPU's. A variant that rounds freely has its twin in exact arithmetic held to the reference's
    // bits, and its own mean to its twin's. Precondition: the variant applies to the scene.
    Verdict check(const Variant& variant);
    // Checks at large sizes the faults, the bits and the work alone (for a variant that rounds freely, those of its
    // twin): no means, and nothing of the CPU's on CUDA.
    Verdict check_film(const Variant& variant);

private:
    Verdict check_bits(const Variant& variant);
    Verdict check_freely_rounded(const Variant& variant);
    const RenderResult& reference(const Variant& reference_variant);
    struct CpuCheck {
        bool is_made = false;      // the CPU has the variant
        std::string failure = {};  // empty: the films agree
    };
    // A reference variant's film on CUDA against that of the CPU's own reference.
    const CpuCheck& against_cpu(const Variant& reference_variant);
    RenderResult render_part(const Variant& variant, std::uint32_t first, std::uint32_t count) const;

    struct MeanCheck {
        std::string failure = {};  // empty: the means agree
        double detectable = 0;     // least relative bias of the image's mean that would have failed
        double effect = 0;         // relative change of the image's mean against the plain choice at the same depth
    };
    MeanCheck check_statistical(const Variant& variant);
    const MeanCheck& mean_check(const Variant& variant);

    const Scene& scene_;
    RenderSettings settings_;
    std::uint32_t spp_;
    Backend backend_;
    std::map<Variant, RenderResult> references_;
    std::map<Variant, MeanCheck> statistical_;
    std::map<Variant, CpuCheck> against_cpu_;  // by reference variant
    std::map<Variant, Verdict> bits_;          // of exact twins
};

// Precondition: the films of the two variants differ at these settings.
Difference first_difference(const Scene& scene, const RenderSettings& settings, std::uint32_t spp,
                            const Variant& reference, const Variant& variant, Backend backend = Backend::cpu);

}  // namespace pt
