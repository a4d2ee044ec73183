# SPDX-License-Identifier: MIT
"""Engines with a line buffer: the units in lockstep, and the renderer that is a row ahead of the monitor."""
