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


@pytest.mark.parametrize("uid", [0, 1000])
@pytest.mark.parametrize(
    ("manager", "icarus", "chromium"),
    [
        ("apt-get", "install -y -q iverilog", "install -y -q chromium"),
        ("dnf", "install -y -q iverilog", "install -y -q chromium"),
        ("pacman", "-S --noconfirm --needed iverilog", "-S --noconfirm --needed chromium"),
        ("brew", "install icarus-verilog", "install --cask google-chrome"),
    ],
)
def test_install_command(machine, manager, icarus, chromium, uid):
    """The available package manager is used, through sudo unless the user is root or it needs none."""
    machine(uid, **{manager: "exit 1"})
    program = f"sudo {manager}" if uid and manager != "brew" else manager
    for tool, expected in (("icarus", icarus), ("chromium", chromium)):
        assert " ".join(install_command(tool)) == f"{program} {expected}"


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
