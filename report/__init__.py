# SPDX-License-Identifier: MIT
"""The report: what fixed point costs in pixels, time and cells, and where it breaks."""
