"""Tables of measured flows: what is read from them, in which units, and what is refused with which words."""

import numpy as np
import pytest

from bedrad.errors import BadFileError
from bedrad.heat.measured_flow import Properties, Tube
from bedrad.jobs.measurements import read_measurements, reduce_measurements

GOOD = """# a comment, with a comma
run,position [mm],mass flow [g/s],mass flow error [g/s],power [W],power error [mW],wall temperature [degC],\
wall temperature error [K],T at r = 0 mm [degC],T at r = 1.5 mm [degC],T(r = 3 mm) [degC],\
T at r=3.5 mm [K],T error [K],inlet temperature [degF],surface temperature [degC],\
surface temperature error [degC],notes of the day

a,640,1.6,0.01,50,100,90,0.5,76,77.5,81,356.15,0.2,86,30,1,all well
a,1260,1.6,0.01,48,100,131,0.5,117,118.5,122,397.15,0.2,,,,
b,640,2e0,0.01,60,100,90,0.5,76,,81,356.15,0.2,86,30,1,"said ""hot"", twice"
a,300,,,,,55,,,,,,,,31,1,
"""

MEAN = "position [m],mass flow [kg/s],voltage [V],current [A],mean temperature [K],wall temperature [K]\n"

BOTH = MEAN.strip() + ",T at r = 0 mm [K]\n0.6,2e-3,2.5,40,350,360,349\n"


@pytest.fixture
def write(tmp_path):
    def write(text, name="table.csv"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return tmp_path / name

    return write


def test_units_rows_and_runs(write):
    a, b = read_measurements(write(GOOD))
    assert (a.name, b.name) == ("a", "b")
    assert [row.position for row in a.rows] == pytest.approx([0.3, 0.64, 1.26])
    assert (a.mass_flow.value, a.mass_flow.error) == pytest.approx((1.6e-3, 1e-5))
    assert b.mass_flow.value == pytest.approx(2e-3)
    assert a.inlet_temperature.value == pytest.approx(303.15)
    between, station = a.rows[:2]
    assert not between.is_station
    assert between.wall_temperature.value == pytest.approx(328.15)
    assert between.wall_temperature.error == 0.0
    np.testing.assert_allclose(station.profile.radius, [0.0, 1.5e-3, 3e-3, 3.5e-3])
    np.testing.assert_allclose(station.profile.temperature, [349.15, 350.65, 354.15, 356.15])
    np.testing.assert_allclose(station.profile.error, 0.2)
    assert (station.power.value, station.power.error) == pytest.approx((50.0, 0.1))
    # an error in degrees Celsius is a difference
    assert station.surface_temperature.error == 1.0
    assert b.rows[0].profile.radius.size == 3
    assert a.rows[2].surface_temperature is None
    assert a.total_power is None


def test_one_run_is_named_after_the_file_and_power_may_be_voltage_times_current(write):
    (run,) = read_measurements(write(MEAN + "0.6,2e-3,2.5,40,350,360\n", "night.csv"))
    assert run.name == "night"
    assert run.rows[0].power.value == 100.0
    assert run.rows[0].mean_temperature.value == 350.0


def test_the_power_of_the_whole_length_is_one_for_the_run(write):
    rows = "0.6,2e-3,2.5,40,350,360\n0.9,,,,355,365\n"
    (run,) = read_measurements(write(MEAN + rows), heated_length=1.5)
    assert (run.total_power.value, run.heated_length) == (100.0, 1.5)
    with pytest.raises(BadFileError, match=r"line 3: power is not that of line 2, 100 against 120"):
        read_measurements(write(MEAN + rows.replace(",,,355", ",3,40,355")), heated_length=1.5)
    with pytest.raises(ValueError, match="heated_length is 0 m"):
        read_measurements(write(MEAN + rows), heated_length=0.0)


def test_a_table_is_read_with_byte_order_mark_crlf_and_gzip(write, tmp_path):
    import gzip

    (tmp_path / "b.csv").write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    (tmp_path / "c.csv.gz").write_bytes(gzip.compress(GOOD.encode()))
    for name in ("b.csv", "c.csv.gz"):
        assert [run.name for run in read_measurements(tmp_path / name)] == ["a", "b"]


def changed(old, new, text=GOOD):
    assert old in text
    return text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "is empty; expected a header"),
        ("# only a comment\n", "is empty; expected a header"),
        (MEAN, "has a header and no rows"),
        (changed("position [mm]", "positon [mm]"), "line 2: column 'positon .mm.' is not known .did you mean 'p"),
        (changed("position [mm]", "elephants [mm]"), "column 'elephants .mm.' is not known; expected run, position, "),
        (changed("position [mm]", "position"), "column 'position' has no unit; expected one in brackets"),
        (changed("position [mm]", "position [kg]"), "wrong kind of unit"),
        (changed("position [mm]", "position [smoot^9^9]"), "unknown unit"),
        (changed("T at r = 1.5 mm", "T at r = 1.5"), "is not a quantity"),
        (changed("T at r = 1.5 mm", "T at r = -1.5 mm"), "the radius is -0.0015 m; expected at least 0"),
        (changed("T at r = 1.5 mm", "T at r = 0 mm"), "columns .* are the same"),
        (changed("run,position [mm]", "run,note"), "no column 'position'"),
        (changed("mass flow [g/s],mass flow error [g/s]", "note,note 2"), "no column 'mass flow'"),
        (changed("power [W],power error [mW]", "note,note 2"), "no column 'power', and none of"),
        (changed("power error [mW]", "voltage [V]"), "power beside voltage or current"),
        (MEAN.replace("voltage [V],", "") + "0.6,2e-3,40,350,360\n", "voltage or current alone"),
        (MEAN.replace("mean temperature [K],", "") + "0.6,2e-3,2,40,360\n", "no temperature of the flow"),
        (changed("a,640,1.6", "a,640,x1.6"), r"line 4: mass flow \[g/s\] is 'x1.6'; expected a number"),
        (changed("surface temperature [degC]", "note 3"), "'surface temperature error' without 'surface temperature'"),
        (changed("a,640,1.6", "a,640,1e400"), "is '1e400'; expected a number"),
        (changed("a,640,1.6", "a,640,nan"), "is 'nan'; expected a number"),
        (changed("a,640,1.6", "a,640,-1.6"), "is '-1.6'; expected more than 0"),
        (changed("a,640,", "a,-640,"), "position .mm. is '-640'; expected at least 0"),
        (changed(",0.5,76,", ",-0.5,76,"), "wall temperature error .K. is '-0.5'; expected at least 0"),
        (changed(",0.5,76,", ",0.5,-300,"), "is '-300'; expected more than absolute zero"),
        (changed("356.15", "-3"), "is '-3'; expected more than 0"),
        (changed("a,640,", "a,,"), "line 4: position is empty"),
        (changed("a,1260,1.6,0.01,48", "a,1260,1.6,0.01"), "line 5: 16 fields; the header names 17 columns"),
        (changed("a,1260,1.6", "a,1260,1.7"), "line 5: mass flow is not that of line 4, 0.0016 against 0.0017"),
        (changed("a,1260", "a,640"), "line 5: position is 0.64 m again, as in line 4"),
        (MEAN + "0.6,,2.5,40,350,360\n", "line 2: run 'table' has no mass flow"),
        (MEAN + "0.6,2e-3,2.5,,350,360\n", "line 2: current is empty; expected voltage and current, or neither"),
        (BOTH, "line 2: a mean temperature beside readings across the tube"),
        ("x" * 200_000 + ",b\n", "field larger than field limit"),
        ('position [m],"unclosed\n' * 3, "is not known"),
        (MEAN.replace(",", ";"), "line 1: one column, 'position .m.;.*; expected several, parted by commas"),
    ],
)  # fmt: skip
def test_broken_tables_give_one_clear_error(write, text, match):
    path = write(text)
    with pytest.raises(BadFileError, match=match) as error:
        read_measurements(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 900


def test_no_power_for_the_whole_length(write):
    with pytest.raises(BadFileError, match="run 'table' has no power in any row"):
        read_measurements(write(MEAN + "0.6,2e-3,,,350,360\n"), heated_length=1.0)


def test_missing_files_and_folders(tmp_path):
    with pytest.raises(BadFileError, match="no such file"):
        read_measurements(tmp_path / "none.csv")
    with pytest.raises(BadFileError, match="is a folder"):
        read_measurements(tmp_path)
    (tmp_path / "binary.csv").write_bytes(bytes(range(256)) * 40)
    with pytest.raises(BadFileError, match=r"binary\.csv"):
        read_measurements(tmp_path / "binary.csv")


def test_what_cannot_be_reduced_names_file_and_run(write):
    path = write(GOOD)
    with pytest.raises(BadFileError, match=r"table.csv: run a: radius is 0.0035 m; expected at least 0 and at most"):
        reduce_measurements(path, Tube(6.9e-3), Properties(600.0, 0.3))
    hot = changed("a,640,1.6,0.01,50,100,90", "a,640,1.6,0.01,50,100,70")
    with pytest.raises(BadFileError, match=r"table.csv: run a: wall_temperature less mean_temperature is -"):
        reduce_measurements(write(hot), Tube(7.614e-3), Properties(600.0, 0.3))


def test_runs_come_out_in_the_order_of_the_table(write):
    found = reduce_measurements(write(GOOD), Tube(7.614e-3), Properties(600.0, 0.3), form="even", flux="section")
    assert [run.run.name for run in found] == ["a", "b"]
    assert [run.position.size for run in found] == [2, 1]


@pytest.mark.parametrize(
    "title", ["a" + " " * 100_000 + "b[c]d", " " * 100_000 + "[m] m", "T at r = " + " " * 100_000 + "("]
)
def test_a_title_of_blanks_takes_no_time(write, title):
    with pytest.raises(BadFileError, match=r"line 1: column .* is not known"):
        read_measurements(write(f"{title},mass flow [kg/s]\n1,2\n"))
