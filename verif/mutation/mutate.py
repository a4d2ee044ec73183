# SPDX-License-Identifier: MIT
"""`raycaster verify mutate`: plant faults in every module and check that its leaf tests notice (mutation testing).

The leaf tests run once and record their inputs and the outputs that they expect. Then, for each recording, Yosys plants
up to --mutants faults in the Verilog of the module under test, spread over its cells: an inverted or stuck bit of a
cell's port, always or depending on another bit. Input bits that a submodule does not read get no fault, because it
would have no effect. Verilator compiles the netlist with all faults and an input that chooses one, and each fault is
replayed. It is caught if an output differs from the expected one in a cycle that the test checks. Registers start as
zeros, as ones and at random, because they are unknown in the tests' simulator.

The survivors are listed, to be read: about one in twenty changes nothing that an output could show. It is an error if a
module catches less than LEAST_CAUGHT of the share in results/mutate.json, with the same number of faults and seed.
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
import tomllib
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import attrgetter
from pathlib import Path
from typing import Any

import raycaster
from raycaster import golden, hdl, rtl
from raycaster.convert.digest import verilog_digest
from raycaster.design.options import CommandParser
from raycaster.errors import UserError
from raycaster.output import Console, Table, emptied
from raycaster.runs.digests import digest
from raycaster.runs.jobs import Kept, add_fresh_option, add_job_options, executors, positive, run_jobs
from raycaster.runs.outcomes import RESULTS, add_keep_option, keep, kept_outcome
from raycaster.runs.tools import ToolError, run_yosys
from raycaster.sim import ensure_tools
from raycaster.sim.simulator import build_program
from raycaster.verif import expected, recording, seeds
from raycaster.verif.formal.prover import with_all_features
from raycaster.verif.recording import RECORD_VARIABLE, recording_name

SOURCES = Path(__file__).parent
RTL = Path(rtl.__file__).parent
LEAVES = SOURCES.resolve().parent / "tests" / "leaves"
KEPT = RESULTS / "mutate.json"
MUTANTS = 200
SEED = 20150
LEAST_CAUGHT = 0.97
"""Minimum share of the mutants that each module caught in the kept figures."""


class MutationError(ToolError):
    """Mutation testing failed, or the data file does not match the design."""


@dataclass(frozen=True)
class Leaf:
    """Leaf test whose recordings a module is mutated with, and its parameter sets; none for its last one."""

    test: str
    sets: Sequence[str] = ()


def blocks() -> list[str]:
    """List the blocks of the hardware, each in the file with its name."""
    return sorted(path.stem for path in RTL.rglob("*.py") if f"@block\ndef {path.stem}(" in path.read_text())


def leaves_of_modules(path: Path = SOURCES / "mutation.toml") -> dict[str, Leaf]:
    """Return the leaf test of each block that is mutated, from the data file.

    Raises:
        MutationError: it has an unknown key, or names no block.
    """
    found = {name: Leaf(f"test_{name}") for name in blocks()}
    for kind, entries in tomllib.loads(path.read_text()).items():
        for module, value in entries.items():
            if module not in found or kind not in ("left_out", *Leaf.__dataclass_fields__):
                raise MutationError(f"{path.name}: {kind}.{module}: there is no such block or key")
            if kind == "left_out":
                del found[module]
            else:
                found[module] = replace(found[module], **{kind: value})
    return found


@dataclass
class Mutant:
    """A planted fault.

    Attributes:
        selector: the number that chooses it.
        mode: inv, const0, const1; cnot0 and cnot1 invert if another bit is 0 or 1.
        kind: kind of the cell: add, procmux, procdff, a submodule's instance, ...
        port: port of the cell, with the bit.
        at: the Verilog that the cell was made from.
        caught: the cycle that caught it, or -1.
    """

    selector: int
    mode: str
    kind: str
    port: str
    at: str
    caught: int = -1

    def __str__(self) -> str:
        return f"{self.mode} {self.kind} {self.port} at `{self.at}`"


@dataclass
class Result:
    """Mutants of a recording."""

    module: str
    recording: str
    mutants: list[Mutant]


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

    def run(self, count: int, seed: int) -> Result:
        """Plant up to `count` faults and replay them.

        Raises:
            MutationError: there is no place for a fault, or the replay fails without one.
        """
        mutants = self.plant(count, seed)
        if not mutants:
            raise MutationError(f"{self.module} has no cell that a fault could be in")
        self._replay(mutants)
        return Result(self.module, self.name, mutants)

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

    def plant(self, count: int, seed: int) -> list[Mutant]:
        """Choose up to `count` faults, and write the netlist with all of them."""
        lines = self._choose(count, seed)
        written = f"write_verilog -noattr -selected {self.module}_mutants.v"
        run_yosys(self._work, "plant", [*self._read(), *lines, written])
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
        """True if the fault is in a bit that a submodule does not read, or where Yosys allows none."""
        options = dict(re.findall(r"-(cell|port|portbit) (\S+)", line))
        # A fault at a register's output takes its initial value away.
        if options["port"] == "Q" and not self._leaf["settled"]:
            return True
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
        return Mutant(number, options["mode"], kind, f"{options['port']}[{options['portbit']}]", " / ".join(texts))

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
            mutant.caught = int(line.split()[1])

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


def leaf_tests(*arguments: str) -> dict[str, list[str]]:
    """Return the parameter sets of each leaf test, as pytest names them, with these arguments of pytest."""
    sets = defaultdict(list)
    for line in _pytest("--collect-only", *arguments, str(LEAVES)).stdout.splitlines():
        sets[line.partition("[")[0].rpartition("::")[2]].append(line)
    return sets


def recordings(known: Mapping[str, Leaf], sets: Mapping[str, list[str]]) -> dict[str, str]:
    """Return the leaf tests to record for these modules, each with its module.

    Raises:
        MutationError: there is no such test or parameter set.
    """
    found = {}
    for module, leaf in known.items():
        there = sets.get(leaf.test, [])
        wanted = [one for one in there if one.partition("[")[2][:-1] in leaf.sets]
        chosen = wanted if leaf.sets else there[-1:]
        if len(chosen) != max(len(leaf.sets), 1):
            raise MutationError(f"{module}: expected sets {leaf.sets} of {leaf.test}, got {chosen}")
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


def by_module(results: Iterable[Result]) -> dict[str, list[int]]:
    """Return the numbers of mutants that were caught, and that survived, in each module."""
    found: dict[str, list[int]] = {}
    for result in sorted(results, key=attrgetter("module")):
        for mutant in result.mutants:
            found.setdefault(result.module, [0, 0])[mutant.caught < 0] += 1
    return found


def share_caught(counts: Sequence[int]) -> float:
    """Return the caught share of a module's mutants."""
    return counts[0] / sum(counts)


def complaints(counts: Mapping[str, Sequence[int]], before: Mapping[str, Sequence[int]]) -> list[str]:
    """List the modules that catch less than `LEAST_CAUGHT` of their share in earlier counts."""
    return [
        f"{module}: {share_caught(counts[module]):.1%} of the mutants are caught, {share_caught(earlier):.1%} before"
        for module, earlier in before.items()
        if module in counts and share_caught(counts[module]) < LEAST_CAUGHT * share_caught(earlier)
    ]


@dataclass(frozen=True)
class Job:
    """A recording to work on."""

    test: str
    module: str
    build: Path
    mutants: int
    seed: int

    @property
    def directory(self) -> Path:
        """Directory of the recording."""
        return self.build / "recordings" / _recording_of(self.test)

    def place(self) -> Path:
        """Return the file in which the result is kept."""
        files = sorted(path for path in self.directory.iterdir() if path.is_file())
        tools = inspect.getsource(Recording), SOURCES / "replay.cpp"
        key = digest(self.mutants, self.seed, [path.name for path in files], *files, *tools)
        return self.build / "results" / f"{self.directory.name}-{key}.pickle"

    def run(self) -> Result | str:
        """Return the result, or an error message."""
        try:
            recording = Recording(self.directory, self.build / "work" / self.directory.name)
            if recording.module != self.module:
                return f"{self.test}: expected a test of {self.module}, got one of {recording.module}"
            return recording.run(self.mutants, self.seed)
        except UserError as error:
            return f"{self.test}: {error}"


def mutate(
    known: Mapping[str, Leaf], mutants: int, seed: int, arguments: argparse.Namespace, console: Console
) -> tuple[list[Result], list[str]]:
    """Record the leaf tests of these modules and replay their mutants.

    Args:
        known: the modules.
        mutants: most faults per recording.
        seed: seed of the faults.
        arguments: options of jobs, `fresh`, and the directory `build`.
        console: console for the progress.

    Returns:
        The results, and the messages of recordings that failed.
    """
    ensure_tools.ensure("icarus")
    build = arguments.build.resolve()  # tools run in the folders below it
    with console.waiting("recording the leaf tests"):
        tests = recordings(known, leaf_tests())
        record(tests, build / "recordings", arguments.jobs)
    jobs = [Job(test, module, build, mutants, seed) for test, module in tests.items()]

    def finished(job: Job, found: Result | str) -> None:
        """Print a line for each recording, for a log without a progress bar."""
        said = found if isinstance(found, str) else f"{share_caught(by_module([found])[job.module]):.1%} caught"
        console.print(f"{job.directory.name}: {said}", soft_wrap=True)

    kept = Kept(Job.place, arguments.fresh, complete=lambda found: isinstance(found, Result))
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        done = run_jobs("recordings", Job.run, jobs, make_executor, console, kept=kept, finished=finished)
    return [one for one in done if isinstance(one, Result)], [one for one in done if isinstance(one, str)]


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify mutate", __doc__, "--module divider")
    only = "mutate only this module; repeatable"
    parser.add_argument("--module", action="append", choices=leaves_of_modules(), metavar="NAME", help=only)
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
    """Digest the Verilog that is mutated, in designs that have all its blocks."""
    return verilog_digest(*with_all_features())


def main(argv: list[str] | None = None) -> int:
    """Run the command; it fails if a module catches less than before, or a recording failed."""
    arguments = command_parser().parse_args(argv)
    known = leaves_of_modules()
    known = {module: known[module] for module in arguments.module or known}
    console = Console()
    results, failures = mutate(known, arguments.mutants, arguments.seed, arguments, console)
    survivors = [f"{one.module}: {mutant}" for one in results for mutant in one.mutants if mutant.caught < 0]
    (arguments.build / "survivors.txt").write_text("".join(f"{line}\n" for line in survivors))
    counts = by_module(results)
    table = Table("module", "caught", "surviving", "share caught", title="Mutants of each module")
    total = [sum(each) for each in zip(*counts.values(), strict=True)]
    for label, found in {**counts, "all": total}.items() if counts else ():
        table.add_row(label, *found, f"{share_caught(found):.1%}")
    console.print(table)
    console.print(f"survivors: {arguments.build / 'survivors.txt'}", soft_wrap=True)
    if counts:
        worst = min(counts, key=lambda module: share_caught(counts[module]))
        figures = {
            "modules": len(counts), "caught": total[0], "surviving": total[1], "not_run": len(failures),
            "worst": worst, "worst_caught": share_caught(counts[worst]), "by_module": counts,
        }  # fmt: skip
        keep(arguments, figures, verilog, ", ".join(sorted({*blocks()} - {*known})))
    usual = (arguments.mutants, arguments.seed) == (MUTANTS, SEED) and KEPT.exists()
    before = kept_outcome(KEPT).figures.get("by_module", {}) if usual else {}
    complaint = failures + complaints(counts, before)
    for line in complaint:
        console.print(line, style="red", soft_wrap=True)
    return 1 if complaint else 0
