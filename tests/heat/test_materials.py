import dataclasses

import pytest

from bedrad.heat import RangeWarning, bulk, materials
from bedrad.heat.gas import air_conductivity


@pytest.mark.parametrize(
    ("material", "at_25"), [(materials.ZIRCONIA_SILICA, 472.0), (materials.ALUMINA_SILICATE, 711.0)]
)
def test_tables_2_2_and_2_3_agree_with_themselves(material, at_25):
    assert material.bulk_density / material.particle_density == pytest.approx(material.packing_fraction, abs=5e-3)
    with pytest.warns(RangeWarning, match=r"298\.15 K, outside the fitted range 313.15 to 773.15 K"):
        value = material.specific_heat(298.15)
    assert value == pytest.approx(at_25, abs=0.5)
    assert materials.MATERIALS[material.name] is material


def test_specific_heat_in_kelvin():
    assert materials.ZIRCONIA_SILICA.specific_heat([373.15, 673.15]) == pytest.approx(
        [271.5 * 100**0.1719, 271.5 * 400**0.1719], rel=1e-14
    )
    with pytest.raises(ValueError, match=r"temperature is 270 K; expected more than 273\.15 K"):
        materials.ALUMINA_SILICATE.specific_heat([400.0, 270.0])


def test_records_do_not_change():
    with pytest.raises(dataclasses.FrozenInstanceError):
        materials.ZIRCONIA_SILICA.emissivity = 0.9


def test_table_2_2_as_printed():
    zirconia, alumina = materials.ZIRCONIA_SILICA, materials.ALUMINA_SILICATE
    assert (zirconia.particle_density, zirconia.bulk_density, zirconia.packing_fraction) == (3801.0, 2386.0, 0.63)
    assert (alumina.particle_density, alumina.bulk_density, alumina.packing_fraction) == (3237.0, 2006.0, 0.62)
    assert zirconia.particle_diameters == (140e-6, 270e-6, 320e-6)
    assert alumina.particle_diameters == (340e-6,)
    assert (zirconia.solid_conductivity, alumina.solid_conductivity) == (2.1, 1.76)


def test_solids_as_printed():
    rows = {"soda lime glass": (2500, 1.1, 795), "steel AISI 52100": (7810, 46.6, 502), "aluminium": (2700, 167, 896)}
    assert rows.keys() == materials.SOLIDS.keys()
    for name, row in rows.items():
        solid = materials.SOLIDS[name]
        assert (solid.density, solid.conductivity, solid.specific_heat) == row
        assert solid.diffusivity == pytest.approx(row[1] / row[0] / row[2], rel=1e-15)


def test_measured_beds_as_printed():
    # W/(m K), MJ/(m3 K), kg/m3
    rows = {
        "Atlanta industrial sand": (0.226, 1.124, 1364),
        "Arizona fracking sand": (0.250, 1.232, 1581),
        "construction sand": (0.224, 1.178, 1524),
        "CarboHSP proppant": (0.263, 1.839, 2152),
        "Accucast ID50-K": (0.220, 1.613, 1823),
        "Riyadh white sand": (0.290, 1.320, 1561),
    }
    assert rows.keys() == materials.MEASURED_BEDS.keys()
    for name, (conductivity, capacity, density) in rows.items():
        bed = materials.MEASURED_BEDS[name]
        assert (bed.conductivity, bed.bulk_density) == (conductivity, density)
        assert bed.volumetric_heat_capacity == pytest.approx(1e6 * capacity, rel=1e-15)
        assert bed.specific_heat == pytest.approx(1e6 * capacity / density, rel=1e-15)
    # the source: well above the 0.75 kJ/(kg K) of a calorimeter
    assert materials.MEASURED_BEDS["Accucast ID50-K"].specific_heat == pytest.approx(885, abs=1)


def test_bulk_conductivities_of_sands_are_those_of_the_model():
    # silica sand in air: the conductivity of the solid that the unit cell needs lies at that of silicates
    for name in ("Atlanta industrial sand", "Arizona fracking sand", "construction sand", "Riyadh white sand"):
        bed = materials.MEASURED_BEDS[name]
        porosity = 1 - bed.bulk_density / 2650.0
        gas = air_conductivity(298.15)
        low, high = bulk.zehner_schluender(gas, [1.0, 10.0], porosity)
        assert low < bed.conductivity < high
