# SPDX-License-Identifier: MIT
"""Plant faults in the model of a property: all of them in one model, with an input that chooses one.

A fault is a text, `place kind` or `place kind in STEPS`: everything that reads the place gets something else, which
must contradict the property within so many steps from reset. The place is `module.signal`, or `module.instance.port`
for an input of that instance alone; a signal may have an index. Kinds are those of `KINDS` and `CELLS`; those of
`OTHERS` with another signal of the module; and `edge`, which moves the limit of each comparison with the signal by one.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from raycaster.verif.formal.prover import Property, make_model, solve

BITS = 8
"""Width of the input that chooses a fault; 0 chooses none."""

STEPS = 12
"""Steps from reset within which a fault contradicts its property, unless it says otherwise."""

Bit = int | str
"""A net of Yosys's JSON, or a constant."""

KINDS: dict[str, Callable[[list[Bit]], list[Bit]]] = {
    "0": lambda bits: ["0"] * len(bits),
    "1": lambda bits: ["1"] * len(bits),
    "short": lambda bits: [*bits[:-1], "0"],
    "signed-short": lambda bits: [*bits[:-1], bits[-2]],
    "halved": lambda bits: [*bits[1:], "0"],
}
"""Kinds that need no cell: a signal that is stuck, or has lost its highest or its lowest bit."""

CELLS = {"inverted": "$not", "negated": "$neg", "increased": "$add", "late": "$dff"}
"""Kinds that are a cell; one more, or a cycle later, for the last ones."""

OTHERS = {"as": None, "and": "$and", "or": "$or", "unless": "$and"}
"""Kinds with another signal: it, both, at least one, or the signal while the other one is low."""

EDGES = {"$lt": "$le", "$le": "$lt", "$gt": "$ge", "$ge": "$gt"}


class Fault(NamedTuple):
    """A fault: the module, an instance if there is one, and the signal or port; the kind; the steps from reset."""

    place: list[str]
    kind: str
    steps: int


def parsed(text: str) -> Fault:
    """Read the text of a fault."""
    what, _, steps = text.partition(" in ")
    place, _, kind = what.partition(" ")
    return Fault(place.split("."), kind, int(steps or STEPS))


class Module:
    """A module of a netlist in Yosys's JSON, to plant faults in."""

    def __init__(self, netlist: dict[str, Any]):
        self._cells: dict[str, Any] = netlist["cells"]
        self._ports: dict[str, Any] = netlist["ports"]
        self._nets: dict[str, Any] = netlist["netnames"]
        self._seen: dict[Bit, Bit] = {}  # what readers of a bit get now
        self._last = max((bit for net in self._nets.values() for bit in net["bits"] if isinstance(bit, int)), default=1)
        self._last = max([self._last, *(bit for bits in self._connected() for bit in bits if isinstance(bit, int))])
        self._chosen = self._fresh(BITS)
        self._ports["fault"] = {"direction": "input", "bits": self._chosen}
        self._nets["fault"] = {"bits": self._chosen, "hide_name": 0, "attributes": {}}

    def pass_on(self, modules: set[str]) -> None:
        """Connect the choice to all instances of these modules."""
        for cell in self._cells.values():
            if cell["type"] in modules:
                cell["port_directions"]["fault"] = "input"
                cell["connections"]["fault"] = self._chosen

    def plant(self, number: int, fault: Fault) -> None:
        """Plant a fault that has this number."""
        *instance, name = fault.place[1:]
        if instance:
            cell = self._cells[instance[0]]
            right = cell["connections"][name]
            cell["connections"][name] = self._either(number, self._wrong(fault.kind, right), right)
        elif fault.kind == "edge":
            self._move_edges(number, {bit for bit in self._bits(name) if isinstance(bit, int)})
        else:
            self._replace(number, fault.kind, name)

    def _bits(self, name: str) -> list[Bit]:
        signal, _, index = name.partition("[")
        nets: list[Bit] = self._nets[signal]["bits"]
        bits = [self._seen.get(bit, bit) for bit in nets]
        return [bits[int(index[:-1])]] if index else bits

    def _replace(self, number: int, kind: str, signal: str) -> None:
        """Let all readers of a signal get something else."""
        bits = self._bits(signal)
        wrong = self._wrong(kind, bits)
        seen = self._fresh(len(bits))
        names: dict[Bit, Bit] = {bit: new for bit, new in zip(bits, seen, strict=True) if isinstance(bit, int)}
        self._seen |= names | {bit: names.get(now, now) for bit, now in self._seen.items()}
        for cell in self._cells.values():
            if not cell["attributes"].get("planted"):
                for port, connected in cell["connections"].items():
                    if cell["port_directions"][port] == "input":
                        cell["connections"][port] = [names.get(bit, bit) for bit in connected]
        inputs = {name: port for name, port in self._ports.items() if port["direction"] == "input"}
        for nets in (self._ports, self._nets):  # what a wrapper peeks at is wrong too
            for name in nets.keys() - inputs.keys():
                now = [names.get(bit, bit) for bit in nets[name]["bits"]]
                nets[name]["bits"] = now if names or name != signal else seen  # a constant has no other readers
        self._either(number, wrong, bits, seen)

    def _move_edges(self, number: int, bits: set[Bit]) -> None:
        found = 0
        for cell in list(self._cells.values()):
            ends = cell["connections"]
            if cell["type"] not in {*EDGES, "$eq", "$ne"} or not any(bits <= set(ends[port]) for port in "AB"):
                continue
            other = {**cell, "type": EDGES.get(cell["type"], cell["type"]), "attributes": {"planted": "1"}}
            moved = {**ends, "Y": self._fresh(len(ends["Y"]))}
            if cell["type"] not in EDGES:
                if not {*ends["B"]} <= {"0", "1"}:
                    continue
                limit = int("".join(map(str, reversed(ends["B"]))), 2) + 1
                moved["B"] = [*reversed(f"{limit:0{len(ends['B'])}b}")]
            found += 1
            self._cells[f"planted{len(self._cells)}"] = other | {"connections": moved}
            output, ends["Y"] = ends["Y"], self._fresh(len(ends["Y"]))
            self._either(number, moved["Y"], ends["Y"], output)
        if not found:
            raise ValueError("no comparison with this signal")

    def _wrong(self, kind: str, bits: list[Bit]) -> list[Bit]:
        word, _, name = kind.partition(" ")
        if kind in KINDS:
            return KINDS[kind](bits)
        if word in OTHERS:
            other = self._bits(name)[: len(bits)]
            other = other + ["0"] * (len(bits) - len(other))
            if word == "unless":
                other = self._cell("$not", {"A": other})
            return self._cell(OTHERS[word], {"A": bits, "B": other}) if OTHERS[word] else other
        if kind == "late":
            return self._cell("$dff", {"CLK": self._bits("clk"), "D": bits})
        one: list[Bit] = ["1"]
        return self._cell(CELLS[kind], {"A": bits} | ({"B": one} if kind == "increased" else {}))

    def _cell(self, kind: str, inputs: dict[str, list[Bit]], to: list[Bit] | None = None) -> list[Bit]:
        """Add a cell of Yosys, and return its output, which is as wide as its first input or D."""
        output = to or self._fresh(1 if kind == "$eq" else len(inputs.get("D", inputs.get("A", []))))
        if kind in {"$mux", "$dff"}:
            parameters = {"WIDTH": f"{len(output):032b}"} | ({"CLK_POLARITY": "1"} if kind == "$dff" else {})
        else:
            parameters = {f"{port}_WIDTH": f"{len(bits):032b}" for port, bits in inputs.items()}
            parameters |= {f"{port}_SIGNED": "0" for port in inputs} | {"Y_WIDTH": f"{len(output):032b}"}
        name = "Q" if kind == "$dff" else "Y"
        directions = dict.fromkeys(inputs, "input") | {name: "output"}
        self._cells[f"planted{len(self._cells)}"] = {
            "hide_name": 1, "type": kind, "parameters": parameters, "attributes": {"planted": "1"},
            "port_directions": directions, "connections": inputs | {name: output},
        }  # fmt: skip
        return output

    def _either(self, number: int, wrong: list[Bit], right: list[Bit], to: list[Bit] | None = None) -> list[Bit]:
        """Add a choice between what is right and, with this fault, what is wrong."""
        chosen = self._cell("$eq", {"A": self._chosen, "B": [*reversed(f"{number:0{BITS}b}")]})
        return self._cell("$mux", {"A": right, "B": wrong, "S": chosen}, to or self._fresh(len(right)))

    def _connected(self) -> list[list[Bit]]:
        return [bits for cell in self._cells.values() for bits in cell["connections"].values()]

    def _fresh(self, count: int) -> list[Bit]:
        self._last += count
        return [*range(self._last - count + 1, self._last + 1)]


def plant(path: Path, faults: Sequence[str]) -> None:
    """Plant faults in a netlist in Yosys's JSON, numbered from 1.

    Raises:
        ValueError: a place does not exist.
    """
    netlist = json.loads(path.read_text())
    modules = {name: Module(module) for name, module in netlist["modules"].items()
               if not int(module["attributes"].get("blackbox", "0"), 2)}  # fmt: skip
    for module in modules.values():
        module.pass_on(set(modules))
    for number, text in enumerate(faults, 1):
        fault = parsed(text)
        try:
            modules[fault.place[0]].plant(number, fault)
        except (KeyError, ValueError) as error:
            raise ValueError(f"{text}: {error}") from error
    path.write_text(json.dumps(netlist))


def model_with_faults(proof: Property, directory: Path) -> None:
    """Write the model of a property with all its faults, as `make_model` writes it without."""
    make_model(proof, directory, lambda path: plant(path, proof.faults))


def outcome(proof: Property, directory: Path, text: str, timeout: float) -> str:
    """Look for a counterexample of a property with one of its faults, and return the solver's outcome.

    Args:
        proof: the property that must not hold.
        directory: the directory of `model_with_faults`.
        text: the fault; an empty one chooses none.
        timeout: time limit in seconds.
    """
    fault, number = parsed(text), proof.faults.index(text) + 1 if text else 0
    model = directory / f"fault{number}.smt2"
    with (directory / f"{proof.wrapper}.smt2").open() as lines:
        chosen = f"((state |{proof.wrapper}_s|)) (_ BitVec {BITS}) #b{number:0{BITS}b}) ; \\fault\n"
        model.write_text("".join(
            f"{line.partition(' (')[0].replace('declare', 'define')} {chosen}" if line.endswith("; \\fault\n") else line
            for line in lines
        ))  # fmt: skip
    options = ["-t", str(fault.steps)]
    if fault.steps > STEPS:
        # Many steps take much less time with one reset, and with few states one by one.
        (directory / "one_reset.smtc").write_text("state 1:*\nassume (= [reset] false)\n")
        options += ["--smtc", "one_reset.smtc"]
    elif not proof.any_product:
        options += ["--unroll", "--noincr"]
    return solve(model, model.stem, options, timeout)[0]
