"""The terminal, and the texts of files on it: they are shown, and steer nothing."""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from bedrad.errors import visible

__all__ = ["Screen", "visible_lines"]


def visible_lines(text: str) -> str:
    """A text of several lines, each as `bedrad.errors.visible` writes it."""
    return "\n".join(map(visible, text.split("\n")))


class Screen(Console):
    """A console that prints texts as they are, and signs that steer a terminal as Python escapes them.

    Nothing in a text is taken for a style, a link or the name of a picture. What rich itself sends to steer the
    terminal, such as colours and the bars of progress, goes through.
    """

    def __init__(self, *, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, markup=False, emoji=False, highlight=False)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Lay out, as rich does: whatever is printed, and every cell of a table, comes through here."""
        for segment in super().render(renderable, options):
            if segment.control or segment.text.isprintable():
                yield segment
            else:
                yield Segment(visible_lines(segment.text), segment.style)
