// Dwivedi sampling of subsurface scattering: walks through a body are drawn towards the surface near which light leaves
// it. In a half space whose collisions scatter the share alpha of the light, evenly, what light deep inside is worth
// outside falls as e^(-kappa depth), with depth in mean free paths and alpha = kappa / artanh(kappa). Who draws the
// cosine mu to the outward normal in proportion to 1 / (1 - kappa mu), and flights in a medium thinned by 1 - kappa mu,
// has on every step the weight e^(-kappa way towards the surface): after any number of collisions nothing is left of it
// but the depth. Dwivedi, "A new importance biasing scheme for deep-penetration Monte Carlo", Annals of Nuclear Energy
// 9, 1982; for bodies seen from outside: Krivanek and d'Eon, "A zero-variance-based sampling scheme for Monte Carlo
// subsurface scattering", SIGGRAPH 2014 talk; towards the nearest surface rather than that of entry: Meng, Hanika and
// Dachsbacher, "Improving the Dwivedi sampling scheme", EGSR 2016.
// Here a share of the steps is drawn so and the rest as ever, and each of the three channels has a kappa of its own. A
// step is weighted by the mean of all six densities, in the shares in which they are drawn (one-sample balance
// heuristic), so a guide that is wrong costs noise and never the mean, and no step grows the sum of the throughputs by
// more than 1 / (1 - share). A phase function that is not even keeps its directions, and flights alone are guided: the
// weight of an even direction under a peaked phase function has no good bound (tried: with g = 0.3 noise grows
// twentyfold).
#pragma once

#include "kernels/medium.h"
#include "kernels/sampling.h"

namespace pt {

// The channel to draw a free path from; never one that carries nothing while another does.
template <class Real>
PT_HD inline std::uint32_t choose_channel(const Vec3<Real>& throughput, Real u) {
    const Real target = u * (throughput.x + throughput.y + throughput.z);
    return target < throughput.x ? 0u : target < throughput.x + throughput.y ? 1u : 2u;
}

// The density that a step of a walk is drawn by: a colour channel's, guided or not. It is chosen once for a direction
// and the flight along it.
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

// A cosine in proportion to 1 / (1 - decay mu), with albedo = decay / artanh(decay): the integral up to mu goes as
// ln((1 + decay) / (1 - decay mu)), so 1 - decay mu = sqrt(1 - decay^2) e^-x with x = artanh(decay) (2u - 1).
template <class Real>
PT_HD inline Real guided_cosine(Real decay, Real albedo, Real u) {
    const Real x = decay / albedo * (Real(2) * u - Real(1));
    const Real root = square_root((Real(1) - decay) * (Real(1) + decay));
    const Real cosine = decay / (Real(1) + root) - exponential_less_one(-x) * root / decay;
    return clamp(cosine, Real(-1), Real(1));
}

// A step as its density sees it: the cosine to the outward normal, and whether its direction was drawn with it. It was
// not where the walk began or was reflected at the boundary, or where the phase function draws all directions.
template <class Real>
struct GuidedStep {
    Real cosine;
    bool drew_direction;
    bool scattered;  // the flight ended in a collision, not at the surface

    // Density of the guided step over that of the plain one, but for the transmittances: of the direction
    // albedo / (1 - decay cosine), of the collision 1 - decay cosine.
    PT_HD Real relative_density(Real decay, Real albedo) const {
        if (drew_direction) {
            return scattered ? albedo : albedo / thinned(decay);
        }
        return scattered ? thinned(decay) : Real(1);
    }
    // Factor by which the medium is thinner in which guided flights are drawn.
    PT_HD Real thinned(Real decay) const { return Real(1) - decay * cosine; }
};

// Weight of a step of length t: what light does on it over the mean density.
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
    // Relative to the most transparent of all six, so that no transmittance underflows in all of them at once.
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
    // Finite where hardly anything is carried, as in flight_weight.
    const Real total = throughput.x + throughput.y + throughput.z;
    constexpr Real most = std::numeric_limits<Real>::max();
    const Real inverse_mean = density > Real(0) ? min(most, total / density) : Real(0);
    const Vec3<Real> weight = carries * inverse_mean;
    return {min(most, weight.x), min(most, weight.y), min(most, weight.z)};
}

}  // namespace pt
