// Exact answers for isotropic scattering in plane layers of matched index with single scattering albedo w.
// Half space: Chandrasekhar, "Radiative Transfer", 1950: albedo 1 - sqrt(1-w) H(mu0), with H from
//   1 / H(mu) = sqrt(1-w) + w/2 int_0^1 mu' H(mu') / (mu + mu') dmu'.
// Slab: the integral equation of the density of collisions, C(x) = source(x) + w/2 int E1(|x-y|) C(y) dy, by Galerkin's
// method with constants on cells that narrow towards both faces. The matrix's row sums telescope, so that w = 1 costs
// no accuracy but rounding; errors fall with the square of the number of cells and are removed by Romberg
// extrapolation.
#pragma once

#include <vector>

#include "stability/oracles/gauss_legendre.h"

namespace pt::stability {

// Exponential integral E_n(x) for n >= 1 and x >= 0 (x > 0 for n = 1). Abramowitz and Stegun 5.1.12 and 5.1.22.
long double exponential_integral(int n, long double x);

class HFunction {
public:
    explicit HFunction(double albedo);
    // Chandrasekhar's H function for a direction of cosine mu from 0 to 1.
    double at(double mu) const;
    double plane_albedo(double mu) const;
    double diffuse_albedo() const;  // albedo of a half space for diffuse light: 1 - 2 sqrt(1-w) alpha_1

private:
    long double albedo_;
    std::vector<Node> nodes_;  // quadrature nodes over the cosine mu
    std::vector<long double> values_;
};

// The mean number of collisions of the weight of a photon that leaves a half space: d ln(albedo) / d ln(w).
double mean_collisions(double albedo, double mu);

struct SlabShares {
    double reflected = 0, transmitted = 0;
    double error = 0;  // error of either share, estimated by the last extrapolation step
};

// The shares of light that a slab reflects and transmits. `mu`: the cosine of incidence, or 0 for diffuse light.
SlabShares slab_shares(double optical_depth, double albedo, double mu);

}  // namespace pt::stability
