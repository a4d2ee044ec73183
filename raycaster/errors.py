# SPDX-License-Identifier: MIT
"""What a user can mend is told in one line."""


class UserError(Exception):
    """Something that the user can mend; its text is the one line that they are shown."""


def not_installed(what: str, extra: str) -> str:
    """The line for something that an extra of this package brings; the package itself is on no index."""
    return f"{what} is missing; it comes with the extra {extra}: in a clone of this project, pip install '.[{extra}]'"
