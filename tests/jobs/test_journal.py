from __future__ import annotations

import pytest

from bedrad.errors import BadFileError
from bedrad.jobs.journal import Journal
from oracles.small_files import small_files

ENTRIES = [b"first", b"", bytes(range(256)), b"last one"]


def written(path, entries=ENTRIES):
    journal = Journal(path)
    assert list(journal.entries()) == []
    for entry in entries:
        journal.append(entry)
    journal.close()
    return path.read_bytes()


def test_entries_come_back_in_order(tmp_path):
    written(tmp_path / "j")
    assert list(Journal(tmp_path / "j").entries()) == ENTRIES


def test_cut_off_at_any_byte_the_whole_entries_stay_and_more_can_follow(tmp_path):
    path = tmp_path / "j"
    content = written(path)
    for length in range(len(content) + 1):
        path.write_bytes(content[:length])
        journal = Journal(path)
        kept = list(journal.entries())
        assert kept == ENTRIES[: len(kept)]
        journal.append(b"more")
        journal.close()
        assert list(Journal(path).entries()) == [*kept, b"more"]
    assert kept == ENTRIES


def test_a_changed_bit_ends_what_is_believed(tmp_path):
    path = tmp_path / "j"
    content = written(path)
    start = len(b"bedrad journal 1\n")
    for place in range(start, len(content)):
        path.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
        kept = list(Journal(path).entries())
        assert kept == ENTRIES[: len(kept)]
        assert len(kept) < len(ENTRIES)


def test_something_else_is_refused_and_left_alone(tmp_path):
    (tmp_path / "j").write_text("notes of mine")
    with pytest.raises(BadFileError, match="not a journal of bedrad"):
        list(Journal(tmp_path / "j").entries())
    assert (tmp_path / "j").read_text() == "notes of mine"


def test_a_write_that_does_not_fit_leaves_the_entries_before(tmp_path):
    journal = Journal(tmp_path / "j")
    assert list(journal.entries()) == []
    journal.append(bytes(3000))
    with small_files(4096), pytest.raises(OSError, match=r"cannot write: File too large: '.*j'"):
        journal.append(bytes(3000))
    journal.append(b"small")
    journal.close()
    assert list(Journal(tmp_path / "j").entries()) == [bytes(3000), b"small"]


def test_a_journal_that_is_done_with_is_removed(tmp_path):
    journal = Journal(tmp_path / "j")
    journal.remove()
    journal.append(b"x")
    journal.remove()
    assert not (tmp_path / "j").exists()


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"cannot write: .*nowhere/j"):
        Journal(tmp_path / "nowhere" / "j").append(b"x")
