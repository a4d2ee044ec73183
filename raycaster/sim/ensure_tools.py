# SPDX-License-Identifier: MIT
"""`python -m raycaster.sim.ensure_tools icarus`: find tools that pip does not have, or install them.

This file needs only the standard library, so that make can run it while pip installs the rest.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass

from raycaster.errors import UserError

INSTALL: dict[str, tuple[str, ...]] = {
    "apt-get": ("apt-get", "install", "-y", "-q"),
    "dnf": ("dnf", "install", "-y", "-q"),
    "pacman": ("pacman", "-S", "--noconfirm", "--needed"),
    "brew": ("brew", "install"),
}
"""Install command by package manager; the first one found is used."""


@dataclass(frozen=True)
class Tool:
    """A tool that pip does not have.

    Attributes:
        name: the name to print.
        programs: names or paths of the tool's executable; any of them will do.
        package: name of its package.
        of_brew: arguments to Homebrew's install command.
        site: the tool's web site.
    """

    name: str
    programs: tuple[str, ...]
    package: str
    of_brew: tuple[str, ...]
    site: str


TOOLS = {
    "icarus": Tool("Icarus Verilog", ("iverilog",), "iverilog", ("icarus-verilog",), "steveicarus.github.io/iverilog"),
    "chromium": Tool(
        "Chromium",
        (
            "chromium",
            "chromium-browser",
            "google-chrome",
            "/Applications/Chromium.app/Contents/MacOS/Chromium",
            "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
        ),
        "chromium",
        ("--cask", "google-chrome"),  # Homebrew's chromium is not signed, so macOS does not run it
        "chromium.org",
    ),
    "tcl": Tool("Tcl", ("tclsh",), "tcl", ("tcl-tk",), "tcl-lang.org"),
}


def find(tool: str) -> str | None:
    """Return the path of one of `TOOLS`, or None if it is not on the PATH."""
    return next(filter(None, map(shutil.which, TOOLS[tool].programs)), None)


def install_command(tool: str) -> tuple[str, ...] | None:
    """Return the command that installs one of `TOOLS` on this system; None without a known package manager."""
    manager = next((name for name in INSTALL if shutil.which(name)), None)
    if manager is None:
        return None
    if manager == "brew":
        return (*INSTALL[manager], *TOOLS[tool].of_brew)  # Homebrew refuses to run as root; the others need it
    command = (*INSTALL[manager], TOOLS[tool].package)
    return command if os.geteuid() == 0 else ("sudo", *command)


def missing(tool: str, why: str = "") -> UserError:
    """Make the error for a missing tool: the reason, and what to run."""
    command = install_command(tool)
    if command is None:
        line = f"is missing, and no package manager is known here; see {TOOLS[tool].site}"
    else:
        line = f"is missing{why}; run: {' '.join(command)}"
    return UserError(f"{TOOLS[tool].name} {line}")


def ensure(tool: str) -> None:
    """Install one of `TOOLS` if it is missing and this user may.

    Raises:
        UserError: it is missing and could not be installed; says what to run.
    """
    if find(tool):
        return
    command = install_command(tool)
    if command is None:
        raise missing(tool)
    if command[0] == "sudo" and not _run("sudo", "-n", "true"):
        raise missing(tool, ", and installing it needs root")
    print(f"{TOOLS[tool].name} is missing; installing it: {' '.join(command)}", file=sys.stderr)
    installed = _run(*command)
    if not installed and "apt-get" in command:
        # The package lists of a fresh container are empty.
        prefix = command[: command.index("apt-get")]
        installed = _run(*prefix, "apt-get", "update", "-q") and _run(*command)
    if not installed or not find(tool):
        raise missing(tool, " and could not be installed")


def _run(*command: str) -> bool:
    try:
        return subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, check=False).returncode == 0
    except OSError:
        return False


if __name__ == "__main__":
    try:
        for wanted in sys.argv[1:]:
            ensure(wanted)
    except UserError as error:
        sys.exit(f"error: {error}")
