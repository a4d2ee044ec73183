# SPDX-License-Identifier: MIT
"""The report: the cost of fixed point in pixels, time and cells, and the scenes that break it."""
