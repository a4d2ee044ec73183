# SPDX-License-Identifier: MIT
"""Seed of random tests: fixed unless `RAYCASTER_SEED` is set, and reported with every failure."""

from __future__ import annotations

import os
import shlex

DEFAULT = 20150
VARIABLE = "RAYCASTER_SEED"


def seed() -> int:
    """Return the seed of this run."""
    return int(os.environ.get(VARIABLE, DEFAULT))


def repeat() -> str:
    """Return the seed and a command line that repeats the failure, for the message of an assertion."""
    # pytest sets it to "path::test[parameters] (call)".
    test = os.environ.get("PYTEST_CURRENT_TEST", "").rpartition(" ")[0]
    return f"seed {seed()}; repeat with: {VARIABLE}={seed()} python -m pytest {shlex.quote(test)}"
