"""A file is there whole or not at all."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

import pytest

from bedrad.atomic import atomic_path
from oracles.small_files import small_files


def test_content_appears_only_when_the_block_ends(tmp_path: Path) -> None:
    target = tmp_path / "a.txt"
    with atomic_path(target) as temporary:
        assert temporary.parent == tmp_path
        temporary.write_text("new")
        assert not target.exists()
    assert target.read_text() == "new"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("failure", [ValueError("x"), KeyboardInterrupt(), SystemExit(1)])
def test_an_early_end_leaves_the_old_file_and_nothing_else(tmp_path: Path, failure: BaseException) -> None:
    target = tmp_path / "a.txt"
    target.write_text("old")

    def fail() -> None:
        with atomic_path(target) as temporary:
            temporary.write_text("half")
            raise failure

    with pytest.raises(type(failure)):
        fail()
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_permissions_follow_the_umask(tmp_path: Path) -> None:
    old = os.umask(0o027)
    try:
        with atomic_path(tmp_path / "a") as temporary:
            temporary.write_text("x")
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640


def test_a_symbolic_link_stays_one(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    link = tmp_path / "link.txt"
    link.symlink_to(tmp_path / "real" / "file.txt")
    with atomic_path(link) as temporary:
        temporary.write_text("x")
    assert link.is_symlink()
    assert (tmp_path / "real" / "file.txt").read_text() == "x"


def test_missing_folder_and_folder_as_target_are_named(tmp_path: Path) -> None:
    with (
        pytest.raises(FileNotFoundError, match=r"cannot write: .*nowhere/a\.h5"),
        atomic_path(tmp_path / "nowhere/a.h5"),
    ):
        pytest.fail("the block must not run")
    with pytest.raises(IsADirectoryError, match="cannot write: Is a directory"), atomic_path(tmp_path):
        pytest.fail("the block must not run")


def test_a_read_only_folder_shows_before_the_block_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # the super-user may write anywhere, so the refusal of the system is imitated
    def refuse(*_: object) -> int:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(os, "open", refuse)
    with (
        pytest.raises(OSError, match=r"cannot write: Read-only file system: '.*a\.h5'") as caught,
        atomic_path(tmp_path / "a.h5"),
    ):
        pytest.fail("the block must not run")
    assert caught.value.errno == errno.EROFS


def test_a_write_that_does_not_fit_is_one_clear_error(tmp_path: Path) -> None:
    target = tmp_path / "a.bin"
    target.write_bytes(b"old")
    with (
        small_files(1 << 16),
        pytest.raises(OSError, match=r"cannot write: File too large: '.*a\.bin'"),
        atomic_path(target) as temporary,
    ):
        temporary.write_bytes(bytes(1 << 17))
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def test_an_error_about_another_file_is_passed_on(tmp_path: Path) -> None:
    def read_another() -> None:
        with atomic_path(tmp_path / "a.txt"):
            (tmp_path / "other.txt").read_text()

    with pytest.raises(FileNotFoundError, match=r"other\.txt") as caught:
        read_another()
    assert "cannot write" not in str(caught.value)
