import dataclasses

import pytest

from bedrad.heat import RangeWarning, materials


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
