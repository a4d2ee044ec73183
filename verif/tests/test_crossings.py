# SPDX-License-Identifier: MIT
"""Boards' netlists: asynchronous inputs pass synchronisers, and every other crossing of clock domains has a reason."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import pytest
from conftest import SMALL_SCENE
from small_program import write_program

from raycaster.design.decide import configure
from raycaster.design.for_scene import Design, ProcessorDesign
from raycaster.fit.fixing import fix
from raycaster.fpga.bitstream import write_project
from raycaster.fpga.board import TOP, OpenBoard, QuartusBoard, board_names, find_board
from raycaster.fpga.flows import FLOWS
from raycaster.fpga.quartus import write_project as write_quartus_project
from raycaster.runs.tools import run_yosys
from raycaster.scene import load_scene

BOARDS = board_names(OpenBoard)
NAMED = {
    # Logic of two asynchronous inputs, which may glitch if both change together.
    "*, locked -> *.reset_release_i.synchroniser_i.arriving": "a glitch only resets once more",
    "* -> *.button_port_i.synchroniser_i.arriving": "a glitch is a button released for some clocks",
    # From the design's clock to the link's.
    "*_lane.held -> *_lane.shift": "a symbol is stable for a pixel, and loaded in the middle of it",
}
"""Crossings that are more than a synchroniser of one bit, with the reason for which they are right."""

BITWISE = {"$not": "A", "$pos": "A", "$and": "AB", "$or": "AB", "$xor": "AB", "$xnor": "AB", "$mux": "AB"}
"""Ports of which bit n decides bit n of the output, by kind of cell; a multiplexer's S decides all."""
INVERTERS = ("$not", "$logic_not", "$pos", "$reduce_bool", "$reduce_or", "$reduce_and")
CLOCKS = {"ODDRX1F": "SCLK", "ODDR": "CLK", "SB_IO": "OUTPUT_CLK"}
"""The clock of a chip's own cells that sample data; those not listed are not registers."""


class Netlist:
    """A flattened module of Yosys's JSON, whose cells are words.

    Attributes:
        faults: crossings that are neither synchronisers nor named.
        named: patterns of `NAMED` that were met.
        synchronisers: first and second register of each synchroniser: cell and place of the bit.
    """

    def __init__(self, module: Mapping[str, Any]):
        self._cells = module["cells"]
        inputs = {name: port for name, port in module["ports"].items() if port["direction"] == "input"}
        self._sources = {bit: name for name, port in inputs.items() for bit in port["bits"]}
        self._names: dict[Any, str] = {}
        shown = {name: net for name, net in module["netnames"].items() if not net.get("hide_name")}
        for name in sorted(shown.keys() - module["ports"].keys(), key=lambda name: -name.count(".")):
            self._names |= dict.fromkeys(shown[name]["bits"], name)
        self._driver, self._readers = {}, defaultdict(list)
        for name, cell in self._cells.items():
            for port, bits in cell["connections"].items():
                for place, bit in enumerate(bits):
                    if cell["port_directions"][port] == "output":
                        self._driver[bit] = (name, place)
                    else:
                        self._readers[bit].append((name, port, place))
        for port in module["ports"].values():
            for bit in port["bits"] if port["direction"] == "output" else ():
                self._readers[bit].append(("", "", 0))
        self._cones: dict[Any, frozenset[Any]] = {}
        self.faults, self.named, self.synchronisers = [], set(), []
        for name, cell in self._cells.items():
            self._check(name, cell)

    def _clock(self, name: str) -> Any:
        """Return the clock of a register or a clocked port of a memory; None for other cells."""
        cell = self._cells[name]
        if "CLK" in cell["connections"] and cell["type"].startswith("$"):
            enabled = cell["parameters"].get("CLK_ENABLE", "1")
            return cell["connections"]["CLK"][0] if int(enabled, 2) else None
        return cell["connections"][CLOCKS[cell["type"]]][0] if cell["type"] in CLOCKS else None

    def _before(self, bit: Any) -> list[Any] | None:
        """Return the bits that decide a combinational one; None if it starts there."""
        if bit not in self._driver:
            return None
        name, place = self._driver[bit]
        cell = self._cells[name]
        if not cell["type"].startswith("$") or self._clock(name) is not None:
            return None
        inputs = {port: bits for port, bits in cell["connections"].items() if cell["port_directions"][port] == "input"}
        if each := BITWISE.get(cell["type"]):
            return [inputs[port][min(place, len(inputs[port]) - 1)] for port in each] + inputs.get("S", [])
        return [bit for bits in inputs.values() for bit in bits]

    def _origin(self, bit: Any) -> Any:
        """Return the clock of a bit at which a path starts, the bit itself if it has none, or None for a constant."""
        if bit in self._sources:
            return bit
        if bit not in self._driver:
            return None
        clock = self._clock(self._driver[bit][0])
        return bit if clock is None else ("clock", clock)

    def origins(self, bit: Any) -> frozenset[Any]:
        """Return all origins of a bit."""
        stack = [bit]
        while stack:
            one = stack[-1]
            before = self._before(one)
            left = [other for other in before or () if other not in self._cones]
            if left and one not in self._cones:
                self._cones[one] = frozenset()  # ends loops
                stack += left
                continue
            stack.pop()
            found = [{self._origin(one)} - {None}]
            if before is not None:
                found = [self._cones.get(other, frozenset()) for other in before]
            self._cones[one] = frozenset().union(*found)
        return self._cones[bit]

    def _alone(self, bit: Any) -> Any:
        """Return the only bit that decides this one, with nothing but inverters on the way; None if there is more."""
        while (before := self._before(bit)) is not None:
            if len(before) != 1 or self._cells[self._driver[bit][0]]["type"] not in INVERTERS:
                return None
            [bit] = before
        return bit

    def _starts(self, bit: Any, foreign: frozenset[Any]) -> set[str]:
        """Return the names of the bits of other domains at which paths to this one start."""
        found, seen, stack = set(), {bit}, [bit]
        while stack:
            one = stack.pop()
            before = self._before(one)
            if before is None and self._origin(one) in foreign:
                found.add(self._sources.get(one) or self._names[one])
            new = set(before or ()) - seen
            seen |= new
            stack += new
        return found

    def _check(self, name: str, cell: Mapping[str, Any]) -> None:
        """Check all inputs of a register, or of another cell with a clock."""
        clock = self._clock(name)
        inputs = [port for port, way in cell["port_directions"].items() if way == "input"] if clock else []
        for port in inputs:
            for place, bit in enumerate(cell["connections"][port]):
                foreign = self.origins(bit) - {("clock", clock)}
                if not foreign or bit == clock:
                    continue
                held = cell["connections"]["Q"][place] if port == "D" else None
                where = self._names.get(held, f"{name}.{port}")
                crossing = f"{', '.join(sorted(self._starts(bit, foreign)))} -> {where}"
                second, reason = self._second(held, clock), ""
                if not second or self._alone(bit) is None:
                    reason = next((one for one in NAMED if fnmatchcase(crossing, one)), "")
                    (self.named.add if reason else self.faults.append)(reason or crossing)
                if second:
                    self.synchronisers.append(((name, place), second))
                elif reason.endswith(".arriving"):
                    self.faults.append(crossing)

    def _second(self, bit: Any, clock: Any) -> tuple[str, int] | None:
        """Return the register that alone reads a bit, directly and with the same clock."""
        match self._readers.get(bit):
            case [(name, "D", place)] if self._clock(name) == clock:
                return name, place
        return None


def netlist_of(board: OpenBoard, design: Design | ProcessorDesign, directory: Path) -> Mapping[str, Any]:
    """Return the flattened top of a board's project, before its words are split into bits."""
    sources = [path.relative_to(directory) for path in write_project(board, design, directory)]
    synthesis = f"{FLOWS[board.flow].synthesis} -top {board.name} -run :coarse"
    return flattened(board.name, [*(f"read_verilog {source}" for source in sources), synthesis], directory)


def flattened(top: str, script: Sequence[str], directory: Path) -> Mapping[str, Any]:
    """Return the flattened top after the commands of a script, before its words are split into bits."""
    script = [*script, "setattr -mod -unset keep_hierarchy *", "proc", "flatten", "opt_expr", "opt_dff", "opt_clean"]
    run_yosys(directory, "top", [*script, f"select {top}", "write_json -selected top.json"])
    return json.loads((directory / "top.json").read_text())["modules"][top]


def check_synchronisers(module: Mapping[str, Any], found: Netlist) -> None:
    """Check that each synchroniser would be missed if its second register read what the first one reads."""
    cells = module["cells"]
    for first, (place, (second, there)) in {
        one: (place, second) for (one, place), second in found.synchronisers
    }.items():
        inputs, outputs = cells[first]["connections"]["D"], cells[second]["connections"]["D"]
        right, outputs[there] = outputs[there], inputs[place]
        assert Netlist(module).faults, first
        outputs[there] = right


def design_on(board: OpenBoard, kind: str, directory: Path) -> Design | ProcessorDesign:
    """Return a small design for a board, with a scene, with a program, or with a serial bus."""
    options = board.configuration | {"engine": "exact"} | ({"screen": "tiny"} if board.video == "dvi" else {"rows": 60})
    if kind == "scene":
        return fix(SMALL_SCENE, options, "rects").design
    serial = {"bus": "uart"} if kind == "serial" else {}
    config = configure(**options | {"rectangles": 3} | serial)
    if serial:
        return Design(SMALL_SCENE, load_scene(SMALL_SCENE), config, config.most_reflections)
    return ProcessorDesign(write_program(SMALL_SCENE, config, directory), config)


@pytest.mark.slow_sets(quick=["de10_lite"])
@pytest.mark.parametrize("name", board_names(QuartusBoard))
def test_every_crossing_of_a_quartus_board(tmp_path, name):
    """Its only clock is the oscillator, so every crossing starts at an asynchronous input."""
    board = find_board(name, QuartusBoard)
    config = configure(**board.configuration | {"screen": "tiny", "engine": "exact", "rectangles": 3})
    write_quartus_project(board, config, load_scene(SMALL_SCENE), tmp_path)
    sources = [f"read_verilog {path.relative_to(tmp_path)}" for path in sorted(tmp_path.rglob("*.v"))]
    module = flattened(TOP, [*sources, f"hierarchy -top {TOP}"], tmp_path)
    found = Netlist(module)
    assert found.faults == []
    assert found.synchronisers and not found.named
    check_synchronisers(module, found)


@pytest.mark.slow_sets(quick=["ulx3s-scene", "ulx3s-serial"])
@pytest.mark.parametrize("kind", ["scene", "game", "serial"])
@pytest.mark.parametrize("name", BOARDS)
def test_every_crossing_is_synchronised_or_named(tmp_path, name, kind):
    board = find_board(name, OpenBoard)
    (tmp_path / "project").mkdir()
    module = netlist_of(board, design_on(board, kind, tmp_path), tmp_path / "project")
    found = Netlist(module)
    assert found.faults == []
    both_fire = kind == "game" and {"forward", "back"} <= board.inputs.keys()
    used = ("reset" in board.inputs, both_fire, board.video == "dvi")
    assert found.named == {one for one, there in zip(NAMED, used, strict=True) if there}
    check_synchronisers(module, found)
