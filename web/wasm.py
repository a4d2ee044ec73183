# SPDX-License-Identifier: MIT
"""C and C++ as WebAssembly for a page, each program compiled once."""

from __future__ import annotations

import importlib.metadata
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import raycaster.sw
from raycaster.configuration import Configuration
from raycaster.errors import UserError, not_installed
from raycaster.options import BUILD
from raycaster.play.machine import MACHINE as MACHINE_HEADER
from raycaster.play.machine import SIGNS, TOP, machine_sources
from raycaster.sim.simulator import VERILATED_DEFINITIONS, find_tool, library_sources, made, models, verilate
from raycaster.tools import TIMEOUT, ToolError, run_program
from raycaster.web.taps import tapped_signals, taps_verilog

HERE = Path(__file__).parent
GOLDEN = HERE / "golden.cpp"
MACHINE = tuple(HERE / name for name in ("machine.cpp", "runtime.cpp", "shim.h", "bus.h"))
"""What a machine is compiled from beside its design; the first two are sources."""

SOFTWARE = Path(raycaster.sw.__path__[0])
DRIVER = SOFTWARE / "raycaster.c"
DRIVER_HEADERS = tuple(SOFTWARE / name for name in ("raycaster.h", "raycaster_regs.h"))
GOLDEN_FLAGS = ("-std=c++17", f"-I{SOFTWARE}", "-Wall", "-Wextra", "-Werror")

WASI = "wasm32-wasi"
"""With C's and C++'s libraries, which know no exceptions; what of the system they call is imported from the page."""

FREESTANDING = "wasm32-freestanding"
"""Without a library: imports nothing."""

_LINKED = {
    WASI: ("-mexec-model=reactor",),
    FREESTANDING: ("-nostdlib", "-Wl,--no-entry"),
}
"""By target, how it becomes a program without main, which is called function by function."""


def compile_wasm(
    name: str,
    sources: Sequence[Path],
    target: str = WASI,
    *,
    headers: Sequence[Path] = (),
    flags: Sequence[str] = (),
    exports: Sequence[str] = (),
    build: Path = BUILD,
) -> Path:
    """Compile and link a program, or find it compiled.

    Args:
        name: of the program, for people.
        sources: of C or C++.
        target: `WASI` or `FREESTANDING`.
        headers: files that the sources include and that may change.
        flags: for the compiler and the linker, after this function's own.
        exports: functions that the page calls, beside those that the sources mark themselves.
        build: the directory that holds `model/`.

    Returns:
        The file, `<name>.wasm`.

    Raises:
        UserError: the compiler is missing, or did not accept the sources.
    """
    arguments = (*flags, *(f"-Wl,--export={function}" for function in exports))
    files = [source.resolve() for source in sources]
    with made(models(build), f"{name}-{target}", [*sources, *headers], (_compiler(), arguments)) as (place, fresh):
        if fresh:
            _link(place.resolve(), name, target, (*arguments, *files))
    return place.resolve() / f"{name}.wasm"


def _compiler() -> str:
    """The compiler's version.

    Raises:
        UserError: it is missing.
    """
    if find_spec("ziglang") is None:
        raise UserError(not_installed("ziglang", "play"))
    return importlib.metadata.version("ziglang")


def _link(directory: Path, name: str, target: str, arguments: Sequence[str | Path]) -> None:
    command = [
        sys.executable, "-m", "ziglang", "c++", "-target", target, *_LINKED[target], "-O3", "-s", *map(str, arguments),
        "-o", f"{name}.wasm",
    ]  # fmt: skip
    done = run_program(command, directory, TIMEOUT)
    log = directory.with_suffix(".log")
    log.write_text(done.stderr)
    if done.returncode:
        raise ToolError(f"the compiler failed on {name}; its log is {log}")


def machine_wasm(config: Configuration, *, processor: bool = False, taps: bool = False, build: Path = BUILD) -> Path:
    """A design that a page runs clock by clock, `machine.cpp`.

    Args:
        config: the design.
        processor: as for `build_machine`.
        taps: whether the page can watch a ray unit; see `taps.py`. Not with a processor.
        build: as for `build_machine`.

    Raises:
        UserError: Verilator or the compiler is missing, or what they need; or the compiler failed.
        SimulationError: Verilator failed.
    """
    tool, design = find_tool("verilator"), machine_sources(config, build, processor=processor)
    text = taps_verilog(config) if taps else ""
    defines = (f"-DTAPS={len(tapped_signals(config, 0))}",) if taps else ()
    flags = (*design.flags, *defines)
    made_with = (tool, _compiler(), flags, design.defines, text)
    sources = [*design.files, *MACHINE, MACHINE_HEADER, SIGNS, DRIVER, *DRIVER_HEADERS]
    name = f"{design.name}-tapped" if taps else design.name
    with made(models(build), f"{name}-{WASI}", sources, made_with) as (place, fresh):
        directory = place.resolve()
        if fresh:
            files = [path.resolve() for path in design.files]
            if taps:
                files.append(directory / "taps.v")
                files[-1].write_text(text)
            verilate(tool, directory, TOP, files, flags, MACHINE[:2])
            library = library_sources(tool)
            includes = (directory, HERE, MACHINE_HEADER.parent, SOFTWARE, library, library / "vltstd")
            _link(
                directory, TOP, WASI,
                # The driver is C, which narrows.
                ("-std=gnu++20", "-Wno-c++11-narrowing", "-fno-exceptions", *VERILATED_DEFINITIONS, *design.defines,
                 *defines, *(f"-I{path}" for path in includes), "-include", HERE / "bus.h", "-include", HERE / "shim.h",
                 "-include", SIGNS, "-x", "c++", "all.cc", DRIVER),
            )  # fmt: skip
    return directory / f"{TOP}.wasm"


def golden_wasm(build: Path = BUILD) -> Path:
    """The golden check, `golden.cpp`, which imports nothing; arguments and errors are those of `compile_wasm`."""
    return compile_wasm("golden", [GOLDEN], FREESTANDING, headers=DRIVER_HEADERS, flags=GOLDEN_FLAGS, build=build)
