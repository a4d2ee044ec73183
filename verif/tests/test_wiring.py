# SPDX-License-Identifier: MIT
"""Boards' tops on their pins, with stand-ins for the generated modules: each pin has its role, each PLL its clocks."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import pytest
from conftest import plant, run_tool

from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.design.for_scene import ProcessorDesign
from raycaster.fpga import bitstream, quartus
from raycaster.fpga import board as board_module
from raycaster.fpga.board import HERE, TOP, Board, OpenBoard, QuartusBoard, board_names, find_board
from raycaster.fpga.flows import clocks_for
from raycaster.memory_map import BUTTON_NAMES, clocks_per_bit
from raycaster.verif.dvi.wiring import OUTPUTS, PIN_FILES, device, read_pin_file, wiring_of

MODELS = Path(__file__).parents[1] / "dvi" / "models.v"

SYSTEM = """
module {name} (
    input wire clk, ready, input wire [{buttons}-1:0] buttons, output wire uart_tx,
    output wire [{bits}-1:0] vga_r, vga_g, vga_b, output wire vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk
);
    // A one moves through the outputs; the number of its places is odd, so that a pixel may take two clocks.
    reg [{bits} * 3 + 4:0] one = 1;
    reg half = 1'b0;
    always @(posedge clk) begin
        one <= {{one[{bits} * 3 + 3:0], one[{bits} * 3 + 4]}};
        half <= ~half;
    end
    assign {{vga_r, vga_g, vga_b, vga_blank_n, vga_vs, vga_hs, vga_sync_n}} = one;
    assign vga_clk = half;
    assign uart_tx = half;
endmodule
"""
"""Stand-in for `scene_system` and `ray_caster_system`."""

ENCODER = """
module dvi_encoder (
    input wire clk, pixel_end, vga_hs, vga_vs, vga_blank_n, input wire [7:0] vga_r, vga_g, vga_b,
    output reg [9:0] blue, green, red, output reg pixel = 1'b0
);
    always @(posedge clk)
        if (pixel_end) begin
            pixel <= ~pixel;
            blue <= {vga_vs, vga_hs, vga_b};
            green <= {2'b01, vga_g};
            red <= {1'b1, vga_blank_n, vga_r};
        end
endmodule
"""
"""Stand-in whose symbols show which input they come from."""

BENCH = """
`timescale 1ns / 1ps
module bench;
    reg reset = 1'b0;
    reg [5:0] buttons = 6'b000000;
    {wires}
    reg serial_in = 1'b0;
    device device (.reset(reset), .buttons(buttons), .serial_in(serial_in){connected});

    integer step;
    initial begin
        #100 look(-1);
        // The PLL locks in this time.
        #20000 look(0);
        for (step = 1; step <= 6; step = step + 1) begin
            buttons = 1 << step - 1;
            serial_in = ~serial_in;
            #200 look(step);
        end
        buttons = 6'b111111;
        #200 look(7);
        reset = 1'b1;
        #200 look(8);
        reset = 1'b0;
        #200 look(9);
        #3000 $finish;
    end

    task look(input integer number);
        $display("step %0d ready=%b buttons=%b in=%b heard=%b{lit_names}", number, {inner}.ready, {inner}.buttons,
            serial_in, {heard}{lit});
    endtask

    // By then the link has found the pixels.
    initial begin
        #16000;
        while ($realtime < 20000)
            #3.1 $strobe("pins one=%b clk=%b half=%b{names}", {inner}.one, {inner}.clk, {inner}.half{values});
    end
    initial begin
        #16000;
        while ($realtime < 20000)
            @({sent}) $strobe("sent link=%b link_n=%b", link, link_n);
    end
endmodule
"""

RESET, ALL = 8, 7
"""Numbers of the bench's step with reset pressed, and of that with all buttons pressed."""


class Case(NamedTuple):
    """A board's design."""

    board: str
    engine: str = "exact"
    game: bool = False
    rows: int | None = None
    bits: int | None = None

    @property
    def config(self) -> Configuration:
        """Configuration with these rows on a monitor, or with the smallest screen."""
        screen = {"screen": "vga" if self.rows else "tiny", "rectangles": 3, "allow_underrun": True}
        own = find_board(self.board, Board).configuration | ({"colour_bits": self.bits} if self.bits else {})
        return configure(**own | screen | {"engine": self.engine, "rows": self.rows})


CASES = [
    *(Case(name) for name in board_names(QuartusBoard)),
    *(Case(name, engine) for name in board_names(OpenBoard) for engine in ("exact", "span") if name != "icebreaker"),
    Case("icebreaker", "span"),
    Case("ulx3s", game=True),
    Case("icebreaker", "span", game=True),
    # Two PLLs.
    Case("ulx3s", rows=240),
    *(Case(name, bits=bits) for name, bits in (("de2", 3), ("de1_soc", 1), ("de10_lite", 8))),
]


@pytest.fixture
def project(monkeypatch, tmp_path) -> Callable[[Case], list[Path]]:
    """Return a function that writes a board's project without converting a design; the last file is its top."""

    def write(case: Case) -> list[Path]:
        board, config = find_board(case.board, Board), case.config

        def stand_in(name: str, text: str) -> Callable[..., list[Path]]:
            def written(*arguments: object) -> list[Path]:
                path = tmp_path / "system" / f"{name}.v"
                path.parent.mkdir(exist_ok=True)
                path.write_text(text)
                return [path]

            return written

        scene, game = (
            SYSTEM.format(name=name, bits=config.colour_bits, buttons=count)
            for name, count in (("scene_system", 6), ("ray_caster_system", 5))
        )
        for module in (bitstream, quartus):
            monkeypatch.setattr(module, "write_scene_system", stand_in("scene_system", scene))
        monkeypatch.setattr(bitstream, "write_system", stand_in("ray_caster_system", game))
        monkeypatch.setattr(bitstream, "write_dvi_encoder", stand_in("dvi_encoder", ENCODER))
        if isinstance(board, QuartusBoard):
            quartus.write_project(board, config, None, tmp_path / "project")
            own = [tmp_path / "project" / name for name in (quartus.HELPER.name, f"{TOP}.v")]
            return [tmp_path / "system" / "scene_system.v", *own]
        (tmp_path / "program").touch()
        scene_design = SimpleNamespace(configuration=config, shown=None)
        design = ProcessorDesign(tmp_path / "program", config) if case.game else scene_design
        return bitstream.write_project(board, design, tmp_path)

    return write


def simulated(case: Case, files: list[Path]) -> list[dict[str, str]]:
    """Simulate a board; return the values of each printed line, by name, and the line's kind as `kind`."""
    board, wiring, top = find_board(case.board, Board), wiring_of(case.board), files[-1]
    [pin_file] = [path for path in top.parent.glob(f"{top.stem}.*") if path.suffix[1:] in PIN_FILES]
    pins, options = read_pin_file(pin_file)
    assert options == wiring.pins
    quartus_board = isinstance(board, QuartusBoard)
    inner = "device.top.system" if quartus_board else "device.top.board.shown.system"
    inside = f"    defparam top.COLOUR_BITS = {case.config.colour_bits};" if quartus_board else ""
    values = [name for name in wiring.outputs if name not in ("link", "link_n")]
    bench = BENCH.format(
        inner=inner,
        heard="device.top.board.shown.uart_rx" if wiring.heard else "serial_in",
        wires="".join(f"wire [{width}-1:0] {name}; " for name, width in OUTPUTS.items()),
        connected="".join(f", .{name}({name})" for name in OUTPUTS),
        lit_names="".join(f" {pin}=%b" for pin in wiring.lit),
        lit="".join(f", device.pin_{pin}" for pin in wiring.lit),
        names="".join(f" {name}=%b" for name in values),
        values="".join(f", {name}" for name in values),
        sent="device.top.board.shift_clk" if "link" in wiring.outputs else "buttons",
    )
    text = device(wiring, top.stem, pins, inside) + bench
    (top.parent / "bench.v").write_text(text)
    built = run_tool(
        top.parent, "iverilog", "-g2005", "-s", "bench", "-o", "bench", *map(str, files), str(MODELS), "bench.v"
    )
    if built.returncode:
        raise ValueError(built.stdout)
    lines = [line.split() for line in run_tool(top.parent, "vvp", "-n", "bench").stdout.splitlines()]
    return [
        {"kind": line[0]} | dict(word.split("=") for word in line[1:] if "=" in word)
        for line in lines
        if line[0] in ("step", "pins", "sent")
    ]


def check_inputs(case: Case, steps: list[dict[str, str]]) -> None:
    """Check what the system and the lights see of each pressed button, of reset, and of the PLL's lock."""
    board, wiring = find_board(case.board, Board), wiring_of(case.board)
    roles = {"forward": 0, "back": 1, "left": 2, "right": 3, "up": 4, "down": 5}
    # As the firmware reads them.
    assert BUTTON_NAMES == ("left", "right", "up", "down", "fire")
    for number, seen in zip(range(-1, 10), steps, strict=True):
        held = {role for role, bit in roles.items() if number >= ALL or number == bit + 1} & wiring.pressed.keys()
        held |= {"reset"} & wiring.pressed.keys() if number == RESET else set()
        locked = number >= 0
        running = (locked or isinstance(board, QuartusBoard)) and "reset" not in held
        assert seen["ready"] == str(int(running)), number
        assert seen["heard"] == seen["in"], number
        names = ("fire", "down", "up", "right", "left") if case.game else tuple(reversed(roles))
        meant = held | ({"fire"} if held & {"forward", "back"} else set())
        assert seen["buttons"] == "".join(str(int(name in meant)) for name in names), number
        levels = {pin.removeprefix("~"): (role in held) != pin.startswith("~") for role, pin in wiring.pressed.items()}
        levels |= {"locked": locked, "0": False, "1": True}
        for pin, meaning in wiring.lit.items():
            assert seen[pin] == str(int(levels[meaning.removeprefix("~")] != meaning.startswith("~"))), (number, pin)


def check_pins(case: Case, seen: list[dict[str, str]]) -> None:
    """Check that each pin of a parallel output follows its bit, or its channel's from the top bit on."""
    board, bits, outputs = find_board(case.board, Board), case.config.colour_bits, wiring_of(case.board).outputs
    places = set()
    for line in seen:
        places.add(line["one"].index("1"))
        one = line["one"][1:]
        expected = {"serial": line["half"] if case.game else "1"}
        expected |= dict(zip(("blank_n", "vs", "hs", "sync_n"), one[3 * bits :], strict=True))
        expected["dac_clock"] = line["half"] if isinstance(board, QuartusBoard) else str(1 - int(line["clk"]))
        for at, channel in enumerate(("red", "green", "blue")):
            if channel in outputs:
                word = one[at * bits : (at + 1) * bits]
                expected[channel] = "".join(word[i % bits] for i in range(len(outputs[channel].split()))).ljust(10, "0")
        assert {name: line[name] for name in outputs if name in line} == {
            name: expected[name] for name in outputs if name in expected
        }
    assert places == set(range(3 * bits + 5))


def check_link(case: Case, sent: list[dict[str, str]]) -> None:
    """Check that the wires of a link carry their channels, and the places of the one in their order."""
    wires = [line["link"] for line in sent]
    if "link_n" in wiring_of(case.board).outputs:
        assert [line["link_n"] for line in sent] == [wire.translate(str.maketrans("01", "10")) for wire in wires]
    clock, red, green, blue = ("".join(wire[at] for wire in wires) for at in range(4))
    assert "01" in clock
    start = clock.index("01") + 1
    words = [[one[at : at + 10][::-1] for one in (clock, red, green, blue)] for at in range(start, len(wires) - 10, 10)]
    places = []
    for rate, r, g, b in words:
        assert (rate, r[0], g[:2]) == ("0000011111", "1", "01")
        # In the order of the system's outputs.
        one = r[2:] + g[2:] + b[2:] + r[1] + b[:2]
        places.append(one.index("1") if "1" in one else -1)
        assert one.count("1") == (places[-1] >= 0)
    count, step = 3 * 8 + 5, case.config.screen_geometry.clocks_per_pixel
    assert set(places) == {*range(count - 2), -1}
    for before, after in pairwise(places):
        if -1 not in (before, after):
            assert (before - after) % count == step or (after - before) % count == step


def check(case: Case, files: list[Path]) -> None:
    """Check pins, standards and options, buttons and their levels, and outputs against the second source."""
    lines = simulated(case, files)
    steps, pins, sent = ([line for line in lines if line["kind"] == kind] for kind in ("step", "pins", "sent"))
    check_inputs(case, steps)
    check_pins(case, pins)
    if "link" in wiring_of(case.board).outputs:
        check_link(case, sent)


@pytest.mark.parametrize("case", CASES, ids=lambda case: "-".join(str(part) for part in case if part))
def test_each_pin_has_its_role(case, project):
    check(case, project(case))


OPTIONS = {
    "ecp5": (r"LFE5U-(\d+)F-(\d)BG(\d+)C", r"--\1k --package CABGA\3 --speed \2"),
    "ice40": ("iCE40UP5K-SG48", "--up5k --package sg48"),
    "gowin": ("GW2AR.*", r"--device \g<0> --vopt family=GW2A-18C"),
}
"""Chips' order codes and nextpnr's options for them, by flow."""

SIZES = {
    "EP2C35F672C6": (33_216, 70, "cycloneive"),
    "EP4CE115F29C7": (114_480, 532, "cycloneive"),
    "5CSEMA5F31C6": (32_070, 3 * 87, "cyclonev"),
    "10M50DAF484C7G": (49_760, 288, "cycloneive"),
}
"""Sizes by order code, as in Quartus's reports: logic elements (ALMs of the Cyclone V), multipliers of 9 bits (three in
each DSP block of the Cyclone V), and the family for which Yosys counts cells."""


@pytest.mark.parametrize("name", board_names(Board))
def test_the_chip_is_the_boards_own(name):
    """Tools get the chip that the second source has; `test_a_small_bitstream` checks its size for open tools."""
    board, wiring = find_board(name, Board), wiring_of(name)
    assert board.chip == wiring.chip
    if isinstance(board, OpenBoard):
        assert " ".join(board.options) == re.sub(*OPTIONS[board.flow], wiring.chip)
        assert board.loader == ("--board", wiring.loader)
    else:
        assert (board.elements, board.multipliers, board.counted_as) == SIZES[wiring.chip]


ICE, GAME, ULX3S, TANG, DE2, LITE = (
    Case("icebreaker", "span"), Case("ulx3s", game=True), Case("ulx3s"), Case("tang_nano_20k"), Case("de2"),
    Case("de10_lite"),
)  # fmt: skip

FAULTS = [
    (ULX3S, "dvi_board.v", "locked & run", "locked"),
    (ULX3S, "dvi_board.v", "locked & run", "1'b0"),
    (ULX3S, "dvi_board.v", "locked & run", "run"),
    (ULX3S, "dvi_board.v", ".vga_blank_n(vga_blank_n),\n    .blue", ".vga_blank_n(vga_vs),\n    .blue"),
    (ULX3S, "dvi_board.v", "(pixel_end),\n    .vga_r(vga_r),\n    .vga_g(vga_g)",
     "(pixel_end),\n    .vga_r(vga_g),\n    .vga_g(vga_r)"),
    (ULX3S, "dvi_serialiser.v", ".symbol(green), .sent(link[1])", ".symbol(green), .sent(link[2])"),
    (ULX3S, "ecp5/link_pins.v", "link_p = link", "link_p = {link[3], link[0], link[1], link[2]}"),
    (ULX3S, "ecp5/ddr_pin.v", ".D0(bits[0]), .D1(bits[1])", ".D0(bits[1]), .D1(bits[0])"),
    (ULX3S, "scene/board_design.v", ".buttons(buttons)", ".buttons({buttons[4], buttons[5], buttons[3:0]})"),
    (ULX3S, "scene/board_design.v", "uart_tx = 1'b1", "uart_tx = 1'b0"),
    (ULX3S, "ulx3s/board.toml", 'reset = "~btn[0]"', 'reset = "btn[0]"'),
    (ULX3S, "ulx3s/board.toml", 'up = "btn[3]"', 'up = "~btn[3]"'),
    (ULX3S, "ulx3s/board.toml", '"R18", "V1"', '"V1", "R18"'),
    (ULX3S, "ulx3s/board.toml", '"A16", "A14", "A12", "A17"', '"A12", "A14", "A16", "A17"'),
    (ULX3S, "ulx3s/board.toml", "clock_mhz = 25", "clock_mhz = 50"),
    (ULX3S, "ulx3s/board.toml", '"UP", "DOWN", "DOWN"', '"DOWN", "DOWN", "DOWN"'),
    (ULX3S, "ulx3s/board.toml", 'wifi_gpio0 = "1\'b1"', 'wifi_gpio0 = "1\'b0"'),
    (GAME, "game/board_design.v", "buttons[5], buttons[4]", "buttons[4], buttons[5]"),
    (GAME, "game/board_design.v", "buttons[0] | buttons[1]", "buttons[0]"),
    (TANG, "gowin/link_pins.v", ".I(link[2]), .O(link_p[2])", ".I(~link[2]), .O(link_p[2])"),
    (TANG, "gowin/board_pll.v", "fifth (.HCLKIN(fast), .RESETN(locked)", "fifth (.HCLKIN(fast), .RESETN(1'b0)"),
    (TANG, "tang_nano_20k/board.toml", '"36", "38", "40", "34"', '"38", "36", "40", "34"'),
    (TANG, "tang_nano_20k/board.toml", 'forward = "btn[0]"', 'forward = "~btn[0]"'),
    (ICE, "parallel_board.v", "locked & run", "locked"),
    (ICE, "parallel_board.v", "locked & run", "run"),
    (ICE, "parallel_board.v", ".vga_hs(vga_hs),\n    .vga_vs(vga_vs)", ".vga_hs(vga_vs),\n    .vga_vs(vga_hs)"),
    (ICE, "ice40/clock_pin.v", ".D_OUT_0(1'b0), .D_OUT_1(1'b1)", ".D_OUT_0(1'b1), .D_OUT_1(1'b0)"),
    (ICE, "icebreaker/board.toml", '"48", "2", "3", "4"', '"4", "3", "2", "48"'),
    (ICE, "icebreaker/board.toml", 'LEDG_N = "~locked"', 'LEDG_N = "locked"'),
    (DE2, "de2/board.toml", '"C8", "F10"', '"F10", "C8"'),
    (DE2, "de2/board.toml", 'VGA_BLANK = "vga_blank_n"', 'VGA_BLANK = "vga_sync_n"'),
    (DE2, "de2/board.toml", 'forward = "~KEY[2]"\nback = "~KEY[1]"', 'forward = "~KEY[1]"\nback = "~KEY[2]"'),
    (DE2, "channel_pins.v", "i % BITS", "0"),
    (LITE, "de10_lite/board.toml", 'pins = "N3"', 'pins = "N4"'),
    (ULX3S, "dvi_board.v", ".uart_rx(serial_in)", ".uart_rx(1'b1)"),
    (ICE, "icebreaker/board.toml", 'RX = { standard = "LVCMOS33", pins = "6" }',
     'RX = { standard = "LVCMOS33", pins = "11" }'),
    (LITE, "de10_lite/board.toml", 'reset = "SW[2]"', 'reset = "~SW[2]"'),
    (ULX3S, "ecp5/ddr_pin.v", ".RST(1'b0)", ".RST(1'b1)"),
]  # fmt: skip
"""Faults that the checks must notice: a design with the fault, the file below `fpga/`, the right and the wrong text."""


@pytest.mark.slow_sets(quick=["ulx3s-exact-dvi_board", "icebreaker-span-parallel", "de2-exact-de2"])
@pytest.mark.parametrize(
    ("case", "file", "right", "wrong"),
    [pytest.param(*fault, id=f"{fault[0].board}-{fault[0].engine}-{fault[1]}-{at}") for at, fault in enumerate(FAULTS)],
)
def test_a_fault_is_noticed(case, file, right, wrong, project, monkeypatch, tmp_path):
    copy = shutil.copytree(HERE, tmp_path / "fpga", ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    plant(copy / file, right, wrong)
    for module in (board_module, bitstream):
        monkeypatch.setattr(module, "HERE", copy)
    monkeypatch.setattr(quartus, "HELPER", copy / quartus.HELPER.name)
    with pytest.raises(AssertionError):
        check(case, project(case))


# PLLs -----------------------------------------------------------------------------------------------------------------

CLOCKS = """
`timescale 1ns / 1ps
module bench;
    reg clk_in = 1'b0;
    wire clk, shift_clk, locked;
    integer slow = 0, fast = 0;
    always #(500.0 / {mhz}) clk_in = ~clk_in;
    board_clocks clocks (
        .clk_in(clk_in), .vga_clk(1'b0), .clk(clk), .shift_clk(shift_clk), .locked(locked), .pixel_end()
    );
    always @(posedge clk) slow = slow + 1;
    always @(posedge shift_clk) fast = fast + 1;
    initial begin
        #100 fast = 0;
        // The first of two PLLs has not locked by now; the second one would run if it were not in reset.
        #300 $display("early %b %b", locked, fast > 0);
        #20000 slow = 0;
        fast = 0;
        #20000 $display("made %b %0d %0d", locked, slow, fast);
        $finish;
    end
endmodule
"""
MEASURED_US = 20

STANDARD_MHZ = {240: 25.175, 200: 25.175, 60: 25.175, 180: 74.25}
"""Pixel clocks from VESA DMT and CTA-861, by rows of rays."""
ALLOWED = 0.005
"""Error of a pixel clock that VESA DMT allows."""

PLLS = [
    *(Case(name, *more) for name in ("ulx3s", "colorlight_i9", "icepi_zero", "tang_nano_20k")
      for more in (("exact", False, 240), ("span", False, 240), ("span", False, 180))),
    Case("ulx3s", "span", rows=200),
    Case("icebreaker", "exact", rows=60),
]  # fmt: skip


def clocks_made(case: Case, files: list[Path]) -> tuple[float, float] | None:
    """Simulate a board's clocks; return clk and shift_clk in MHz, or None if a PLL does not lock, or runs too early."""
    bench = files[-1].with_name("clocks_bench.v")
    bench.write_text(CLOCKS.format(mhz=wiring_of(case.board).mhz))
    used = [path for path in files if path.name in ("board_clocks.v", "board_pll.v")]
    words = ("iverilog", "-g2005", "-s", "bench", "-o", "clocks", *map(str, used), str(MODELS), str(bench))
    built = run_tool(bench.parent, *words)
    if built.returncode:
        raise ValueError(built.stdout)
    said = [line.split() for line in run_tool(bench.parent, "vvp", "-n", "clocks").stdout.splitlines()]
    [early], [made] = ([line[1:] for line in said if line[0] == kind] for kind in ("early", "made"))
    assert early[0] == "0"
    waits = early[1] == "0" or "FIRST_DIV" not in clocks_for(find_board(case.board, OpenBoard), case.config).parameters
    return (int(made[1]) / MEASURED_US, int(made[2]) / MEASURED_US) if waits and made[0] == "1" else None


def ecp5_clocks(mhz: float, p: dict[str, Any]) -> tuple[float, float]:
    """FPGA-TN-02200: the feedback divides CLKFB as CLKI_DIV divides the input; limits from FPGA-DS-02012."""
    if p.get("FIRST_DIV"):
        compared = mhz / p["FIRST_CLKI_DIV"]
        oscillator = compared * p["FIRST_FB_DIV"]
        mhz = oscillator / p["FIRST_DIV"]
        assert 10 <= compared <= 400 <= oscillator <= 800
        assert max(p["FIRST_CLKI_DIV"], p["FIRST_FB_DIV"], p["FIRST_DIV"]) <= 128
    compared = mhz / p["CLKI_DIV"]
    shift = compared * p["CLKFB_DIV"]
    oscillator = shift * p["SHIFT_DIV"]
    assert 8 <= mhz <= 400
    assert 10 <= compared <= 400 <= oscillator <= 800
    assert max(p["CLKI_DIV"], p["SHIFT_DIV"], p["CLK_DIV"]) <= 128
    assert p["CLKFB_DIV"] <= 80
    return oscillator / p["CLK_DIV"], shift


def ice40_clocks(mhz: float, p: dict[str, Any]) -> tuple[float, float]:
    """Lattice's FPGA-TN-02052 for SIMPLE feedback, and the limits that icepll checks."""
    compared = mhz / (p["DIVR"] + 1)
    oscillator = compared * (p["DIVF"] + 1)
    assert 10 <= compared <= 133
    assert 533 <= oscillator <= 1066
    assert (p["DIVR"] <= 15, p["DIVF"] <= 127, 1 <= p["DIVQ"] <= 6) == (True, True, True)
    assert p["FILTER_RANGE"] == 1 + sum(compared >= limit for limit in (17, 26, 44, 66, 101))
    return oscillator / 2 ** p["DIVQ"], 0


def gowin_clocks(mhz: float, p: dict[str, Any]) -> tuple[float, float]:
    """Gowin's UG286 for rPLL; the limits are those of the GW2A in speed grade C8."""
    compared = mhz / (p["IDIV_SEL"] + 1)
    made = compared * (p["FBDIV_SEL"] + 1)
    assert 3 <= compared <= 500 <= made * p["ODIV_SEL"] <= 1250
    assert max(p["IDIV_SEL"], p["FBDIV_SEL"]) <= 63
    assert p["ODIV_SEL"] in (2, 4, 8, 16, 32, 48, 64, 80, 96, 112, 128)
    assert float(p["FCLKIN"]) == mhz
    return made / 5, made / (2 if p["HALVED"] else 1)


FORMULAS = {"ecp5": ecp5_clocks, "ice40": ice40_clocks, "gowin": gowin_clocks}


@pytest.mark.parametrize("case", PLLS, ids=lambda case: f"{case.board}-{case.engine}-{case.rows}")
def test_the_pll_makes_the_standards_clock(case, project):
    """The vendor's formula, the simulated PLL and the table of clocks agree, within the limits of the data sheet."""
    board, config = find_board(case.board, OpenBoard), case.config
    clocks, per_pixel = clocks_for(board, config), config.screen_geometry.clocks_per_pixel
    clk, shift = FORMULAS[board.flow](wiring_of(case.board).mhz, dict(clocks.parameters))
    assert clocks.nets == pytest.approx({"clk": clk, "shift_clk": shift} if shift else {"clk": clk}, rel=1e-9)
    assert clk / per_pixel == pytest.approx(STANDARD_MHZ[case.rows], rel=ALLOWED)
    assert not shift or shift == pytest.approx(5 * clk / per_pixel, rel=1e-9)
    assert clocks_made(case, project(case)) == pytest.approx((clk, shift), rel=2e-3, abs=0.06)
    # The serial port's 115,200 baud, within what receivers accept.
    assert clk * 1e6 / clocks_per_bit(config.screen_geometry.clock_hz) == pytest.approx(115_200, rel=0.02)


@pytest.mark.parametrize(
    ("board", "right", "wrong"),
    [
        ("ulx3s", ".feedback(shift_clk)", ".feedback(1'b0)"),
        ("ulx3s", ".feedback(shift_clk)", ".feedback(clk)"),
        ("ulx3s", ".feedback(feedback)", ".feedback(reference)"),
        ("ulx3s", '.FEEDBK_PATH("CLKOS")', '.FEEDBK_PATH("CLKOP")'),
        ("ulx3s", ".reset(!first_locked)", ".reset(first_locked)"),
        ("ulx3s", ".reset(!first_locked)", ".reset(1'b0)"),
        ("ulx3s", '.PLLRST_ENA("ENABLED")', '.PLLRST_ENA("DISABLED")'),
        ("ulx3s", '.OUTDIVIDER_MUXA("DIVA")', '.OUTDIVIDER_MUXA("REFCLK")'),
        ("ulx3s", '.OUTDIVIDER_MUXB("DIVB")', '.OUTDIVIDER_MUXB("REFCLK")'),
        ("ulx3s", ".CLKOS_FPHASE(0)", ".CLKOS_FPHASE(1)"),
        ("ulx3s", "first_locked & last_locked", "1'b0"),
        ("ulx3s", ".CLKI_DIV(FIRST_CLKI_DIV)", ".CLKI_DIV(3)"),
        ("tang_nano_20k", ".RESET(1'b0)", ".RESET(1'b1)"),
        ("tang_nano_20k", '.CLKFB_SEL("internal")', '.CLKFB_SEL("external")'),
        ("tang_nano_20k", ".ODIV_SEL(ODIV_SEL)", ".ODIV_SEL(8)"),
        ("tang_nano_20k", ".FCLKIN(FCLKIN)", '.FCLKIN("20")'),
        ("icebreaker", ".RESETB(1'b1)", ".RESETB(1'b0)"),
        ("icebreaker", '"SIMPLE"', '"DELAY"'),
        ("icebreaker", ".FILTER_RANGE(FILTER_RANGE)", ".FILTER_RANGE(3)"),
    ],
)
def test_a_broken_pll_does_not_lock(board, right, wrong, project):
    case = next(case for case in PLLS if case.board == board)
    files = project(case)
    [path] = [path for path in files if path.name == "board_pll.v"]
    plant(path, right, wrong)
    assert clocks_made(case, files) is None
