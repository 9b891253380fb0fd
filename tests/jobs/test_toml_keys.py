"""Keys of a TOML text are counted as the parser counts them, in time that grows with the text and no more."""

import time
import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bedrad.errors import BadFileError
from bedrad.jobs.job import parse_job
from bedrad.jobs.toml_keys import MOST_PARTS, longest_key

LARGEST = 2**16

DEEP = "a" + ".a" * 30_000


@pytest.mark.parametrize(
    "text",
    [
        f"{DEEP} = 1",
        f"[{DEEP}]",
        f"[[{DEEP}]]",
        f"x = {{ {DEEP} = 1 }}",
        DEEP.replace(".", " . ")[:LARGEST],
        '"a"' + '."a"' * 15_000 + " = 1",
        "'a.a'" + ".'a.a'" * 10_000 + " = 1",
    ],
)
def test_a_key_that_would_keep_the_parser_busy_is_refused_at_once(text):
    begin = time.process_time()
    with pytest.raises(BadFileError, match=rf"^a\.toml: line 3: a key of \d+ parts; .* at most {MOST_PARTS}$"):
        parse_job(f"# a job\nseed = 1\n{text}\n", Path("a.toml"))
    # the parser takes 24 s for the first of them
    assert time.process_time() - begin < 2.0


@pytest.mark.parametrize(
    "text",
    [
        'paths = ["' + '", "'.join(f"beds.v1.2/bed.{k}.dump.gz" for k in range(1500)) + '"]',
        "paths = ['" + "','".join(f"bed.{k}.dump.gz" for k in range(1500)) + "']",
        "numbers = [" + ", ".join(f"{k}.5" for k in range(5000)) + "]",
        "numbers = [\n" + "".join(f"  {k}.5,\n" for k in range(5000)) + "]",
        'text = "' + "." * 5000 + '"',
        'text = "\\"' + ".a" * 5000 + '"',
        'text = """\n' + ".a\n" * 500 + '"" . . "' + " . " * 500 + '"""',
        "text = '''\n" + "a." * 5000 + "''''",
        "seed = 1 # " + "a." * 5000,
        "a = '#' # " + "a." * 5000,
    ],
)
def test_dots_that_stand_in_no_key_are_none_of_its_own(text):
    assert tomllib.loads(text)
    assert longest_key(text)[0] <= 2


def test_a_key_of_as_many_parts_as_may_be_reaches_the_job():
    with pytest.raises(BadFileError, match=r"^a\.toml: a: unknown key"):
        parse_job("a" + ".a" * (MOST_PARTS - 1) + " = 1", Path("a.toml"))


@pytest.mark.parametrize(
    "unit",
    ['"', "'", '\\"', '"\\', '"""', "'''", '""', "#", '"\n', '"""\n\\', "a", ".", "a.", "[", '"\\"', "''''", '"a".'],
)
def test_no_text_takes_long(unit):
    text = (unit * LARGEST)[:LARGEST]
    begin = time.process_time()
    longest_key(text)
    longest_key('"""' + text)
    assert time.process_time() - begin < 1.0


bare = st.text("ab1-_", min_size=1, max_size=3)
quoted = st.text(".a\"'#\\= ", max_size=4).map(lambda s: '"' + s.replace("\\", "\\\\").replace('"', '\\"') + '"')
literal = st.text('.a"#\\= ', max_size=4).map("'{}'".format)
multiline = st.text('.a"#\\=\n', max_size=6).map(lambda s: '"""' + s.replace("\\", "\\\\").replace('"', '\\"') + '"""')
values = st.one_of(quoted, literal, multiline, st.just("1.5"))
parts = st.lists(st.one_of(bare, quoted, literal), min_size=1, max_size=6)


@given(
    parts, st.sampled_from([".", " . ", "\t."]), st.one_of(quoted, literal, multiline, st.just("1.5")), st.booleans()
)
def test_parts_are_counted_as_the_parser_nests_tables(keys, dot, value, comment):
    text = f"\n{dot.join(keys)} = {value}" + (" # a.b.c.d.e.f.g.h" if comment else "")
    found = tomllib.loads(text)
    nested, levels = found, 0
    while isinstance(nested, dict):
        nested, levels = next(iter(nested.values())), levels + 1
    number = value == "1.5"
    assert longest_key(text)[0] == max(levels, 2 if number else 1)
