"""A whole HTML file: style and scripts inside, and a policy that lets it load nothing and run nothing else."""

from __future__ import annotations

import base64
import hashlib
import re
from importlib.resources import files
from pathlib import Path

from bedrad.atomic import atomic_path
from bedrad.report.page_html import Html, element, joined
from bedrad.report.pictures import BEYOND, layer_colour
from bedrad.report.style import COLOURS

__all__ = ["asset", "data_uri", "document", "write_document"]


def asset(name: str) -> str:
    """A style sheet or script that comes with bedrad, as text."""
    return (files("bedrad.report") / name).read_text(encoding="utf-8")


def data_uri(content: bytes, kind: str) -> str:
    """Bytes as an address that holds them.

    Parameters
    ----------
    content : bytes
        The file.
    kind : str
        Its type, such as ``image/png``.
    """
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def document(title: str, body: Html, script: str = "") -> str:
    """Write down a whole page.

    Parameters
    ----------
    title : str
        Title.
    body : Html
        What it holds.
    script : str
        The only script that may run.

    Returns
    -------
    str
        The file.
    """
    style = _style()
    policy = "; ".join(
        (
            "default-src 'none'",
            "img-src data:",
            f"style-src 'sha256-{_digest(style)}'",
            f"script-src 'sha256-{_digest(script)}'" if script else "script-src 'none'",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", http_equiv="Content-Security-Policy", content=policy),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("meta", name="referrer", content="no-referrer"),
        element("meta", name="color-scheme", content="light dark"),
        element("meta", name="generator", content="bedrad"),
        element("title", title),
        # an icon of its own, or the browser asks for one
        Html('<link rel="icon" href="data:,">'),
        element("style", Html(style)),
    )
    parts = [body, element("script", Html(script))] if script else [body]
    return f"<!DOCTYPE html>\n{element('html', head, element('body', joined(parts)), lang='en')}\n"


def write_document(text: str, path: Path) -> None:
    """Write a page, whole or not at all; OSError if it cannot be written."""
    with atomic_path(path) as temporary:
        # a name of a file may hold what is no text
        temporary.write_bytes(text.encode("utf-8", "replace"))


def _digest(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _style() -> str:
    """The style sheet, with a class for the colour of each layer."""
    colours = "".join(f".layer-{k + 1} {{ color: {layer_colour(k)}; }}\n" for k in range(len(COLOURS)))
    colours += f".beyond {{ color: {BEYOND}; }}\n"
    return re.sub(r"/\*.*?\*/\s*", "", asset("page.css"), flags=re.DOTALL) + colours
