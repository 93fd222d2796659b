// What single scattering by GGX facets loses of a white surface's light, as a fit: 1 / E - 1, E the directional albedo
// with Smith's height-correlated masking. Scaling the lobe by 1 + F0 (1 / E - 1) gives it back (Turquin, "Practical
// multiple scattering compensation for microfacet models", 2019). The numbers are from tools/materials/fit_ggx_gain.py,
// and 1 / E is right to 2.5e-3 (tests/unit/ggx_gain_test.cpp holds it to quadrature).
#pragma once

#include "kernels/math.h"

namespace pt {

// Chebyshev sum of c_k T_k(x) for x from -1 to 1, by Clenshaw's recurrence (1955).
template <class Real, int count>
PT_HD inline Real chebyshev_sum(const Real (&c)[count], Real x) {
    Real next = Real(0), after = Real(0);
    for (int k = count - 1; k > 0; --k) {
        const Real sum = Real(2) * x * next - after + c[k];
        after = next;
        next = sum;
    }
    return x * next - after + c[0];
}

// Fit of 1 / E - 1 (GGX energy loss) for a direction of cosine c to the normal, by x = c / sqrt(c^2 + alpha^2 (1 -
// c^2)): this spreads grazing angles evenly over all alpha. Without roughness x is 1 and nothing is lost.
template <class Real>
PT_HD inline Real ggx_gain(Real x, Real alpha) {
    constexpr Real upright[] = {Real(-0.004551), Real(1.043431), Real(2.231394),
                                Real(-1.611678), Real(0.548024), Real(0.054912)};
    constexpr Real rest[][6] = {
        {Real(-0.582792), Real(-1.231263), Real(-0.340795), Real(0.010335), Real(-0.002346), Real(-0.009460)},
        {Real(0.301608), Real(-0.258924), Real(-0.005562), Real(0.060600), Real(-0.006666), Real(-0.014940)},
        {Real(0.137898), Real(-0.204390), Real(-0.000423), Real(0.043643), Real(-0.008502), Real(-0.011463)},
        {Real(0.075711), Real(-0.101607), Real(0.003769), Real(0.024263), Real(-0.008170), Real(-0.008026)},
        {Real(0.040862), Real(-0.048891), Real(0.001337), Real(0.011976), Real(-0.006378), Real(-0.005232)},
        {Real(0.017871), Real(-0.023732), Real(0.000072), Real(0.005687), Real(-0.004392), Real(-0.003141)},
        {Real(0.007942), Real(-0.008731), Real(-0.000139), Real(0.002027), Real(-0.002727), Real(-0.001855)},
        {Real(0.002243), Real(-0.002664), Real(-0.000736), Real(0.000626), Real(-0.001167), Real(-0.000481)}};
    Real sum = Real(0);
    for (int k = 5; k >= 0; --k) {
        sum = (sum + upright[k]) * alpha;
    }
    Real by_root[8] = {};
    for (int i = 0; i < 8; ++i) {
        by_root[i] = chebyshev_sum(rest[i], Real(2) * alpha - Real(1));
    }
    return max(sum + (Real(1) - x) * chebyshev_sum(by_root, Real(2) * square_root(x) - Real(1)), Real(0));
}

}  // namespace pt
