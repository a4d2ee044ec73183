# SPDX-License-Identifier: MIT
"""Seed of random tests: fixed unless `RAYCASTER_SEED` is set, and reported with every failure. Long runs draw one."""

from __future__ import annotations

import argparse
import datetime
import os
import shlex
from typing import Any

from raycaster.design.options import command_line
from raycaster.output import Console
from raycaster.runs.jobs import natural

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


def add_seed_option(parser: argparse.ArgumentParser) -> None:
    """Add `--seed`, for a command that calls `drawn`."""
    parser.add_argument(
        "--seed", type=natural, default=os.environ.get(VARIABLE), metavar="N",
        help="seed of the random numbers, which repeats a run (default: the date, unless a run is resumed)",
    )  # fmt: skip


def drawn(command: str, asked: int | None, unfinished: int | None, console: Console, **options: Any) -> int:
    """Return the seed of a long run, and print it.

    Args:
        command: the command, with the `options` that repeat the run.
        asked: value of `--seed`.
        unfinished: seed of an earlier run, which this one resumes unless another seed is asked for.
        console: the console.
    """
    why, found = "by date", int(datetime.date.today().strftime("%Y%m%d"))
    if asked is not None:
        why, found = "as asked for", asked
    elif unfinished is not None:
        why, found = "of the unfinished run that is resumed", unfinished
    console.print(f"seed {found}, {why}; repeat with: {command_line(command, options={'seed': found} | options)}")
    return found
