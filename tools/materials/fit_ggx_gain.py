"""Fits the table of kernels/ggx_gain.h: 1 / E - 1, with the directional albedo E of a white rough conductor.

The albedo (GGX, Smith's height-correlated masking, single scattering) is integrated over the visible facets. Prints the
table and the fit's largest error of 1 / E. Needs numpy: python3 tools/materials/fit_ggx_gain.py
"""

import numpy as np
from numpy.polynomial import chebyshev

ALONG, ACROSS, UPRIGHT = 8, 6, 6  # numbers of basis functions: in sqrt(x), in alpha, in alpha alone (for x = 1)


def directional_albedo(x, alpha, points=160):
    """Albedo at the cosine c with c / sqrt(c^2 + alpha^2 (1 - c^2)) = x; visible normals after Heitz 2018."""
    cosine = x * alpha / np.sqrt(1 - x * x * (1 - alpha * alpha)) if x < 1 else 1.0
    q = np.sqrt(cosine**2 + alpha**2 * (1 - cosine**2))
    sine = np.sqrt(max(0.0, 1 - cosine**2))
    nodes, weights = np.polynomial.legendre.leggauss(points)
    radius, turn = np.meshgrid((nodes + 1) / 2, (np.arange(points) + 0.5) / points * 2 * np.pi, indexing="ij")
    view_z, view_x = cosine / q, alpha * sine / q
    a, on_disc = radius * np.cos(turn), radius * np.sin(turn)
    visible = (1 + view_z) / 2
    b = (1 - visible) * np.sqrt(np.maximum(0, 1 - a * a)) + visible * on_disc
    c = np.sqrt(np.maximum(0, 1 - a * a - b * b))
    facet_z = np.maximum(b * view_x + c * view_z, 1e-12)
    slope_x, slope_y = alpha * (c * view_x - b * view_z) / facet_z, alpha * a / facet_z
    length = 1 / np.sqrt(1 + slope_x**2 + slope_y**2)
    incoming = 2 * (sine * slope_x + cosine) * length**2 - cosine
    above = np.maximum(incoming, 0)
    incoming_q = np.sqrt(above**2 + alpha**2 * np.maximum(0, 1 - above**2))
    share = above * (cosine + q) / (incoming_q * cosine + above * q + 1e-300)
    return (share * weights[:, None] * radius).sum() / points


def columns(root, alpha):
    """Basis functions of the fit: alpha^k, and (1 - x) times products of Chebyshev polynomials."""
    of_root = chebyshev.chebvander(2 * root - 1, ALONG - 1)
    of_alpha = chebyshev.chebvander(2 * alpha - 1, ACROSS - 1)
    upright = [alpha ** (k + 1) for k in range(UPRIGHT)]
    rest = [(1 - root**2) * of_root[:, i] * of_alpha[:, j] for i in range(ALONG) for j in range(ACROSS)]
    return np.stack(upright + rest, axis=-1)


def main():
    nodes = [(1 - np.cos((np.arange(n) + 0.5) * np.pi / n)) / 2 for n in (26, 16)]
    root, alpha = (grid.ravel() for grid in np.meshgrid(np.append(nodes[0], 1.0), nodes[1], indexing="ij"))
    gain = np.array([1 / directional_albedo(r * r, a) - 1 for r, a in zip(root, alpha, strict=True)])
    matrix, weights = columns(root, alpha), 1 / (1 + gain)
    for _ in range(30):  # Lawson's reweighting turns the least-squares fit into a near-minimax one
        table, *_rest = np.linalg.lstsq(matrix * weights[:, None], gain * weights, rcond=None)
        error = np.abs(matrix @ table - gain) / (1 + gain)
        weights = weights * np.sqrt(0.3 + error / error.max())
    rows = table[UPRIGHT:].reshape(ALONG, ACROSS)
    print("upright: {" + ", ".join(f"{v:.6f}" for v in table[:UPRIGHT]) + "}")
    for row in rows:
        print("{" + ", ".join(f"{v:.6f}" for v in row) + "},")
    print(f"largest relative error {error.max():.2e}")


if __name__ == "__main__":
    main()
