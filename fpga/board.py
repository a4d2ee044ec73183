# SPDX-License-Identifier: MIT
"""Boards, each a folder with a description, which is checked here."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, model_validator

from raycaster.complaints import did_you_mean, refusal
from raycaster.errors import UserError
from raycaster.rtl.system.scene_player import BUTTONS

HERE = Path(__file__).parent
TOP = "ray_caster_project"
"""Name of every Quartus project and of its top module."""

DESCRIPTION = "board.toml"
"""Name of the file that makes a folder here a board."""


CHANNELS = ("vga_r", "vga_g", "vga_b")
VGA = (*CHANNELS, "vga_hs", "vga_vs", "vga_blank_n", "vga_sync_n", "vga_clk")
"""Outputs of `scene_system`."""


class BoardError(UserError):
    """An error in a board's description or project, in one line."""


def _check_pins(value: object) -> object:
    pins = [value] if isinstance(value, str) else value
    if not isinstance(pins, list) or not pins:
        raise ValueError('must be a pin such as "N2", or a list of them')
    for pin in pins:
        if not isinstance(pin, str) or not re.fullmatch("[A-Z]{0,2}[1-9][0-9]?", pin):
            raise ValueError(f'must be a pin such as "N2", not {json.dumps(pin, default=str)}')
    return value


def _signal(bit: str) -> str:
    """Return the name of a bit's signal: `KEY` for `~KEY[0]`."""
    return bit.removeprefix("~").partition("[")[0]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class BoardSignal(_Strict):
    """A signal, named as in the board's manual: one pin, or a pin per bit from 0 on."""

    standard: str
    pins: Annotated[str | tuple[str, ...], BeforeValidator(_check_pins)]
    options: dict[str, str | tuple[str, ...]] = {}
    """Further options in the pin file, such as a pull-up: one value for all pins, or one per pin."""

    @model_validator(mode="after")
    def _check_options(self) -> BoardSignal:
        count = 1 if isinstance(self.pins, str) else len(self.pins)
        for name, values in self.options.items():
            if not isinstance(values, str) and len(values) != count:
                raise ValueError(f"{name} has {len(values)} values for {count} pins; give one for all, or one per pin")
        return self

    def options_of(self, at: int) -> dict[str, str]:
        """Return the options of one pin."""
        return {name: value if isinstance(value, str) else value[at] for name, value in self.options.items()}


class Board(_Strict):
    """Description of a board: the part that all kinds share. The top of its designs is generated.

    `inputs` and `outputs` are Verilog. An input is a bit that is high while one of `BUTTONS`, or `reset`, is pressed;
    the input `serial` is the line from the USB chip. An output is an expression of the signals of the modules in the
    top.
    """

    directory: Path
    title: str
    chip: str
    """Order code of the chip."""
    elements: int
    """Number of the chip's logic elements, from its maker's data sheet: look-up tables with 4 inputs, or ALMs."""
    multipliers: int
    """Number of the chip's multipliers, from the same data sheet; on Intel's chips, those of 9 bits. Excess products
    become logic."""
    clock: str
    """Signal from the oscillator."""
    source: str
    """Source of the pins and standards. Confirmation and disagreements name other sources, or say "none"."""
    confirmation: str
    disagreements: str
    configuration: dict[str, Any]
    """Default configuration options of the hardware."""
    inputs: dict[str, str]
    outputs: dict[str, str]
    signals: dict[str, BoardSignal]

    @model_validator(mode="after")
    def _check(self) -> Board:
        users: dict[str, str] = {}
        for bit, pin in self.pins.items():
            if pin in users:
                raise ValueError(f"signals: {pin} is both {users[pin]} and {bit}")
            users[pin] = bit
        for name in self.clocks:
            if name not in self.pins:
                raise ValueError(f"signals: {name} is missing, but is one of the board's clocks")
        for name, value in self.inputs.items():
            if name not in ("reset", *BUTTONS, "serial"):
                raise ValueError(f"inputs: {name} is not one of reset, {', '.join(BUTTONS)}, serial")
            if value.removeprefix("~") not in self.pins or _signal(value) in self.outputs:
                raise ValueError(f"inputs: {name}: {value} is not a bit of a signal here, or is an output")
        for name in self.outputs:
            if name not in self.signals:
                raise ValueError(f"outputs: {name} is not among the signals")
        read = [value.removeprefix("~") for value in (self.clock, *self.inputs.values())]
        for bit in self.pins:
            if bit not in read and _signal(bit) not in self.outputs:
                raise ValueError(f"signals: {bit} is neither the clock nor used in inputs or outputs")
        return self

    def pressed(self, name: str) -> str:
        """Return the Verilog of an input, which is 0 if the board lacks it."""
        return self.inputs.get(name, "1'b0")

    @property
    def buttons(self) -> str:
        """Verilog of all `BUTTONS`, the first in bit 0."""
        return f"{{{', '.join(map(self.pressed, reversed(BUTTONS)))}}}"

    @property
    def port_list(self) -> str:
        """Verilog of the top's ports, which are all signals."""
        lines = []
        for name, signal in self.signals.items():
            vector = "" if isinstance(signal.pins, str) else f" [{len(signal.pins) - 1}:0]"
            lines.append(f"    {'output' if name in self.outputs else 'input '} wire{vector} {name}")
        return ",\n".join(lines)

    @property
    def name(self) -> str:
        """Name of the board's folder."""
        return self.directory.name

    @property
    def clocks(self) -> list[str]:
        """Signals that carry a clock."""
        return [self.clock]

    @property
    def pins(self) -> dict[str, str]:
        """Pins of all signals, by bit, such as `KEY[0]` or `CLOCK_50`."""
        return {bit: pin for name in self.signals for bit, pin in self.bits(name).items()}

    def bits(self, name: str) -> dict[str, str]:
        """Return the pins of one signal, by bit."""
        pins = self.signals[name].pins
        return {name: pins} if isinstance(pins, str) else {f"{name}[{at}]": pin for at, pin in enumerate(pins)}


class QuartusBoard(Board):
    """Board with an Intel (formerly Altera) chip, with the signal names of its manual.

    Its outputs are outputs of `scene_system`.
    """

    flow: Literal["quartus"]
    family: str
    counted_as: Literal["cycloneive", "cyclonev"]
    """Family whose cells Yosys counts for the chip. Yosys lacks the Cyclone II and the MAX 10, which have the logic
    elements of the Cyclone IV."""
    quartus: str
    """Required version of Quartus."""
    dac_clock: str | None = None
    """Signal whose rising edge clocks the DAC; None if the DAC has no clock."""
    settings: dict[str, str]
    """Global assignments of the board in Quartus."""

    @model_validator(mode="after")
    def _check_outputs(self) -> QuartusBoard:
        given = self.outputs.values()
        for port in given:
            if port not in VGA:
                raise ValueError(f"outputs: {port} is not one of {', '.join(VGA)}")
        for channel in CHANNELS:
            if channel not in given:
                raise ValueError(f"outputs: none is {channel}")
        return self

    @property
    def clocks(self) -> list[str]:
        """Signals that carry a clock."""
        return [name for name in (self.clock, self.dac_clock) if name is not None]


class OpenBoard(Board):
    """Board whose bitstreams Yosys and nextpnr make."""

    flow: Literal["ecp5", "ice40", "gowin"]
    """Name of an entry of `flows.FLOWS`, and of the folder with modules made of the chip's own cells."""
    options: tuple[str, ...]
    """nextpnr's options for the chip, its package and its speed grade."""
    memories: int
    """Number of the chip's RAM blocks, from its maker's data sheet."""
    single_ports: int = 0
    """Number of the chip's larger RAMs with a single port, from the same data sheet."""
    clock_mhz: float
    video: Literal["dvi", "parallel"]
    """Kind of output: a DVI link driven by the chip itself, or colours and syncs for a DAC or a transmitter."""
    loader: tuple[str, ...]
    """openFPGALoader's options for the board."""


Kind = TypeVar("Kind", bound=Board)


def board_names(kind: type[Board]) -> list[str]:
    """Return the names of the boards of a kind, in alphabetical order.

    Raises:
        BoardError: a description is not TOML.
    """
    return [path.parent.name for path in sorted(HERE.glob(f"*/{DESCRIPTION}")) if issubclass(_kind(_read(path)), kind)]


def _read(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BoardError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BoardError(f"{path}: is not TOML: {error}") from None


def _kind(contents: Mapping[str, Any]) -> type[Board]:
    return QuartusBoard if contents.get("flow") == "quartus" else OpenBoard


def load_board(directory: Path) -> Board:
    """Read the board whose description is in a directory.

    Raises:
        BoardError: the description cannot be read, or is wrong; one line gives the place and the mistake.
    """
    path = directory / DESCRIPTION
    contents = _read(path)
    try:
        return _kind(contents).model_validate(contents | {"directory": directory})
    except ValidationError as error:
        raise BoardError(f"{path}: {refusal(error.errors())}") from None


def find_board(name: str, kind: type[Kind]) -> Kind:
    """Return the board of a kind with this name.

    Raises:
        BoardError: there is no such board, or its description is wrong.
    """
    known = board_names(kind)
    if name not in known:
        near = did_you_mean(name, known)
        raise BoardError(f"board: expected {', '.join(known[:-1])} or {known[-1]}, got {name or 'none'}{near}")
    board = load_board(HERE / name)
    assert isinstance(board, kind)
    return board
