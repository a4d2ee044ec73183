# SPDX-License-Identifier: MIT
"""The output of `make verilog` works in another folder and in its users' tools."""

from __future__ import annotations

import fnmatch
import json
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import SMALL_SCENE, plant, run_tool
from tcl import tcl_calls

from raycaster.buses import BRIDGED, BUSES, OWN
from raycaster.configuration import FEATURES, MOST_RECTANGLES, Configuration
from raycaster.convert import verilog
from raycaster.convert.platform_designer import COMPONENT, NIOS_SYSTEM
from raycaster.convert.register_views import HEADER
from raycaster.convert.take_home import FILE_LIST, PREFIX, TOP, waivers
from raycaster.convert.write import write_verilog
from raycaster.design.decide import configure
from raycaster.fit.fixing import fix
from raycaster.hdl.hierarchy import prefixed
from raycaster.registers import address_bits
from raycaster.rtl.engines import EXACT
from raycaster.runs.tools import run_yosys

EVERYTHING = dict.fromkeys(EXACT.facts.features, True)
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
    configure(engine="exact", screen="tiny", units=2, rectangles=2, reflections=2, allow_underrun=True, **EVERYTHING),
    configure(engine="span", rows=180, rectangles=MOST_RECTANGLES),
    configure(engine="span", screen="tiny", reflections=2, rectangles=3, scale=1),
    configure(engine="span", reflections=0, rectangles=1, colour_bits=4),
    configure(engine="span", screen="tiny", reflections=4, rectangles=2, units=2),
    configure(engine="span", rows=180, scale=6, pixels=2, units=3),
    configure(engine="span", screen="tiny", rectangles=2, turn=True, materials=True, patterns=True, pixels=2),
    configure(engine="span", screen="tiny", reflections=2, rectangles=2, **dict.fromkeys(FEATURES, True)),
    *(configure(engine="exact", screen="tiny", rectangles=2, bus=bus) for bus in BRIDGED),
    fix(SMALL_SCENE, {"screen": "tiny"}, "rects").design.configuration,
    *(fix(SMALL_SCENE, {"engine": engine}, "all").design.configuration for engine in ("seed", "exact", "span")),
]
SMALL = configure(screen="tiny", units=2, rectangles=2, allow_underrun=True)

configurations = pytest.mark.parametrize("config", CONFIGURATIONS, ids=lambda config: config.name)


def verilator_says(directory: Path) -> list[str]:
    done = run_tool(directory, "verilator", "--lint-only", "-Wall", "--top-module", TOP, f"{TOP}.vlt", "-f", FILE_LIST)
    return re.findall(r"^%(?:Warning|Error).*$", done.stdout, re.M)


PYTHON = re.compile(r"`|\b(?:None|True|False|config|self)\b|\b[a-z_]\w*\.[a-z_]")
"""Text that no Verilog comment may contain: names in backquotes, words of Python, attributes."""


@pytest.mark.slow_sets(
    quick=[
        "exact-tiny48-u2-r2-m2-c8-turn-materials-patterns-light",
        "exact-tiny48-u2-r2-m1-c8-axi4lite",
        "exact-tiny48-u2-r2-m1-c8-uart",
        "span-tiny48-s2-u1-r2-m1-pairs",
        "span-tiny48-s2-u1-r2-m2",
    ]
)
@configurations
def test_tools_have_nothing_to_say(config: Configuration, tmp_path):
    """The top's head has the options; the description has the ports that Yosys finds, and the files of the list."""
    directory = tmp_path / "taken home"
    write_verilog(config, directory)
    comments = [line for path in directory.glob("*.v") for line in re.findall(r"//.*", path.read_text())]
    assert [line for line in comments if PYTHON.search(line)] == []
    head = (directory / f"{TOP}.v").read_text().partition("\nmodule ")[0]
    for name in ("units", "rectangles", "fraction_bits", "screen"):
        assert re.search(rf"^//     {name} +{getattr(config, name)}$", head, re.M), name
    assert verilator_says(directory) == []
    done = run_tool(directory, "iverilog", "-g2005", "-Wall", "-s", TOP, "-o", "a.out", "-c", FILE_LIST)
    assert (done.returncode, done.stdout) == (0, "")
    sources = (directory / FILE_LIST).read_text().split()
    script = [*(f"read_verilog {source}" for source in sources), f"hierarchy -check -top {TOP}", "proc"]
    run_yosys(directory, "elaborate", [*script, "check -assert", "write_json ports.json"])
    assert "arning" not in (directory / "elaborate.log").read_text()
    found = json.loads((directory / "ports.json").read_text())["modules"][TOP]["ports"]
    ports = {name: (port["direction"], len(port["bits"])) for name, port in found.items()}
    assert config.fixed or f"rectangle[{config.table}];" in (directory / HEADER).read_text()
    of_intel = [name for name in (COMPONENT, NIOS_SYSTEM.name) if (directory / name).exists()]
    assert of_intel == ([COMPONENT, NIOS_SYSTEM.name] if config.bus == OWN else [])
    if of_intel:
        check_component(config, tcl_calls(directory, Path(COMPONENT)), ports, sources)


Ports = dict[str, tuple[str, int]]


def check_component(config: Configuration, calls: list[list[str]], ports: Ports, sources: list[str]) -> None:
    """Check the parts of the Platform Designer component that differ between designs."""
    declared = [(call[2], (call[4].lower(), int(call[5]))) for call in calls if call[0] == "add_interface_port"]
    assert sorted(declared) == sorted(ports.items())
    assert 2 ** ports["avs_s0_address"][1] == 1 << address_bits(*config.map)
    files = [call[1:] for call in calls if call[0] == "add_fileset_file"]
    assert files == 2 * [[name, "VERILOG", "PATH", name] for name in sources]
    hertz = config.screen_geometry.clock_hz
    assert ["set_interface_property", "clock", "clockRate", str(hertz)] in calls


def test_each_module_has_the_prefix(tmp_path):
    """Files and instances have it too, and nothing else differs."""
    plain = write_verilog(SMALL, tmp_path / "plain")
    files = write_verilog(SMALL, tmp_path / "taken", "left_")
    longer = re.compile(rf"\bleft_(?=(?:{'|'.join(path.stem for path in plain)})\b)")
    for path, old in zip(files, plain, strict=True):
        assert f"{path.stem}_".startswith("left_")
        assert longer.sub("", path.stem) == old.stem
        assert re.findall(r"^\s*module (\w+)", path.read_text(), re.M) == [path.stem]
        assert longer.sub("", path.read_text()).split() == old.read_text().split()
    assert longer.sub("", files[-1].stem) == TOP


def test_the_command_adds_a_prefix(tmp_path):
    options = ["--screen", "tiny", "--engine", "exact", "--rectangles", "2", "--output", str(tmp_path / "verilog")]
    verilog.main(options)
    assert all(path.stem.startswith(PREFIX[:-1]) for path in (tmp_path / "verilog").glob("*.v"))
    verilog.main([*options, "--prefix", ""])
    assert (tmp_path / "verilog" / "nearest_hit.v").is_file()


def test_lists_work_from_anywhere(tmp_path):
    """The paths in each list are relative to it."""
    directory, elsewhere = tmp_path / "taken home", tmp_path / "elsewhere"
    files = write_verilog(SMALL, directory, "left_")
    elsewhere.mkdir()
    library = directory / files[-1].stem
    own = str(library.with_suffix(".vlt"))
    lint = ("verilator", "--lint-only", "-Wall", "--top-module", library.name, own, "-F", f"{library}.f")
    done = run_tool(elsewhere, *lint)
    assert (done.returncode, "%" in done.stdout) == (0, False)
    calls = tcl_calls(elsewhere, library.with_suffix(".qip"), f"set quartus(qip_path) {{{directory}}}")
    assert calls == [["set_global_assignment", "-name", "VERILOG_FILE", str(path)] for path in files]


BENCHED = {
    "seed": SMALL,
    **{bus: configure(engine="exact", screen="tiny", rectangles=2, bus=bus) for bus in BUSES},
    "span": configure(engine="span", screen="tiny", rectangles=2),
    "pairs": configure(engine="span", screen="tiny", rectangles=2, pixels=2, colour_bits=4),
    "play": configure(engine="span", screen="play", rectangles=2),
    "720p": configure(engine="span", rows=180, rectangles=1, reflections=0),
    "60 rows": configure(engine="exact", rows=60),
    "200 rows": configure(rows=200),
    "fixed": fix(SMALL_SCENE, {"engine": "exact"}, "all").design.configuration,
}
"""A design for each kind of bus, screen and engine, as the bench sees them."""

HORIZONTAL, BUS = "video_generator", "avalon_interface"
BENCH_FAULTS = [
    ("seed", HORIZONTAL, "if (x == 127)", "if (x == 126)", "a line of 159 pixels, 16 of them sync; expected 160"),
    ("seed", HORIZONTAL, "vga_hs = hs", "vga_hs = !hs", "a line of 160 pixels, 144 of them sync"),
    ("seed", HORIZONTAL, "vga_hs = hs", "vga_hs = 1", "0 lines, expected 3 or more"),
    ("seed", BUS, "32'h52415943", "32'h52415944", "address 0 reads 52415944, expected 52415943"),
    ("seed", BUS, "readdatavalid <= reading", "readdatavalid <= 0", "address 0: no answer in "),
    ("axi4lite", BUS, "readdatavalid <= reading", "readdatavalid <= 0", "address 0: no answer in "),
]
"""Design, module, text and its replacement, and what the bench says."""


@pytest.mark.slow_sets(
    "720p",
    "play",
    "60 rows",
    "200 rows",
    "fixed",
    "pairs",
    "apb",
    "uart",
    "wishbone",
    "fault-0 lines",
    "fault-address 0: n-axi",
)
@pytest.mark.parametrize(
    ("name", "module", "right", "wrong", "complaint"),
    [
        *(pytest.param(name, "", "", "", "", id=name) for name in BENCHED),
        *(pytest.param(*row, id=f"fault-{row[-1][:12]}-{row[0]}") for row in BENCH_FAULTS),
    ],
)
def test_the_bench_as_it_is_has_one_verdict(name, module, right, wrong, complaint, tmp_path):
    """Compiled next to its design, without a parameter, it passes the right one, and fails one with a fault."""
    write_verilog(BENCHED[name], tmp_path / "rtl", PREFIX)
    if module:
        path = tmp_path / "rtl" / f"{PREFIX}{module}.v"
        plant(path, right, wrong)
    run_tool(tmp_path / "rtl", "iverilog", "-g2005", "-o", "a.out", "-y", ".", "bench/smoke_bench.v")
    done = run_tool(tmp_path / "rtl", "vvp", "-N", "a.out")
    verdicts = re.findall("^(?:PASS|FAIL)", done.stdout, re.M)
    assert (verdicts, done.returncode == 0) == (["FAIL" if complaint else "PASS"], not complaint), done.stdout
    assert complaint in done.stdout


@pytest.mark.parametrize("prefix", ["", PREFIX, "left_"])
def test_waivers_are_for_own_files_alone(prefix):
    """A user's files with longer names have no waivers; with the file's name in any folder, Verilator needs them."""
    names = [
        f"{prefixed(name, prefix)}.v" for name in ("divider", "operand_ends_9", "ray_unit", "apb_bridge", "by_axis")
    ]
    patterns = re.findall('-file "(.*?)"', waivers(names, prefix))
    for name in names:
        assert any(fnmatch.fnmatch(name, pattern) for pattern in patterns) and f"*/{name}" in patterns
        assert not [one for one in (f"my_{name}", f"my/my_{name}", "usb_bridge.v", "my_unit.v", "top.v")
                    if any(fnmatch.fnmatch(one, pattern) for pattern in patterns)]  # fmt: skip


def fusesoc(folder: Path, *target: str) -> subprocess.CompletedProcess[str]:
    """Run FuseSoC on the core in a folder."""
    command = ("fusesoc", "--cores-root", "cores", "run", "--target", *target, f"raycaster::{TOP}")
    return run_tool(folder, *command, HOME=str(folder), XDG_DATA_HOME=str(folder), XDG_CONFIG_HOME=str(folder))


@pytest.mark.slow_sets(quick=["icarus-avalon"])
@pytest.mark.parametrize(
    ("tool", "bus"), [("icarus", "avalon"), ("verilator", "avalon"), *(("icarus", bus) for bus in BRIDGED)]
)
def test_fusesoc_simulates(tool, bus, tmp_path):
    write_verilog(replace(SMALL, bus=bus), tmp_path / "cores" / "verilog", PREFIX)
    for target in (("sim", "--tool", tool), *[("lint",)] * (tool == "verilator")):
        done = fusesoc(tmp_path, *target)
        assert done.returncode == 0, done.stdout
        assert target == ("lint",) or "PASS: " in done.stdout
