# SPDX-License-Identifier: MIT
"""The program `raycaster` and its subcommands."""
