# SPDX-License-Identifier: MIT
"""Installation of tools that pip does not provide."""

from __future__ import annotations

import os
from collections.abc import Callable

import pytest
from conftest import write_script

from raycaster.sim import ensure_tools
from raycaster.sim.ensure_tools import UserError, ensure, find, install_command


@pytest.fixture
def machine(tmp_path, monkeypatch) -> Callable[..., None]:
    """Return a function that lets only some programs be on the path, for a user."""

    def make(uid: int, **programs: str) -> None:
        for name, script in programs.items():
            write_script(tmp_path / "bin", name, script)
        monkeypatch.setenv("PATH", str(tmp_path / "bin"))
        monkeypatch.setattr(os, "geteuid", lambda: uid)

    return make


@pytest.mark.parametrize(
    ("tool", "manager", "uid", "expected"),
    [
        ("icarus", "apt-get", 0, "apt-get install -y -q iverilog"),
        ("icarus", "apt-get", 1000, "sudo apt-get install -y -q iverilog"),
        ("icarus", "dnf", 1000, "sudo dnf install -y -q iverilog"),
        ("icarus", "pacman", 0, "pacman -S --noconfirm --needed iverilog"),
        ("icarus", "brew", 1000, "brew install icarus-verilog"),
        ("chromium", "apt-get", 0, "apt-get install -y -q chromium"),
        ("chromium", "dnf", 1000, "sudo dnf install -y -q chromium"),
        ("chromium", "pacman", 0, "pacman -S --noconfirm --needed chromium"),
        ("chromium", "brew", 1000, "brew install --cask google-chrome"),
    ],
)
def test_install_command(machine, tool, manager, uid, expected):
    """The available package manager is used, through sudo unless the user is root."""
    machine(uid, **{manager: "exit 1"})
    assert " ".join(install_command(tool)) == expected


@pytest.mark.parametrize(
    ("tool", "program"),
    [("icarus", "iverilog"), ("chromium", "chromium"), ("chromium", "google-chrome"), ("tcl", "tclsh")],
)
def test_an_installed_tool_is_used(machine, tmp_path, monkeypatch, tool, program):
    machine(0, **{program: "exit 1"})
    monkeypatch.setattr(ensure_tools, "_run", lambda *command: pytest.fail(f"ran {command}"))
    assert find(tool) == str(tmp_path / "bin" / program)
    ensure(tool)


@pytest.mark.parametrize(
    ("uid", "managers", "complaint"),
    [
        (1000, {"apt-get": "exit 1"}, "Icarus .* needs root; run: sudo apt-get install -y -q iverilog$"),
        (0, {}, "Icarus .*, and no package manager is known here; see steveicarus"),
        (0, {"dnf": "exit 1"}, ".* could not be installed; run: dnf install -y -q iverilog$"),
        (0, {"dnf": "exit 0"}, ".* could not be installed; run: dnf install -y -q iverilog$"),
    ],
    ids=["no root", "no manager", "no such package", "no program in it"],
)
def test_it_cannot_be_installed(machine, uid, managers, complaint):
    """The error is one line that says what to run, if anything."""
    machine(uid, **managers)
    with pytest.raises(UserError, match=f"^{complaint}"):
        ensure("icarus")


@pytest.mark.parametrize(("tool", "program"), [("icarus", "iverilog"), ("chromium", "chromium"), ("tcl", "tclsh")])
def test_it_is_installed(machine, tmp_path, capsys, tool, program):
    """If root's first attempt fails, as in a fresh container, the package lists are updated before the next."""
    install = (
        f"if [ $1 = update ]; then : > {tmp_path}/lists; exit 0; fi\n"
        f"[ -e {tmp_path}/lists ] || exit 100\n"
        f"/bin/cp {tmp_path}/bin/template {tmp_path}/bin/{program}"
    )
    machine(0, **{"template": "exit 0", "apt-get": install})
    ensure(tool)
    assert find(tool)
    assert "is missing; installing it: apt-get install" in capsys.readouterr().err
