"""The command that reduces measured flows: what it prints, writes, draws and refuses."""

import builtins
import csv
import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.filterwarnings("default::bedrad.heat.RangeWarning")

TABLE = Path(__file__).parents[1] / "examples" / "measured_flow.csv"
TUBE = ("--tube", "7.614mm", "--outer", "9.53mm", "--heated-length", "1.57m")
WOOL = ("--insulation", "25 mm: 0.09 W/(m K)", "--insulation", "70 mm: 0.05 W/(m K)", "--instrument", "0.004")
ALL = (*TUBE, *WOOL, "--diameter", "270um")


@pytest.fixture
def table(tmp_path):
    (tmp_path / "flow.csv").write_text(TABLE.read_text(encoding="utf-8"), encoding="utf-8")
    return tmp_path / "flow.csv"


def test_one_screen(call, table):
    code, out, err = call("reduce", table, *ALL)
    assert code == 0
    # the flow enters colder than its specific heat was measured
    assert all(line.startswith("warning: specific heat of zirconia-silica") for line in err)
    lines = out.splitlines()
    assert len(lines) <= 45
    assert max(len(line.rstrip()) for line in lines) <= 80
    assert "…" not in out
    assert re.search(r"A, 0\.64 +250 ± 13 +5\.0 +6\.21 ± 0\.75", out)
    assert "standard error 5.6 %" in out
    assert list(table.parent.iterdir()) == [table]


def test_a_table_that_is_missing_or_broken_is_told_before_what_else_is_wanted(refused, table):
    for words in ((), ("--diameter", "123um"), ("--bulk-conductivity", "0.3 W/(m K)", "--instrument", "7")):
        assert refused(2, "reduce", "nowhere.csv", *TUBE, *words).startswith("nowhere.csv: ")
    broken = table.with_name("broken.csv")
    broken.write_text(table.read_text().replace("position [m]", "place [m]"))
    assert refused(2, "reduce", broken, *TUBE).startswith(f"{broken}, line 5: column 'place [m]' is not known")
    assert refused(2, "reduce", table, *TUBE).startswith("give --diameter")


def test_table_and_figure(call, table, tmp_path):
    code, out, _ = call("reduce", table, *ALL, "-o", tmp_path / "out.csv")
    assert code == 0
    assert out.splitlines()[-2:] == [f"wrote {tmp_path / 'out.csv'}", f"wrote {tmp_path / 'out.png'}"]
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
    with (tmp_path / "out.csv").open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["run"] for row in rows] == list("AABBCC")
    assert float(rows[0]["model Nusselt number at z* [1]"]) == pytest.approx(6.72, abs=0.02)
    assert float(rows[0]["velocity [m/s]"]) == pytest.approx(0.015, rel=0.01)


def nusselts(call, tmp_path, table, *options):
    code, _, _ = call("reduce", table, *options, "-o", tmp_path / "n.csv")
    assert code == 0
    with (tmp_path / "n.csv").open(newline="", encoding="utf-8") as stream:
        return [float(row["Nusselt number [1]"]) for row in csv.DictReader(stream)]


def test_options_reach_the_reduction(call, table, tmp_path, monkeypatch):
    monkeypatch.setattr("bedrad.report.measured_figure.write_measured_figure", lambda *_: None)
    usual = nusselts(call, tmp_path, table, *ALL)
    # the mean loss of a section is smaller than that at its end, and the flux larger
    assert nusselts(call, tmp_path, table, *ALL, "--flux", "section")[0] > 1.03 * usual[0]
    # twice the drop in the wall: a smaller difference, a larger h
    assert nusselts(call, tmp_path, table, *ALL, "--heating", "conducted")[0] > usual[0]
    assert nusselts(call, tmp_path, table, *ALL, "--profile", "even")[0] != usual[0]
    given = nusselts(call, tmp_path, table, *TUBE, *WOOL, "--bulk-conductivity", "0.62 W/(m K)",
                     "--specific-heat", "600 J/(kg K)")  # fmt: skip
    assert given[0] == pytest.approx(usual[0] * 0.3062 / 0.62, rel=1e-3)


def test_without_matplotlib_the_table_is_written_and_the_figure_told(call, table, tmp_path, monkeypatch):
    found = builtins.__import__

    def missing(name, *rest, **options):
        if name.partition(".")[0] == "matplotlib":
            raise ImportError(name)
        return found(name, *rest, **options)

    monkeypatch.setattr(builtins, "__import__", missing)
    code, out, _ = call("reduce", table, *ALL, "-o", tmp_path / "out.csv")
    assert code == 0
    assert 'pip install "bedrad[view]"' in out.splitlines()[-1]
    assert (tmp_path / "out.csv").exists()
    assert not (tmp_path / "out.png").exists()


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ((*TUBE,), "give --diameter, for the fits of the bulk conductivity and the model, or --bulk-conductivity"),
        ((*TUBE, "--diameter", "500um"), "zirconia-silica of 500 um; give --bulk-conductivity"),
        (("--tube", "7.614mm", *WOOL, "--diameter", "270um"), "--insulation needs --outer"),
        ((*ALL, "--insulation", "3 mm"), "expected a thickness and a conductivity"),
        ((*ALL, "--insulation", "3 mm: 4 W"), "wrong kind of unit"),
        ((*TUBE, "--diameter", "270um", "--instrument", "4"), "--instrument is 4; expected a share from 0 to below 1"),
        ((*ALL, "--bulk-conductivity-error", "-1"), "bulk_conductivity_error is -1"),
        (("--tube", "7.614mm", "--outer", "5mm", "--diameter", "270um"), "outer_diameter is 0.005 m; expected more"),
        (("--tube", "6 mm", "--heated-length", "1.57m", "--diameter", "270um"), "radius is 0.0035 m"),
        (("--tube", "7.614", "--diameter", "270um"), "'7.614' is not a quantity"),
        ((*ALL, "--profile", "cubic"), "cubic"),
        ((*ALL, "--developed-from=-1m"), "developed_from is -1 m"),
        ((*ALL, "-o", "out.txt"), "results are written as .csv"),
        (("--tube", "7.614mm", "--diameter", "270um"), "no power is given for the section that ends at 0.64 m"),
    ],
)
def test_wrong_options(refused, table, options, match):
    assert match in refused(2, "reduce", table, *options)


def test_the_table_itself_is_not_overwritten(refused, table):
    before = table.read_bytes()
    assert "is the table itself" in refused(2, "reduce", table, *ALL, "-o", table)
    assert table.read_bytes() == before


def test_broken_tables_and_places(refused, table, tmp_path):
    assert "no such file" in refused(2, "reduce", tmp_path / "none.csv", *ALL)
    table.write_text(TABLE.read_text(encoding="utf-8").replace("wall temperature [degC]", "wall temprature [degC]"))
    assert "did you mean 'wall temperature'" in refused(2, "reduce", table, *ALL)
    assert "cannot write" in refused(1, "reduce", TABLE, *ALL, "-o", table / "out.csv")
