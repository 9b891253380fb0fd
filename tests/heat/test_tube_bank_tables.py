import math

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from bedrad.heat import RangeWarning
from bedrad.heat.tube_bank_tables import MATERIALS, TABLE_12, TABLE_13, TABLE_14, TABLE_15
from oracles.nguyen import rows

SPEEDS = np.array([3.0, 5.0, 10.0])


def test_tables_14_and_15_are_those_printed():
    count = 0
    for row in rows("coefficients"):
        table = {"14": TABLE_14, "15": TABLE_15}[row["table"]]
        speed, power = (3, 5, 10).index(int(row["speed_mm_s"])), ("low", "high").index(row["power"])
        assert table[row["material"]][speed][power] == float(row["coefficient"])
        count += 1
    assert count == 60
    assert set(TABLE_14) == set(TABLE_15) == set(TABLE_12) == set(TABLE_13) == set(MATERIALS)


@pytest.mark.parametrize(("number", "fits", "measured"), [("12", TABLE_12, TABLE_14), ("13", TABLE_13, TABLE_15)])
def test_the_rows_of_the_fits_belong_to_other_materials_than_printed(number, fits, measured):
    printed = [row for row in rows("fits_as_printed") if row["table"] == number]
    materials = list(measured)
    means = np.array([np.mean(measured[material], axis=1) for material in materials])
    misfits = np.zeros((5, 5))
    for i, row in enumerate(printed):
        columns = [float(row[f"column_{k}"]) for k in (1, 2, 3)]
        # the headings are b2, b1, a; Table 12 has a, b1, b2
        a, b1, b2 = columns if number == "12" else columns[::-1]
        misfits[i] = np.sqrt(np.mean((a + b1 * SPEEDS + b2 * SPEEDS**2 - means) ** 2, axis=1))
    row_of, best = linear_sum_assignment(misfits)
    assert np.array_equal(row_of, np.arange(5))
    for i, j in enumerate(best):
        fit = fits[materials[j]]
        columns = [float(printed[i][f"column_{k}"]) for k in (1, 2, 3)]
        assert [fit.a, fit.b1, fit.b2] == (columns if number == "12" else columns[::-1])
        assert fit.r_squared == float(printed[i]["r_squared"])
    # the rows are in the order of Table 14
    assert [materials[j] for j in best] == list(TABLE_14)
    found = misfits[np.arange(5), best]
    labelled = np.array([misfits[i, materials.index(row["printed_material"])] for i, row in enumerate(printed)])
    assert found.max() < 3.0
    assert np.sum(labelled > 5.0) >= 3
    assert [row["printed_material"] for row in printed].index("CarboHSP") == 3  # the one that is right


def test_headings_of_table_12_as_printed_would_give_thousands():
    row = next(row for row in rows("fits_as_printed") if row["table"] == "12")
    b2, b1, a = (float(row[f"column_{k}"]) for k in (1, 2, 3))
    assert a + b1 * 10.0 + b2 * 100.0 > 9000.0


@pytest.mark.parametrize("material", list(MATERIALS))
def test_fits_against_the_measured_values(material):
    for fits, table, off in ((TABLE_12, TABLE_14, 0.025), (TABLE_13, TABLE_15, 0.06)):
        speed = SPEEDS * 1e-3
        assert fits[material].coefficient(speed) == pytest.approx(np.mean(table[material], axis=1), rel=off)


def test_coefficient_of_a_fit():
    fit = TABLE_12["Riyadh"]
    assert fit.coefficient(0.005) == pytest.approx(100.22 + 2.36 * 5 - 0.05 * 25, rel=1e-14)
    assert isinstance(fit.coefficient(0.005), float)
    assert fit.tubes == "bare"
    with pytest.warns(
        RangeWarning, match=r"Riyadh at bare tubes .* is 0.02 m/s, outside the fitted range 0.003 to 0.01"
    ):
        fit.coefficient(0.02)
    with pytest.raises(ValueError, match="speed is 0 m/s"):
        fit.coefficient(0.0)


def test_materials():
    for material in MATERIALS.values():
        assert 0.2e-3 < material.sauter_diameter < 0.8e-3
        # the probe's specific heat, which the source finds too high
        assert 770.0 < material.volumetric_heat_capacity / material.bulk_density < 890.0
    with pytest.raises(TypeError):
        TABLE_14["ID50-K"] = ()
    assert math.isclose(MATERIALS["CarboHSP"].bulk_density, 2152.0)
