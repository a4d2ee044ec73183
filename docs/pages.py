# SPDX-License-Identifier: MIT
"""The pages and their generated text: everything between `<!--name-->` and `<!--/-->` is generated, not typed.

The generated text is stored in the pages, so that a page can be read without being built.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from raycaster.errors import UserError

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
README = ROOT / "README.md"
PAGES = (*sorted(HERE.glob("*.md")), README, ROOT / "CONTRIBUTING.md")

MADE = re.compile(r"<!--(\w+)-->(.*?)<!--/-->", re.DOTALL)
"""A marker's name and its generated text: a few words within a line, or separate lines."""


def rendered(text: str, values: Mapping[str, str], place: str) -> str:
    """Return a page with these values, by marker name, between its markers.

    Raises:
        UserError: a marker has no value.
    """

    def made(match: re.Match[str]) -> str:
        if match[1] not in values:
            raise UserError(f"{place}: unknown marker {match[1]}; expected one of {', '.join(sorted(values))}")
        value = values[match[1]]
        gap = "\n\n" if "\n" in match[2] else ""
        return f"<!--{match[1]}-->{gap}{value}{gap}<!--/-->"

    return MADE.sub(made, text)


def need_clone() -> None:
    """Refuse to run if the package was installed without the project around it.

    Raises:
        UserError: the directory above the pages has no README.
    """
    if not README.is_file():
        raise UserError(f"{README}: not found; this command needs a clone of the project")


def render_all(values: Mapping[str, str]) -> list[Path]:
    """Update the generated text of all pages, and return those that have changed.

    Raises:
        UserError: as for `rendered`.
    """
    changed = []
    for page in PAGES:
        text = page.read_text()
        new = rendered(text, values, str(page))
        if new != text:
            page.write_text(new)
            changed.append(page)
    return changed
