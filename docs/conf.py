# SPDX-License-Identifier: MIT
"""Sphinx configuration, which `raycaster docs` uses on a copy of the pages."""

from __future__ import annotations

import re
from typing import Any

project = "RayCaster"
author = "The RayCaster authors"
copyright = f"2026 {author}, MIT licence"
html_title = "RayCaster"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
autodoc_default_options = {"members": True, "exclude-members": "model_config"}
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
default_role = "code"
myst_heading_anchors = 2
html_theme = "furo"
html_static_path = ["style"]
html_css_files = ["wide.css"]
html_extra_path = ["extra"]
html_copy_source = False


def _keep_bars(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Escape bars: docstrings write |x| for a magnitude, which reStructuredText would take for a substitution."""
    lines[:] = [re.sub(r"(`[^`]*`)|\|", lambda found: found[1] or r"\|", line) for line in lines]


_as_written: dict[str, list[str]] = {}
"""Docstrings that napoleon is about to change, by name."""


def _note(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Remember an attribute's docstring, because napoleon takes text before a colon in its first line for a type."""
    if what in ("attribute", "data", "property"):
        _as_written[name] = list(lines)


def _restore(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Restore a remembered docstring."""
    lines[:] = _as_written.pop(name, lines)


def setup(app: Any) -> None:
    """Connect the functions above to Sphinx."""
    for change, priority in ((_note, 400), (_restore, 600), (_keep_bars, 700)):  # napoleon has priority 500
        app.connect("autodoc-process-docstring", change, priority=priority)
