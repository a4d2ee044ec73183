# SPDX-License-Identifier: MIT
"""Boards with an Intel (before: Altera) chip: their descriptions, and the check of what a project assigns to pins."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, model_validator

from raycaster.errors import UserError

TOP = "ray_caster_project"
"""The top of every board, and the name of its project."""

BOARDS = ("de2", "de2_115", "de1_soc", "de10_lite")
"""Each is a folder beside this file."""

DESCRIPTION = "board.toml"


class BoardError(UserError):
    """A board's description, or a project for it, that is refused; one line."""


def _check_pins(value: object) -> object:
    pins = [value] if isinstance(value, str) else value
    if not isinstance(pins, list) or not pins:
        raise ValueError('must be a pin such as "N2", or a list of them')
    for pin in pins:
        if not isinstance(pin, str) or not re.fullmatch("[A-Z]{1,2}[1-9][0-9]?", pin):
            raise ValueError(f'must be a pin such as "N2", not {json.dumps(pin, default=str)}')
    return value


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class BoardSignal(_Strict):
    """What the board's manual has under one name: a pin, or one for each bit from 0 on."""

    standard: str
    pins: Annotated[str | tuple[str, ...], BeforeValidator(_check_pins)]


class Board(_Strict):
    """A board's description. Its signals are more than a project uses, and bear the names of the board's manual."""

    directory: Path
    title: str
    family: str
    device: str
    quartus: str
    """The version that it needs."""
    top: Path
    """The Verilog of the top, from the board's folder on."""
    clock: str
    """The signal of 50 MHz."""
    dac_clock: str | None = None
    """The signal at whose rising edge the DAC takes the colours, where it has a clock."""
    source: str
    """Where the pins and standards are from; confirmation and disagreements are of other sources, or "none"."""
    confirmation: str
    disagreements: str
    settings: dict[str, str]
    """Global assignments that the board needs."""
    configuration: dict[str, Any]
    """What the hardware is unless something else is asked for."""
    signals: dict[str, BoardSignal]

    @model_validator(mode="after")
    def _check(self) -> Board:
        users: dict[str, str] = {}
        for bit, pin in self.pins.items():
            if pin in users:
                raise ValueError(f"signals: {pin} is both {users[pin]} and {bit}")
            users[pin] = bit
        for name in (self.clock, self.dac_clock):
            if name is not None and name not in self.pins:
                raise ValueError(f"signals: {name} is missing, and the board's clocks name it")
        return self

    @property
    def pins(self) -> dict[str, str]:
        """The pin of every bit of every signal, `KEY[0]` or `CLOCK_50`."""
        pins: dict[str, str] = {}
        for name, signal in self.signals.items():
            if isinstance(signal.pins, str):
                pins[name] = signal.pins
            else:
                pins |= {f"{name}[{index}]": pin for index, pin in enumerate(signal.pins)}
        return pins


def load_board(directory: Path) -> Board:
    """Read the description in a board's folder.

    Raises:
        BoardError: it cannot be read, or is not one; one line says where and what is wrong.
    """
    path = directory / DESCRIPTION
    try:
        contents = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BoardError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BoardError(f"{path}: is not TOML: {error}") from None
    try:
        return Board.model_validate(contents | {"directory": directory})
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        message = first["msg"].removeprefix("Value error, ")
        raise BoardError(f"{path}: {place}: {message}" if place else f"{path}: {message}") from None


def find_board(name: str) -> Board:
    """One of `BOARDS`.

    Raises:
        BoardError: there is no such board.
    """
    if name not in BOARDS:
        raise BoardError(f"board: {', '.join(BOARDS[:-1])} or {BOARDS[-1]}, not {name}")
    return load_board(Path(__file__).with_name(name))


def top_ports(verilog: str) -> dict[str, str]:
    """The bits of the top's ports and their directions, from Verilog as the tops here are written.

    Raises:
        BoardError: it is written in another way.
    """
    header = re.search(rf"^module {TOP} #\(\n[^()]*\n\) \(\n(.*?)\n\);$", verilog, re.M | re.S)
    if header is None:
        raise BoardError(f"the top has no module {TOP} with parameters and ports")
    ports: dict[str, str] = {}
    for line in header[1].splitlines():
        port = re.fullmatch(r" *(input|output) +wire +(?:\[(\d+):0\] +)?(\w+),?", line)
        if port is None:
            raise BoardError(f"the top has a port that cannot be read: {line.strip()}")
        direction, highest, name = port.groups()
        names = [name] if highest is None else [f"{name}[{index}]" for index in range(int(highest) + 1)]
        ports |= dict.fromkeys(names, direction)
    return ports


def assignments(qsf: str) -> list[tuple[str, str, str]]:
    """What a settings file says of ports: kind (`LOCATION`, `IO_STANDARD` and the like), value, and port bit."""
    found = []
    for line in qsf.splitlines():
        if location := re.fullmatch(r"set_location_assignment PIN_(\w+) -to (\S+)", line):
            found.append(("LOCATION", location[1], location[2]))
        elif instance := re.fullmatch(r'set_instance_assignment -name (\w+) "(.*)" -to (\S+)', line):
            found.append((instance[1], instance[2], instance[3]))
    return found


def check_project(board: Board, verilog: str, qsf: str) -> None:
    """See that a settings file and the top agree with each other and with the board.

    Args:
        board: the board.
        verilog: the text of the top.
        qsf: the text of the settings file.

    Raises:
        BoardError: they do not; one line with everything that is wrong.
    """
    ports = top_ports(verilog)
    given = assignments(qsf)
    locations = [(value, bit) for kind, value, bit in given if kind == "LOCATION"]
    standards = {bit for kind, _, bit in given if kind == "IO_STANDARD"}
    wrong = [f"{bit} has no pin" for bit in ports if bit not in {bit for _, bit in locations}]
    wrong += [f"{bit} has no I/O standard" for bit in ports if bit not in standards]
    wrong += [f"{bit} is not a port" for bit in dict.fromkeys(bit for *_, bit in given) if bit not in ports]
    wrong += _wrong_pins(locations, {pin: bit for bit, pin in board.pins.items()})
    if wrong:
        raise BoardError(f"{TOP} on the {board.title}: {'; '.join(wrong)}")


def _wrong_pins(locations: list[tuple[str, str]], known: Mapping[str, str]) -> list[str]:
    wrong = []
    users: dict[str, str] = {}
    for pin, bit in locations:
        if pin in users:
            wrong.append(f"{pin} is both {users[pin]} and {bit}")
        elif pin not in known:
            wrong.append(f"{bit} is on {pin}, which the board's table does not have")
        elif known[pin] != bit:
            wrong.append(f"{bit} is on {pin}, which is the board's {known[pin]}")
        users[pin] = bit
    return wrong
