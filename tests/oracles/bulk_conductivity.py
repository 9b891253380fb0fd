"""Models of the conductivity of beds as printed, in 80 digits: they divide by zero where the equations do."""

from __future__ import annotations

import csv
from pathlib import Path

import mpmath

SIGMA = mpmath.mpf(5.670374419e-8)
REFERENCES = Path(__file__).parents[1] / "references" / "bulk_conductivity_models.csv"


def references(model):
    """Value and parameters of the reference values of one model."""
    with REFERENCES.open(newline="", encoding="utf-8") as stream:
        rows = [row for row in csv.DictReader(stream) if row.pop("model") == model]
    for row in rows:
        row.pop("unit")
    return [{name: float(text) for name, text in row.items() if text} for row in rows]


def exact(function):
    """Evaluate with every argument as the float it is, in 80 digits."""

    def evaluate(*arguments, **options):
        with mpmath.workdps(80):
            return function(*map(mpmath.mpf, arguments), **options)

    return evaluate


def deviation(value, expected):
    """Relative deviation of a float from a long number."""
    return abs(float(mpmath.mpf(float(value)) / expected - 1)) if expected else abs(float(value))


@exact
def zehner_bauer_schluender(k_g, k_s, eps, d, T, e, phi, path):
    """VDI Heat Atlas D6.3."""
    K, B = k_s / k_g, mpmath.mpf(5) / 4 * ((1 - eps) / eps) ** (mpmath.mpf(10) / 9)
    R = 4 * SIGMA * T**3 * d / ((2 / e - 1) * k_g) if e else mpmath.mpf(0)
    G = 1 / (1 + path / d)
    N = (1 + (R - B * G) / K) / G - B * (1 / G - 1) * (1 + R / K)
    core = B * (K + R - 1) / (N**2 * G * K) * mpmath.log((K + R) / (B * (G + (1 - G) * (K + R))))
    core += (B + 1) / (2 * B) * (R / G - B * (1 + (1 - G) / G * R)) - (B - 1) / (N * G)
    root = mpmath.sqrt(1 - eps)
    return k_g * ((1 - root) * eps * (1 / (eps - 1 + 1 / G) + R) + root * (phi * K + (1 - phi) * 2 / N * core))


@exact
def zehner_schluender(k_g, k_s, eps):
    """Zehner and Schluender 1970."""
    K, B = k_s / k_g, mpmath.mpf(5) / 4 * ((1 - eps) / eps) ** (mpmath.mpf(10) / 9)
    N, root = 1 - B / K, mpmath.sqrt(1 - eps)
    core = (1 - 1 / K) * B / N**2 * mpmath.log(K / B) - (B + 1) / 2 - (B - 1) / N
    return k_g * (1 - root + 2 * root / N * core)


@exact
def kunii_smith_gas_film(K, eps):
    """Kunii and Smith 1960; 1/3 at K = 1, where it is 0/0."""
    if K == 1:
        return mpmath.mpf(1) / 3
    films = []
    for n in (mpmath.mpf(3) / 2, 4 * mpmath.sqrt(3)):
        cosine = mpmath.sqrt(1 - 1 / n)
        below = mpmath.log(K - (K - 1) * cosine) - (K - 1) / K * (1 - cosine)
        films.append(((K - 1) / K) ** 2 / n / 2 / below - 2 / (3 * K))
    closest, loosest = mpmath.mpf(0.26), mpmath.mpf(0.476)
    share = min(max((eps - closest) / (loosest - closest), 0), 1)
    return films[1] + (films[0] - films[1]) * share


@exact
def kunii_smith(k_g, k_s, eps, d, T, e, beta, gas_in_voids=1):
    """Kunii and Smith 1960; with gas_in_voids=0 Yagi and Kunii 1957."""
    black = 4 * SIGMA * T**3
    h_rs = black / (2 / e - 1) if e else mpmath.mpf(0)
    h_rv = black / (1 + eps * (1 - e) / (2 * (1 - eps) * e)) if e else mpmath.mpf(0)
    film = kunii_smith_gas_film(k_s / k_g, eps)
    spheres = (1 - eps) / (1 / (1 / film + h_rs * d / k_g) + mpmath.mpf(2) / 3 * k_g / k_s)
    return k_g * (eps * gas_in_voids + beta * (eps * h_rv * d / k_g + spheres))


@exact
def breitbach_barthels(k_s, eps, d, T, e):
    """Breitbach and Barthels 1980."""
    black = 4 * SIGMA * T**3 * d
    B, root = mpmath.mpf(5) / 4 * ((1 - eps) / eps) ** (mpmath.mpf(10) / 9), mpmath.sqrt(1 - eps)
    grey = 2 / e - 1 if e else mpmath.inf
    return black * ((1 - root) * eps + root / grey * (B + 1) / B / (1 + 1 / (grey * k_s / black)))


@exact
def singh_kaviany(k_s, d, T, e):
    """Singh and Kaviany 1994, diffuse reflection."""
    black = 4 * SIGMA * T**3 * d
    a_1, a_2, a_3, a_4 = map(mpmath.mpf, (0.5756, 1.5353, 0.8011, 0.1843))
    angle = mpmath.atan(a_2 * (k_s / black) ** a_3 / e) if e else mpmath.pi / 2
    return black * (a_1 * e * angle + a_4)


@exact
def schotte(k_s, eps, d, T, e):
    """Schotte 1960."""
    k = 4 * SIGMA * T**3 * d * e
    return (1 - eps) / (1 / k_s + 1 / k) + eps * k if e else mpmath.mpf(0)


@exact
def vortmeyer(d, T, e):
    """Vortmeyer 1978."""
    B = sum(mpmath.mpf(c) * e**n for n, c in enumerate((0.149909, -0.24791, 0.290799, -0.20081, 0.0651042)))
    return 4 * SIGMA * T**3 * d * (2 * B + e * (1 - B)) / (2 * (1 - B) - e * (1 - B))
