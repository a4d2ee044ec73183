# SPDX-License-Identifier: MIT
"""Boards as others document them: for each pin of the chip its part, standard and options, independent of `board.toml`.

Simulations of a board connect to the chip's pins by this table, and a test compares pin files with it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from raycaster.errors import UserError

BUTTONS = ("forward", "back", "left", "right", "up", "down")
"""Buttons from bit 0 on, as the simulations press them."""

OUTPUTS = {"link": 4, "link_n": 4, "serial": 1, "red": 10, "green": 10, "blue": 10} | dict.fromkeys(
    ("hs", "vs", "blank_n", "sync_n", "dac_clock"), 1
)
"""Widths of a device's outputs, by role. Colours are aligned at the top bit."""


@dataclass(frozen=True)
class Wiring:
    """Parts of a board, by the pins of its chip.

    Attributes:
        source: source of the chip, the pins and levels, other than that of `board.toml`.
        chip: order code of the chip.
        clock: pin of the oscillator.
        mhz: frequency of the oscillator.
        pressed: pin of each button and of reset; `~` if it is low while pressed.
        outputs: pins of the outputs by role, from bit 0 on.
        heard: pin of the line from the USB chip, if there is one.
        loader: the board's name for openFPGALoader, from its doc/boards.yml; empty for boards that Quartus programs.
        lit: meaning of each other output, by pin: a level, `locked`, or the pin of a button; `~` inverts it.
        options: pins by their standard and further options, as the pin file has them.
    """

    source: str
    chip: str
    clock: str
    mhz: float
    pressed: Mapping[str, str]
    outputs: Mapping[str, str]
    options: Mapping[str, str]
    lit: Mapping[str, str] = field(default_factory=dict)
    heard: str = ""
    loader: str = ""

    @property
    def pins(self) -> dict[str, str]:
        """Standard and options of each pin."""
        return {pin: options for options, pins in self.options.items() for pin in pins.split()}


_LVTTL = "3.3-V LVTTL"
_KEYS = ("reset", "up", "down", "forward", "back", "left", "right")

WIRING = {
    "ulx3s": Wiring(
        source="amaranth-boards, ulx3s.py: buttons by label, hdmi by channel; ULX3S's manual: the ESP32's GPIO0",
        chip="LFE5U-85F-6BG381C",
        loader="ulx3s",
        clock="G2",
        mhz=25,
        pressed=dict(zip(_KEYS, ("~D6", "R18", "V1", "R1", "T1", "U1", "H16"), strict=True)),
        outputs={"link": "A16 A14 A12 A17", "serial": "L4"},
        heard="M1",
        lit={"B2": "R1", "C2": "T1", "C1": "R18", "D2": "V1", "D1": "U1", "E2": "H16", "E1": "0", "H3": "locked",
             "L2": "1"},
        options={
            "LVCMOS33 PULLMODE=NONE": "G2",
            "LVCMOS33 PULLMODE=UP": "D6 M1",
            "LVCMOS33 PULLMODE=DOWN": "R1 T1 R18 V1 U1 H16",
            "LVCMOS33 DRIVE=4 PULLMODE=NONE": "B2 C2 C1 D2 D1 E2 E1 H3 L2",
            "LVCMOS33 DRIVE=4 PULLMODE=UP": "L4",
            "LVCMOS33D DRIVE=4": "A16 A14 A12 A17",
        },
    ),
    "icepi_zero": Wiring(
        source="coldelectrons' amaranth-boards, icepi_zero.py for version 1.3",
        chip="LFE5U-25F-6BG256C",
        loader="icepi-zero",
        clock="M1",
        mhz=50,
        pressed=dict(zip(_KEYS[1:], ("~P2", "~M2", "~C4", "~C5", "~R3", "~P3"), strict=True)),
        outputs={"link": "R13 R15 P16 R12", "serial": "K15"},
        heard="K16",
        lit={"E13": "~R3", "D14": "~P3", "E12": "~P2", "C13": "~M2", "D13": "locked"},
        options={
            "LVCMOS33 PULLMODE=NONE": "M1",
            "LVCMOS33 PULLMODE=UP": "C4 C5 R3 P3 P2 M2 K16",
            "LVCMOS33 DRIVE=4": "E13 D14 E12 C13 D13 K15",
            "LVCMOS33D DRIVE=4": "R13 R15 P16 R12",
        },
    ),
    "colorlight_i9": Wiring(
        source="amaranth-boards, colorlight_i9_r7_2.py; muselab's ulx3s_v20_segpdi.lpf has the channels of gpdi",
        chip="LFE5U-45F-6BG381C",
        loader="colorlight-i9",
        clock="P3",
        mhz=25,
        pressed=dict(zip(_KEYS[1:], ("~A18", "~A19", "~C17", "~B18", "~B20", "~F20"), strict=True)),
        outputs={"link": "G19 E20 C20 J19", "serial": "J17"},
        heard="H18",
        lit={"L2": "~locked"},
        options={
            "LVCMOS33": "P3 L2 J17",
            "LVCMOS33 PULLMODE=UP": "C17 B18 B20 F20 A18 A19 H18",
            "LVCMOS33D DRIVE=4": "G19 E20 C20 J19",
        },
    ),
    "tang_nano_20k": Wiring(
        source="Sipeed's TangNano-20K-example, hdmi/src/hdmi.cst and uart/src/top.cst; Apicula's tangnano20k.cst",
        chip="GW2AR-LV18QN88C8/I7",
        loader="tangnano20k",
        clock="4",
        mhz=27,
        pressed={"forward": "88", "back": "87"},
        outputs={"link": "35 37 39 33", "link_n": "36 38 40 34", "serial": "69"},
        heard="70",
        lit={"15": "~88", "16": "~87", "17": "1", "18": "1", "19": "1", "20": "~locked"},
        options={
            "IO_TYPE=LVCMOS33": "4 15 16 17 18 19 20",
            "IO_TYPE=LVCMOS33 PULL_MODE=NONE": "87 88",
            "IO_TYPE=LVCMOS33 PULL_MODE=UP": "69 70",
            "PULL_MODE=NONE": "33 34 35 36 37 38 39 40",
        },
    ),
    "icebreaker": Wiring(
        source="LiteX-Boards, icebreaker.py: pmod connectors, dvi_pmod and break_off_pmod",
        chip="iCE40UP5K-SG48",
        loader="ice40_generic",
        clock="35",
        mhz=12,
        pressed={"reset": "~10", "left": "20", "forward": "19", "right": "18"},
        outputs={"red": "48 2 3 4", "green": "44 45 46 47", "blue": "34 36 42 43", "hs": "31", "vs": "28",
                 "blank_n": "32", "dac_clock": "38", "serial": "9"},
        heard="6",
        lit={"37": "~locked"},
        options={"LVCMOS33": "35 10 20 19 18 37 6 9 48 2 3 4 44 45 46 47 34 36 42 43 31 28 32 38"},
    ),
    "de2": Wiring(
        source="Altera's Tcl board package for Quartus, qboard; the DE2's manual: keys are low while pressed",
        chip="EP2C35F672C6",
        clock="N2",
        mhz=50,
        pressed=dict(zip(_KEYS, ("P25", "N25", "N26", "~P23", "~N23", "~W26", "~G26"), strict=True)),
        outputs={"red": "C8 F10 G10 D9 C9 A8 H11 H12 F11 E10", "green": "B9 A9 C10 D10 B10 A10 G11 D11 E12 D12",
                 "blue": "J13 J14 F12 G12 J10 J11 C11 B11 C12 B12", "hs": "A7", "vs": "D8", "blank_n": "D6",
                 "sync_n": "B7", "dac_clock": "B8"},
        options={_LVTTL: "N2 G26 N23 P23 W26 N25 N26 P25 C8 F10 G10 D9 C9 A8 H11 H12 F11 E10 B9 A9 C10 D10 B10 A10 "
                 "G11 D11 E12 D12 J13 J14 F12 G12 J10 J11 C11 B11 C12 B12 A7 D8 D6 B7 B8"},
    ),
    "de2_115": Wiring(
        source="projects of Terasic's System Builder; the DE2-115's manual: keys are low while pressed",
        chip="EP4CE115F29C7",
        clock="Y2",
        mhz=50,
        pressed=dict(zip(_KEYS, ("AC27", "AB28", "AC28", "~N21", "~M21", "~R24", "~M23"), strict=True)),
        outputs={"red": "E12 E11 D10 F12 G10 J12 H8 H10", "green": "G8 G11 F8 H12 C8 B8 F10 C9",
                 "blue": "B10 A10 C11 B11 A11 C12 D11 D12", "hs": "G13", "vs": "C13", "blank_n": "F11", "sync_n": "C10",
                 "dac_clock": "A12"},
        options={
            "2.5 V": "M23 M21 N21 R24 AB28 AC28 AC27",
            _LVTTL: "Y2 E12 E11 D10 F12 G10 J12 H8 H10 G8 G11 F8 H12 C8 B8 F10 C9 B10 A10 C11 B11 A11 C12 D11 D12 G13 "
                    "C13 F11 C10 A12",
        },
    ),
    "de1_soc": Wiring(
        source="MiSTer's and System Builder's qsf files; LiteX-Boards, terasic_de1soc.py: KEY and SW",
        chip="5CSEMA5F31C6",
        clock="AF14",
        mhz=50,
        pressed=dict(zip(_KEYS, ("AF9", "AB12", "AC12", "~W15", "~AA15", "~Y16", "~AA14"), strict=True)),
        outputs={"red": "A13 C13 E13 B12 C12 D12 E12 F13", "green": "J9 J10 H12 G10 G11 G12 F11 E11",
                 "blue": "B13 G13 H13 F14 H14 F15 G15 J14", "hs": "B11", "vs": "D11", "blank_n": "F10", "sync_n": "C10",
                 "dac_clock": "A11"},
        options={_LVTTL: "AF14 AA14 AA15 W15 Y16 AB12 AC12 AF9 A13 C13 E13 B12 C12 D12 E12 F13 J9 J10 H12 G10 G11 G12 "
                 "F11 E11 B13 G13 H13 F14 H14 F15 G15 J14 B11 D11 F10 C10 A11"},
    ),
    "de10_lite": Wiring(
        source="LiteX-Boards, terasic_de10lite.py; System Builder's qsf files: standards",
        chip="10M50DAF484C7G",
        clock="P11",
        mhz=50,
        pressed=dict(zip(_KEYS, ("D12", "C10", "C11", "A12", "C12", "~A7", "~B8"), strict=True)),
        outputs={"red": "AA1 V1 Y2 Y1", "green": "W1 T2 R2 R1", "blue": "P1 T1 P4 N2", "hs": "N3", "vs": "N1"},
        options={
            "3.3 V SCHMITT TRIGGER": "B8 A7",
            _LVTTL: "P11 C10 C11 D12 C12 A12 AA1 V1 Y2 Y1 W1 T2 R2 R1 P1 T1 P4 N2 N3 N1",
        },
    ),
}  # fmt: skip
"""Wiring by the names of the boards."""

PIN_FILES = {
    "lpf": (r'^LOCATE COMP "(\S+)" SITE "(\w+)";$', r'^IOBUF PORT "(\S+)" IO_TYPE=(.*);$'),
    "pcf": (r"^set_io (?:-\w+ \w+ )*(\S+) (\w+) ", r"^set_io (?:-\w+ \w+ )*(\S+) \w+  # (.*)$"),
    "cst": (r'^IO_LOC "(\S+)" (\w+);$', r'^IO_PORT "(\S+)" (.*);$'),
    "qsf": (r"^set_location_assignment PIN_(\w+) -to (\S+)$",
            r'^set_instance_assignment -name IO_STANDARD "(.*)" -to (\S+)$'),
}  # fmt: skip
"""Lines with the pin, and with the standard and options, of a bit, by suffix of the pin file."""


def wiring_of(name: str) -> Wiring:
    """Return the wiring of a board.

    Raises:
        UserError: there is none.
    """
    if name not in WIRING:
        raise UserError(f"board: {name} has no entry in {Path(__file__).name}; add its pins from a second source")
    return WIRING[name]


def read_pin_file(path: Path) -> tuple[dict[str, str], dict[str, str]]:
    """Return the pin of each bit of a top's ports, and the standard and options of each pin."""
    text = path.read_text()
    located, given = (re.findall(pattern, text, re.M) for pattern in PIN_FILES[path.suffix[1:]])
    if path.suffix == ".qsf":
        located, given = ([found[::-1] for found in one] for one in (located, given))
    pins = dict(located)
    assert len(pins) == len(located), f"{path}: a bit has two pins"
    assert pins.keys() == dict(given).keys(), f"{path}: a bit has no pin, or no standard"
    return pins, {pins[bit]: options if path.suffix == ".qsf" else _sorted(options) for bit, options in given}


def _sorted(options: str) -> str:
    """Sort the options after a standard."""
    first, *rest = options.split()
    return " ".join([first, *sorted(rest)])


def device(wiring: Wiring, top: str, pins: Mapping[str, str], inside: str = "") -> str:
    """Return a module with a board in it: the top's ports are connected to the board's parts by the chip's pins.

    Ports: reset and buttons, high while pressed; serial_in; and `OUTPUTS`. Outputs that the board lacks are z, and a
    differential output that is not the inverse of the other is x.

    Args:
        wiring: the board.
        top: name of the top module.
        pins: pin of each bit of the top's ports.
        inside: further text for the module.
    """
    bits: dict[str, list[str]] = {}
    for bit, pin in pins.items():
        name, _, index = bit.rstrip("]").partition("[")
        assert len(bits.setdefault(name, [])) == int(index or 0), f"{bit}: bits are not in order"
        bits[name].append(f"pin_{pin}")
    ports = ", ".join(f".{name}({{{', '.join(reversed(wires))}}})" for name, wires in bits.items())
    lines = [
        f"    reg pin_{wiring.clock} = 1'b0;",
        f"    always #({500 / wiring.mhz}) pin_{wiring.clock} = ~pin_{wiring.clock};",
    ]
    lines += [f"    wire pin_{pin};" for pin in sorted(wiring.pins.keys() - {wiring.clock})]
    for role, pin in wiring.pressed.items():
        source = "reset" if role == "reset" else f"buttons[{BUTTONS.index(role)}]"
        lines.append(f"    assign pin_{pin.removeprefix('~')} = {'~' * pin.startswith('~')}{source};")
    if wiring.heard:
        lines.append(f"    assign pin_{wiring.heard} = serial_in;")
    for role, wires in wiring.outputs.items():
        given = ", ".join(f"pin_{pin}" for pin in reversed(wires.split()))
        below = OUTPUTS[role] - len(wires.split())
        lines.append(f"    assign {role} = {{{given}{f', {below}' + chr(39) + 'b0' if below else ''}}};")
    body = "\n".join(lines)
    outputs = "".join(f",\n    output wire [{width - 1}:0] {role}" for role, width in OUTPUTS.items())
    return f"""`timescale 1ns / 1ps

module device (
    input  wire reset,
    input  wire [{len(BUTTONS) - 1}:0] buttons,
    input  wire serial_in{outputs}
);
{body}
    {top} top ({ports});
{inside}
endmodule
"""
