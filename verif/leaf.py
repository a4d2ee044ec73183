# SPDX-License-Identifier: MIT
"""A bench for one block, which runs the same inputs in MyHDL's simulator and in the converted Verilog."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any

from myhdl import ResetSignal, Simulation, StopSimulation, block, delay, instance

from raycaster.complaints import fault_in_block
from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.convert.elaboration import elaboration
from raycaster.convert.hierarchy import Module, Port, convert_hierarchy
from raycaster.convert.inside import port_signals
from raycaster.engines.exact import PATTERN_LATENCY
from raycaster.errors import UserError
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.output import emptied
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.common.records import Record

Cycle = Mapping[str, int]

EARLY_OUT_AT = 2
"""Cycles from the start of a rectangle that no ray runs towards to its early out, the last cycle of its slot."""

RECORD_VARIABLE = "RAYCASTER_RECORD"
"""Environment variable: the directory in which `Leaf.run_both` records each run, under the name of its test."""


@dataclass(frozen=True)
class Member:
    """A port, or a field of a record at a port, as stimuli and expectations name it."""

    port: str
    width: int
    low: int = 0
    """Lowest bit of the member within the port."""


class Leaf:
    """A block with given parameters and new signals at its ports; a record's fields replace its port.

    Args:
        function: the block.
        arguments: creates the block's arguments for each elaboration: signals, interfaces, configuration.
        directory: scratch space for the Verilog.
    """

    with_myhdl = True
    """True if `run_both` also simulates MyHDL. As that is slow, tests do it for one parameter set per block."""

    def __init__(self, function: Callable, arguments: Callable[[], dict[str, Any]], directory: Path):
        self._function, self._arguments, self._directory = function, arguments, directory
        try:
            with elaboration():
                top = function(**arguments())
            self.modules: list[Module] = convert_hierarchy(top, directory, "// {module}")
        except Exception as error:
            if fault := fault_in_block(error):
                raise UserError(fault) from None
            raise
        self.verilog: Sequence[Path] = [module.path for module in self.modules]
        """Files that `run_verilog` simulates; another form of the same block, such as its netlist, may replace them."""
        ports = self.modules[-1].ports
        self.inputs = {port.name: port for port in ports if not port.output and port.name != "clk"}
        self.outputs = {port.name: port for port in ports if port.output}
        layouts = _layouts(arguments())
        self.given, self.seen = (_members(ports, layouts) for ports in (self.inputs, self.outputs))
        """Members that a stimulus sets, and that a run returns, by name."""
        self._clocked = any(port.name == "clk" for port in ports)

    @elaboration()
    def run_myhdl(self, stimulus: Sequence[Cycle]) -> list[dict[str, int]]:
        """Simulate MyHDL; return each cycle's outputs just before the clock rises, as two's complement bit patterns."""
        arguments = self._arguments()
        signals = port_signals(arguments)
        recorded: list[dict[str, int]] = []

        @block
        def bench():
            dut = self._function(**arguments)

            @instance
            def drive():
                for words in self._port_words(stimulus):
                    for name, value in words.items():
                        port = self.inputs[name]
                        negative = port.signed and value >> (port.width - 1) & 1
                        signals[name].next = value - (1 << port.width) if negative else value
                    yield delay(1)
                    recorded.append(self._members_of({name: int(signals[name].val) for name in self.outputs}))
                    if self._clocked:
                        signals["clk"].next = True
                        yield delay(1)
                        signals["clk"].next = False
                        yield delay(1)
                raise StopSimulation

            return dut, drive

        simulation = Simulation(bench())
        try:
            simulation.run(quiet=1)
        finally:
            simulation.quit()
        return recorded

    def run_verilog(self, stimulus: Sequence[Cycle]) -> list[dict[str, int | None]]:
        """Simulate the converted Verilog in Icarus; as `run_myhdl`, with None for an output that has an unknown bit."""
        words = self._input_words(stimulus)
        (self._directory / "stimulus.hex").write_text("".join(f"{word:x}\n" for word in words))
        width = sum(port.width for port in self.inputs.values())
        (self._directory / "leaf_bench.v").write_text(self._bench(width, len(stimulus)))
        sources = [str(path.resolve()) for path in self.verilog]
        self._call(
            "iverilog", "-g2005", "-Wall", "-Wno-timescale", "-s", "leaf_bench", "-o", "leaf", "leaf_bench.v", *sources
        )
        self._call("vvp", "-n", "leaf")
        recorded = []
        for line in (self._directory / "outputs.txt").read_text().splitlines():
            bits = dict(zip(self.outputs, line.split(), strict=True))
            fields = {}
            for name, member in self.seen.items():
                text = bits[member.port]
                text = text[len(text) - member.low - member.width : len(text) - member.low]
                fields[name] = int(text, 2) if set(text) <= {"0", "1"} else None
            recorded.append(fields)
        return recorded

    def run_both(self, stimulus: Sequence[Cycle], settled: int = 0) -> Sequence[Mapping[str, int | None]]:
        """Run both and check that they agree; without `with_myhdl`, run Verilog and check that values are known.

        Args:
            stimulus: values for the inputs, by cycle; an input that a cycle does not mention keeps its value, which
                is 0 at first.
            settled: the first cycle from which Verilog's registers, which start unknown, must have known values.

        Returns:
            The outputs of each cycle; unknown outputs of Verilog, possible before `settled`, are None.

        Raises:
            AssertionError: the first difference, or unknown output, with its cycle.
        """
        actual = self.run_verilog(stimulus)
        assert len(actual) == len(stimulus)
        if not self.with_myhdl and RECORD_VARIABLE not in os.environ:
            for cycle in range(settled, len(stimulus)):
                unknown = [name for name, value in actual[cycle].items() if value is None]
                assert not unknown, f"{self._function.__name__}, cycle {cycle}: unknown {', '.join(unknown)}"
            return actual
        expected = self.run_myhdl(stimulus)
        for cycle in range(settled, len(stimulus)):
            assert actual[cycle] == expected[cycle], (
                f"{self._function.__name__}, cycle {cycle}: Verilog {actual[cycle]}, MyHDL {expected[cycle]}"
            )
        if RECORD_VARIABLE in os.environ:
            # pytest sets it to "path::test[parameters] (call)".
            test = os.environ["PYTEST_CURRENT_TEST"].rpartition("::")[2].rpartition(" ")[0]
            self.record(Path(os.environ[RECORD_VARIABLE]) / recording_name(test), stimulus, expected, settled)
        return expected

    def record(
        self, directory: Path, stimulus: Sequence[Cycle], expected: Sequence[Mapping[str, int]], settled: int
    ) -> None:
        """Record a run, so that it can be replayed without MyHDL.

        Args:
            directory: replaced; gets the Verilog files, `leaf.json`, which describes them, and `vectors.txt`: one
                line per cycle, with a vector of all inputs and a vector of all outputs, the first port in the highest
                bits, in 32-bit hexadecimal words, the lowest first.
            stimulus: as for `run_both`.
            expected: outputs of each cycle.
            settled: the first cycle from which outputs must be as expected.
        """
        emptied(directory)
        data = set()
        for module in self.modules:
            # Initial words of a memory are in a file of the test, which pytest removes.
            text = module.path.read_text()
            for path in re.findall(r'\$readmemh\("(.+?)"', text):
                shutil.copy(path, directory)
                data.add(Path(path).name)
                text = text.replace(path, Path(path).name)
            (directory / module.path.name).write_text(text)
        inputs, outputs = ({name: port.width for name, port in ports.items()} for ports in (self.inputs, self.outputs))
        description = {
            "module": self.modules[-1].name,
            "files": [module.path.name for module in self.modules],
            "data": sorted(data),
            "clocked": self._clocked,
            "inputs": inputs,
            "outputs": outputs,
            "settled": settled,
            "cycles": len(stimulus),
        }
        (directory / "leaf.json").write_text(json.dumps(description, indent=2) + "\n")
        input_words = self._input_words(stimulus)
        output_words = [_joined(self.outputs, _words(self.seen, cycle)) for cycle in expected]
        lines = (
            f"{_split(given, sum(inputs.values()))} {_split(wanted, sum(outputs.values()))}\n"
            for given, wanted in zip(input_words, output_words, strict=True)
        )
        (directory / "vectors.txt").write_text("".join(lines))

    def _input_words(self, stimulus: Sequence[Cycle]) -> list[int]:
        """All inputs of each cycle as one vector, the first port in the highest bits."""
        return [_joined(self.inputs, words) for words in self._port_words(stimulus)]

    def _port_words(self, stimulus: Sequence[Cycle]) -> Iterator[dict[str, int]]:
        """Yield the value of every input port in each cycle.

        Raises:
            KeyError: a stimulus has a name that is not an input of the block.
        """
        held = dict.fromkeys(self.given, 0)
        for cycle in stimulus:
            if strangers := set(cycle) - set(held):
                raise KeyError(f"{self._function.__name__} has no input {', '.join(sorted(strangers))}")
            held |= cycle
            yield _words(self.given, held)

    def _members_of(self, words: Mapping[str, int]) -> dict[str, int]:
        return {name: words[one.port] >> one.low & (1 << one.width) - 1 for name, one in self.seen.items()}

    def _bench(self, width: int, cycles: int) -> str:
        declarations = [f"reg [{port.width - 1}:0] {name} = 0;" for name, port in self.inputs.items()]
        declarations += [f"wire [{port.width - 1}:0] {name};" for name, port in self.outputs.items()]
        names = ["clk"] * self._clocked + [*self.inputs, *self.outputs]
        module = self.modules[-1].name
        tick = "clk = 1; #1; clk = 0; #1;" if self._clocked else ""
        return f"""module leaf_bench;
reg clk = 0;
reg [{width - 1}:0] stimulus [0:{cycles - 1}];
{chr(10).join(declarations)}
integer cycle, file;
{module} dut ({", ".join(f".{name}({name})" for name in names)});
initial begin
    $readmemh("stimulus.hex", stimulus);
    file = $fopen("outputs.txt", "w");
    for (cycle = 0; cycle < {cycles}; cycle = cycle + 1) begin
        {{{", ".join(self.inputs)}}} = stimulus[cycle];
        #1;
        $fdisplay(file, "{" ".join(["%b"] * len(self.outputs))}", {", ".join(self.outputs)});
        {tick}
    end
    $fclose(file);
end
endmodule
"""

    def _call(self, *command: str) -> None:
        done = subprocess.run(command, cwd=self._directory, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{' '.join(command)}: {done.stdout}{done.stderr}"


def recording_name(test: str) -> str:
    """Return the name of a recording's directory: its test with parameters, without characters unsuited to paths."""
    return re.sub(r"[^\w.-]+", "-", test).strip("-")


def _layouts(arguments: Mapping[str, Any]) -> dict[str, Record]:
    """Return the records among a block's arguments, by the name of their port."""
    found = {}
    for name, value in arguments.items():
        if isinstance(value, Record):
            found[f"{name}_word"] = value
        elif getattr(value, "is_interface", False):
            found |= _layouts({f"{name}_{attribute}": one for attribute, one in vars(value).items()})
    return found


def _members(ports: Mapping[str, Port], records: Mapping[str, Record]) -> dict[str, Member]:
    """Return each port as a member, or for the word of a record its fields."""
    found = {}
    for name, port in ports.items():
        if name not in records:
            found[name] = Member(name, port.width)
            continue
        low = port.width
        for field, width in records[name].layout.items():
            low -= width
            found[f"{name.removesuffix('_word')}_{field}"] = Member(name, int(width), low)
    return found


def _words(members: Mapping[str, Member], values: Cycle) -> dict[str, int]:
    """Assemble the value of each port from its members."""
    words = dict.fromkeys((one.port for one in members.values()), 0)
    for name, one in members.items():
        words[one.port] |= values[name] % (1 << one.width) << one.low
    return words


def _joined(ports: Mapping[str, Port], values: Mapping[str, int]) -> int:
    word = 0
    for name, port in ports.items():
        word = word << port.width | values[name] % (1 << port.width)
    return word


def _split(vector: int, width: int) -> str:
    return " ".join(f"{vector >> low & 0xFFFFFFFF:x}" for low in range(0, width, 32))


def reset_signal() -> ResetSignal:
    """Return a reset as all modules use it: synchronous and active high."""
    return ResetSignal(0, active=1, isasync=False)


def sorted_rect(rectangles: Rectangles, index: int, prefix: str, config: Configuration | None = None) -> dict[str, int]:
    """Return what `rect_sorter` must output for a rectangle, as values for the ports of a `Rect` named `prefix`.

    Values of the looks are included if there is a configuration that has them.
    """
    axis = int(rectangles.axes[index])
    u, v = OTHER_AXES[axis]
    low, high = rectangles.low[index], rectangles.high[index]
    fields = {
        "axis": axis,
        "position": low[axis],
        "u_low": low[u],
        "u_high": high[u],
        "v_low": low[v],
        "v_high": high[v],
        "colour": int.from_bytes(bytes(rectangles.colours[index])),
    }
    if config and config.materials:
        fields["mirror"] = rectangles.mirrors[index]
    if config and config.patterns:
        fields["kind"] = rectangles.kinds[index] if rectangles.cells[index] < WORLD_SIZE else 0
        fields["cell"] = int(rectangles.cells[index]).bit_length() - 4
        fields["colour_2"] = int.from_bytes(bytes(rectangles.colours_2[index]))
    return {f"{prefix}_{name}": int(value) for name, value in fields.items()}


@dataclass
class TraceCycle:
    """Expected behaviour of an engine's control in one cycle of tracing a group of rays."""

    steps: dict[str, int]
    """Values for the ports of `steps`."""

    bounce: int
    """0 in the pass of the primary ray, 1 and 2 in those of its reflections."""

    current: int | None = None
    """Rectangle that is held for the dividers to start on; None for don't care."""

    offered: int | None = None
    """Rectangle whose quotients were stored last; in the exact engine the one whose verdict is due."""

    towards: int | None = None
    """1 if a ray runs towards the rectangle that was started; None for don't care."""

    alive: int | None = None
    """1 if a ray still hits anything; None for don't care."""


def step_names(config: Configuration) -> list[str]:
    """List the attributes of `Steps` that the control of a line-buffered engine drives."""
    return [
        name
        for name in vars(Steps())
        if (config.facts.divides or config.patterns or name not in ("load_divider", "store_quotient"))
        and (config.light or name not in ("aim", "from_light", "write_shadow"))
    ]


def slot_length(config: Configuration) -> int:
    """Return the cycles from one rectangle to the next: one, or those for the 9 integer bits and the fraction bits."""
    return -(-(9 + config.fraction_bits) // config.divider_bits) if config.facts.divides else 1


def ends_early(config: Configuration) -> bool:
    """True if a rectangle that no ray runs towards has a slot long enough to be ended early."""
    return bool(config.culling) and slot_length(config) > EARLY_OUT_AT + 1


def trace_cycles(
    config: Configuration,
    usable: Sequence[int],
    reflections: int,
    *,
    may_hit: Collection[int] | None = None,
    behind: Collection[tuple[int, int]] = (),
    lost: int | None = None,
) -> list[TraceCycle]:
    """List the cycles from the one that generates a group's rays to the last before `done`, timed as in the blocks'
    contracts.

    Args:
        config: gives the engine, the divider and culling.
        usable: indices of the rectangles that are enabled and have a plane, ascending.
        reflections: number of reflections of the scene.
        may_hit: indices of the rectangles that a primary ray may hit; None for all.
        behind: (bounce, index) of the rectangles that no ray runs towards.
        lost: the bounce after which no ray is alive.
    """
    division = slot_length(config)
    exact = not config.facts.divides
    offered_after = 3 if exact else division + 4
    idle = {f"steps_{name}": 0 for name in step_names(config)}
    cycles = [TraceCycle(dict(idle), 0)]

    def strobe(cycle: int, *names: str) -> None:
        cycles[cycle].steps |= {f"steps_{name}": 1 for name in names}

    strobe(0, "screen_to_ray", "reset_colour", "reset_z_buf")
    for bounce in range(reflections + 1):
        visited = [index for index in usable if bounce or may_hit is None or index in may_hit]
        early = [ends_early(config) and (bounce, index) in behind for index in visited]
        starts = list(accumulate((EARLY_OUT_AT + 1 if ended else division for ended in early), initial=0))
        offered = [start + offered_after for start, ended in zip(starts, early, strict=False) if not ended]
        # A pass without rectangles only searches for one and adds the background; a lost ray adds it at once.
        traced = lost is None or bounce <= lost
        patterns = PATTERN_LATENCY if config.patterns and exact else 0
        length = 2 + max([starts[-1], *(end + patterns for end in offered)]) if traced else 1
        first = len(cycles)
        cycles += [TraceCycle(idle | {"steps_initial_ray": int(bounce == 0)}, bounce) for _ in range(length)]
        strobe(-1, "add_colour", "reset_z_buf", *(["store_ray"] if bounce < reflections else []))
        cycles[-1].alive = int(lost is None or bounce < lost)
        for index, ended, place in zip(visited if traced else [], early, starts, strict=False):
            start = first + place
            strobe(start, "find_intersection")
            if exact:
                strobe(start + 3, "write_z_buf")
                cycles[start].current = cycles[start + 3].offered = index
                if config.patterns:
                    strobe(start + 4, "load_divider")
                if config.patterns and place == starts[-2]:
                    strobe(start + 7, "store_quotient")
                continue
            cycles[start + 1].towards = int((bounce, index) not in behind)
            strobe(start + 2, "load_divider")
            for cycle in cycles[start : start + (EARLY_OUT_AT + 1 if ended else division)]:
                cycle.current = index
            if not ended:
                strobe(start + 2 + division, "store_quotient")
                strobe(start + 4 + division, "write_z_buf")
                for cycle in cycles[start + 3 + division :]:
                    cycle.offered = index
    # A finished rectangle is held until the next one has finished.
    for before, cycle in pairwise(cycles):
        if not exact and cycle.offered is None:
            cycle.offered = before.offered
    return cycles
