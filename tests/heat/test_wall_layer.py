import csv
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bedrad.heat import RangeWarning, cylinder, wall_layer

TABLE = Path(__file__).parents[1] / "data" / "wall_layer_conductivity.csv"
ROWS = list(csv.DictReader(line for line in TABLE.read_text().splitlines() if not line.startswith("#")))
FORMS = ("simplified", "general", "flat", "cylinder")


def correlated(A, d, U):
    """Contacts and packing fraction by correlation."""
    contacts = wall_layer.contact_ratio(A, U, d, warn=False) * wall_layer.maximum_contacts(A, d)
    return contacts, wall_layer.packing_fraction(A, U, d, warn=False)


@pytest.mark.parametrize("row", ROWS)
def test_reference_table(row):
    d = float(row["particle_diameter_m"])
    A = float(row["tube_diameter_m"]) / d
    contacts, fraction = correlated(A, d, float(row["velocity_m_s"]))
    assert contacts == pytest.approx(float(row["contacts_m_2"]), rel=1e-8)
    assert wall_layer.contact_factor(70.0) == pytest.approx(float(row["contact_factor"]), rel=1e-8)
    assert wall_layer.no_contact_factor(70.0) == pytest.approx(float(row["no_contact_factor"]), rel=1e-8)
    values = {f: wall_layer.conductivity(0.03, 2.1, A, d, contacts, fraction, form=f) for f in FORMS}
    for form, value in values.items():
        # the flat column of the table holds to seven digits only
        assert value == pytest.approx(float(row[form]), rel=5e-8 if form == "flat" else 1e-8), form
    excess = values["simplified"] / values["cylinder"] - 1
    assert excess == pytest.approx(float(row["simplified_over_cylinder_less_1"]), abs=1e-9)


def test_published_case_of_300_um_in_7_75_mm_at_0_058_m_s():
    A = 7.75e-3 / 300e-6
    contacts, fraction = correlated(A, 300e-6, 0.058)
    value = wall_layer.conductivity(0.03, 2.1, A, 300e-6, contacts, fraction)
    assert value == pytest.approx(0.11977432, rel=5e-9 / 0.119)


def test_chute_form_of_the_source_is_the_flat_form_rounded():
    # eq. 45 with B = 1; its 0.74 and 0.95 round 0.74044 and 0.9516
    A, d = 25.8, 3e-4
    contacts, fraction = correlated(A, d, 0.058)
    area = math.pi * (d / 2) ** 2 * contacts
    bracket = 3 * (1 - 0.5 / A) * fraction - 2 * area
    factors = 2 * wall_layer.contact_factor(70.0) - 1, 2 * wall_layer.no_contact_factor(70.0) - 0.95
    printed = 0.03 * (1 + area * factors[0] + 0.74 * bracket * factors[1])
    flat = wall_layer.conductivity(0.03, 2.1, A, d, contacts, fraction, form="flat")
    assert flat == pytest.approx(printed, rel=1e-4)
    assert flat != printed


@pytest.mark.parametrize("form", FORMS)
def test_shares_add_up_and_packing_fraction_is_recovered_from_the_counts(form):
    A, d = 17.2, 450e-6
    contacts, fraction = correlated(A, d, 0.1)
    shares = wall_layer.contributions(0.03, 2.1, A, d, contacts, fraction, form=form)
    assert shares.conductivity == pytest.approx(shares.contact + shares.no_contact + shares.void, rel=1e-14)
    assert shares.void == pytest.approx(0.03 * (1 - shares.covered_share), rel=1e-14)
    r = d / 2
    if form == "cylinder":
        volumes = cylinder.particle_volume(A) * r**3, cylinder.particle_volume(A, 0.22) * r**3
    else:
        volumes = 2 * math.pi / 3 * r**3, math.pi / 3 * 0.78**2 * 2.22 * r**3
    solid = volumes[0] * contacts + volumes[1] * shares.no_contact_per_area
    assert 2 * A * solid / (r * (2 * A - 1)) == pytest.approx(fraction, rel=1e-13)  # eq. 31


@pytest.mark.parametrize("form", ["general", "flat", "cylinder"])
def test_particles_that_conduct_like_the_gas_do_not_matter(form):
    for K in (1 - 1e-9, 1.0, 1 + 1e-9):
        value = wall_layer.conductivity(0.03, 0.03 * K, 20.0, 3e-4, 5e6, 0.42, 0.3, form=form)
        assert value == pytest.approx(0.03, rel=1e-8)


def test_all_particles_in_contact_leave_nothing_for_the_others():
    # packing fraction made of contact particles alone
    contacts, d = 6e6, 3e-4
    fraction = 2 * math.pi / 3 * (d / 2) ** 2 * contacts
    shares = wall_layer.contributions(0.03, 2.1, np.inf, d, contacts, fraction, [0.0, 0.22, 0.9], form="flat")
    assert np.all(np.abs(shares.no_contact_per_area) < 1e-6)
    assert np.ptp(shares.conductivity) < 1e-15


def test_at_distance_zero_only_the_number_of_particles_counts():
    values = [
        wall_layer.conductivity(0.03, 2.1, np.inf, 3e-4, contacts, 0.42, 0.0, form="flat")
        for contacts in (0.0, 3e6, 8e6)
    ]
    assert values == pytest.approx([values[0]] * 3, rel=1e-13)


def test_negative_number_of_no_contact_particles_is_refused_with_the_values():
    contacts, fraction = correlated(6.7, 3e-4, 0.0)
    with pytest.raises(ValueError, match=r"packing_fraction 0\.41.*diameter_ratio 6\.7.*negative number"):
        wall_layer.conductivity(0.03, 2.1, 6.7, 3e-4, contacts, fraction)
    contacts, fraction = correlated(np.array([6.78, 6.79]), 3e-4, 0.0)
    with pytest.raises(ValueError, match=r"diameter_ratio 6\.78:"):
        wall_layer.conductivity(0.03, 2.1, np.array([6.78, 6.79]), 3e-4, contacts, fraction)
    # the correlations for a resting bed close from A = 6.7894 on
    contacts, fraction = correlated(6.79, 3e-4, 0.0)
    assert wall_layer.contributions(0.03, 2.1, 6.79, 3e-4, contacts, fraction).no_contact_per_area >= 0


def test_overlapping_areas_are_reported():
    arguments = (0.03, 2.1, 25.8, 3e-4, 6.5e6, 0.415)
    assert wall_layer.contributions(*arguments, 0.55, "general").void > 0
    with pytest.warns(RangeWarning, match="void share of k_wa is negative") as record:
        shares = wall_layer.contributions(*arguments, 0.7, "general")
    assert len(record) == 1
    assert record[0].filename == __file__
    assert shares.void < 0
    assert shares.covered_share > 1
    with pytest.warns(RangeWarning) as record:
        wall_layer.conductivity(*arguments, 0.7, "general")
    assert record[0].filename == __file__


def test_arrays_broadcast_against_each_other():
    gas = np.array([0.03, 0.05, 0.07])
    A = np.array([[12.9], [25.8]])
    contacts, fraction = correlated(A, 3e-4, 0.05)
    values = wall_layer.conductivity(gas, 2.1, A, 3e-4, contacts, fraction)
    assert values.shape == (2, 3)
    single = wall_layer.conductivity(0.05, 2.1, 25.8, 3e-4, contacts[1, 0], fraction[1, 0])
    assert np.ndim(single) == 0
    assert values[1, 1] == single


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"form": "round"}, "form is 'round'; expected one of simplified"),
        ({"nc_distance": 0.3}, r"nc_distance is 0.3, but the simplified form .* choose form=\"general\""),
        ({"nc_distance": 1.0, "form": "general"}, "nc_distance is 1 particle radii; expected .* less than 1"),
        ({"gas_conductivity": 0.0}, r"gas_conductivity is 0 W/\(m K\)"),
        ({"solid_conductivity": [2.1, -1]}, r"solid_conductivity is -1"),
        ({"packing_fraction": 1.2}, "packing_fraction is 1.2; expected at least 0 and at most 1"),
        ({"packing_fraction": np.nan}, "packing_fraction is nan"),
        ({"contacts_per_area": -1.0}, "contacts_per_area is -1 1/m2"),
        ({"diameter_ratio": 1.0}, "diameter_ratio is 1; expected more than 1"),
        ({"diameter_ratio": np.inf}, "diameter_ratio is inf"),
        ({"particle_diameter": 0.0}, "particle_diameter is 0 m"),
    ],
)
def test_refusals(change, message):
    arguments = {
        "gas_conductivity": 0.03,
        "solid_conductivity": 2.1,
        "diameter_ratio": 20.0,
        "particle_diameter": 3e-4,
        "contacts_per_area": 6e6,
        "packing_fraction": 0.42,
    }
    with pytest.raises(ValueError, match=message):
        wall_layer.conductivity(**(arguments | change))


@given(
    a=st.floats(0.0, 0.98),
    touching=st.floats(0.0, 0.8),
    apart=st.floats(0.01, 0.5),
    A=st.sampled_from([3.0, 12.9, 40.0, math.inf]),
    volumes=st.sampled_from(["flat", "cylinder"]),
)
@settings(max_examples=60, deadline=None, derandomize=True)
def test_closing_distance_is_found_again(a, touching, apart, A, volumes):
    # counts per hexagonal maximum of a wall layer of 0.6 mm spheres
    d, r = 0.6e-3, 0.3e-3
    if volumes == "cylinder" and math.isinf(A):
        A = 1e6
    most = wall_layer.maximum_contacts(A, d)
    if volumes == "cylinder":
        volume = [cylinder.particle_volume(A, x) for x in (0.0, a)]
    else:
        volume = [math.pi / 3 * (1 - x) ** 2 * (2 + x) for x in (0.0, a)]
    fraction = (volume[0] * touching + volume[1] * apart) * most * r**2 / (1 - 0.5 / A)
    found = wall_layer.closing_nc_distance(fraction, touching * most, apart * most, d, A, volumes)
    # near a = 1 the volume goes like (1-a)^2, so rounding of the fraction grows as 1/(apart (1-a))
    assert found == pytest.approx(a, abs=2e-14 / (apart * (1 - a)))


def test_closing_distance_where_none_closes():
    d = 0.6e-3
    fractions = [0.45, 0.1, 0.99]
    found = wall_layer.closing_nc_distance(fractions, 2e6, [0.0, 1e6, 1e4], d, 12.9, "cylinder")
    assert np.all(np.isnan(found))
    assert wall_layer.closing_nc_distance(0.45, 2e6, 8e5, d) < 1
    with pytest.raises(ValueError, match="no_contact_per_area is -1"):
        wall_layer.closing_nc_distance(0.45, 2e6, -1.0, d)
    with pytest.raises(ValueError, match="volumes is 'round'"):
        wall_layer.closing_nc_distance(0.45, 2e6, 1e6, d, 12.9, "round")
