# SPDX-License-Identifier: MIT
"""A bench for one block, which runs the same inputs in MyHDL's simulator and in the converted Verilog."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from myhdl import Simulation, StopSimulation, block, delay, instance

from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.errors import faults_in_one_line
from raycaster.hdl.hierarchy import Module, Port, convert_hierarchy
from raycaster.hdl.records import Record, is_interface, port_signals
from raycaster.hdl.verilog_style import without_power_up

Cycle = Mapping[str, int]


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

    most_in_myhdl: ClassVar[int | None] = None
    """Most cycles that `run_both` simulates in MyHDL, from the first cycle in which values must be known; None: all."""

    simulator: ClassVar[str] = "icarus"
    """Verilog simulator: icarus, or verilator, which knows no unknown bits and takes seconds to compile a block."""

    recorder: ClassVar[Callable[[Any, Sequence[Cycle], Sequence[Cycle], int], None] | None] = None
    """Called with the leaf, the stimulus, the expected outputs and `settled` after each `run_both` with MyHDL."""

    def __init__(self, function: Callable, arguments: Callable[[], dict[str, Any]], directory: Path):
        self._function, self._arguments, self._directory = function, arguments, directory
        with elaboration(), faults_in_one_line():
            self.modules: list[Module] = convert_hierarchy(
                function(**arguments()), directory, "// {module}", vhdl=False
            )
        self.verilog: Sequence[Path] = [module.path for module in self.modules]
        """Files that `run_verilog` simulates; another form of the same block, such as its netlist, may replace them."""
        ports = self.modules[-1].ports
        self.inputs = {port.name: port for port in ports if not port.output and port.name != "clk"}
        self.outputs = {port.name: port for port in ports if port.output}
        layouts = _layouts(arguments())
        self.given, self.seen = (_members(ports, layouts) for ports in (self.inputs, self.outputs))
        """Members that a stimulus sets, and that a run returns, by name."""
        self.clocked = any(port.name == "clk" for port in ports)

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
                    if self.clocked:
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

    def run_verilog(self, stimulus: Sequence[Cycle], power_up: bool = True) -> list[dict[str, int | None]]:
        """Simulate the converted Verilog; as `run_myhdl`, with None for an output that has an unknown bit.

        Args:
            stimulus: values for the inputs, by cycle.
            power_up: False to let registers and memories begin unknown, whatever their initial values.

        Raises:
            AssertionError: the simulator refuses the Verilog; its output.
        """
        words = self.input_words(stimulus)
        (self._directory / "stimulus.hex").write_text("".join(f"{word:x}\n" for word in words))
        width = sum(port.width for port in self.inputs.values())
        (self._directory / "leaf_bench.v").write_text(self._bench(width, len(stimulus)))
        sources = ["leaf_bench.v", *(str(path.resolve()) for path in self.verilog)]
        if not power_up:
            sources = ["leaf_bench.v", "leaf_unknown.v"]
            texts = (without_power_up(path.read_text()) for path in self.verilog)
            (self._directory / "leaf_unknown.v").write_text("".join(texts))
        if self.simulator == "verilator":
            flags = ("--binary", "-Wno-fatal", "-Wno-lint", "-CFLAGS", "-fcoroutines -std=gnu++20")
            self._call("verilator", *flags, "--top", "leaf_bench", "-o", "leaf", *sources)
            self._call("obj_dir/leaf")
        else:
            self._call("iverilog", "-g2005", "-Wall", "-Wno-timescale", "-s", "leaf_bench", "-o", "leaf", *sources)
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
        """Run both and check that they agree; where MyHDL is not simulated, check that values in Verilog are known.

        Args:
            stimulus: values for the inputs, by cycle; an input that a cycle does not mention keeps its value, which
                is 0 at first.
            settled: the first cycle from which values in Verilog must be known and agree, with registers and memories
                that start unknown; 0: from the start, with their initial values.

        Returns:
            The outputs of each cycle; unknown outputs of Verilog, possible before `settled`, are None.

        Raises:
            AssertionError: the first difference, or unknown output, with its cycle.
        """
        actual = self.run_verilog(stimulus, power_up=not settled)
        assert len(actual) == len(stimulus)
        most = len(stimulus) if self.most_in_myhdl is None else settled + self.most_in_myhdl
        expected = self.run_myhdl(stimulus[:most]) if self.with_myhdl else []
        for cycle in range(settled, len(expected)):
            assert actual[cycle] == expected[cycle], (
                f"{self._function.__name__}, cycle {cycle}: Verilog {actual[cycle]}, MyHDL {expected[cycle]}"
            )
        for cycle in range(max(settled, len(expected)), len(stimulus)):
            unknown = [name for name, value in actual[cycle].items() if value is None]
            assert not unknown, f"{self._function.__name__}, cycle {cycle}: unknown {', '.join(unknown)}"
        if self.recorder:
            self.recorder(stimulus, expected, settled)
        return [*expected, *actual[len(expected) :]]

    def input_words(self, stimulus: Sequence[Cycle]) -> list[int]:
        """All inputs of each cycle as one vector, the first port in the highest bits."""
        return [_joined(self.inputs, words) for words in self._port_words(stimulus)]

    def output_words(self, outputs: Sequence[Cycle]) -> list[int]:
        """All outputs of each cycle as one vector, the first port in the highest bits."""
        return [_joined(self.outputs, _words(self.seen, cycle)) for cycle in outputs]

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
        names = ["clk"] * self.clocked + [*self.inputs, *self.outputs]
        module = self.modules[-1].name
        tick = "clk = 1; #1; clk = 0; #1;" if self.clocked else ""
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


def _layouts(arguments: Mapping[str, Any]) -> dict[str, Record]:
    """Return the records among a block's arguments, by the name of their port."""
    found = {}
    for name, value in arguments.items():
        if isinstance(value, Record):
            found[f"{name}_word"] = value
        elif is_interface(value):
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
