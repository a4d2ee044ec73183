# SPDX-License-Identifier: MIT
"""See to it that Icarus Verilog is there: it is the one tool that pip does not have."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

from raycaster.errors import UserError
from raycaster.options import run_command

PACKAGE_MANAGERS: dict[str, tuple[str, ...]] = {
    "apt-get": ("apt-get", "install", "-y", "-q", "iverilog"),
    "dnf": ("dnf", "install", "-y", "-q", "iverilog"),
    "pacman": ("pacman", "-S", "--noconfirm", "--needed", "iverilog"),
    "brew": ("brew", "install", "icarus-verilog"),
}
"""The command that installs it, by the package manager's name; the first that is there is taken."""


def find() -> bool:
    """Whether Icarus Verilog is on the PATH."""
    return bool(shutil.which("iverilog") and shutil.which("vvp"))


def install_command() -> tuple[str, ...] | None:
    """The command that installs it on this system, or None where no package manager is known."""
    manager = next((name for name in PACKAGE_MANAGERS if shutil.which(name)), None)
    if manager is None:
        return None
    # Homebrew refuses to be run as root; the others want it.
    root = manager == "brew" or os.geteuid() == 0
    return PACKAGE_MANAGERS[manager] if root else ("sudo", *PACKAGE_MANAGERS[manager])


def _run(*command: str) -> bool:
    try:
        return subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, check=False).returncode == 0
    except OSError:
        return False


def main() -> None:
    """Install Icarus Verilog where it is missing and this user may.

    Raises:
        UserError: it is missing and could not be installed; says what to run.
    """
    if find():
        return
    command = install_command()
    if command is None:
        raise UserError(
            "Icarus Verilog is missing, and no package manager is known here; see steveicarus.github.io/iverilog"
        )
    by_hand = f"run: {' '.join(command)}"
    if command[0] == "sudo" and not _run("sudo", "-n", "true"):
        raise UserError(f"Icarus Verilog is missing, and installing it needs root; {by_hand}")
    print(f"Icarus Verilog is missing; installing it: {' '.join(command)}", file=sys.stderr)
    installed = _run(*command)
    if not installed and "apt-get" in command:
        # The package lists of a fresh container are empty.
        prefix = command[: command.index("apt-get")]
        installed = _run(*prefix, "apt-get", "update", "-q") and _run(*command)
    if not installed or not find():
        raise UserError(f"Icarus Verilog is missing and could not be installed; {by_hand}")


if __name__ == "__main__":
    run_command(main)
