# SPDX-License-Identifier: MIT
"""`raycaster verify all`: all tests, those included that `make test` leaves out because they take long."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from raycaster import ensure_tools
from raycaster.errors import UserError
from raycaster.jobs import positive
from raycaster.options import CommandParser

TESTS = Path(__file__).with_name("tests")


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("verify all", __doc__, "--jobs 4")
    parser.add_argument("--jobs", type=positive, default=2, metavar="N", help="tests at a time (default: %(default)s)")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """The command; returns pytest's exit code.

    Raises:
        UserError: there are no tests, as this is not a clone.
    """
    arguments = command_parser().parse_args(argv)
    if not TESTS.is_dir():
        raise UserError("verify all: the tests come with a clone, not with the installed program")
    for tool in ensure_tools.TOOLS:
        ensure_tools.ensure(tool)
    command = [sys.executable, "-m", "pytest", "-q", "-n", str(arguments.jobs), "--dist", "worksteal"]
    return subprocess.run([*command, "--durations=10", str(TESTS)], cwd=TESTS.parents[1], check=False).returncode
