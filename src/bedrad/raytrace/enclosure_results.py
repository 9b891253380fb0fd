"""What the exchange between wall and layers came out as: matrices, how sure they are, and what they cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.raytrace.factors import LeftOut
from bedrad.walls import Window

__all__ = ["ExchangeFactors", "ReflectedFactors", "jackknife_error", "reciprocal_matrix"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def jackknife_error(replicates: FloatArray) -> FloatArray:
    """Standard error of a quantity from its values (n, ...) with one of n independent parts left out each time."""
    n = len(replicates)
    return np.asarray(np.sqrt((n - 1) / n * ((replicates - replicates.mean(axis=0)) ** 2).sum(axis=0)))


def _shares(counts: IntArray) -> FloatArray:
    """Rows of counts as shares of their sum; a zone without surface, which emits nothing, is said to see the wall."""
    emitted = counts.sum(axis=1, keepdims=True)
    shares = counts / np.maximum(emitted, 1)
    shares[emitted[:, 0] == 0, 0] = 1.0
    return np.asarray(shares)


def reciprocal_matrix(counts: IntArray, areas: FloatArray) -> FloatArray:
    """Exchange factors from counts of rays both ways, with A_i F_ij = A_j F_ji and rows that sum to one.

    Rays from i to j and from j to i measure the same exchange area G = A_i F_ij. With N_i rays from zone i, each
    stands for the area A_i/N_i, so that the likeliest G of two Poisson counts is (c_ij + c_ji)/(N_i/A_i + N_j/A_j).
    What the rows then lack to their areas is shared out among their entries with the least sum of squares in standard
    errors (Lagrange multipliers, one for each row).

    Parameters
    ----------
    counts : (zones, zones + lost) int array
        Rays from each zone to each, and to where they are lost.
    areas : (zones,) array
        The zones' areas. [m2]

    Returns
    -------
    (zones, zones + lost) array
        Exchange factors.
    """
    n = len(counts)
    matrix = _shares(counts)
    used = np.flatnonzero((areas > 0.0) & (counts.sum(axis=1) > 0))
    order = np.concatenate([used, np.arange(n, counts.shape[1])])
    c, A = counts[np.ix_(used, order)].astype(float), areas[used]
    m = len(used)
    rays_per_area = c.sum(axis=1) / A
    both = rays_per_area[:, None] + rays_per_area
    G, variance = c / rays_per_area[:, None], c / rays_per_area[:, None] ** 2
    mutual = ~np.eye(m, dtype=bool)
    G[:, :m][mutual] = ((c[:, :m] + c[:, :m].T) / both)[mutual]
    variance[:, :m][mutual] = (G[:, :m] / both)[mutual]
    system = np.where(mutual, variance[:, :m], 0.0) + np.diag(variance.sum(axis=1))
    # singular where no zone sees itself and nothing is lost, as then the two sides must agree of themselves
    multipliers = np.linalg.lstsq(system, A - G.sum(axis=1), rcond=1e-12)[0]
    pull = np.tile(multipliers[:, None], (1, len(order)))
    pull[:, :m] += np.where(mutual, multipliers, 0.0)
    G = np.maximum(G + variance * pull, 0.0)
    rows = np.zeros((m, counts.shape[1]))
    rows[:, order] = G / G.sum(axis=1, keepdims=True)
    matrix[used] = rows
    return matrix


@dataclass(frozen=True)
class ExchangeFactors:
    """Exchange factors between the zones of a bed: the wall, and the spheres' surface in each layer.

    Rows of `matrix` and `counted` sum to one. A layer without surface has the area 0 and is said to see the wall. Where
    the window is a whole period, reciprocity holds but for the noise of the rays; a piece of an open bed exchanges with
    its neighbours as with itself on average only, and `reciprocity` shows how far that is from being so.

    Parameters
    ----------
    matrix, matrix_error : (zones, zones + 2) arrays
        Shares of each zone's radiation that end at each zone, beyond the last layer, and outside the open ends; from
        the rays of both directions together, so that A_i F_ij = A_j F_ji. Standard errors from independent scramblings.
    counted, counted_error : (zones, zones + 2) arrays
        The same from the rays of each row alone.
    areas : (zones,) array
        Of the wall in the window, and of the spheres' surface over it; exact for whole layers, by the share of starting
        points for orientations. [m2]
    layer_of_zone : (zones,) int array
        Number of the layer of each zone, -1 for the wall.
    reciprocity : (zones, zones) array
        Difference of A_i F_ij and A_j F_ji by rays of one direction each, in its standard errors; nan where no
        ray went.
    replicates : (n, zones, zones + 2) array
        `matrix` with each of n scramblings left out, for `error_of`.
    emitted : (zones,) int array
        Number of rays from each zone.
    edges : (layers + 1,) array
        Depths that part the layers. [m]
    orientations : int
        Ranges of angles to the wall.
    window : Window
        The piece of wall that emits.
    rays : int
        Number of rays.
    seconds, setup_seconds : float
        Run time in all, and what of it went into areas and grid. [s]
    seed : int
        Seed of the rays.
    left_out : LeftOut
        What the scene did not need.
    """

    matrix: FloatArray
    matrix_error: FloatArray
    counted: FloatArray
    counted_error: FloatArray
    areas: FloatArray
    layer_of_zone: IntArray
    reciprocity: FloatArray
    replicates: FloatArray
    emitted: IntArray
    edges: FloatArray
    orientations: int
    window: Window
    rays: int
    seconds: float
    setup_seconds: float
    seed: int
    left_out: LeftOut

    @classmethod
    def from_counts(
        cls,
        counts: IntArray,
        *,
        wall_area: float,
        layer_areas: FloatArray,
        edges: FloatArray,
        orientations: int,
        window: Window,
        seconds: float,
        setup_seconds: float,
        seed: int,
        left_out: LeftOut,
    ) -> ExchangeFactors:
        """Matrices and errors from the counts (scramblings, zones, zones + 2) of independent scramblings.

        Raises
        ------
        ValueError
            If a layer with surface emitted no ray in all scramblings but one.
        """
        total = counts.sum(axis=0)
        without = total - counts
        in_layer = total[1:].sum(axis=1).reshape(-1, orientations)
        least = without[:, 1:].sum(axis=2).reshape(len(counts), -1, orientations).sum(axis=2).min(axis=0)
        bare = np.flatnonzero((layer_areas > 0.0) & (least == 0))
        if len(bare):
            raise ValueError(
                f"too few of {total.sum():,} rays start in layer {bare[0] + 1}, which has {layer_areas[bare[0]]:.3g} "
                "m2 of surface: give more rays"
            )
        share = in_layer / np.maximum(in_layer.sum(axis=1, keepdims=True), 1)
        areas = np.concatenate([[wall_area], (layer_areas[:, None] * share).ravel()])
        replicates = np.array([reciprocal_matrix(part, areas) for part in without])
        counted = np.array([_shares(part) for part in without])
        n = len(total)
        flows = areas[:, None] * counted[:, :, :n]
        one_way = areas[:, None] * _shares(total)[:, :n]
        error = jackknife_error(flows - flows.transpose(0, 2, 1))
        return cls(
            matrix=reciprocal_matrix(total, areas),
            matrix_error=jackknife_error(replicates),
            counted=_shares(total),
            counted_error=jackknife_error(counted),
            areas=areas,
            layer_of_zone=np.concatenate([[-1], np.repeat(np.arange(len(layer_areas)), orientations)]),
            reciprocity=np.where(error > 0.0, (one_way - one_way.T) / np.where(error > 0.0, error, 1.0), np.nan),
            replicates=replicates,
            emitted=total.sum(axis=1),
            edges=edges,
            orientations=orientations,
            window=window,
            rays=int(total.sum()),
            seconds=seconds,
            setup_seconds=setup_seconds,
            seed=seed,
            left_out=left_out,
        )

    @property
    def exchange(self) -> FloatArray:
        """The square part (zones, zones) of `matrix`: what stays between wall and layers."""
        return self.matrix[:, : len(self.areas)]

    @property
    def lost(self) -> FloatArray:
        """What of each zone's radiation ends beyond the last layer or outside the open ends, (zones,)."""
        return np.asarray(self.matrix[:, len(self.areas) :].sum(axis=1))

    def error_of(self, quantity: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Standard error of whatever is computed from the matrix.

        Parameters
        ----------
        quantity : callable
            Takes a matrix (zones, zones + 2) and gives an array.
        """
        return jackknife_error(np.array([quantity(matrix) for matrix in self.replicates]))

    def __str__(self) -> str:
        layers = len(self.edges) - 1
        tags = [f".{k + 1}" for k in range(self.orientations)] if self.orientations > 1 else [""]
        names = ["wall", *(f"layer {k + 1}{tag}" for k in range(layers) for tag in tags), "beyond", "escaped"]
        lines = [f"{'from, to':<11}" + "".join(f"{name:>10}" for name in names) + f"{'area [m2]':>12}"]
        for name, row, area in zip(names, self.matrix, self.areas, strict=False):
            lines.append(f"{name:<11}" + "".join(f"{value:>10.5f}" for value in row) + f"{area:>12.4g}")
        z = np.abs(self.reciprocity[np.triu_indices(len(self.areas), 1)])
        farthest = f"{np.nanmax(z):.1f}" if np.isfinite(z).any() else "no"
        lines.append(f"largest standard error {self.matrix_error.max():.1e}; reciprocity within {farthest} of them")
        lines.append(f"{self.rays:,} rays in {self.seconds:.2f} s; left out: {self.left_out}")
        return "\n".join(lines)


@dataclass(frozen=True)
class ReflectedFactors:
    """What becomes of the radiation that a grey wall emits; `layers`, `wall`, `beyond` and `escaped` sum to one.

    Parameters
    ----------
    layers, layers_error : (layers,) arrays
        Share that the spheres' surface in each layer absorbs, and its standard error.
    wall, wall_error, beyond, beyond_error, escaped, escaped_error : float
        Share that the wall absorbs, that gets beyond the last layer, that leaves through open ends.
    wall_emissivity, particle_emissivity : float
        As given.
    edges : (layers + 1,) array
        Depths that part the layers. [m]
    window : Window
        The piece of wall that emits.
    rays, reflections : int
        Number of rays, and of all their reflections.
    ended : int
        Rays that were ended where they were after `bedrad.raytrace.enclosure.MOST_REFLECTIONS` reflections.
    seconds, setup_seconds, seed, left_out
        As for `ExchangeFactors`.
    replicates : (n, layers + 3) array
        Shares of wall, layers, beyond and escaped with each of n scramblings left out.
    """

    layers: FloatArray
    layers_error: FloatArray
    wall: float
    wall_error: float
    beyond: float
    beyond_error: float
    escaped: float
    escaped_error: float
    wall_emissivity: float
    particle_emissivity: float
    edges: FloatArray
    window: Window
    rays: int
    reflections: int
    ended: int
    seconds: float
    setup_seconds: float
    seed: int
    left_out: LeftOut
    replicates: FloatArray

    @classmethod
    def from_counts(
        cls,
        counts: IntArray,
        *,
        wall_emissivity: float,
        particle_emissivity: float,
        edges: FloatArray,
        window: Window,
        reflections: int,
        ended: int,
        seconds: float,
        setup_seconds: float,
        seed: int,
        left_out: LeftOut,
    ) -> ReflectedFactors:
        """Shares and errors from the counts (scramblings, layers + 3) of independent scramblings."""
        total = counts.sum(axis=0)
        share, without = total / total.sum(), total - counts
        replicates = without / without.sum(axis=1, keepdims=True)
        error = jackknife_error(replicates)
        return cls(
            layers=share[1:-2],
            layers_error=error[1:-2],
            wall=float(share[0]),
            wall_error=float(error[0]),
            beyond=float(share[-2]),
            beyond_error=float(error[-2]),
            escaped=float(share[-1]),
            escaped_error=float(error[-1]),
            wall_emissivity=wall_emissivity,
            particle_emissivity=particle_emissivity,
            edges=edges,
            window=window,
            rays=int(total.sum()),
            reflections=reflections,
            ended=ended,
            seconds=seconds,
            setup_seconds=setup_seconds,
            seed=seed,
            left_out=left_out,
            replicates=replicates,
        )

    def __str__(self) -> str:
        rows = [(f"layer {k + 1}", f, e) for k, (f, e) in enumerate(zip(self.layers, self.layers_error, strict=True))]
        rows += [(name, getattr(self, name), getattr(self, f"{name}_error")) for name in ("beyond", "wall", "escaped")]
        lines = [f"{'absorbed by':<14}{'share':>12}{'± rays':>10}"]
        lines += [f"{name:<14}{value:>12.6f}{error:>10.1e}" for name, value, error in rows]
        lines.append(
            f"emissivity {self.wall_emissivity:g} (wall), {self.particle_emissivity:g} (particles): "
            f"{self.rays:,} rays, {self.reflections / self.rays:.2f} reflections each, in {self.seconds:.2f} s"
        )
        if self.ended:
            lines.append(f"{self.ended:,} rays were ended before they were absorbed")
        lines.append(f"left out: {self.left_out}")
        return "\n".join(lines)
