# SPDX-License-Identifier: MIT
"""Compile C and C++ to WebAssembly for a page, each program once."""

from __future__ import annotations

import importlib.metadata
import re
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import raycaster.sw
from raycaster.configuration import MOST_RECTANGLES, Configuration
from raycaster.design.options import BUILD
from raycaster.errors import UserError, not_installed
from raycaster.play.machine import HOST, SIGNS, TOP, MachineSources, machine_sources
from raycaster.play.machine import MACHINE as MACHINE_HEADER
from raycaster.registers import address_bits
from raycaster.rtl.common.widths import pixel_bits
from raycaster.rtl.span.lists import ListEntry
from raycaster.runs.tools import TIMEOUT, ToolError, run_program
from raycaster.sim.simulator import (
    VERILATED_DEFINITIONS,
    SimulationError,
    find_tool,
    library_sources,
    made,
    models,
    verilate,
)
from raycaster.web.taps import tapped_signals, taps_verilog

HERE = Path(__file__).parent
GOLDEN = HERE / "golden.cpp"
MACHINE = tuple(HERE / name for name in ("machine.cpp", "runtime.cpp", "shim.h", "bus.h"))
"""Files that a machine is compiled from, besides its design; the first two are sources."""

DRAWING = tuple(HERE / name for name in ("drawing.v", "drawing.h"))
"""Bench and loop of a design without a monitor."""

REPLACED = ("frame_list", "video_generator")
"""Modules of the design that the bench of a drawing replaces."""

CLOCKED = {
    "bus_clk": ("avalon_interface", "camera_mem", "frame_registers", "rect_slot"),
    "fetch_clk": ("rect_mem",),
}
"""Modules that a drawing clocks apart from the others, by their clock in the bench."""

DIRECT = ("__VactTriggered[0U]", "__VnbaTriggered[0U]", "___eval_triggers_vec__act(", "___eval_nba(")
"""Parts of Verilator's model that `drawing.h` uses if they are there."""

SOFTWARE = Path(raycaster.sw.__path__[0])
DRIVER = SOFTWARE / "raycaster.c"
DRIVER_HEADERS = tuple(SOFTWARE / name for name in ("raycaster.h", "raycaster_regs.h"))
GOLDEN_FLAGS = ("-std=c++17", f"-DMOST_RECTANGLES={MOST_RECTANGLES}", f"-I{SOFTWARE}", "-Wall", "-Wextra", "-Werror")

WASI = "wasm32-wasi"
"""Target with the C and C++ libraries, without exceptions; their system calls are imported from the page."""

FREESTANDING = "wasm32-freestanding"
"""Target without libraries, which imports nothing."""


def _compiler() -> str:
    """Return the compiler's version.

    Raises:
        UserError: the compiler is missing.
    """
    if find_spec("ziglang") is None:
        raise UserError(not_installed("ziglang", "play"))
    return importlib.metadata.version("ziglang")


def _link(directory: Path, name: str, target: str, *arguments: str | Path) -> None:
    """Compile and link a program without `main`, whose functions the page calls, to `<name>.wasm`."""
    command = [
        sys.executable, "-m", "ziglang", "c++", "-target", target, "-O3", "-s", *map(str, arguments),
        "-o", f"{name}.wasm",
    ]  # fmt: skip
    done = run_program(command, directory, TIMEOUT)
    log = directory.with_suffix(".log")
    log.write_text(done.stderr)
    if done.returncode:
        raise ToolError(f"the compiler failed on {name}; its log is {log}")


def machine_wasm(
    config: Configuration, *, processor: bool = False, taps: bool = False, draws: bool = False, build: Path = BUILD
) -> Path:
    """Compile a design, with `machine.cpp`, that a page runs clock by clock; see `build_machine`.

    With taps, the page can watch a ray unit, see `taps.py`; this does not support a processor. A design that draws has
    neither, and no monitor; see `drawing_sources`.

    Raises:
        UserError: Verilator, the compiler or one of their dependencies is missing, or the compiler failed.
        SimulationError: Verilator failed.
    """
    tool = find_tool("verilator")
    design = drawing_sources(config, build) if draws else machine_sources(config, build, processor=processor)
    text = taps_verilog(config) if taps else ""
    tapped = (f"-DTAPS={len(tapped_signals(config, 0))}",) if taps else ()
    flags = (*design.flags, *tapped)
    defines = (*tapped, *design.defines, f"-DWHOLE_FRAMES={int(config.facts.whole_frames and not draws)}")
    made_with = (tool, _compiler(), flags, defines, text, DIRECT)
    header = DRAWING[1] if draws else MACHINE_HEADER
    sources = [*design.files, *MACHINE, header, HOST, SIGNS, DRIVER, *DRIVER_HEADERS]
    name = f"{design.name}-tapped" if taps else design.name
    with made(models(build), f"{name}-{WASI}", sources, made_with) as (place, fresh):
        directory = place.resolve()
        if fresh:
            files = [path.resolve() for path in design.files]
            if taps:
                files.append(directory / "taps.v")
                files[-1].write_text(text)
            verilate(tool, directory, TOP, files, flags, MACHINE[:2])
            direct = (f"-DDIRECT={int(draws and is_direct(directory))}",)
            library = library_sources(tool)
            includes = (directory, HERE, HOST.parent, SOFTWARE, library, library / "vltstd")
            _link(
                directory, TOP, WASI, "-mexec-model=reactor",
                # The driver is C, which allows narrowing conversions.
                "-std=gnu++20", "-Wno-c++11-narrowing", "-fno-exceptions", *VERILATED_DEFINITIONS, *defines, *direct,
                *(f"-I{path}" for path in includes), "-include", HERE / "bus.h", "-include", HERE / "shim.h",
                "-include", SIGNS, "-x", "c++", "all.cc", DRIVER,
            )  # fmt: skip
    return directory / f"{TOP}.wasm"


def drawing_sources(config: Configuration, build: Path = BUILD) -> MachineSources:
    """Convert a design of whole frames, to be run without a monitor; see `drawing.v`."""
    driven = machine_sources(config, build, processor=False)
    originals = [path for path in driven.files[:-1] if path.stem not in REPLACED]
    with made(build / "model" / config.name, "drawing", originals, CLOCKED) as (directory, fresh):
        if fresh:
            for name, text in _clocked(originals).items():
                (directory / name).write_text(text)
        files = [copy if (copy := directory / path.name).exists() else path for path in originals]
    flags = [flag for flag in driven.flags if not flag.startswith("-G")]
    entry_bits = len(ListEntry(config.screen_geometry.columns, pixel_bits(config)).word)
    sizes = (
        f"-DADDRESS_BITS={address_bits(*config.map)}", f"-DENTRY_BITS={entry_bits}",
        f"-DROWS={config.screen_geometry.rows}", f"-DCOLOUR_BITS={config.colour_bits}",
    )  # fmt: skip
    defines = ("-DDRAWING", f"-DCOLOUR_BITS={config.colour_bits}")
    return MachineSources(f"{config.name}-drawing", (*files, DRAWING[0]), (*flags, *sizes), defines)


def _clocked(files: Sequence[Path]) -> dict[str, str]:
    """Return the modules that instantiate those of `CLOCKED`, with the bench's clocks at these instances, by file name.

    Raises:
        SimulationError: nothing instantiates one of the modules.
    """
    texts = {path.name: path.read_text() for path in files}
    changed = {}
    for clock, modules in CLOCKED.items():
        for module in modules:
            instance = re.compile(rf"^({module}(?:_\d+)? \w+ \(\n    \.clk\()clk\)", re.MULTILINE)
            found = [name for name, text in texts.items() if instance.search(text)]
            if not found:
                raise SimulationError(f"{files[0].parent}: no module instantiates {module} with clk first")
            for name in found:
                texts[name] = changed[name] = instance.sub(rf"\1{TOP}.{clock})", texts[name])
    return changed


def is_direct(directory: Path) -> bool:
    """Check that a drawing's model is one of those that `drawing.h` evaluates itself.

    Its triggers must be the rising edges of its clocks, and `DIRECT` must be in it, as in Verilator 5.48.
    """
    text = "".join(path.read_text() for path in sorted(directory.glob(f"V{TOP}___024root*")))
    triggers = set(re.findall(r"\b__Vtrigprevexpr_\w+?__(\w+?)__\d+;", text))
    return triggers == {"clk", *CLOCKED} and all(part in text for part in DIRECT)


def golden_wasm(build: Path = BUILD) -> Path:
    """Compile the golden check, `golden.cpp`, which imports nothing, unless it is already compiled.

    Raises:
        UserError: the compiler is missing, or rejected the source.
    """
    flags = ("-nostdlib", "-Wl,--no-entry", *GOLDEN_FLAGS)
    sources, made_with = [GOLDEN, *DRIVER_HEADERS], (_compiler(), flags)
    with made(models(build), f"golden-{FREESTANDING}", sources, made_with) as (place, fresh):
        directory = place.resolve()
        if fresh:
            _link(directory, "golden", FREESTANDING, *flags, GOLDEN)
    return directory / "golden.wasm"
