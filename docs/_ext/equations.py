r"""The directive `equation`: a formula, its number in the source, the functions that compute it, what was corrected.

    ```{equation} W(22)
    :by: bedrad.heat.two_layer.nusselt_developed
    :corrected: what the print has in its place, and why that cannot be
    \mathrm{Nu} = ...
    ```

`:by:` takes several names, parted by commas. Each must be in the reference: the build fails if it is not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx import addnodes
from sphinx.util.docutils import SphinxDirective

if TYPE_CHECKING:
    from sphinx.application import Sphinx


class Equation(SphinxDirective):
    """A display formula and a line below it."""

    has_content = True
    required_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar[dict[str, Any]] = {
        "by": directives.unchanged_required,
        "corrected": directives.unchanged_required,
    }

    def run(self) -> list[nodes.Node]:
        """Make the box: formula, line, and what was corrected."""
        if "by" not in self.options:
            raise self.error("an equation names the functions that compute it, :by:")
        latex = "\n".join(self.content)
        math = nodes.math_block(latex, latex, nowrap=False, number=None, label=None)
        self.set_source_info(math)
        line = nodes.paragraph(classes=["equation-source"])
        line += nodes.strong(text=self.arguments[0])
        line += nodes.Text("  ·  ")
        for k, name in enumerate(part.strip() for part in self.options["by"].split(",")):
            if k:
                line += nodes.Text(", ")
            line += self.link(name)
        box = nodes.container(classes=["equation"])
        box += [math, line]
        if "corrected" in self.options:
            inner, messages = self.parse_inline("**Corrected:** " + self.options["corrected"])
            note = nodes.paragraph(classes=["equation-corrected"])
            note += [*inner, *messages]
            box += note
        return [box]

    def link(self, name: str) -> nodes.Node:
        """A link to a function, by its name within the package."""
        short = name.removeprefix("bedrad.heat.").removeprefix("bedrad.")
        reference = addnodes.pending_xref(
            "", nodes.literal(text=short), refdomain="py", reftype="func", reftarget=name, refwarn=True,
            refdoc=self.env.docname,
        )  # fmt: skip
        self.set_source_info(reference)
        return reference


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_directive("equation", Equation)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
