"""The two-layer model in many digits, slow and literal: the printed series, and its Laplace transform.

All in units of the tube radius, k_b and alpha_b. Two roads that share nothing but the problem: equations (73)-(80) of
Watkins (2018) term by term with roots bracketed by brute force, and the numerical inversion (Talbot's contour) of the
transform written with plain modified Bessel functions.
"""

from __future__ import annotations

import csv
from pathlib import Path

import mpmath as mp
import numpy as np

FOLDER = Path(__file__).parents[1] / "references"

DIGITS = 36
DEGREE = 32
"""Nodes of Talbot's contour: about 0.6 digits each."""

CASES = [
    (A, kappa, z_star)
    for A in ("1.0000001", "1.1", "28.2", "1e3", "1e6")
    for kappa in ("1e-4", "1e-2", "1", "2.5", "1e2", "1e4")
    for z_star in ("1e-16", "1e-8", "1e-6", "1e-4", "1e-2", "1e-1")
]


def table(name):
    """Columns of a table of tests/references."""
    with (FOLDER / name).open(newline="") as file:
        rows = list(csv.reader(file))
    return np.array(rows[1:], dtype=float).T


def eigencondition(lam, W, kappa):
    """Left side of (79) with lambda_b = lam."""
    wall = lam * mp.sqrt(kappa)
    J, Y = mp.besselj, mp.bessely
    return J(0, lam * W) * (Y(1, wall * W) * J(1, wall) - J(1, wall * W) * Y(1, wall)) + mp.sqrt(kappa) * J(
        1, lam * W
    ) * (J(0, wall * W) * Y(1, wall) - J(1, wall) * Y(0, wall * W))


def roots(A, kappa, number, step=0.02):
    """The first eigenvalues: steps of a fiftieth of their mean distance over pi, refined where the sign changes."""
    W, kappa = 1 - 1 / mp.mpf(A), mp.mpf(kappa)
    step = mp.mpf(step) * mp.pi / (W + mp.sqrt(kappa) * (1 - W))
    found, low = [], step / 10
    before = eigencondition(low, W, kappa)
    while len(found) < number:
        high = low + step
        after = eigencondition(high, W, kappa)
        if before * after < 0:
            found.append(mp.findroot(lambda x: eigencondition(x, W, kappa), (low, high), solver="anderson"))
        low, before = high, after
    return found


def coefficients(lam, W, kappa):
    """G, H of (75), (76)."""
    J, Y = mp.besselj, mp.bessely
    b, a = lam * W, lam * mp.sqrt(kappa) * W
    below = J(1, a) * Y(0, a) - J(0, a) * Y(1, a)
    G = (mp.sqrt(kappa) * J(1, b) * Y(0, a) - J(0, b) * Y(1, a)) / below
    H = (J(0, b) * J(1, a) - mp.sqrt(kappa) * J(0, a) * J(1, b)) / below
    return G, H


def norm(lam, W, kappa, G, H):
    """n_p of (78)."""
    J, Y = mp.besselj, mp.bessely

    def bracket(x):
        return (
            G**2 * (J(0, x) ** 2 + J(1, x) ** 2)
            + 2 * G * H * (J(0, x) * Y(0, x) + J(1, x) * Y(1, x))
            + H**2 * (Y(0, x) ** 2 + Y(1, x) ** 2)
        )

    wall = lam * mp.sqrt(kappa)
    inner = J(0, lam * W) ** 2 + J(1, lam * W) ** 2
    return W**2 / 2 * (inner + bracket(wall) / W**2 - bracket(wall * W))


def printed_amplitude(lam, W, kappa, G, H):
    """E_p of (77) at z = 0, term by term as printed."""
    J, Y = mp.besselj, mp.bessely
    wall, b = lam * mp.sqrt(kappa), lam * W
    a = wall * W
    shared = W / 4 * W**3 * (kappa - 1) * wall**2
    at_edge = G * J(1, a) + H * Y(1, a)
    at_wall = G * J(1, wall) + H * Y(1, wall)
    bulk = W / lam**2 * (lam * (W / 4 * W**3 * (kappa - 1) - kappa * W / 2 * W + kappa / 4) * J(1, b) + W * J(2, b))
    layer = (
        G * wall**2 * kappa * (J(0, wall) - W**2 * J(0, a))
        + wall * W * (shared - wall**2 * kappa * W / 2 * W + kappa / 4 * (8 + wall**2)) * at_edge
        + H * wall**2 * kappa * (Y(0, wall) - W**2 * Y(0, a))
        + wall * (-shared + kappa / 4 * (wall**2 - 8)) * at_wall
    )
    return (bulk - layer / wall**4) / norm(lam, W, kappa, G, H)


def printed_bracket(lam, W, kappa, G, H):
    """What E_p is multiplied with in (74)."""
    J, Y = mp.besselj, mp.bessely
    wall = lam * mp.sqrt(kappa)
    edge = G * J(1, wall * W) + H * Y(1, wall * W)
    rest = G * J(1, wall) + H * Y(1, wall) - W * edge
    return G * J(0, wall) + H * Y(0, wall) - 2 / lam * W * J(1, lam * W) - 2 / wall * rest


def series_nusselt(A, kappa, z_star, eigenvalues):
    """(73) with the exponent of (77) as in (71): -lambda_b^2 alpha_b z/U = -4 z* lambda^2."""
    W, kappa, z_star = 1 - 1 / mp.mpf(A), mp.mpf(kappa), mp.mpf(z_star)
    total = mp.mpf(0)
    for lam in eigenvalues:
        G, H = coefficients(lam, W, kappa)
        weight = mp.exp(-4 * z_star * lam**2)
        total += weight * printed_amplitude(lam, W, kappa, G, H) * printed_bracket(lam, W, kappa, G, H)
    return 2 / (total + kappa / 4 - W**4 / 4 * (kappa - 1))


def transform_nusselt(A, kappa, z_star, degree=DEGREE):
    """Nu from the transform of the wall temperature, inverted with Talbot's contour."""
    A, kappa, t = mp.mpf(A), mp.mpf(kappa), 4 * mp.mpf(z_star)
    W = 1 - 1 / A

    def wall(s):
        p = mp.sqrt(s)
        q = mp.sqrt(kappa) * p
        x, y = q * W, mp.sqrt(kappa) * mp.besseli(1, p * W) / mp.besseli(0, p * W)
        I0, I1, K0, K1, I0x, I1x, K0x, K1x = (f(n, v) for v in (q, x) for f in (mp.besseli, mp.besselk) for n in (0, 1))
        value = I0 * K1x + I1x * K0 + y * (I0 * K0x - K0 * I0x)
        slope = I1 * K1x - I1x * K1 + y * (I1 * K0x + K1 * I0x)
        return kappa / q * value / slope / s

    return 2 / (mp.invertlaplace(wall, t, method="talbot", degree=degree) - 2 * t)


def write_table(path: Path) -> None:
    """Write Nu of all CASES to a CSV file; minutes."""
    with mp.workdps(DIGITS), path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["D/d", "k_b/k_wa", "z_star", "Nu"])
        rows.writerows((*case, mp.nstr(transform_nusselt(*case), 17)) for case in CASES)
