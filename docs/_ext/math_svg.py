"""Draws LaTeX math as SVG while the pages are built, so that they need no script and no network."""

from __future__ import annotations

import html
from functools import cache
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree as ET

import ziamath
from docutils import nodes

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.writers.html5 import HTML5Translator

SIZE = 20.0
"""Size of the drawing, which the pages scale to the text around it."""

ziamath.config.svg2 = False  # each drawing stands alone: no ids that another one on the page could have too
ziamath.config.precision = 2


@cache
def draw(latex: str, inline: bool) -> str:
    """The formula as an SVG element, in units of the text's size and on its baseline.

    Raises
    ------
    ValueError
        If the LaTeX cannot be drawn.
    """
    try:
        formula = ziamath.Latex(latex, size=SIZE, inline=inline, color="currentColor", margin=0.5)
        svg = formula.svgxml()
    except Exception as error:
        raise ValueError(f"cannot draw the formula {latex!r}: {error}") from error
    drop = formula.margin - formula.getyofst()
    sides = [float(svg.attrib[name]) / SIZE for name in ("width", "height")]
    svg.attrib["style"] = f"width:{sides[0]:.3f}em;height:{sides[1]:.3f}em;vertical-align:{-drop / SIZE:.3f}em"
    svg.attrib |= {"role": "img", "aria-label": " ".join(latex.split())}
    for name in ("width", "height"):
        del svg.attrib[name]
    return ET.tostring(svg, encoding="unicode")


def visit_inline(self: HTML5Translator, node: nodes.math) -> None:
    self.body.append(f'<span class="math">{_drawn(node, True)}</span>')
    raise nodes.SkipNode


def visit_block(self: HTML5Translator, node: nodes.math_block) -> None:
    self.body.append(f'<div class="math-block">{_drawn(node, False)}</div>')
    raise nodes.SkipNode


def _drawn(node: nodes.Element, inline: bool) -> str:
    from sphinx.util import logging

    latex = node.astext().strip()
    try:
        return draw(latex, inline)
    except ValueError as error:
        logging.getLogger(__name__).warning("%s", error, location=node, type="math_svg")
        return f"<code>{html.escape(latex)}</code>"


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_html_math_renderer("svg", (visit_inline, None), (visit_block, None))
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
