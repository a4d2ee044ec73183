# SPDX-License-Identifier: MIT
"""A real Tcl for what Intel's tools would run: the one that Python has in it for tkinter."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

INTERPRETER = """
import sys, tkinter
tcl = tkinter.Tcl()
tcl.eval(f"set argv {{{' '.join(sys.argv[2:])}}}")
try:
    tcl.call("source", sys.argv[1])
except tkinter.TclError as error:
    sys.exit(str(error))
"""


def run_tcl(directory: Path, script: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a script in a directory, with arguments that have no blanks; skips the test where Python has no Tcl."""
    pytest.importorskip("tkinter", reason="Python has no tkinter here, and so no Tcl: Debian's package python3-tk")
    main = directory / "main.tcl"
    main.write_text(script)
    command = [sys.executable, "-c", INTERPRETER, main.name, *arguments]
    return subprocess.run(command, cwd=directory, capture_output=True, text=True, check=False)
