// Gauss-Legendre quadrature in long double: nodes by Newton's method on the recurrence of the Legendre polynomials
// (Abramowitz and Stegun 25.4.29 and 22.7.10).
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

namespace pt::stability {

struct Node {
    long double x, weight;
};

// Nodes and weights of Gauss-Legendre quadrature on the interval [0, 1].
inline std::vector<Node> gauss_legendre(int count) {
    std::vector<Node> nodes;
    for (int i = 0; i < count; ++i) {
        long double x = std::cos(std::numbers::pi_v<long double> * (i + 0.75L) / (count + 0.5L));
        long double derivative = 1;
        for (int step = 0; step < 100; ++step) {
            long double previous = 1, value = x;
            for (int degree = 2; degree <= count; ++degree) {
                const long double next = ((2 * degree - 1) * x * value - (degree - 1) * previous) / degree;
                previous = value;
                value = next;
            }
            derivative = count * (x * value - previous) / (x * x - 1);
            const long double change = value / derivative;
            x -= change;
            if (std::abs(change) < 1e-18L) {
                break;
            }
        }
        nodes.push_back({(1 - x) / 2, 1 / ((1 - x * x) * derivative * derivative)});
    }
    return nodes;
}

// Quadrature nodes over [low, high] in panels that halve towards `low`, where the integrand has a root or logarithm.
inline std::vector<Node> graded_nodes(long double low, long double high, int panels = 60, int nodes_per_panel = 16) {
    const std::vector<Node> unit = gauss_legendre(nodes_per_panel);
    std::vector<Node> nodes;
    long double right = 1;
    for (int panel = 0; panel < panels; ++panel) {
        const long double left = panel + 1 < panels ? right / 2 : 0;
        for (const Node& node : unit) {
            nodes.push_back(
                {low + (high - low) * (left + (right - left) * node.x), (high - low) * (right - left) * node.weight});
        }
        right = left;
    }
    return nodes;
}

}  // namespace pt::stability
