from __future__ import annotations

import json
import os
import re
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import bedrad
from bedrad.errors import BadFileError
from bedrad.jobs.job import load_job, parse_job

ROOT = Path(__file__).parents[2]
HOT_TUBE = ROOT / "examples" / "hot_tube.toml"

TUBE = '[wall]\ndiameter = "7.75 mm"\n'
ROD = '[wall]\nshape = "rod"\ndiameter = "1 mm"\n'
PLATE = '[wall]\nshape = "plate"\n'
SETTLE = '[packing.settle]\ndiameter = "0.6 mm"\nheight = "18 mm"\n'
FILE = '[packing.file]\npath = "bed.h5"\n'
PREDICTION = '[prediction]\nvelocity = "0.016 m/s"\nwall_temperatures = ["850 degC"]\n'


def parse(text, file="jobs/a.toml"):
    return parse_job(text, Path(file))


def refusal(text):
    with pytest.raises(BadFileError) as error:
        parse(text)
    return str(error.value)


def test_the_job_of_the_demo_says_what_it_should():
    job = load_job(HOT_TUBE)
    assert job.wall.build() == bedrad.Tube(7.75e-3 / 2)
    assert job.packing.settle.diameter == pytest.approx(600e-6, rel=1e-15)
    # at least 25 diameters tall
    assert job.packing.settle.height >= 25 * job.packing.settle.diameter
    assert {name for name in ("statistics", "view_factors", "convergence", "prediction") if getattr(job, name)} == {
        "statistics",
        "view_factors",
        "convergence",
        "prediction",
    }
    temperatures = job.prediction.wall_temperatures.values()
    assert temperatures[0] == pytest.approx(373.15, rel=1e-15)
    assert temperatures[-1] == pytest.approx(1373.15, rel=1e-15)
    assert len(temperatures) == 21
    assert job.prediction.published_systems
    assert job.output.tables
    assert job.output.figures


def test_defaults_are_filled_in_and_the_resolved_job_holds_si_numbers():
    job = parse(FILE)
    assert (job.seed, job.layers.count, job.wall, job.statistics) == (0, 3, None, None)
    resolved = json.loads(parse(TUBE + SETTLE).resolved())
    assert resolved["wall"]["diameter"] == 7.75e-3
    assert resolved["packing"]["settle"]["density"] == 3800.0
    assert resolved["layers"] == {"count": 3, "margin": 4.0}


def test_walls_are_built_from_their_section():
    assert parse(TUBE + FILE).wall.build() == bedrad.Tube(3.875e-3)
    assert parse(ROD + FILE).wall.build() == bedrad.Rod(0.5e-3)
    assert parse(PLATE + FILE).wall.build() == bedrad.Plate()


def test_one_temperature_and_a_period_of_one_or_two_lengths():
    text = PREDICTION.replace('["850 degC"]', '{ lowest = "500 K", highest = "900 K", count = 1 }')
    assert parse(FILE + text).prediction.wall_temperatures.values() == [500.0]
    assert parse(FILE + 'period = "1 m"').packing.file.period == 1.0
    assert parse(FILE + 'period = ["1 m", "2 m"]').packing.file.period == (1.0, 2.0)


def test_a_relative_path_counts_from_the_folder_of_the_job(tmp_path):
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "job.toml").write_text(FILE)
    assert load_job(tmp_path / "deep" / "job.toml").packing.file.path == tmp_path / "deep" / "bed.h5"
    assert parse(FILE.replace("bed.h5", "/data/bed.h5")).packing.file.path == Path("/data/bed.h5")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("sede = 1\n" + FILE, "sede: unknown key; did you mean 'seed'?"),
        (FILE + 'diametre = "1 mm"\n', "packing.file.diametre: unknown key; did you mean 'diameter'?"),
        (FILE + "[view_factor]\nrays = 1\n", "view_factor: unknown key; did you mean 'view_factors'?"),
        (FILE + "[layers]\nqqq = 1\n", "layers.qqq: unknown key; known here: count, margin"),
        (
            TUBE + '[packing.settle]\nheight = "1 mm"\nsizes = [{ diameter = "1 mm", share = 1.0, shar = 1.0 }]\n',
            "packing.settle.sizes.0.shar: unknown key; did you mean 'share'?",
        ),
        (
            FILE + PREDICTION.replace('["850 degC"]', '{ lowest = "1 K", highest = "2 K", cuont = 3 }'),
            "prediction.wall_temperatures.cuont: unknown key; did you mean 'count'?",
        ),
        (
            FILE + "columns = { x = 1, raduis = 4 }\n",
            "packing.file.columns.raduis: unknown key; did you mean 'radius'?",
        ),
        (FILE + 'units = "mm"\n', "packing.file.units: unknown key; did you mean 'unit'?"),
        (FILE + 'wallunit = "mm"\n', "packing.file.wallunit: unknown key; did you mean 'wall_unit'?"),
        (FILE + "overlap = 0.2\n", "packing.file.overlap: unknown key; did you mean 'max_overlap'?"),
        ('"a\\nb" = 1\n' + FILE, '"a\\nb": unknown key; known here: convergence, layers, name'),
        ('"<list>" = 1\n' + FILE, '"<list>": unknown key; known here: '),
    ],
)
def test_an_unknown_key_is_refused_by_name_with_the_nearest_known_one(text, message):
    found = refusal(text)
    assert found.startswith(f"jobs/a.toml: {message}")
    assert "\n" not in found


@pytest.mark.parametrize(
    ("text", "field", "value"),
    [
        (TUBE.replace("7.75 mm", "7.75 K") + FILE, "wall.diameter", "'7.75 K'"),
        (TUBE.replace('"7.75 mm"', "7.75") + FILE, "wall.diameter", "7.75"),
        (TUBE.replace("7.75 mm", "-7.75 mm") + FILE, "wall.diameter", "'-7.75 mm'"),
        ('[wall]\nshape = "cube"\n' + FILE, "wall.shape", "'cube'"),
        ('wall = "tube"\n' + FILE, "wall", "'tube'"),
        ("packing = [1]\n", "packing", "[1]"),
        ("name = 3\n" + FILE, "name", "3"),
        (f'name = "{"x" * 201}"\n' + FILE, "name", "'xxxx"),
        ("seed = 1.0\n" + FILE, "seed", "1.0"),
        ("seed = true\n" + FILE, "seed", "True"),
        ("seed = -1\n" + FILE, "seed", "-1"),
        (f"seed = {2**63}\n" + FILE, "seed", str(2**63)),
        ("[packing.file]\npath = 3\n", "packing.file.path", "3"),
        (FILE + "frame = 0.5\n", "packing.file.frame", "0.5"),
        (FILE + 'period = "1 s"\n', "packing.file.period", "'1 s'"),
        (FILE + 'period = ["1 m", "-2 m"]\n', "packing.file.period.1", "'-2 m'"),
        (FILE + 'period = ["1 m"]\n', "packing.file.period.1", "['1 m']"),
        (FILE + 'period = ["1 m", "1 m", "1 m"]\n', "packing.file.period", "['1 m', '1 m', '1 m']"),
        (FILE + 'period = "-1 m"\n', "packing.file.period", "'-1 m'"),
        (FILE + 'unit = "furlong"\n', "packing.file.unit", "'furlong'"),
        (FILE + "unit = 1e-3\n", "packing.file.unit", "0.001"),
        (FILE + 'wall = "cone"\n', "packing.file.wall", "'cone'"),
        (FILE + 'wall = "tube.obj"\n', "packing.file.wall", "'tube.obj'"),
        (FILE + "wall = 7.75e-3\n", "packing.file.wall", "0.00775"),
        (FILE + 'axis = "u"\n', "packing.file.axis", "'u'"),
        (FILE + "axis = [0, 0, 0]\n", "packing.file.axis", "[0, 0, 0]"),
        (FILE + "axis = [0, nan, 1]\n", "packing.file.axis.1", "nan"),
        (FILE + 'axis = ["0", 0, 1]\n', "packing.file.axis.0", "'0'"),
        (FILE + 'origin = [0, "0 m", "0 m"]\n', "packing.file.origin.0", "0"),
        (FILE + 'origin = "0 m"\n', "packing.file.origin", "'0 m'"),
        (FILE + "max_overlap = -0.1\n", "packing.file.max_overlap", "-0.1"),
        (FILE + "columns = 3\n", "packing.file.columns", "3"),
        (FILE + "columns = { x = 0 }\n", "packing.file.columns.x", "0"),
        (FILE + "columns = { x = true }\n", "packing.file.columns.x", "True"),
        (FILE + 'columns = { x = " " }\n', "packing.file.columns.x", "' '"),
        (FILE + f'columns = {{ x = "{"x" * 201}" }}\n', "packing.file.columns.x", "'xxxx"),
        (TUBE + SETTLE + 'friction = "0.4"\n', "packing.settle.friction", "'0.4'"),
        (TUBE + SETTLE + "friction = nan\n", "packing.settle.friction", "nan"),
        (TUBE + SETTLE + "restitution = 1.5\n", "packing.settle.restitution", "1.5"),
        (TUBE + SETTLE + "ranks = 0\n", "packing.settle.ranks", "0"),
        (TUBE + SETTLE + "sizes = 3\n", "packing.settle.sizes", "3"),
        (TUBE + '[packing.settle]\nheight = "1 mm"\nsizes = [3]\n', "packing.settle.sizes.0", "3"),
        (FILE + "[layers]\ncount = 10001\n", "layers.count", "10001"),
        (FILE + "[layers]\nmargin = inf\n", "layers.margin", "inf"),
        (FILE + "[statistics]\ncontact_gap = -0.1\n", "statistics.contact_gap", "-0.1"),
        (FILE + "[view_factors]\nrays = 1e6\n", "view_factors.rays", "1000000.0"),
        (FILE + "[view_factors]\ntolerance = 0\n", "view_factors.tolerance", "0"),
        (FILE + "[convergence]\nseeds = 1\n", "convergence.seeds", "1"),
        (FILE + PREDICTION.replace('["850 degC"]', '"850 degC"'), "prediction.wall_temperatures", "'850 degC'"),
        (FILE + PREDICTION.replace("850 degC", "850 mm"), "prediction.wall_temperatures.0", "'850 mm'"),
        (FILE + PREDICTION.replace("850 degC", "-300 degC"), "prediction.wall_temperatures.0", "'-300 degC'"),
        (FILE + PREDICTION.replace('"850 degC"', '"1 K",' * 1001), "prediction.wall_temperatures", "['1 K', '1 K'"),
        (FILE + PREDICTION + "emissivity = 1.1\n", "prediction.emissivity", "1.1"),
        (FILE + PREDICTION + 'bulk = "zbss"\n', "prediction.bulk", "'zbss'"),
        (FILE + PREDICTION + 'heat_flux = "5 kW"\n', "prediction.heat_flux", "'5 kW'"),
        (FILE + PREDICTION + 'properties = "film"\n', "prediction.properties", "'film'"),
        (FILE + PREDICTION + "errors = { porosity = -0.1 }\n", "prediction.errors.porosity", "-0.1"),
        (
            FILE + PREDICTION + 'errors = { wall_temperature = "5 degC" }\n',
            "prediction.errors.wall_temperature",
            "5 degC",
        ),
        (FILE + '[output]\ntables = "yes"\n', "output.tables", "'yes'"),
        (FILE + "[output]\nfigures = 1\n", "output.figures", "1"),
    ],
)
def test_a_wrong_value_is_one_line_with_field_and_value(text, field, value):
    found = refusal(text)
    assert found.startswith(f"jobs/a.toml: {field}: ")
    assert value in found
    assert "\n" not in found


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("[packing.file]\n", "packing.file.path"),
        (TUBE + '[packing.settle]\ndiameter = "1 mm"\n', "packing.settle.height"),
        (FILE + '[prediction]\nvelocity = "1 m/s"\n', "prediction.wall_temperatures"),
        (FILE + '[prediction]\nwall_temperatures = ["1 K"]\n', "prediction.velocity"),
        (FILE + PREDICTION.replace('["850 degC"]', '{ lowest = "1 K" }'), "prediction.wall_temperatures.highest"),
    ],
)
def test_a_missing_key_is_named(text, field):
    assert refusal(text) == f"jobs/a.toml: {field}: required, and not there"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "job: nothing to do: give a [packing] or a [prediction]"),
        (TUBE, "job: nothing to do: give a [packing] or a [prediction]"),
        ("[packing]\n", "packing: give one source of the bed, [packing.settle], [packing.flow] or [packing.file]"),
        (
            TUBE + SETTLE + FILE,
            "packing: give one source of the bed, [packing.settle], [packing.flow] or [packing.file]",
        ),
        (SETTLE, "job: [packing.settle] needs a [wall]"),
        (ROD + SETTLE, "job: [packing.settle] is for a tube; the wall is a rod"),
        (PLATE + SETTLE, "job: [packing.settle] is for a tube; the wall is a plate"),
        ('[wall]\nshape = "tube"\n' + FILE, "wall: a tube takes a diameter"),
        (PLATE + 'diameter = "1 mm"\n' + FILE, "wall: a plate takes no diameter"),
        (
            TUBE + SETTLE + 'sizes = [{ diameter = "1 mm", share = 1.0 }]\n',
            "packing.settle: give a diameter or sizes, one of the two",
        ),
        (
            TUBE + '[packing.settle]\nheight = "1 mm"\n',
            "packing.settle: give a diameter or sizes, one of the two",
        ),
        (
            TUBE + '[packing.settle]\nheight = "1 mm"\nsizes = []\n',
            "packing.settle: give a diameter or sizes, one of the two",
        ),
        (TUBE + "[statistics]\n", "job: [statistics] needs a [packing]"),
        (TUBE + "[view_factors]\n", "job: [view_factors] needs a [packing]"),
        (TUBE + "[convergence]\n", "job: [convergence] needs a [packing]"),
        (FILE + "[view_factors]\nrays = 64\ntolerance = 1e-3\n", "view_factors: give tolerance or rays, not both"),
        (
            FILE + "[convergence]\nrays = 1024\nreference_rays = 4096\n",
            "convergence: reference_rays is 4096; expected at least 16 times rays, 16384",
        ),
        (ROD + FILE + PREDICTION, "job: [prediction] is for flow in a tube; the wall is a rod"),
        (PLATE + FILE + PREDICTION, "job: [prediction] is for flow in a tube; the wall is a plate"),
        (
            FILE + 'wall = "rod"\n' + PREDICTION,
            "job: [prediction] is for flow in a tube; the wall is a rod",
        ),
        (TUBE + FILE + 'wall = "tube"\n', "job: give the wall by a [wall] or by packing.file.wall, not both"),
        (FILE + 'wall_unit = "mm"\n', "packing.file: wall_unit is for a wall from an .stl file"),
        (FILE + 'wall = "rod"\nwall_unit = "mm"\n', "packing.file: wall_unit is for a wall from an .stl file"),
        (
            FILE + 'wall = "rod"\norigin = ["0 m", "0 m", "0 m"]\n',
            "packing.file: where the rod is will be fitted; origin is for the wall of a [wall]",
        ),
        (
            FILE + 'wall = "w.stl"\naxis = "x"\n',
            "packing.file: the .stl file says where the wall is; axis and origin are for other walls",
        ),
        (TUBE + PREDICTION, "job: [prediction] without a [packing] needs a [wall] and a particle_diameter"),
        (
            PREDICTION + 'particle_diameter = "1 mm"\n',
            "job: [prediction] without a [packing] needs a [wall] and a particle_diameter",
        ),
        (
            FILE + PREDICTION.replace('["850 degC"]', "[]"),
            "prediction: wall_temperatures is an empty list; give a temperature, such as '850 degC'",
        ),
        (
            FILE + PREDICTION + 'properties = "layers"\n',
            "prediction: properties 'layers' needs a heat_flux, which parts mean and wall temperature",
        ),
    ],
)
def test_sections_that_contradict_each_other_are_refused(text, message):
    assert refusal(text) == f"jobs/a.toml: {message}"


def test_every_problem_of_a_job_is_told_in_a_line_of_its_own():
    found = refusal("sede = 1\n" + TUBE.replace("mm", "K") + FILE + "frame = true\n").splitlines()
    assert sorted(line.split(": ")[1] for line in found) == ["packing.file.frame", "sede", "wall.diameter"]


@pytest.mark.parametrize(
    "text",
    [
        "a = = 1",
        "seed = 1\nseed = 2",
        "[packing",
        "a = " + "[" * 5000,
        "seed = " + "9" * 5000,
        "when = 2020-99-99",
        "\0",
    ],
)
def test_what_is_not_toml_is_said_to_be_so(text):
    assert refusal(text).startswith("jobs/a.toml: not a TOML file: ")


def test_a_file_that_cannot_be_read_is_named(tmp_path):
    with pytest.raises(BadFileError, match=r"nowhere\.toml: no such job file$"):
        load_job(tmp_path / "nowhere.toml")
    with pytest.raises(BadFileError, match=r"cannot be read as a text file: .*Is a directory"):
        load_job(tmp_path)
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BadFileError, match=r"binary\.toml: cannot be read as a text file: 'utf-8' codec"):
        load_job(tmp_path / "binary.toml")


LINES = HOT_TUBE.read_text(encoding="utf-8").splitlines()

values = st.one_of(
    st.integers(-3, 3).map(str),
    st.floats().map(lambda x: repr(x)),
    st.sampled_from(["true", '""', '"1 m"', '"1 degC"', "[]", "{}", '["1 K"]', '{ diameter = "1 m" }', "1979-05-27"]),
    st.text(max_size=8).map(json.dumps),
)


@st.composite
def mutated_jobs(draw):
    """The job of the demo with lines left out, doubled, cut, or given another value."""
    lines = list(LINES)
    for _ in range(draw(st.integers(1, 4))):
        i = draw(st.integers(0, len(lines) - 1))
        key = lines[i].split("=")[0]
        change = draw(st.sampled_from(["drop", "double", "cut", "value", "key", "section", "insert"]))
        if change == "drop" and len(lines) > 1:
            del lines[i]
        elif change == "double":
            lines.insert(draw(st.integers(0, len(lines))), lines[i])
        elif change == "cut":
            lines[i] = lines[i][: draw(st.integers(0, len(lines[i])))]
        elif change == "value":
            lines[i] = f"{key}= {draw(values)}"
        elif change == "key":
            lines[i] = lines[i].replace(key.strip(), json.dumps(draw(st.text(max_size=8))))
        elif change == "section":
            sections = ["[packing.file]", "[packing]", "[wall]", "[output]", "[job]", "[[wall]]", "[prediction.bulk]"]
            lines[i] = draw(st.sampled_from(sections))
        else:
            lines.insert(i, draw(st.text(max_size=20)))
    return "\n".join(lines)


@given(mutated_jobs())
@example('name = "\\u0000"\n' + FILE)
def test_a_mutated_job_is_a_job_or_a_bad_file(text):
    try:
        job = parse(text)
    except BadFileError as error:
        assert all(line.startswith("jobs/a.toml: ") for line in str(error).splitlines())  # noqa: PT017
    else:
        json.loads(job.resolved())


@pytest.mark.parametrize(
    ("layers", "message"),
    [("count = 8", "layers.count is 8: the last layer would end"), ("margin = 16", "layers.margin is 16: leaving out")],
)
def test_layers_and_ends_that_the_settled_bed_has_no_room_for(layers, message):
    text = (
        '[wall]\ndiameter = "7.75 mm"\n[packing.settle]\ndiameter = "0.6 mm"\nheight = "18 mm"\n'
        f"[statistics]\n[layers]\n{layers}\n"
    )
    with pytest.raises(BadFileError, match=re.escape(message)):
        parse_job(text, Path("job.toml"))


def test_a_job_that_never_ends_is_refused(tmp_path):
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    with pytest.raises(BadFileError, match="is a pipe or a device; expected a text file"):
        load_job(pipe)
    large = tmp_path / "large.toml"
    large.write_text("#" * 70_000)
    with pytest.raises(BadFileError, match="has 70000 bytes; a job has at most 65536"):
        load_job(large)


def test_of_many_problems_some_are_told():
    found = refusal("".join(f"key{k} = 1\n" for k in range(500)) + FILE)
    assert len(found.splitlines()) == 21
    assert found.endswith("and 480 more problems")
