# SPDX-License-Identifier: MIT
"""Installation of tools that pip does not provide."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from raycaster.sim import ensure_tools
from raycaster.sim.ensure_tools import UserError, ensure, find, install_command


def _program(directory: Path, name: str, text: str = "exit 1") -> None:
    directory.mkdir(exist_ok=True)
    path = directory / name
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


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
def test_install_command(tmp_path, monkeypatch, tool, manager, uid, expected):
    """The available package manager is used, through sudo unless the user is root."""
    _program(tmp_path, manager)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(os, "geteuid", lambda: uid)
    assert " ".join(install_command(tool)) == expected


@pytest.mark.parametrize(
    ("tool", "program"),
    [("icarus", "iverilog"), ("chromium", "chromium"), ("chromium", "google-chrome"), ("tcl", "tclsh")],
)
def test_an_installed_tool_is_used(tmp_path, monkeypatch, tool, program):
    monkeypatch.setenv("PATH", str(tmp_path))
    _program(tmp_path, program)
    monkeypatch.setattr(ensure_tools, "_run", lambda *command: pytest.fail(f"ran {command}"))
    assert find(tool) == str(tmp_path / program)
    ensure(tool)


def test_without_root(tmp_path, monkeypatch):
    """Without root or sudo, one line says what to run."""
    _program(tmp_path, "apt-get")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    with pytest.raises(UserError, match=r"^Icarus .* needs root; run: sudo apt-get install -y -q iverilog$"):
        ensure("icarus")


def test_without_package_manager(tmp_path, monkeypatch):
    """The error is one line and suggests no command."""
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UserError, match=r"^Icarus .*, and no package manager is known here; see steveicarus"):
        ensure("icarus")


@pytest.mark.parametrize("reason", ["no such package", "no program in it"])
def test_it_cannot_be_installed(tmp_path, monkeypatch, reason):
    _program(tmp_path, "dnf", f"exit {int(reason == 'no such package')}")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    with pytest.raises(UserError, match=r"could not be installed; run: dnf install -y -q iverilog$"):
        ensure("icarus")


@pytest.mark.parametrize(("tool", "program"), [("icarus", "iverilog"), ("chromium", "chromium"), ("tcl", "tclsh")])
def test_it_is_installed(tmp_path, monkeypatch, capsys, tool, program):
    """If root's first attempt fails, as in a fresh container, the package lists are updated before the next."""
    tools = tmp_path / "bin"
    _program(tools, "template", "exit 0")
    _program(
        tools,
        "apt-get",
        f"if [ $1 = update ]; then : > {tmp_path}/lists; exit 0; fi\n"
        f"[ -e {tmp_path}/lists ] || exit 100\n"
        f"/bin/cp {tools}/template {tools}/{program}",
    )
    monkeypatch.setenv("PATH", str(tools))
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    ensure(tool)
    assert find(tool)
    assert "is missing; installing it: apt-get install" in capsys.readouterr().err
