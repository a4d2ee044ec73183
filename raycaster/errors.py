# SPDX-License-Identifier: MIT
"""What a user can mend is told in one line."""


class UserError(Exception):
    """Something that the user can mend; its text is the one line that they are shown."""
