"""View factors between spheres, cylinders and plates against the closed forms of tests/references.

Where a sphere emits, cosine rays leave its surface and are followed by the kernel; where the wall emits, reciprocity
(A_w F_ws = A_s F_sw) turns the sphere's factor into the wall's. Each comparison allows 4 standard errors. With 29 of
them and normal errors (6e-5 each) one change of seed in five hundred raises a false alarm; the seeds are fixed.

Specks of 1e-6 hold the open ends of a scene where they should be; what they hide is below 1e-10.

Left out, because spheres and bedrad's walls cannot form them: coaxial discs (neither a wall nor a sphere), and coaxial
cylinders of finite length (a rod made of spheres bulges beyond its ends); the infinite rod is below.
"""

import numpy as np
import pytest

import bedrad
from bedrad.raytrace.scene import build_scene
from bedrad.walls import Window
from oracles.emission import distances, hit, scene_grid, surface_rays
from oracles.references import closed_form

SPECK = 1e-6
SPHERE = 4.0 * np.pi  # area of a unit sphere


def open_tube(length, tube_radius=1.0, centers=(), radii=()):
    """Spheres in a tube from z = 0 to its length, whose ends are open."""
    marks = [[0.0, 0.0, SPECK], [0.0, 0.0, length - SPECK]]
    return bedrad.Packing([*marks, *centers], [SPECK, SPECK, *radii], bedrad.Tube(tube_radius), max_overlap=2.0)


def from_the_wall(bed, axial=None, lateral=None, edges=None, rays=2**18, seed=1):
    """View factors of a window; of the whole bed, but for 1e-9 that rounding may need, where not given."""
    low, high = bed.extent(bed.wall.axial)
    window = Window(axial or (low + 1e-9, high - 1e-9), lateral)
    return bedrad.view_factors(bed, [0.0, bed.wall.radius] if edges is None else edges, rays=rays, window=window,
                               seed=seed, blocks=1)  # fmt: skip


def sphere_to_sphere(radius, other, distance, rays, seed):
    """Share of a sphere's radiation that reaches another, by emission, and its standard error."""
    height = max(radius, other)
    # the emitter is in the scene too, where it must not catch its own rays
    bed = bedrad.Packing([[0, 0, height], [distance, 0, height]], [radius, other], bedrad.Plate())
    grid = scene_grid(build_scene(bed, Window((0.0, 1e-3), (0.0, 1e-3)), 2.0 * height))
    origins, directions = surface_rays(np.random.default_rng(seed), bed.centers[0], radius, rays)
    share = hit(distances(grid, origins, directions)).mean()
    return share, np.sqrt(share * (1.0 - share) / rays)


@pytest.mark.parametrize("distance", ["2", "2.2", "3", "6"])
def test_equal_spheres_by_emission(distance):
    share, error = sphere_to_sphere(1.0, 1.0, float(distance), 2**20, seed=1)
    assert abs(share - closed_form("sphere to equal sphere", f"c={distance}")) < 4 * error


@pytest.mark.parametrize("radius", ["0.2", "0.6", "2", "10"])
def test_touching_unequal_spheres_by_emission(radius):
    share, error = sphere_to_sphere(float(radius), 1.0, float(radius) + 1.0, 2**21, seed=2)
    assert abs(share - closed_form("sphere to touching unit sphere", f"r={radius}")) < 4 * error


@pytest.mark.parametrize("radius", ["0.2", "10"])
def test_touching_unequal_spheres_by_reciprocity(radius):
    """The unit sphere emits to the other: r^2 F is what the table's direction gives."""
    share, error = sphere_to_sphere(1.0, float(radius), float(radius) + 1.0, 2**20, seed=3)
    exact = float(radius) ** 2 * closed_form("sphere to touching unit sphere", f"r={radius}")
    assert abs(share - exact) < 4 * error


@pytest.mark.parametrize("distance", ["2.2", "3", "6"])
def test_equal_spheres_from_the_wall_around_them(distance):
    """A row of spheres on the axis of a tube: nearest neighbours hide all others, so A_w F_ws = A_s (1 - 2 F)."""
    period = float(distance)
    row = bedrad.Packing([[0.0, 0.0, 0.0]], 1.0, bedrad.Tube(1.5), period=period)
    found = bedrad.view_factors(row, [0.0, 1.0], rays=2**20, seed=4)
    ratio = 2.0 * np.pi * 1.5 * period / SPHERE
    share, error = (1.0 - ratio * (1.0 - found.wall)) / 2.0, ratio * found.wall_error / 2.0
    assert abs(share - closed_form("sphere to equal sphere", f"c={distance}")) < 4 * error


@pytest.mark.parametrize("length", [1, 2, 4, 8])
def test_cylinder_interior_to_its_ends_and_end_to_end(length):
    """Half of what escapes leaves by each end; A_disc (1 - F_disc-disc) = A_w F_w-end, areas pi and 2 pi L."""
    found = from_the_wall(open_tube(length), edges=[0.0, 0.5], seed=5)
    end, error = found.escaped / 2.0, found.escaped_error / 2.0
    assert abs(end - closed_form("cylinder interior to one end", f"L={length}")) < 4 * error
    discs = 1.0 - 2.0 * length * end
    assert abs(discs - closed_form("end disc to end disc", f"L={length}")) < 4 * 2.0 * length * error


def test_band_to_band_of_a_cylinder():
    """What the band (0, 1) sends to a tube of length 3 less what it sends to one of length 2."""
    three, two = (from_the_wall(open_tube(n), (1e-9, 1.0), edges=[0.0, 0.5], rays=2**20, seed=n) for n in (3, 2))
    exact = closed_form("cylinder band to band", "z=(0, 1, 2, 3)")
    assert abs(three.wall - two.wall - exact) < 4 * np.hypot(three.wall_error, two.wall_error)


@pytest.mark.parametrize("radius", [1.0, 0.3])
def test_sphere_to_coaxial_disc(radius):
    """A disc closes the end of a tube of its radius, 2, at a = 1: the wall before it takes 1/2 - F of the sphere."""
    bed = open_tube(2.0, 2.0, [[0.0, 0.0, 1.0]], [radius])
    found = from_the_wall(bed, (1.0, 2.0 - 1e-9), rays=2**19, seed=6)
    ratio = 2.0 * np.pi * 2.0 / (SPHERE * radius**2)
    disc, error = 0.5 - ratio * found.layers[0], ratio * found.layers_error[0]
    assert abs(disc - closed_form("sphere to coaxial disc", "(r, a)=(2, 1)")) < 4 * error


@pytest.mark.parametrize("half_width", [1, 3])
@pytest.mark.parametrize("radius", [1.0, 0.4])
def test_sphere_to_rectangle(half_width, radius):
    a = float(half_width)
    corners = [[s * (a + SPECK), t * (a + SPECK), SPECK] for s in (-1, 1) for t in (-1, 1)]
    bed = bedrad.Packing([[0.0, 0.0, 1.0], *corners], [radius, *4 * [SPECK]], bedrad.Plate())
    found = from_the_wall(bed, (-a, a), (-a, a), edges=[0.0, 3.0], seed=7)
    ratio = 4.0 * a * a / (SPHERE * radius**2)
    exact = closed_form("sphere to centred rectangle", f"(a, b, h)=({half_width}, {half_width}, 1)")
    assert abs(ratio * found.layers[0] - exact) < 4 * ratio * found.layers_error[0]


@pytest.mark.parametrize("radius", [1.0, 0.5])
def test_cylinder_to_sphere_on_its_axis(radius):
    """R = L = 1; the sphere of radius 1 touches the wall all round, others get r^2 of its share."""
    found = from_the_wall(open_tube(2.0, 1.0, [[0.0, 0.0, 1.0]], [radius]), seed=8)
    exact = closed_form("cylinder interior to sphere on axis", "(r, R, L)=(1, 1, 1)")
    assert abs(found.layers[0] / radius**2 - exact) < 4 * found.layers_error[0] / radius**2


@pytest.mark.parametrize("radius", [0.1, 0.04])
def test_off_axis_sphere_to_the_cylinder(radius):
    """e = 0.9, R = L = 1: the sphere of radius 0.1 touches the wall."""
    found = from_the_wall(open_tube(2.0, 1.0, [[0.9, 0.0, 1.0]], [radius]), rays=2**19, seed=9)
    ratio = 2.0 * np.pi * 2.0 / (SPHERE * radius**2)
    exact = closed_form("off-axis sphere to cylinder", "(e, R, L)=(0.9, 1, 1)")
    assert abs(ratio * found.layers[0] - exact) < 4 * ratio * found.layers_error[0]


def test_infinite_rod_of_spheres_in_a_tube():
    """Coaxial infinite cylinders: F = r/R. Spheres every 0.02 r form a rod whose waists are 5e-5 r thinner.

    The body lies between the cylinders of its waist and of its equator, and so does its factor.
    """
    step, period = 0.02, 3.0
    z = step * np.arange(round(period / step))
    bed = bedrad.Packing(np.c_[0 * z, 0 * z, z], 1.0, bedrad.Tube(2.0), period=period, max_overlap=2.0)
    found = bedrad.view_factors(bed, [0.0, 2.0], rays=2**16, seed=10)
    waist = np.sqrt(1.0 - step**2 / 4.0)
    assert waist / 2.0 - 4 * found.wall_error < 1.0 - found.wall < 1.0 / 2.0 + 4 * found.wall_error
