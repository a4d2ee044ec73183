# SPDX-License-Identifier: MIT
"""The system with a processor in simulation: the game, recorded or in a window."""
