# SPDX-License-Identifier: MIT
"""Simulate the system with a processor: the game, recorded or in a window."""
