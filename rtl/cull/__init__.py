# SPDX-License-Identifier: MIT
"""Which rectangles a group's primary rays may hit."""
