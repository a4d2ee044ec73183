# SPDX-License-Identifier: MIT
"""The program `raycaster`: one command, and what it can do as subcommands."""
