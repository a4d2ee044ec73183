# SPDX-License-Identifier: MIT
"""Usual durations of long waits, on two cores of an AMD EPYC; those of builds are among an engine's facts."""

from __future__ import annotations

import sys
from collections.abc import Mapping

from raycaster.configuration import Facts

COMMANDS: Mapping[str, str] = {"area": "3 min", "area --route": "5 min", "fit": "4 min per scene", "docs": "7 min"}
"""Durations by command, with its default options."""


def announce(command: str) -> None:
    """Print on standard error how long a command usually takes, whether or not that is a terminal."""
    print(f"{command}: usually {COMMANDS[command]}", file=sys.stderr, flush=True)


def building(facts: Facts) -> str:
    """Return the usual time to build a model of an engine's design."""
    return f"usually {facts.usual_build}, once"
