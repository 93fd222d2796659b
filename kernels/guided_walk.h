// Dwivedi sampling of subsurface scattering: random walks through a body are biased towards the surface near which
// light leaves it. In a half space with isotropic scattering of albedo alpha, the importance of light falls as
// e^(-kappa depth), with depth in mean free paths and alpha = kappa / artanh(kappa). If the cosine mu to the outward
// normal is drawn in proportion to 1 / (1 - kappa mu), and flights in a medium thinned by 1 - kappa mu, every step has
// the weight e^(-kappa distance towards the surface): the product over any number of collisions depends on the depth
// alone. Dwivedi, "A new importance biasing scheme for deep-penetration Monte Carlo", Annals of Nuclear Energy 9, 1982;
// for bodies seen from outside: Krivanek and d'Eon, "A zero-variance-based sampling scheme for Monte Carlo subsurface
// scattering", SIGGRAPH 2014 talk; towards the nearest surface rather than that of entry: Meng, Hanika and Dachsbacher,
// "Improving the Dwivedi sampling scheme", EGSR 2016.
// In this code a share of the steps is guided in this way and the rest is not, and each of the three channels has its
// own kappa. A step is weighted by the mean of all six densities, in the shares in which they are drawn (one-sample
// balance heuristic), so a wrong guide costs noise but never the mean, and no step grows the sum of the throughputs by
// more than 1 / (1 - share). An anisotropic phase function draws its own directions, and only flights are guided: the
// weight of an isotropic direction under a peaked phase function has no good bound (tried: with g = 0.3 noise grows
// twentyfold).
#pragma once

#include "kernels/medium.h"
#include "kernels/sampling.h"

namespace pt {

// Chooses the colour channel by which a free path is drawn, in proportion to throughput.
template <class Real>
PT_HD inline std::uint32_t choose_channel(const Vec3<Real>& throughput, Real u) {
    const Real target = u * (throughput.x + throughput.y + throughput.z);
    return target < throughput.x ? 0u : target < throughput.x + throughput.y ? 1u : 2u;
}

// Density by which a step of a subsurface random walk is drawn: one colour channel's, guided or not. The choice is made
// once for a direction and the flight along it.
struct StepChoice {
    std::uint32_t colour = 0;
    bool is_guided = false;
};

template <class Real>
PT_HD inline StepChoice choose_step(const ScatteringMedium<Real>& medium, const Vec3<Real>& throughput, Real u) {
    const Real share = medium.guided_share;
    const bool is_guided = u < share;
    const Real rest = is_guided ? u / share : (u - share) / (Real(1) - share);
    return {choose_channel(throughput, rest), is_guided};
}

// e^x - 1 for |x| up to 8/3, without cancellation: the series of exponential() for x / 8, thrice doubled.
template <class Real>
PT_HD inline Real exponential_less_one(Real x) {
    const Real r = x * Real(0.125);
    const Real c = r - exponential_series(r * r);
    Real y = r + r * c / (Real(2) - c);
    for (int i = 0; i < 3; ++i) {
        y = y * (Real(2) + y);
    }
    return y;
}

// Samples a cosine mu in proportion to 1 / (1 - decay mu), with albedo = decay / artanh(decay): the integral up to mu
// goes as ln((1 + decay) / (1 - decay mu)), so 1 - decay mu = sqrt(1 - decay^2) e^-x with x = artanh(decay) (2u - 1).
template <class Real>
PT_HD inline Real guided_cosine(Real decay, Real albedo, Real u) {
    const Real x = decay / albedo * (Real(2) * u - Real(1));
    const Real root = square_root((Real(1) - decay) * (Real(1) + decay));
    const Real cosine = decay / (Real(1) + root) - exponential_less_one(-x) * root / decay;
    return clamp(cosine, Real(-1), Real(1));
}

// What the pdf of a guided walk's step depends on: the cosine to the outward normal, and whether the direction was
// drawn with the step (not at the start, after internal reflection, or where the phase function draws it).
template <class Real>
struct GuidedStep {
    Real cosine;
    bool drew_direction;
    bool scattered;  // the free flight ended in a collision, not at the surface

    // Density of the guided step over that of the plain step, transmittances apart: albedo / (1 - decay cosine) for the
    // direction, 1 - decay cosine for the collision.
    PT_HD Real relative_density(Real decay, Real albedo) const {
        if (drew_direction) {
            return scattered ? albedo : albedo / thinned(decay);
        }
        return scattered ? thinned(decay) : Real(1);
    }
    // Factor by which the medium's extinction is thinned for guided flights.
    PT_HD Real thinned(Real decay) const { return Real(1) - decay * cosine; }
};

// Weight of a guided walk's step of length t: transmittance, and scattering at its end, over the mean density.
template <class Real>
PT_HD inline Vec3<Real> guided_step_weight(const ScatteringMedium<Real>& medium, const Vec3<Real>& throughput,
                                           const GuidedStep<Real>& step, Real t) {
    const Real share = medium.guided_share;
    const auto relative_density = [&](int i) {
        return step.relative_density(medium.guide_decay[i], medium.guide_albedo[i]);
    };
    if (medium.has_one_guide()) {
        const Real guided =
            relative_density(0) * exponential(medium.sigma_t.x * medium.guide_decay.x * step.cosine * t);
        const Real weight = Real(1) / ((Real(1) - share) + share * guided);
        return step.scattered ? medium.scattering_albedo * weight : Vec3<Real>{weight, weight, weight};
    }
    const auto guided_sigma = [&](int i) { return medium.sigma_t[i] * step.thinned(medium.guide_decay[i]); };
    // Relative to the most transparent of the six densities (3 channels, guided or not) one transmittance is always 1.
    Real least = min(medium.sigma_t.x, guided_sigma(0));
    for (int i = 1; i < 3; ++i) {
        least = min(least, min(medium.sigma_t[i], guided_sigma(i)));
    }
    Vec3<Real> carries;
    Real density = Real(0);
    for (int i = 0; i < 3; ++i) {
        const Real transmittance = exponential((least - medium.sigma_t[i]) * t);
        const Real guided = relative_density(i) * exponential((least - guided_sigma(i)) * t);
        const Real mean = (Real(1) - share) * transmittance + share * guided;
        density += throughput[i] * (step.scattered ? medium.sigma_t[i] * mean : mean);
        carries[i] = step.scattered ? medium.sigma_s[i] * transmittance : transmittance;
    }
    // The step's weight stays finite where hardly anything is transmitted, as the weight of flight_weight does.
    const Real total = throughput.x + throughput.y + throughput.z;
    constexpr Real most = std::numeric_limits<Real>::max();
    const Real inverse_mean = density > Real(0) ? min(most, total / density) : Real(0);
    const Vec3<Real> weight = carries * inverse_mean;
    return {min(most, weight.x), min(most, weight.y), min(most, weight.z)};
}

}  // namespace pt
