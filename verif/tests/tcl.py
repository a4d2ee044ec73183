# SPDX-License-Identifier: MIT
"""Run Tcl scripts made for Intel's tools in a real Tcl interpreter."""

from __future__ import annotations

import subprocess
from pathlib import Path

from raycaster.sim import ensure_tools


def run_tcl(directory: Path, script: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a script in a directory, with arguments.

    Raises:
        UserError: Tcl is missing.
    """
    program = ensure_tools.find("tcl")
    if program is None:
        raise ensure_tools.missing("tcl")
    main = directory / "main.tcl"
    main.write_text(script)
    command = [program, main.name, *arguments]
    return subprocess.run(command, cwd=directory, capture_output=True, text=True, check=False)
