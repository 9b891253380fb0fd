from __future__ import annotations

import math
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bedrad.report.page_html import Html, element, joined, measured, number, table
from bedrad.report.page_html import given as as_given


class Read(HTMLParser):
    """What a browser would make of a piece of HTML: elements with attributes, and text."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.elements, self.text = [], ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.text += data


@given(text=st.text(), attribute=st.text())
def test_any_text_stays_text(text, attribute):
    read = Read(element("p", text, title=attribute))
    kept = ["".join(c if c.isprintable() or c in "\n\t" else "\ufffd" for c in given) for given in (text, attribute)]
    assert read.elements == [("p", {"title": kept[1]})]
    assert read.text == kept[0]


def test_markup_stays_markup_and_names_of_attributes_become_what_html_has():
    made = element("label", element("b", "<x>"), " & y", for_="a", aria_label='"q"', hidden=True, disabled=False)
    assert made == '<label for="a" aria-label="&quot;q&quot;" hidden><b>&lt;x&gt;</b> &amp; y</label>'
    assert isinstance(made, Html)
    assert joined(["<", Html("<")]) == "&lt;<"


def test_a_table_has_a_caption_and_every_heading_its_scope():
    read = Read(table("Depths", ["layer", "mm"], [["1 <wall>", "0.3"], ["2", "0.9"]], ["a note"], words=[1]))
    headings = [attributes["scope"] for tag, attributes in read.elements if tag == "th"]
    assert headings == ["col", "col", "row", "row"]
    assert [tag for tag, _ in read.elements].count("td") == 2
    scrolls = next(attributes for tag, attributes in read.elements if tag == "div")
    assert (scrolls["role"], scrolls["tabindex"], scrolls["aria-label"]) == ("region", "0", "Depths")
    with pytest.raises(ValueError, match="zip"):
        table("Depths", ["layer"], [["1", "one too many"]])


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.450123, 0.00288, "0.4501 ± 0.0029"),
        (0.450123, 0.000996, "0.4501 ± 0.0010"),
        (-0.5221, 0.0742, "−0.522 ± 0.074"),
        (647.3, 24.4, "647 ± 24"),
        (2059123.0, 17312.0, "(2.059 ± 0.017) × 10⁶"),
        (12345.6, 234.0, "12,350 ± 230"),
        (1.36e-5, 9.3e-6, "(1.36 ± 0.93) × 10⁻⁵"),
        (0.0, 0.01, "0.000 ± 0.010"),
        (0.5, math.nan, "0.5000"),
        (0.5, 0.0, "0.5000"),
        (0.5, 1e-17, "0.5000"),
        (math.nan, 0.1, "–"),
        (math.inf, 0.1, "–"),
    ],
)
def test_a_value_is_rounded_by_its_error(value, error, text):
    assert measured(value, error) == text


@given(value=st.floats(-1e12, 1e12), error=st.floats(1e-9, 1e9))
def test_rounding_moves_a_value_by_less_than_a_tenth_of_its_error(value, error):
    text = measured(value, error)
    if "±" not in text:
        assert error <= 1e-12 * abs(value)
        return
    power = 1.0
    if "×" in text:
        mantissas, _, exponent = text.partition(" × 10")
        power = 10.0 ** int(exponent.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")))
        text = mantissas.strip("()")
    shown, said = (power * float(part.replace("−", "-").replace(",", "")) for part in text.split(" ± "))
    assert abs(shown - value) <= 0.06 * error + 1e-9 * abs(value)
    assert abs(said - error) <= 0.06 * error


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (0.0, 4, "0"),
        (1100.0, 4, "1,100"),
        (7.75, 4, "7.750"),
        (99999.6, 4, "100,000"),
        (1e5, 3, "1.00 × 10⁵"),
        (-3.2e-5, 2, "−3.2 × 10⁻⁵"),
        (math.nan, 2, "–"),
    ],
)
def test_a_number_without_error_has_its_digits(value, digits, text):
    assert number(value, digits) == text


def test_a_number_that_was_given_has_no_zeros_behind_it():
    assert [as_given(x) for x in (1100.0, 0.4, -1.5e-5, 3800.0, math.nan)] == ["1,100", "0.4", "−1.5e−05", "3,800", "–"]
