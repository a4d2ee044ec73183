# SPDX-License-Identifier: MIT
"""Seeds of random tests: fixed unless `RAYCASTER_SEED` says otherwise, and told with every failure."""

from __future__ import annotations

import os
import shlex

DEFAULT = 20150
VARIABLE = "RAYCASTER_SEED"


def seed() -> int:
    """The seed of this run."""
    return int(os.environ.get(VARIABLE, DEFAULT))


def repeat() -> str:
    """For a failed assertion's message: the seed, and the command line that fails again with it."""
    # pytest sets it to "path::test[parameters] (call)".
    test = os.environ.get("PYTEST_CURRENT_TEST", "").rpartition(" ")[0]
    return f"seed {seed()}; repeat with: {VARIABLE}={seed()} python -m pytest {shlex.quote(test)}"
