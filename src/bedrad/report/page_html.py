"""HTML in small pieces: every text is escaped on its way in, and numbers are rounded by their errors."""

from __future__ import annotations

import html
import math
from collections.abc import Collection, Sequence

__all__ = ["Html", "element", "figure", "given", "joined", "measured", "number", "page_section", "table"]

_NO_CONTENT = ("img", "meta", "input")

_EXPONENTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

_ROUNDING = 1e-12
"""Errors below this share of a value come from the arithmetic."""

_PLAIN = (1e-3, 1e5)
"""Numbers between these are written without a power of ten."""


class Html(str):
    """Markup; a plain text is none and is escaped where it meets markup."""

    __slots__ = ()


def joined(parts: Sequence[str]) -> Html:
    """One piece of markup from several; texts among them are escaped."""
    return Html("".join(_escaped(part) for part in parts))


def element(name: str, /, *parts: str, **attributes: str | int | bool) -> Html:
    """An element around texts, which are escaped, and markup, which is not.

    Parameters
    ----------
    name : str
        Name of the element.
    *parts : str or Html
        What it holds.
    **attributes : str, int or bool
        Attributes; an underscore at the end of a name is dropped, others become hyphens, False is left out.
    """
    texts = []
    for key, value in attributes.items():
        word = key.rstrip("_").replace("_", "-")
        if value is True:
            texts.append(f" {word}")
        elif value is not False:
            texts.append(f' {word}="{_clean(str(value))}"')
    start = f"<{name}{''.join(texts)}>"
    return Html(start) if name in _NO_CONTENT else Html(f"{start}{joined(parts)}</{name}>")


def _escaped(text: str) -> str:
    return text if isinstance(text, Html) else _clean(text)


def _clean(text: str) -> str:
    """A text for HTML: escaped, and without what no HTML file may hold."""
    kept = "".join(c if c.isprintable() or c in "\n\t" else "\ufffd" for c in text)
    return html.escape(kept, quote=True)


def page_section(anchor: str, title: str, *parts: str) -> Html:
    """A section of the page with its heading."""
    heading = element("h2", title, id=f"{anchor}-title")
    return element("section", heading, *parts, id=anchor, aria_labelledby=f"{anchor}-title")


def table(
    caption: str,
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    notes: Sequence[str] = (),
    words: Collection[int] = (),
) -> Html:
    """A table in a box that scrolls where the screen is narrower.

    Parameters
    ----------
    caption : str
        Title.
    columns : sequence of str
        Headings, those of the rows first.
    rows : sequence of sequences of str
        Cells; the first of each row is its heading.
    notes : sequence of str
        Sentences below the table.
    words : collection of int
        Columns of words, which stand to the left and may take several lines; all others are of numbers.
    """
    looks = ["words" if k == 0 or k in words else "number" for k in range(len(columns))]
    head = [element("th", text, scope="col", class_=look) for text, look in zip(columns, looks, strict=True)]
    body = []
    for row in rows:
        cells = [element("td", text, class_=look) for text, look in zip(row[1:], looks[1:], strict=True)]
        body.append(element("tr", element("th", row[0], scope="row", class_="words"), *cells))
    whole = element(
        "table",
        element("caption", caption),
        element("thead", element("tr", *head)),
        element("tbody", *body),
    )
    # what scrolls takes the focus, so that the arrow keys reach it
    box = element("div", whole, class_="scroll", role="region", aria_label=caption, tabindex=0)
    return joined([box, *(element("p", note, class_="note") for note in notes)])


def figure(source: str, text: str, caption: str, *, wide: bool = False) -> Html:
    """A picture with its caption.

    Parameters
    ----------
    source : str
        The picture as a data URI.
    text : str
        What it shows, for those who do not see it.
    caption : str
        Text below it.
    wide : bool
        Whether it needs the width of two columns to be read.
    """
    picture = element("img", src=source, alt=text)
    box = element("div", picture, class_="scroll", role="region", aria_label=f"figure: {caption}", tabindex=0)
    return element("figure", box, element("figcaption", caption), class_="wide" if wide else "plain")


def given(value: float) -> str:
    """A number that was given and not computed, such as 1,100: six digits, and no zeros behind them."""
    return _minus(f"{value:,.6g}") if math.isfinite(value) else "–"


def number(value: float, digits: int = 4) -> str:
    """A number without error, to some significant digits; an en dash where there is none."""
    if not math.isfinite(value):
        return "–"
    text = f"{value:.{digits - 1}e}"
    mantissa, power = float(text.split("e")[0]), int(text.split("e")[1])
    if value == 0 or _PLAIN[0] <= abs(value) < _PLAIN[1]:
        return _minus(f"{float(text):,.{max(0, digits - 1 - power)}f}") if value else "0"
    return f"{_minus(f'{mantissa:.{digits - 1}f}')} × {_power(power)}"


def measured(value: float, error: float, digits: int = 4) -> str:
    """A value with its standard error, both to two significant digits of the error, such as "0.4501 ± 0.0029".

    Parameters
    ----------
    value, error : float
        Without an error (nan, zero, or rounding alone) the value stands alone, to `digits` significant digits.
    """
    if not math.isfinite(value):
        return "–"
    # an error of rounding says nothing about the value
    if not (math.isfinite(error) and error > _ROUNDING * abs(value)):
        return number(value, digits)
    # rounded first: 0.0996 to two digits is 0.10
    place = int(f"{error:.1e}".split("e")[1]) - 1
    top = max(abs(value), error)
    if _PLAIN[0] <= top < _PLAIN[1]:
        decimals = max(0, -place)
        rounded = (round(value, -place), round(error, -place))
        return _minus(f"{rounded[0]:,.{decimals}f} ± {rounded[1]:,.{decimals}f}")
    power = math.floor(math.log10(top))
    decimals = max(0, power - place)
    scaled = (value / 10.0**power, error / 10.0**power)
    return f"{_minus(f'({scaled[0]:.{decimals}f} ± {scaled[1]:.{decimals}f})')} × {_power(power)}"


def _power(exponent: int) -> str:
    return f"10{str(exponent).translate(_EXPONENTS)}"


def _minus(text: str) -> str:
    return text.replace("-", "−")
