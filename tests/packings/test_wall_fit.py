"""A wall is fitted where the bed has one, with its uncertainty, and refused where it has none."""

from __future__ import annotations

import numpy as np
import pytest

from bedrad import Plate, Rod, Tube
from bedrad.packings.wall_fit import WALL_KINDS, fit_wall

ANYWHERE = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
"""Columns of an orthonormal basis."""


def wall_layer(
    rng: np.random.Generator, radius: float, count: int = 2000, overlap: float = 0.0, side: int = 1
) -> np.ndarray:
    """Centres of spheres of radius 1: two thirds touch a tube (a rod for side -1) with overlaps, the rest are away."""
    gap = np.where(rng.random(count) < 2 / 3, -overlap * rng.random(count), rng.uniform(0.05, 3.0, count))
    reach = np.maximum(radius - side * (1.0 + gap), 0.0)
    turn = rng.uniform(0, 2 * np.pi, count)
    return np.stack([reach * np.cos(turn), reach * np.sin(turn), rng.uniform(0, 60, count)], axis=1)


def floor_layer(rng: np.random.Generator, count: int = 2000, overlap: float = 0.0) -> np.ndarray:
    """Centres of spheres of radius 1 on the plane z = 0, two thirds of them."""
    gap = np.where(rng.random(count) < 2 / 3, -overlap * rng.random(count), rng.uniform(0.05, 3.0, count))
    return np.column_stack([rng.uniform(0, 60, (count, 2)), 1.0 + gap])


@pytest.mark.parametrize("radius", [2.5, 12.9])
@pytest.mark.parametrize(("kind", "side", "wall"), [("tube", 1, Tube), ("rod", -1, Rod)])
def test_exact_contacts_give_the_exact_wall(radius: float, kind: str, side: int, wall: type) -> None:
    centers = wall_layer(np.random.default_rng(1), radius, side=side) + np.array([5.0, -7.0, 0.0])
    fit = fit_wall(kind, centers, np.ones(len(centers)))  # type: ignore[arg-type]
    assert isinstance(fit.wall, wall)
    np.testing.assert_allclose([*fit.origin, fit.wall.radius], [5.0, -7.0, 0.0, radius], rtol=1e-12)  # type: ignore[union-attr]
    # roundings are no tilt, however well they fit
    assert (fit.direction, fit.direction_error) == ((0.0, 0.0, 1.0), None)
    assert fit.radius_error is not None
    assert fit.radius_error < 1e-14


def test_exact_contacts_give_the_exact_plate() -> None:
    fit = fit_wall("plate", floor_layer(np.random.default_rng(1)) + [0.0, 0.0, 3.0], np.ones(2000))  # noqa: RUF005
    assert fit.wall == Plate()
    np.testing.assert_allclose(fit.origin, [0.0, 0.0, 3.0], atol=1e-13)
    assert (fit.direction, fit.radius_error) == ((0.0, 0.0, 1.0), None)


@pytest.mark.parametrize("kind", ["tube", "rod", "plate"])
def test_a_tilted_wall_is_found_with_its_direction(kind: str) -> None:
    rng = np.random.default_rng(2)
    centers = floor_layer(rng) if kind == "plate" else wall_layer(rng, 12.9, side=1 if kind == "tube" else -1)
    axis = np.array([0.05, -0.08, 1.0])
    axis /= np.linalg.norm(axis)
    across = np.cross(axis, [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    basis = np.stack([np.cross(across, axis), across, axis])
    fit = fit_wall(kind, centers @ basis + [1.0, 2.0, 3.0], np.ones(len(centers)))  # type: ignore[arg-type]
    np.testing.assert_allclose(fit.direction, axis, atol=1e-12)
    placed = fit.placing.place(centers @ basis + np.array([1.0, 2.0, 3.0]))
    expected = centers[:, 2] if kind == "plate" else np.hypot(centers[:, 0], centers[:, 1])
    np.testing.assert_allclose(
        placed[:, 2] if kind == "plate" else np.hypot(placed[:, 0], placed[:, 1]), expected, atol=1e-11
    )
    assert abs(float(np.dot(fit.origin, axis)) if kind != "plate" else 0.0) < 1e-12


def test_a_tube_in_any_direction_is_found() -> None:
    centers = wall_layer(np.random.default_rng(3), 12.9) @ ANYWHERE.T
    fit = fit_wall("tube", centers, np.ones(len(centers)))
    assert abs(float(np.dot(fit.direction, ANYWHERE[:, 2]))) == pytest.approx(1.0, abs=1e-14)
    assert fit.wall.radius == pytest.approx(12.9, rel=1e-12)  # type: ignore[union-attr]
    # only those directions that are asked for
    with pytest.raises(ValueError, match="give the wall"):
        fit_wall("tube", centers, np.ones(len(centers)), [np.array([0.0, 0.0, 1.0])], may_turn=False)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_tube_along_another_axis_is_turned_exactly(axis: int) -> None:
    centers = np.roll(wall_layer(np.random.default_rng(4), 12.9), axis + 1, axis=1)
    fit = fit_wall("tube", centers, np.ones(len(centers)))
    assert fit.direction == tuple(np.eye(3)[axis].tolist())


def test_overlaps_shift_the_radius_by_their_mean() -> None:
    # overlaps uniform in 0 .. 0.015 radii: the mean contact reaches 0.0075 too far out
    centers = wall_layer(np.random.default_rng(2), 12.9, overlap=0.015)
    fit = fit_wall("tube", centers, np.ones(len(centers)))
    scatter = 0.015 / np.sqrt(12) / np.sqrt(fit.touching)
    assert fit.wall.radius - 12.9 == pytest.approx(0.0075, abs=4 * scatter)  # type: ignore[union-attr]
    assert np.hypot(*fit.origin[:2]) < 6 * scatter
    assert 0 < fit.residual < 0.015
    # for contacts all round: one unknown among n, and cos^2 of the angles for the axis
    assert fit.radius_error == pytest.approx(scatter, rel=0.1)
    assert fit.origin_error == pytest.approx(np.sqrt(2) * scatter, rel=0.1)


@pytest.mark.parametrize(("kind", "side"), [("tube", 1), ("rod", -1), ("plate", 0)])
def test_the_stated_errors_are_the_scatter_over_many_beds(kind: str, side: int) -> None:
    # the scatter of 40 beds has a standard error of 11 %; 4 of them, in 4 numbers, are a false alarm in 4000 or so
    found, stated = [], []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        centers = wall_layer(rng, 12.9, 3000, 0.015, side) if side else floor_layer(rng, 2000, 0.015)
        fit = fit_wall(kind, centers, np.ones(len(centers)))  # type: ignore[arg-type]
        assert fit.direction == (0.0, 0.0, 1.0)
        if side:
            found.append([*fit.origin[:2], fit.wall.radius])  # type: ignore[union-attr]
            stated.append([fit.origin_error, fit.origin_error, fit.radius_error])
        else:
            found.append([fit.origin[2]])
            stated.append([fit.origin_error])
    np.testing.assert_allclose(np.std(found, axis=0, ddof=1) / np.mean(stated, axis=0), 1.0, atol=0.45)


def test_the_stated_error_of_a_direction_is_its_scatter() -> None:
    slope, found, stated = 0.01, [], []
    for seed in range(40):
        centers = wall_layer(np.random.default_rng(seed), 12.9, 3000, 0.015)
        centers[:, 0] += slope * centers[:, 2]
        fit = fit_wall("tube", centers, np.ones(len(centers)))
        assert fit.direction_error is not None
        found.append(fit.direction[:2])
        stated.append(fit.direction_error)
    # sheared circles are round but for the square of the slope
    mean_error = np.mean(stated) / np.sqrt(40)
    np.testing.assert_allclose(np.mean(found, axis=0), [slope, 0.0], atol=5 * mean_error)
    np.testing.assert_allclose(np.std(found, axis=0, ddof=1) / np.mean(stated), 1.0, atol=0.45)


def test_the_notes_say_how_sure_the_fit_is() -> None:
    centers = wall_layer(np.random.default_rng(2), 12.9, overlap=0.015)
    straight = fit_wall("tube", centers, np.ones(len(centers))).notes()
    assert straight["wall_origin"] == "tube fitted by least squares to the outermost spheres, its axis moved to 0, 0"
    assert set(straight) == {
        "wall_origin", "wall_fit_residual_radii", "wall_fit_spheres", "wall_fit_axis_x_m", "wall_fit_axis_y_m",
        "wall_fit_axis_z_m", "wall_fit_axis_error_m", "wall_fit_radius_error_m",
    }  # fmt: skip
    turned = fit_wall("tube", centers @ ANYWHERE.T, np.ones(len(centers))).notes()
    assert turned["wall_origin"] == f"{straight['wall_origin']} and turned to z"
    assert set(turned) - set(straight) == {
        "wall_fit_direction_x", "wall_fit_direction_y", "wall_fit_direction_z", "wall_fit_direction_error_rad",
    }  # fmt: skip
    plate = fit_wall("plate", floor_layer(np.random.default_rng(1)) - [0.0, 0.0, 4.0], np.ones(2000)).notes()
    assert plate["wall_fit_height_m"] == pytest.approx(-4.0)
    assert plate["wall_origin"] == "plate fitted by least squares to the lowest spheres, moved to z = 0"


def test_spheres_of_unlike_sizes() -> None:
    rng = np.random.default_rng(3)
    radii = rng.uniform(0.5, 1.0, 1000)
    turn = rng.uniform(0, 2 * np.pi, 1000)
    centers = np.stack([(9 - radii) * np.cos(turn), (9 - radii) * np.sin(turn), rng.uniform(0, 50, 1000)], axis=1)
    fit = fit_wall("tube", centers, radii)
    np.testing.assert_allclose([*fit.origin, fit.wall.radius], [0.0, 0.0, 0.0, 9.0], atol=1e-12)  # type: ignore[union-attr]


def test_a_square_box_is_no_tube() -> None:
    centers = np.random.default_rng(4).uniform(0, 30, (6000, 3))
    with pytest.raises(ValueError, match=r"outermost spheres miss a common circle by .* radii .*; give the wall"):
        fit_wall("tube", centers, np.ones(6000))


def test_a_ragged_cloud_is_beside_no_wall() -> None:
    centers = np.random.default_rng(5).normal(size=(3000, 3)) * [6, 6, 20]
    with pytest.raises(ValueError, match="miss a common circle"):
        fit_wall("tube", centers, np.ones(3000))
    with pytest.raises(ValueError, match="lowest spheres miss a common plane"):
        fit_wall("plate", centers, np.ones(3000))


def test_a_full_tube_has_no_rod_inside() -> None:
    rng = np.random.default_rng(6)
    turn, reach = rng.uniform(0, 2 * np.pi, 4000), 10.0 * np.sqrt(rng.random(4000))
    centers = np.stack([reach * np.cos(turn), reach * np.sin(turn), rng.uniform(0, 60, 4000)], axis=1)
    with pytest.raises(ValueError, match="do not surround an axis along z, so that no rod can be fitted"):
        fit_wall("rod", centers, np.ones(4000))


def test_half_a_tube_is_no_tube() -> None:
    centers = wall_layer(np.random.default_rng(6), 12.9)
    with pytest.raises(ValueError, match=r"give the wall"):
        fit_wall("tube", centers[centers[:, 0] > 4.0], np.ones(int((centers[:, 0] > 4.0).sum())))


def test_a_chain_on_an_axis_is_no_tube() -> None:
    centers = np.stack([np.zeros(40), np.zeros(40), 2.0 * np.arange(40)], axis=1)
    with pytest.raises(ValueError, match="do not surround an axis"):
        fit_wall("tube", centers, np.ones(40))


def test_what_cannot_be_fitted_at_all() -> None:
    with pytest.raises(ValueError, match="not finite and positive"):
        fit_wall("tube", np.full((20, 3), np.nan), np.ones(20))
    with pytest.raises(ValueError, match="11 spheres are too few to fit a rod to them; give the wall"):
        fit_wall("rod", np.zeros((11, 3)), np.ones(11))
    with pytest.raises(ValueError, match="the wall to fit is 'cone'; expected 'tube', 'rod', 'plate'"):
        fit_wall("cone", np.zeros((20, 3)), np.ones(20))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="give the wall"):
        fit_wall("plate", np.zeros((20, 3)), np.ones(20))


@pytest.mark.parametrize(("reach", "radius"), [(1e300, 1.0), (1e150, 1e-150), (1e-300, 1e-310), (1e10, 1.0)])
def test_what_no_arithmetic_can_fit_is_refused(reach: float, radius: float) -> None:
    centers = np.random.default_rng(1).uniform(-reach, reach, (500, 3))
    for kind in WALL_KINDS:
        with pytest.raises(ValueError, match=rf"lie up to .* m from 0, 0, 0, too far to fit a {kind}; give the wall"):
            fit_wall(kind, centers, np.full(500, radius))
