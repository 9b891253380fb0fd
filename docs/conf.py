"""How Sphinx makes the documentation: `make docs`, without network, into build/docs."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from docutils import nodes

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_ext"))
sys.path.insert(0, str(HERE.parent / "src"))

import bedrad  # noqa: E402

if TYPE_CHECKING:
    from sphinx.application import Sphinx

project = "bedrad"
author = "The bedrad developers"
copyright = author  # noqa: A001
version = release = bedrad.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "numpydoc",
    "cyclopts.sphinx_ext",
    "math_svg",
    "equations",
    "gallery",
]
exclude_patterns = ["_ext", "_static"]
nitpicky = True
# single backticks in docstrings are links where they name something, and code where they do not
default_role = "py:obj"
smartquotes = False  # options begin with two hyphens, not with a dash
nitpick_ignore_regex = [("py:obj", ".*"), ("py:class", ".*")]
html_math_renderer = "svg"

myst_enable_extensions = ["dollarmath", "attrs_block", "colon_fence", "deflist"]
myst_heading_anchors = 4
myst_dmath_double_inline = True

autodoc_typehints = "none"  # the docstrings say what each thing is, with its unit
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False
numpydoc_xref_param_type = False

html_theme = "furo"
html_title = f"bedrad {version}"
html_static_path = ["_static"]
html_css_files = ["bedrad.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}

# bars of the field's symbols, which reStructuredText would take for substitutions
rst_prolog = """
.. |psi_6| replace:: \\|psi_6\\|
.. |value| replace:: \\|value\\|
"""

PAGES_ELSEWHERE = {"../CONTRIBUTING.md": "contributing.md", "../CHANGELOG.md": "changelog.md"}
"""Pages of the repository's root that links in docs/ name, and the pages that include them."""


def link_to_included(_app: Sphinx, _name: str, source: list[str]) -> None:
    """Turn links to files of the repository's root into links to their pages."""
    for file, page in PAGES_ELSEWHERE.items():
        source[0] = source[0].replace(f"]({file})", f"]({page})")


def unlink_addresses(_app: Sphinx, doctree: nodes.document) -> None:
    """Leave addresses of clusters as text: no browser can open them."""
    for link in [*doctree.findall(nodes.reference)]:
        if link.get("refuri", "").startswith("tcp:"):
            link.replace_self(nodes.Text(link.astext()))


def setup(app: Sphinx) -> None:
    """Connect what this file does to pages."""
    app.connect("source-read", link_to_included)
    app.connect("doctree-read", unlink_addresses)
