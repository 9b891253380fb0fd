"""What files say stands on the screen as text: it steers no terminal, has no style and leads nowhere."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from rich.console import Group
from rich.progress import Progress, TextColumn
from rich.segment import Segment
from rich.text import Text

import bedrad
from bedrad import command_options
from bedrad.command_options import fail, list_files, progress_bars, say, warning_printer
from bedrad.jobs.ensemble_store import EnsembleStore
from bedrad.jobs.members import Failure, Member
from bedrad.jobs.results import Results
from bedrad.jobs.unit_record import StageRecord, UnitRecord, pack
from bedrad.report.ensemble_screen import summary as summary_of_many
from bedrad.report.terminal import add_row, new_table, summary
from bedrad.screen import Screen
from jobs.small_job import ring_bed

HOSTILE = "a\x1b]0;owned\x07\x1b[2J\r\x9b31m\u202eb [bold]c[/bold] [link=file:///etc]d[/link] :warning:"
SHOWN = r"a\x1b]0;owned\x07\x1b[2J\r\x9b31m\u202eb [bold]c[/bold] [link=file:///etc]d[/link] :warning:"


def harmless(text):
    """Whether lines hold nothing but signs that can be seen."""
    return all(line.isprintable() for line in text.split("\n"))


@pytest.fixture
def screen(monkeypatch):
    """A wide terminal, in the place of which a text keeps what is sent to it."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "300")
    made = Screen()
    made.file = io.StringIO()
    assert made.is_terminal
    return made


def sent(screen):
    """What was sent, without the bold type that rich itself asks for."""
    return re.sub(r"\x1b\[[013]?m", "", screen.file.getvalue())


def test_a_text_is_shown_and_not_obeyed(screen):
    screen.print(HOSTILE)
    assert harmless(sent(screen))
    assert r"a\x1b]0;owned" in sent(screen)
    assert "[bold]c[/bold] [link=file:///etc]d[/link] :warning:" in sent(screen)


def test_no_cell_title_caption_or_line_is_obeyed(screen):
    table = new_table(HOSTILE, HOSTILE, HOSTILE)
    add_row(table, HOSTILE, HOSTILE)
    table.add_row(Text(HOSTILE), HOSTILE)
    table.caption = Text(HOSTILE)
    screen.print(Group(Text(HOSTILE), table))
    assert harmless(sent(screen))
    assert sent(screen).count("owned") == 9


def test_what_steers_the_bars_goes_through(screen):
    with Progress(TextColumn("{task.fields[note]}", markup=False), console=screen) as bars:
        task = bars.add_task("", total=1.0, note=HOSTILE)
        bars.update(task, completed=1.0)
    text = screen.file.getvalue()
    assert "\x1b[?25l" in text  # the cursor is hidden, by rich
    assert "[bold]c[/bold]" in text
    assert not {"\x1b]", "\x1b[2J", "\x9b", "\u202e"} & {text[k : k + n] for k in range(len(text)) for n in (1, 2, 4)}


def test_a_segment_that_is_not_text_is_none_of_our_business(screen):
    control = Segment("\x1b[1A", None, [(1,)])

    class Moves:
        def __rich_console__(self, *_):
            yield control

    assert list(screen.render(Moves())) == [control]


def test_lines_files_warnings_and_errors(capsys):
    say(HOSTILE)
    list_files([Path(f"folder/{HOSTILE}\nwrote x".replace("///", "/"))])
    warning_printer()(UserWarning(f"{HOSTILE} twice"))
    assert fail(f"{HOSTILE}\nmore", 2) == 2
    assert fail(OSError(2, "No such file", f"{HOSTILE}\nmore"), 1) == 1
    out, err = capsys.readouterr()
    assert out.splitlines() == [SHOWN, rf"wrote folder/{SHOWN}\nwrote x".replace("///", "/")]
    assert err.splitlines() == [
        f"warning: {SHOWN} twice".replace(r"\r", " "),  # a warning is one line
        f"bedrad: {SHOWN}",
        "more",
        rf"bedrad: {SHOWN}\nmore: No such file",
    ]


def test_the_notes_of_the_bars_are_texts(monkeypatch, screen):
    monkeypatch.setattr(command_options, "NOTES", screen)
    with progress_bars() as report:
        report("ensemble", 0.5, HOSTILE)
    assert "[bold]c[/bold]" in screen.file.getvalue()
    assert "\x1b]" not in screen.file.getvalue()


def test_the_end_of_a_job_with_a_hostile_name_and_titles(fabricate, screen):
    def change(prediction):
        _, _, case = prediction.pop("configuration_2")
        prediction[f"x{HOSTILE.replace('/', '')}"] = (HOSTILE, HOSTILE, case)

    def left(data):
        data["names"] = [HOSTILE] * 6

    made = fabricate("view_factors").add("convergence", left).add("prediction", change)
    with h5py.File(made.results.path, "r+") as file:
        job = json.loads(file.attrs["job"]) | {"name": HOSTILE}
        file.attrs["job"] = json.dumps(job)
        file["view_factors"].attrs["left_out"] = HOSTILE
    screen.print(summary(made.results))
    assert harmless(sent(screen))
    assert sent(screen).count(SHOWN) >= 3
    assert sent(screen).splitlines()[0].rstrip() == SHOWN


def test_the_end_of_a_run_on_many_beds(tmp_path, screen):
    store, key = EnsembleStore(tmp_path / "r.h5"), "0" * 64
    data = {"packing_fraction": np.array(0.4), "packing_fraction_error": np.array(0.02)}
    store.add(pack(UnitRecord(key, {"statistics": StageRecord("s", data)}, (HOSTILE.replace("\r", ""),), 0.5)))
    member = Member(HOSTILE, key, {"statistics": "s"}, 9, values={"seed": 1})
    store.merge([member], [Failure(HOSTILE, HOSTILE)], {"job": json.dumps({"name": HOSTILE}), "inputs": "{}"})
    screen.print(summary_of_many(Results(tmp_path / "r.h5")))
    assert harmless(sent(screen))
    assert sent(screen).splitlines()[0].rstrip() == SHOWN
    assert "1 bed warns: a" in sent(screen)


def hostile_bed(folder):
    """A bed whose file says more than it should, in a file of such a name."""
    bed = ring_bed()
    notes = {"made_by": HOSTILE, f"key{HOSTILE}".replace("/", ""): "x\nwrote nothing"}
    path = folder / f"bed{HOSTILE}.h5".replace("/", "")
    bedrad.write(bedrad.Packing(bed.centers, bed.radii, bed.wall, period=bed.period, provenance=notes), path)
    return path


@pytest.mark.parametrize(
    "words",
    [
        ("convert", "BED", "OUT.vtp"),
        ("convert", "BED", "OUT.vtp", "--all-frames"),
        ("statistics", "BED", "-o", "OUT.h5"),
        ("statistics", "BED", "BED"),
        ("view-factors", "BED", "--rays", "4096", "-o", "OUT.h5"),
        ("convergence", "BED.none"),
        ("show", "BED", "--vtp", "OUT"),
        ("report", "BED"),
        ("run", "BED"),
        ("reduce", "BED", "--tube", "8mm", "--diameter", "270um"),
    ],
    ids=" ".join,
)
def test_no_command_lets_a_file_steer_the_terminal(call, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    bed = str(hostile_bed(tmp_path))
    out = str(tmp_path / f"out{HOSTILE}".replace("/", ""))
    _, said, told = call(*(word.replace("BED", bed).replace("OUT", out) for word in words))
    assert harmless(said)
    assert harmless("\n".join(told))
    assert "owned" in said + "".join(told)
    assert "wrote nothing" not in said.splitlines()
