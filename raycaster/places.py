# SPDX-License-Identifier: MIT
"""Folders in which the project can be installed, and in which programs that it runs can work.

This file needs only the standard library, so that make and pip can run it before anything is installed.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Collection
from pathlib import Path

ODD_FOR_TOOLS = '"\\'
"""Printable characters in a path with which Verilator fails to read or write files there."""

ODD_FOR_SHELLS = f"{ODD_FOR_TOOLS} '`$&;|<>()*?[]{{}}#"
"""Characters in the path of Verilator with which it does not start: its wrapper gives the path to a shell."""

ODD_FOR_INSTALLING = f"{ODD_FOR_SHELLS}%:"
"""Characters in the path of a clone with which Verilator, pip or venv fails."""

NAMES = {" ": "a space", "\n": "a line's end", "'": "an apostrophe", '"': "a quotation mark", "$": "a dollar sign"}


def shown(text: object, kept: str = "") -> str:
    r"""Return a text with an escape, as in \x1b, for each character that is not printable.

    Args:
        text: the text.
        kept: characters that stay.
    """
    return "".join(one if one.isprintable() or one in kept else _escaped(one) for one in str(text))


def _escaped(one: str) -> str:
    # Python has these for bytes of a file's name that are not UTF-8.
    return f"\\x{ord(one) - 0xDC00:02x}" if is_byte(one) else one.encode("unicode_escape").decode()


def is_byte(one: str) -> bool:
    """Return True if a character stands for a byte that is not UTF-8."""
    return "\udc80" <= one <= "\udcff"


def odd_character(path: object, odd: Collection[str] = "") -> str:
    """Name the first character of a path that is not allowed; empty if there is none.

    Args:
        path: the path.
        odd: printable characters that are not allowed; others, such as a line's end, never are.
    """
    one = next((one for one in str(path) if one in odd or not one.isprintable()), "")
    return "a byte that is not UTF-8" if one and is_byte(one) else NAMES.get(one, shown(one))


def links_complaint(root: Path) -> str:
    """Return one line about links in `raycaster/` that are lost, as in a ZIP file; empty if all are there."""
    folders = sorted(path.parent.name for path in root.glob("*/__init__.py"))
    lost = [name for name in folders if name != "raycaster" and not (root / "raycaster" / name).is_dir()]
    if not lost:
        return ""
    return (
        f"{shown(root)}/raycaster: {', '.join(lost)}: must be symbolic links to the folders above with these names; "
        "clone the project again with symbolic links: git clone -c core.symlinks=true"
    )


def clone_complaint(root: Path) -> str:
    """Return one line about a clone in which nothing can be installed; empty if it can."""
    if odd := odd_character(root, ODD_FOR_INSTALLING):
        return f"{shown(root)}: the path has {odd}, with which the installation would fail; move the clone elsewhere"
    return links_complaint(root)


if __name__ == "__main__":
    if said := clone_complaint(Path(__file__).resolve().parents[1]):
        os.write(sys.stderr.fileno(), f"error: {said}\n".encode(errors="backslashreplace"))
        sys.exit(2)
