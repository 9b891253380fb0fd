from __future__ import annotations

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bedrad.jobs.units import quantity, shortened, temperature_difference

UNITS = ("m", "m/s", "K", "kg/m^3", "N/m", "W/(m K)")


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("600 um", "m", 600e-6),
        ("600um", "m", 600e-6),
        ("600 µm", "m", 600e-6),  # micro sign
        ("600 μm", "m", 600e-6),  # Greek letter
        ("  7.75   mm ", "m", 7.75e-3),
        ("-1e-3 km", "m", -1.0),
        (".5 m", "m", 0.5),
        ("5. m", "m", 5.0),
        ("1 in", "m", 25.4e-3),
        ("850 degC", "K", 1123.15),
        ("850 °C", "K", 1123.15),
        ("-40 degF", "K", 233.15),
        ("300 K", "K", 300.0),
        ("180 m/h", "m/s", 0.05),
        ("5 cm s^-1", "m/s", 0.05),
        ("3.8 g/cm^3", "kg/m^3", 3800.0),
        ("3.8 g/cm**3", "kg/m^3", 3800.0),
        ("0.1 N/mm", "N/m", 100.0),
        ("2.1 W/(m K)", "W/(m K)", 2.1),
        ("2.1 W/m/K", "W/(m K)", 2.1),
        ("2.1 W m^-1 K^-1", "W/(m K)", 2.1),
        ("21 mW/(cm K)", "W/(m K)", 2.1),
    ],
)
def test_a_number_with_a_unit_is_read_in_si(text, unit, value):
    # a rounding or two in the factors of the unit
    assert quantity(text, unit) == pytest.approx(value, rel=4e-16, abs=0.0)


@pytest.mark.parametrize(
    "text", [600, 600.0, None, True, ["1 m"], {"m": 1}, "", "um", "600", "600 600", "nan m", "inf m", "1,5 mm", "1 m\0"]
)
def test_what_is_no_quantity_is_refused_with_an_example(text):
    with pytest.raises(
        ValueError, match=r"is not a quantity; expected a number with a unit, such as '600 um'$"
    ) as error:
        quantity(text, "m")
    assert str(error.value).startswith(repr(text))


@pytest.mark.parametrize(
    ("unit", "wrong", "sample"),
    [
        ("m", "600 K", "600 um"),
        ("m/s", "5 m", "0.05 m/s"),
        ("K", "850 mm", "850 degC"),
        ("kg/m^3", "3800 kg/m^2", "3800 kg/m^3"),
        ("N/m", "100 N", "100 N/m"),
        ("W/(m K)", "2.1 W/m K", "2.1 W/(m K)"),  # which is W K/m
    ],
)
def test_a_unit_of_another_kind_is_refused_with_an_example_of_this_one(unit, wrong, sample):
    message = f"'{wrong}' has the wrong kind of unit; expected a number with a unit, such as '{sample}'"
    with pytest.raises(ValueError) as error:
        quantity(wrong, unit)
    assert str(error.value) == message
    # the example of the message is itself understood
    assert math.isfinite(quantity(sample, unit))


def test_an_unknown_unit_is_named():
    with pytest.raises(ValueError, match=r"^'600 mmm' has an unknown unit 'mmm'; expected .* such as '600 um'$"):
        quantity("600 mmm", "m")


def test_an_infinite_quantity_is_refused():
    with pytest.raises(ValueError, match=r"^'1e999 m' is not a finite quantity; expected"):
        quantity("1e999 m", "m")


def test_a_unit_without_an_example_of_its_own_gets_one():
    with pytest.raises(ValueError, match=r"such as '1 s'$"):
        quantity("1 m", "s")


@pytest.mark.parametrize("tower", ["1 m^9^9^9^9", "1 m 99999999^99999999", "1 m**9**9**9**9", "1 m^9999999999"])
def test_a_tower_of_powers_is_refused_and_not_worked_out(tower):
    with pytest.raises(ValueError, match="unknown unit"):
        quantity(tower, "m")


def test_a_long_text_is_refused_at_once_and_cut_off_in_the_message():
    with pytest.raises(ValueError, match=r"^'1 m{57}\.\.\. is not a quantity") as error:
        quantity("1 " + "m" * 100_000, "m")
    assert len(str(error.value)) < 150
    assert shortened("600 um") == "'600 um'"


@given(
    st.one_of(
        st.text(max_size=40),
        st.from_regex(r"[-+]?[0-9]{1,3}(\.[0-9]{0,2})?(e[-+]?[0-9]{1,3})? ?[a-zA-Zµ°/^*() 0-9-]{0,25}", fullmatch=True),
        st.none() | st.booleans() | st.integers() | st.floats() | st.lists(st.integers(), max_size=3),
    ),
    st.sampled_from(UNITS),
)
@example("1 lambda", "m")
@example("1 ((((((((((", "m")
@example("1 m/0", "m")
@example("1 degC*degC", "K")
@example("1 dB", "m")
def test_anything_else_is_a_finite_number_or_a_value_error(text, unit):
    try:
        value = quantity(text, unit)
    except ValueError as error:
        assert "expected a number with a unit, such as" in str(error)  # noqa: PT017
    else:
        assert isinstance(value, float)
        assert math.isfinite(value)


@pytest.mark.parametrize(("text", "kelvin"), [("5 K", 5.0), ("5 mK", 5e-3)])
def test_a_difference_of_temperatures(text, kelvin):
    assert temperature_difference(text) == pytest.approx(kelvin)


@pytest.mark.parametrize("text", ["5 degC", "9 degF", "5 °C"])
def test_a_temperature_is_no_difference_of_temperatures(text):
    with pytest.raises(ValueError, match="is a temperature; expected a difference of temperatures, such as '5 K'"):
        temperature_difference(text)
