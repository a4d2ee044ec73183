# SPDX-License-Identifier: MIT
"""`raycaster commands`: run every command in the manual, exactly as printed there."""

from __future__ import annotations

import re
import subprocess
import time
from collections.abc import Iterable, Sequence
from pathlib import Path

from raycaster.docs.pages import PAGES, ROOT, need_clone
from raycaster.errors import UserError
from raycaster.options import CommandParser, outside_make
from raycaster.output import Console, Table

LEFT_OUT = {
    "make test": "it checks the commands itself",
    ".venv/bin/python -m pytest -q verif/tests/leaves/engine/test_colour_dimmer.py": (
        "the test is only on the page, not in the clone"
    ),
}
"""Commands that are not run, with the reason."""


def commands_of(pages: Iterable[Path]) -> list[str]:
    """Return the commands in the shell blocks of pages, without comments and repetitions."""
    text = "".join(page.read_text() for page in pages)
    blocks = re.findall(r"^```sh\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    lines = (line.partition(" #")[0].strip() for block in blocks for line in block.splitlines())
    return list(dict.fromkeys(filter(None, lines)))


def run(command: str, log: Path) -> tuple[int, float]:
    """Run a command from a page in the project's root, with its output in a file; return its exit code and seconds."""
    ending = " FRAMES=10" if command.startswith("make play") else ""  # nobody would close the window
    environment = outside_make() | {"SDL_VIDEODRIVER": "dummy"}
    started = time.monotonic()
    with log.open("w") as file:
        done = subprocess.run(
            command + ending, shell=True, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, stdout=file,
            stderr=subprocess.STDOUT, check=False,
        )  # fmt: skip
    return done.returncode, time.monotonic() - started


def command_parser() -> CommandParser:
    """Return the command's parser."""
    parser = CommandParser("commands", __doc__, "--only boxes")
    parser.add_argument("--only", default="", metavar="TEXT", help="only run commands that contain this text")
    parser.add_argument(
        "--output", type=Path, default=Path("build/commands"), help="directory for logs (default: %(default)s)"
    )
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    need_clone()
    chosen = [command for command in commands_of(PAGES) if arguments.only in command]
    if not chosen:
        raise UserError(f"only: no command in the manual contains {arguments.only!r}")
    arguments.output.mkdir(parents=True, exist_ok=True)
    console, failed = Console(), 0
    table = Table("command", "seconds", "exit code", "log", texts=("log",))
    for number, command in enumerate(chosen):
        if reason := LEFT_OUT.get(command):
            table.add_row(command, "", "", f"left out: {reason}")
            continue
        log = arguments.output / f"{number:02}.log"
        with console.waiting(f"{number + 1} of {len(chosen)}: {command}"):
            code, seconds = run(command, log)
        failed += code != 0
        table.add_row(command, f"{seconds:.0f}", code, log, style="red" if code else None)
    console.print(table)
    return int(failed > 0)
