# SPDX-License-Identifier: MIT
"""Errors that the user can fix, reported in one line."""

from collections.abc import Iterable

from raycaster.hdl.errors import UserError

__all__ = ["UserError", "listed", "not_installed"]


def not_installed(what: str, extra: str) -> str:
    """Return the message for a missing dependency that an extra installs; the package itself is on no index."""
    return f"{what} is missing; it comes with the extra {extra}: in a clone of it, run pip install '.[{extra}]'"


def listed(choices: Iterable[object]) -> str:
    """Join two or more choices as in a sentence, such as `a, b or c`."""
    *others, last = map(str, choices)
    return f"{', '.join(others)} or {last}"
