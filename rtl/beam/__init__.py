# SPDX-License-Identifier: MIT
"""The beam engine: exact, all rectangles at once, a pixel a clock."""
