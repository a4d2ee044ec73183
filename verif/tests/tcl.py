# SPDX-License-Identifier: MIT
"""Run Tcl scripts made for Intel's tools in a real Tcl interpreter, and record the commands that they call."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from difflib import ndiff
from importlib.metadata import version
from pathlib import Path

from conftest import KEPT, compare_kept

from raycaster.sim import ensure_tools

RECORD = r"""
rename package ""
proc unknown args {
    # The index of a port's bit, as in KEY[0], which Quartus does not evaluate.
    if {[string is integer $args]} { return "\[$args\]" }
    # Such a call is shown where its result is used.
    if {[string match get_* [lindex $args 0]]} { return "\[$args\]" }
    puts [join $args \t]
    return [lindex $args end]
}
"""
"""Commands that Tcl does not know are Intel's: each call is printed as a line, and returns its last argument."""


def tcl_calls(directory: Path, script: Path, settings: str = "") -> list[list[str]]:
    """Return the calls of Intel's commands by a script that runs in a directory: each call's name and arguments.

    The settings are Tcl that runs before the script. An error in the script is an AssertionError with its first line.

    Raises:
        UserError: Tcl is missing.
    """
    program = ensure_tools.find("tcl")
    if program is None:
        raise ensure_tools.missing("tcl")
    (directory / "main.tcl").write_text(f"{RECORD}\n{settings}\nsource {{{script}}}\n")
    done = subprocess.run([program, "main.tcl"], cwd=directory, capture_output=True, text=True, check=False)
    assert not done.returncode, done.stderr.splitlines()[0]
    return [line.split("\t") for line in done.stdout.splitlines()]


def compare_calls(name: str, calls: list[list[str]], base: Sequence[list[str]] = ()) -> None:
    """Compare calls, except the project's version, with those kept under a name.

    If there is a base, only the differences from its calls are kept. With `KEEP=1` in the environment, they are kept
    first.
    """
    before, lines = ([" | ".join(call).rstrip() + "\n" for call in one] for one in (base, calls))
    if base:
        lines = [line for line in ndiff(before, lines) if line[0] in "+-"]
    text = "".join(lines).replace(version("raycaster"), "VERSION")
    compare_kept(KEPT / f"{name}.txt", text)
