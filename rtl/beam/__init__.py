# SPDX-License-Identifier: MIT
"""The beam engine: exact, all rectangles at once, one or two pixels per clock."""
