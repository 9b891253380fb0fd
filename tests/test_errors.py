"""What stands in an error that names a file: on the screen, nothing that a file should steer."""

from __future__ import annotations

import pickle

import pytest

from bedrad.errors import BadFileError, visible


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("x [mm], µ, é, 球", "x [mm], µ, é, 球"),
        ("\x1b[31mred", r"\x1b[31mred"),
        ("a\r\nb\t\0\x9b", r"a\r\nb\t\x00\x9b"),
        ("\u202egpj.exe", r"\u202egpj.exe"),
        ("\udcff", r"\udcff"),
    ],
)
def test_signs_that_steer_a_terminal_are_written_as_escapes(text: str, shown: str) -> None:
    assert visible(text) == shown
    assert shown.isprintable()


def test_an_error_shows_its_lines_and_nothing_else() -> None:
    error = BadFileError("job.toml: a\x1b[2J\njob.toml: b")
    assert str(error) == "job.toml: a\\x1b[2J\njob.toml: b"
    assert str(pickle.loads(pickle.dumps(error))) == str(error)
