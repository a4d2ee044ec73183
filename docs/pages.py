# SPDX-License-Identifier: MIT
"""The pages, and what is written into them: everything between `<!--name-->` and `<!--/-->` is made, not typed.

The values stand in the pages themselves, so that a page can be read where nothing builds it.
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
"""A name, and what is made of it: a word or two within a line, or lines of their own."""


def rendered(text: str, values: Mapping[str, str], place: str) -> str:
    """A page with these values in it.

    Args:
        text: the page.
        values: in Markdown, by name.
        place: of the page, for complaints.

    Raises:
        UserError: it names what has no value.
    """

    def made(match: re.Match[str]) -> str:
        if match[1] not in values:
            raise UserError(f"{place}: {match[1]} is none of what is made; there are {', '.join(sorted(values))}")
        value = values[match[1]]
        gap = "\n\n" if "\n" in match[2] else ""
        return f"<!--{match[1]}-->{gap}{value}{gap}<!--/-->"

    return MADE.sub(made, text)


def need_clone() -> None:
    """Refuse to go on where the package was installed without the project around it.

    Raises:
        UserError: there is no README above the pages.
    """
    if not README.is_file():
        raise UserError(f"{README}: is not there; this command needs a clone of the project")


def render_all(values: Mapping[str, str]) -> list[Path]:
    """Write all pages anew.

    Returns:
        Those that have changed.

    Raises:
        UserError: as `rendered`.
    """
    changed = []
    for page in PAGES:
        text = page.read_text()
        new = rendered(text, values, str(page))
        if new != text:
            page.write_text(new)
            changed.append(page)
    return changed
