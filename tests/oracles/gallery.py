"""Loads the gallery's examples, which are files and not a package."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

GALLERY = Path(__file__).parents[2] / "examples" / "gallery"


def load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"gallery_{name}", GALLERY / f"{name}.py")
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    return example
