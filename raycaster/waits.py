# SPDX-License-Identifier: MIT
"""Usual durations of long waits, on two cores of an AMD EPYC: the one place that has them.

A command shows them before it begins, on a terminal and on a pipe alike.
"""

from __future__ import annotations

from collections.abc import Mapping

COMMANDS: Mapping[str, str] = {"area": "3 min", "fit": "4 min per scene", "docs": "7 min"}
"""By command, with its default options and nothing kept from an earlier run."""

BUILDS: Mapping[str, str] = {"seed": "30 s", "exact": "15 s", "beam": "25 s"}
"""By engine, to convert its default design and build it with Verilator; estimated from processor time."""


def building(engine: str) -> str:
    """The usual wait for a model of an engine's design."""
    return f"usually {BUILDS[engine]}, once"
