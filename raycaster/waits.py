# SPDX-License-Identifier: MIT
"""Usual durations of long waits, on two cores of an AMD EPYC. A build's is a fact of its engine."""

from __future__ import annotations

import sys
from collections.abc import Mapping

from raycaster.engines import ENGINES

COMMANDS: Mapping[str, str] = {"area": "3 min", "fit": "4 min per scene", "docs": "7 min"}
"""By command, with its default options and nothing kept from an earlier run."""


def announce(command: str) -> None:
    """Say on standard error how long a command usually takes, on a terminal and on a pipe alike."""
    print(f"{command}: usually {COMMANDS[command]}, less where results are kept", file=sys.stderr, flush=True)


def building(engine: str) -> str:
    """The usual wait for a model of an engine's design."""
    return f"usually {ENGINES[engine].usual_build}, once"
