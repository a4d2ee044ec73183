# SPDX-License-Identifier: MIT
"""`raycaster verify mutate`: plant faults in every module and check that its leaf tests notice (mutation testing).

The leaf tests run once and record their inputs and the outputs that they expect. Then, for each recording, Yosys plants
up to --mutants faults in the Verilog of the module under test, spread over its cells: an inverted or stuck bit of a
cell's port, always or depending on another bit. Input bits that a submodule does not read get no fault, because it
would have no effect. Verilator compiles the netlist with all faults and an input that chooses one, and each fault is
replayed. It is caught if an output differs from the expected one in a cycle that the test checks. Registers start as
zeros, as ones and at random, because they are unknown in the tests' simulator.

Survivors go to the solver z3. If no input sequence distinguishes a mutant from the module, it is equivalent, or
equivalent under the module's contract, which lists assumptions about inputs, and invariants of registers that are
proved first. The solver compares the module's own cells, so the inputs of submodules must not differ. All other
survivors must be explained in mutation.toml, or it is an error; so is an explanation that no mutant needs.
"""

from __future__ import annotations

import argparse
import inspect
import json
import os
import re
import shutil
import subprocess
import sys
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Any

import raycaster
from raycaster import golden, hdl, rtl
from raycaster.convert.digest import verilog_digest
from raycaster.digests import digest
from raycaster.errors import UserError
from raycaster.jobs import Kept, add_fresh_option, add_job_options, executors, positive, run_jobs
from raycaster.options import CommandParser
from raycaster.outcomes import add_keep_option, keep
from raycaster.output import Console, Table, emptied
from raycaster.sim import ensure_tools
from raycaster.sim.simulator import build_program
from raycaster.tools import ToolError, run_yosys
from raycaster.verif import expected, recording, seeds
from raycaster.verif.formal.prover import missing_tools, with_all_looks
from raycaster.verif.recording import RECORD_VARIABLE, recording_name

SOURCES = Path(__file__).parent
RTL = Path(rtl.__file__).parent
LEAVES = SOURCES.resolve().parent / "tests" / "leaves"
MUTANTS = 200
SEED = 20150
LEAST_CAUGHT = 0.97
"""Minimum share of the mutants that are not equivalent, in each module."""

OUTCOMES = ("caught", "equivalent", "contract", "explained", "surviving")


class MutationError(ToolError):
    """Mutation testing failed, or the data file does not match the design."""


@dataclass(frozen=True)
class Expectation:
    """Facts about a module, from the data file.

    Attributes:
        test: leaf test whose recordings are used; empty for the one with the module's name.
        sets: its parameter sets; none for its last one.
        assumptions: Verilog expressions of the module's inputs that its contract guarantees, each with its reason.
        invariants: Verilog expressions of its registers, true from reset on; proved.
        look_into: submodules that are part of what the solver compares, with `*` for any text.
        explained: survivors, as `Mutant` prints them, with `*` for any text, each with the reason.
    """

    test: str = ""
    sets: Sequence[str] = ()
    assumptions: Mapping[str, str] = field(default_factory=dict)
    invariants: Sequence[str] = ()
    look_into: Sequence[str] = ()
    explained: Mapping[str, str] = field(default_factory=dict)


def blocks() -> list[str]:
    """List the blocks of the hardware, each in the file with its name."""
    return sorted(path.stem for path in RTL.rglob("*.py") if f"@block\ndef {path.stem}(" in path.read_text())


def expectations(path: Path = SOURCES / "mutation.toml") -> dict[str, Expectation]:
    """Return the expectation of each block that is mutated, from the data file.

    Raises:
        MutationError: it has an unknown key, or names no block.
    """
    found = {name: Expectation(f"test_{name}") for name in blocks()}
    for kind, entries in tomllib.loads(path.read_text()).items():
        for module, value in entries.items():
            if module not in found or kind not in ("left_out", *Expectation.__dataclass_fields__):
                raise MutationError(f"{path.name}: {kind}.{module}: there is no such block or key")
            if kind == "left_out":
                del found[module]
            else:
                found[module] = replace(found[module], **{kind: value})
    return found


def fits(pattern: str, text: str) -> bool:
    """True if the pattern, in which `*` stands for any text, is the whole text."""
    return re.fullmatch(re.escape(pattern).replace(r"\*", ".*"), text) is not None


@dataclass
class Mutant:
    """A planted fault.

    Attributes:
        selector: the number that chooses it.
        mode: inv, const0, const1; cnot0 and cnot1 invert if another bit is 0 or 1.
        kind: kind of the cell: add, procmux, procdff, a submodule's instance, ...
        port: port of the cell, with the bit.
        at: the Verilog that the cell was made from.
        options: options of Yosys's mutate command.
        outcome: one of `OUTCOMES`.
        detail: the cycle that caught it, or the reason why it may survive.
    """

    selector: int
    mode: str
    kind: str
    port: str
    at: str
    options: str = field(repr=False)
    outcome: str = "surviving"
    detail: str = ""

    def __str__(self) -> str:
        return f"{self.mode} {self.kind} {self.port} at `{self.at}`"


@dataclass
class Result:
    """Mutants of a recording."""

    module: str
    recording: str
    cycles: int
    seconds: float
    mutants: list[Mutant]

    def explain(self, explained: Mapping[str, str]) -> None:
        """Mark the survivors that have an explanation."""
        for mutant in self.mutants:
            reason = next((why for pattern, why in explained.items() if fits(pattern, str(mutant))), None)
            if mutant.outcome == "surviving" and reason:
                mutant.outcome, mutant.detail = "explained", reason


class Recording:
    """Recording of a leaf test by `raycaster.verif.recording`, and the work on it.

    Args:
        directory: the recording.
        work: scratch space, replaced.
    """

    def __init__(self, directory: Path, work: Path):
        self.name, self._directory, self._work = directory.name, directory, work
        self._leaf: dict[str, Any] = json.loads((directory / "leaf.json").read_text())
        self.module: str = self._leaf["module"]
        emptied(work)
        for name in [*self._leaf["files"], *self._leaf["data"]]:
            shutil.copy(directory / name, work)

    def run(self, count: int, seed: int, expectation: Expectation) -> Result:
        """Plant up to `count` faults, replay them, and let the solver judge the survivors.

        Raises:
            MutationError: there is no place for a fault, the replay fails without one, or an invariant does not hold.
        """
        begin = time.monotonic()
        mutants = self.plant(count, seed, expectation.look_into)
        if not mutants:
            raise MutationError(f"{self.module} has no cell that a fault could be in")
        self._replay(mutants)
        if survivors := [mutant for mutant in mutants if mutant.outcome == "surviving"]:
            self._compare(survivors, expectation)
        result = Result(self.module, self.name, self._leaf["cycles"], time.monotonic() - begin, mutants)
        result.explain(expectation.explained)
        return result

    def _read(self) -> list[str]:
        return [
            f"read_verilog {' '.join(self._leaf['files'])}",
            f"hierarchy -check -top {self.module}",
            # A module with parameters has one name per set of values, and is flattened into this one.
            *(f"setattr -mod -set keep_hierarchy 1 {name}" for name in self._submodules),
            f"select {self.module}",
            "flatten",
            *(f"setattr -mod -unset keep_hierarchy {name}" for name in self._submodules),
            f"select {self.module}",
            # MyHDL's constants have 32 bits; faults in most of these would change nothing.
            "proc -norom",  # a fault in the address of a ROM would make a memory that Yosys cannot write
            "opt",
            "wreduce",
            "opt_clean",
        ]

    @cached_property
    def _submodules(self) -> list[str]:
        """Names of the modules below this one that have no parameters."""
        texts = {Path(name).stem: (self._work / name).read_text() for name in self._leaf["files"][:-1]}
        return [name for name, text in texts.items() if not re.search(r"^module \w+ #\(", text, re.MULTILINE)]

    def plant(self, count: int, seed: int, look_into: Sequence[str] = ()) -> list[Mutant]:
        """Choose up to `count` faults, and write the netlist with all of them, for simulation and for the solver.

        For the solver, submodules except those in `look_into` are only ports: equal inputs give equal outputs.
        """
        ports = [name for name in self._submodules if not any(fits(pattern, name) for pattern in look_into)]
        lines = self._choose(count, seed)
        cut = [
            # For a $pmux with two bits of S set, Verilog and SMT-LIB would choose different branches.
            "pmuxtree",
            f"write_verilog -noattr -selected {self.module}_mutants.v",
            "select -clear",
            *(f"setattr -mod -set keep_hierarchy 1 {name}" for name in ports),
            *(f"proc -norom {name}" for name in self._submodules if name not in ports),
            "flatten",
            f"expose -evert -sep _ {self.module}/c:*",  # of its cells only, else all wires would become outputs
            "memory_map",
            "opt_clean",
            "async2sync",
            "dffunmap",
            "setundef -zero",
            *(f"delete {name}" for name in ports),
            f"write_smt2 -stbv -wires {self.module}.smt2",
        ]
        run_yosys(self._work, "plant", [*self._read(), *lines, *cut])
        return [self._describe(number, line) for number, line in enumerate(lines, 1)]

    def _choose(self, count: int, seed: int) -> list[str]:
        """Return Yosys's commands for `count` faults, or all possible ones, numbered from 1 without a gap."""
        width, wanted = count.bit_length(), count
        while True:
            listing = f"mutate -list {wanted} -seed {seed} -ctrl mutsel {width} 1 -o mutants.ys"
            run_yosys(self._work, "list", [*self._read(), listing])
            lines = (self._work / "mutants.ys").read_text().splitlines()
            seen = [line for line in lines if not self._hidden(line)]
            if len(seen) >= count or len(lines) < wanted:
                break
            wanted += wanted - len(seen)
        return [
            re.sub(r"-ctrl mutsel \d+ \d+", f"-ctrl mutsel {width} {number}", line)
            for number, line in enumerate(seen[:count], 1)
        ]

    def _hidden(self, line: str) -> bool:
        """True if the fault is in a bit that a submodule does not read, or where Yosys's memories allow none."""
        options = dict(re.findall(r"-(cell|port|portbit) (\S+)", line))
        # The initial words of a memory must be constant, and its ports must have one clock.
        if "$meminit" in options["cell"] or ("proc_memwr" in options["cell"] and options["port"] == "CLK"):
            return True
        read = self.read_bits.get((options["cell"], options["port"]), -1)
        return not read >> int(options["portbit"]) & 1

    @cached_property
    def read_bits(self) -> dict[tuple[str, str], int]:
        """Masks of the bits that submodules read of their input ports, by instance and port.

        A bit that does not reach an output of the submodule, through all its cells, is not read.
        """
        run_yosys(self._work, "instances", [*self._read(), "write_json -selected instances.json"])
        cells = _netlist(self._work / "instances.json", self.module)["cells"]
        instances = {name: cell["type"] for name, cell in cells.items() if cell["type"] in self._submodules}
        script = [*self._read()[:2], "design -save all"]
        for name in sorted(set(instances.values())):
            # Only simplify what holds for any initial registers; then split cells into single bits if possible, so that
            # those which no output needs are removed.
            script += ["design -load all", f"hierarchy -top {name}", "proc -norom", "flatten", "opt_expr -keepdc"]
            script += ["opt_clean", "wreduce -keepdc", "pmuxtree", "simplemap", "opt_expr -keepdc", "opt_clean"]
            script.append(f"write_json {name}.json")
        if instances:
            run_yosys(self._work, "read", script)
        masks = {name: _read_masks(_netlist(self._work / f"{name}.json", name)) for name in set(instances.values())}
        return {(instance, port): mask for instance, name in instances.items() for port, mask in masks[name].items()}

    def _describe(self, number: int, line: str) -> Mutant:
        options = dict(re.findall(r"-(mode|cell|port|portbit) (\S+)", line))
        # "$add$file.v:12$34", "$procmux$34", "instance"
        kind = options["cell"].lstrip("$").split("$")[0]
        texts = dict.fromkeys(self._text(source) for source in re.findall(r"-src (\S+)", line))
        return Mutant(
            number, options["mode"], kind, f"{options['port']}[{options['portbit']}]", " / ".join(texts), line
        )

    def _text(self, source: str) -> str:
        """Return the Verilog from `file:line.column` up to `line.column`, or its first line."""
        [(file, *numbers)] = re.findall(r"^(.+):(\d+)\.(\d+)-(\d+)\.(\d+)$", source)
        first, start, last, end = map(int, numbers)
        line = (self._work / file).read_text().splitlines()[first - 1]
        # The label of a case has a position but no extent.
        return line[start - 1 : end - 1 if first == last and start < end else None].strip()

    def _replay(self, mutants: list[Mutant]) -> None:
        width = max(mutant.selector for mutant in mutants).bit_length()
        (self._work / "replay.v").write_text(self._wrapper(width))
        names = ["replay.v", f"{self.module}_mutants.v", *self._leaf["files"][:-1]]
        bits = {"IN": sum(self._leaf["inputs"].values()), "OUT": sum(self._leaf["outputs"].values())}
        words = (f"-D{way}_WORDS={-(-count // 32)}" for way, count in bits.items())
        replay = build_program(
            f"{self.module}-mutants", "replay", [self._work / name for name in names], [SOURCES / "replay.cpp"],
            flags=("-O3", "--no-assert", "--x-assign", "unique", "--x-initial", "unique", "-Wno-lint", "-Wno-style"),
            compiler=("-O1", *words),
        )  # fmt: skip
        command = [*replay, str(self._directory / "vectors.txt"), str(self._leaf["settled"]), str(len(mutants))]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        first, fault_free, *lines = done.stdout.splitlines() or ["", ""]
        if done.returncode or first != f"cycles {self._leaf['cycles']}" or len(lines) != len(mutants):
            raise MutationError(f"{self.name}: the replay failed: {done.stdout[-500:]}{done.stderr}")
        if fault_free != "0 -1":
            raise MutationError(f"{self.name}: the replay differs from the recording without any fault: {fault_free}")
        for mutant, line in zip(mutants, lines, strict=True):
            cycle = int(line.split()[1])
            if cycle >= 0:
                mutant.outcome, mutant.detail = "caught", f"cycle {cycle}"

    def _wrapper(self, selector_width: int) -> str:
        inputs, outputs = self._leaf["inputs"], self._leaf["outputs"]
        # Vectors of more than 64 bits, so that Verilator has arrays of words for them.
        bits_in, bits_out = (max(65, sum(ports.values())) for ports in (inputs, outputs))
        wires = "".join(f"wire [{width - 1}:0] {name};\n" for name, width in (inputs | outputs).items())
        pins = [".mutsel(selector)", *[".clk(clk)"] * self._leaf["clocked"]]
        pins += [f".{name}({name})" for name in inputs | outputs]
        return f"""module replay(input clk, input [{selector_width - 1}:0] selector, input [{bits_in - 1}:0] in,
    output [{bits_out - 1}:0] out);
{wires}{self.module} dut ({", ".join(pins)});
assign {{{", ".join(inputs)}}} = in;
assign out = {{{", ".join(outputs)}}};
endmodule
"""

    def _compare(self, survivors: Iterable[Mutant], expectation: Expectation) -> None:
        # z3 may be missing if only this file's help or names are needed.
        from raycaster.verif.mutation.equivalence import Comparison  # noqa: PLC0415

        read = {f"{instance}_{port}": mask for (instance, port), mask in self.read_bits.items()}
        ways = {"equivalent": Comparison(self._work, self.module, read)}
        if expectation.assumptions or expectation.invariants:
            given = tuple(expectation.assumptions), expectation.invariants
            ways["contract"] = Comparison(self._work, self.module, read, *given)
        for mutant in survivors:
            shown = (outcome for outcome, way in ways.items() if way.equivalent(mutant.selector))
            mutant.outcome = next(shown, mutant.outcome)


def _netlist(path: Path, module: str) -> dict[str, Any]:
    """Read a module from Yosys's JSON."""
    return json.loads(path.read_text())["modules"][module]


def _read_masks(netlist: Mapping[str, Any]) -> dict[str, int]:
    """Return for each input port the bits that are connected to a cell or an output of the netlist."""
    ports = netlist["ports"]
    inputs = {name: port["bits"] for name, port in ports.items() if port["direction"] == "input"}
    readers = [bits for cell in netlist["cells"].values() for bits in cell["connections"].values()]
    used = {bit for bits in [*readers, *(ports[name]["bits"] for name in ports.keys() - inputs.keys())] for bit in bits}
    return {name: sum(1 << place for place, bit in enumerate(bits) if bit in used) for name, bits in inputs.items()}


def leaf_tests() -> dict[str, list[str]]:
    """Return the parameter sets of each leaf test, as pytest names them."""
    sets = defaultdict(list)
    for line in _pytest("--collect-only", str(LEAVES)).stdout.splitlines():
        sets[line.partition("[")[0].rpartition("::")[2]].append(line)
    return sets


def recordings(known: Mapping[str, Expectation], sets: Mapping[str, list[str]]) -> dict[str, str]:
    """Return the leaf tests to record for these modules, each with its module.

    Raises:
        MutationError: there is no such test or parameter set.
    """
    found = {}
    for module, expectation in known.items():
        there = sets.get(expectation.test, [])
        wanted = [one for one in there if one.partition("[")[2][:-1] in expectation.sets]
        chosen = wanted if expectation.sets else there[-1:]
        if len(chosen) != max(len(expectation.sets), 1):
            raise MutationError(f"{module}: expected sets {expectation.sets} of {expectation.test}, got {chosen}")
        found |= dict.fromkeys(chosen, module)
    return found


def _pytest(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", *arguments], cwd=LEAVES.parents[2], env=os.environ | environment,
        capture_output=True, text=True, check=False,
    )  # fmt: skip


def record(tests: Iterable[str], directory: Path, jobs: int) -> None:
    """Run leaf tests with recording switched on; a recording of the same sources is kept.

    Raises:
        MutationError: a test failed.
    """
    packages = (Path(package.__path__[0]) for package in (raycaster, rtl, golden, hdl))
    checks = Path(expected.__file__), Path(recording.__file__)
    made_of = digest(os.environ.get(seeds.VARIABLE), LEAVES.parent, *checks, *packages)
    stamps = {test: directory / f"{_recording_of(test)}.stamp" for test in tests}
    missing = [test for test, stamp in stamps.items() if not stamp.exists() or stamp.read_text() != made_of]
    if not missing:
        return
    options = "-n", str(jobs), "--dist", "worksteal"
    done = _pytest(*options, *missing, **{RECORD_VARIABLE: str(directory.resolve())})
    if done.returncode:
        raise MutationError(f"the leaf tests could not be recorded:\n{done.stdout[-2000:]}{done.stderr[-1000:]}")
    for test in missing:
        stamps[test].write_text(made_of)


def _recording_of(test: str) -> str:
    return recording_name(test.partition("::")[2])


def count_outcomes(results: Iterable[Result]) -> dict[str, int]:
    """Count the mutants with each outcome."""
    counts = Counter(mutant.outcome for result in results for mutant in result.mutants)
    return {outcome: counts[outcome] for outcome in OUTCOMES}


def share_caught(results: Iterable[Result]) -> float:
    """Return the caught share of the mutants that are not equivalent; explained ones count as not caught."""
    counts = count_outcomes(results)
    different = counts["caught"] + counts["explained"] + counts["surviving"]
    return counts["caught"] / different if different else 1.0


def by_module(results: Iterable[Result]) -> dict[str, list[Result]]:
    """Return the results of each module."""
    ordered = sorted(results, key=attrgetter("module"))
    return {module: list(of_module) for module, of_module in groupby(ordered, attrgetter("module"))}


def _table(results: list[Result]) -> Table:
    table = Table("module", "mutants", *OUTCOMES, "of all", "of the rest", "seconds", title="Mutants of each module")
    for label, chosen in {**by_module(results), "all": results}.items():
        counts = count_outcomes(chosen)
        total = sum(counts.values())
        table.add_row(
            label, total, *counts.values(), f"{counts['caught'] / max(total, 1):.1%}", f"{share_caught(chosen):.1%}",
            f"{sum(result.seconds for result in chosen):.0f}", style="bold" if label == "all" else "",
        )  # fmt: skip
    return table


def complaints(results: list[Result], known: Mapping[str, Expectation]) -> list[str]:
    """List the reasons why the command fails; all explanations of the known modules must be needed."""
    found = []
    for module, of_module in by_module(results).items():
        mutants = [(result.recording, mutant) for result in of_module for mutant in result.mutants]
        for vectors, mutant in mutants:
            if mutant.outcome == "surviving":
                found.append(f"{module}: survives the vectors of {vectors}: {mutant}")
        if share_caught(of_module) < LEAST_CAUGHT:
            found.append(f"{module}: fewer than {LEAST_CAUGHT:.0%} of the mutants that differ are caught")
        explained = [str(mutant) for _, mutant in mutants if mutant.outcome == "explained"]
        for pattern in known[module].explained if module in known else ():
            if not any(fits(pattern, text) for text in explained):
                found.append(f"{module}: needed by no mutant: {pattern}")
    return found


@dataclass(frozen=True)
class Job:
    """A recording to work on, without the explanations, which do not change what survives."""

    test: str
    module: str
    build: Path
    mutants: int
    seed: int
    expectation: Expectation

    @property
    def name(self) -> str:
        """Name of the recording."""
        return _recording_of(self.test)

    @property
    def directory(self) -> Path:
        """Directory of the recording."""
        return self.build / "recordings" / self.name

    def place(self) -> Path:
        """Return the file in which the result is kept."""
        files = sorted(path for path in self.directory.iterdir() if path.is_file())
        choice = self.mutants, self.seed, replace(self.expectation, test="", sets=())
        tools = inspect.getsource(Recording), SOURCES / "equivalence.py", SOURCES / "replay.cpp"
        key = digest(choice, [path.name for path in files], *files, *tools)
        return self.build / "results" / f"{self.name}-{key}.pickle"

    def run(self) -> Result | str:
        """Return the result, or an error message."""
        try:
            recording = Recording(self.directory, self.build / "work" / self.name)
            if recording.module != self.module:
                return f"{self.test}: expected a test of {self.module}, got one of {recording.module}"
            return recording.run(self.mutants, self.seed, self.expectation)
        except UserError as error:
            return f"{self.test}: {error}"


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify mutate", __doc__, "--module divider")
    parser.add_argument("--module", action="append", metavar="NAME", help="mutate only this module; repeatable")
    parser.add_argument(
        "--mutants", type=positive, default=MUTANTS, help="most faults per recording (default: %(default)s)"
    )
    parser.add_argument("--seed", type=positive, default=SEED, help="seed of the faults (default: %(default)s)")
    add_job_options(parser)
    add_fresh_option(parser)
    parser.add_argument("--build", type=Path, default=Path("build/mutation"), help="output directory (%(default)s)")
    add_keep_option(parser)
    return parser


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog of the designs whose modules get faults."""
    return verilog_digest(*with_all_looks())


def unmutated(known: Iterable[str]) -> list[str]:
    """List the blocks of the hardware that are not among these modules."""
    return sorted({*blocks()} - {*known})


def main(argv: list[str] | None = None) -> int:
    """Run the command; it fails if a survivor is not explained, an explanation is stale, or too few are caught."""
    arguments = command_parser().parse_args(argv)
    arguments.build = arguments.build.resolve()  # tools run in the folders below it
    ensure_tools.ensure("icarus")
    if missing := missing_tools():
        raise UserError(f"{', '.join(missing)} not found; install the extra `formal` of this package")
    known = expectations()
    for module in arguments.module or []:
        if module not in known:
            raise UserError(f"module: got {module}, expected one of {', '.join(known)}")
    known = {module: known[module] for module in arguments.module or known}
    console = Console()
    with console.waiting("recording the leaf tests"):
        tests = recordings(known, leaf_tests())
        record(tests, arguments.build / "recordings", arguments.jobs)
    jobs = [
        Job(test, module, arguments.build, arguments.mutants, arguments.seed, replace(known[module], explained={}))
        for test, module in tests.items()
    ]

    def finished(job: Job, found: Result | str) -> None:
        """Print a line for each recording, for a log without a progress bar."""
        said = found if isinstance(found, str) else f"{found.seconds:.0f} s, {share_caught([found]):.1%} caught"
        console.print(f"{job.name}: {said}", soft_wrap=True)

    kept = Kept(Job.place, arguments.fresh, complete=lambda found: isinstance(found, Result))
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        done = run_jobs("recordings", Job.run, jobs, make_executor, console, kept=kept, finished=finished)
    results = [one for one in done if isinstance(one, Result)]
    failures = [one for one in done if isinstance(one, str)]
    for result in results:
        result.explain(known[result.module].explained)
    (arguments.build / "results.json").write_text(json.dumps([asdict(result) for result in results], indent=2) + "\n")
    console.print(_table(results))
    shares = {module: share_caught(of_module) for module, of_module in by_module(results).items()}
    worst = min(shares, key=shares.__getitem__, default="")
    figures = {
        "modules": len(shares), "recordings": len(results), **count_outcomes(results), "not_run": len(failures),
        "caught_of_the_rest": share_caught(results), "worst": worst, "worst_caught": shares.get(worst),
    }  # fmt: skip
    keep(arguments, figures, verilog, ", ".join(unmutated(known)))
    # Other choices of faults need not have the survivors that are explained.
    usual = (arguments.mutants, arguments.seed) == (MUTANTS, SEED)
    found = failures + complaints(results, known if usual and not failures else {})
    for complaint in found:
        console.print(complaint, style="red", soft_wrap=True)
    return 1 if found else 0
