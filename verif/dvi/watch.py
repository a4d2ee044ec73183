# SPDX-License-Identifier: MIT
"""Decode the video output of a simulated board, as a monitor does, and check its timing against the standard."""

from __future__ import annotations

import contextlib
import re
import subprocess
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from raycaster.configuration import Configuration
from raycaster.design.for_scene import Design
from raycaster.errors import UserError
from raycaster.fpga.board import Board, QuartusBoard
from raycaster.golden.engines import model_of
from raycaster.golden.picture import shown
from raycaster.golden.tmds import CONTROL_SYMBOLS, decode
from raycaster.rtl.system.scene_player import BUTTONS
from raycaster.screens import Screen
from raycaster.sim.monitor import Line, VideoError, decode_frame
from raycaster.sim.simulator import SimulationError, build_program
from raycaster.verif.dvi.wiring import PIN_FILES, device, read_pin_file, wiring_of

SYMBOL_BITS = 10
MASKS = 8
"""Number of settings of the buttons in a simulation."""
ALLOWED = 0.005
"""Error of a pixel clock that VESA DMT allows."""

HERE = Path(__file__).parent
_CHANNELS = ("blue", "green", "red", "clock")

_LINK = """
    // Symbols must be stable for this many cycles of shift_clk before and after they are sampled.
    localparam real STILL_CYCLES = 1.5;
    wire sample = top.board.shift_clk;
    wire [3:0] value = {value};
    integer unsteady = 0;
    realtime changed = 0, taken = 0, rose = 0, cycle = 0;

    // Changes near the edge that samples them arrive a cycle early, or not, in the synchroniser of the two clocks.
    always @(posedge top.board.shift_clk) begin
        cycle = $realtime - rose;
        rose = $realtime;
        #0.1;
        if ($random % 2)
            top.board.serialiser.arriving = top.board.serialiser.held_pixel;
    end

    always @(top.board.serialiser.blue_lane.held, top.board.serialiser.green_lane.held,
             top.board.serialiser.red_lane.held) begin
        changed = $realtime;
        if (board_bench.recording && changed - taken < STILL_CYCLES * cycle)
            unsteady = unsteady + 1;
    end

    always @(posedge top.board.shift_clk)
        if (board_bench.recording && top.board.serialiser.blue_lane.load_here) begin
            taken = $realtime;
            if (taken - changed < STILL_CYCLES * cycle)
                unsteady = unsteady + 1;
        end
"""
"""Part of a board with a DVI link. A pair whose wires are not each other's inverse is x."""

_PLACED_LINK = """
    wire sample = top.{shift_clk};
    wire [3:0] value = {value};
    integer unsteady = 0;
"""
"""Part of a board whose netlist has a DVI link; a netlist lacks most names in `_LINK`."""

_PARALLEL = """
    // Data must be stable around the rising edge of the clock.
    localparam real STILL_NS = 3;
    reg sample = 1'b0;
    wire [27:0] value = {{hs, vs, blank_n, {sync_n}, red[9:2], green[9:2], blue[9:2]}};
    integer unsteady = 0;
    realtime changed = 0, taken = 0;

    always @(posedge dac_clock) begin
        taken = $realtime;
        if (board_bench.recording && taken - changed < STILL_NS)
            unsteady = unsteady + 1;
        sample = ~sample;
    end

    always @(value) begin
        changed = $realtime;
        if (board_bench.recording && changed - taken < STILL_NS)
            unsteady = unsteady + 1;
    end
"""
"""Part of a board with a DAC or a transmitter."""


def watch(
    board: Board,
    sources: Sequence[Path],
    design: Configuration,
    frames: int,
    directory: Path,
    *,
    simulator: str = "verilator",
    buttons: Sequence[int] = (0,),
    late_ns: int = 0,
    again: int = 0,
    placed: bool = False,
    blank: int = 0,
    sends: bytes = b"",
) -> list[np.ndarray]:
    """Simulate the board and return the first frames with a picture that its monitor sees after reset.

    The board's parts are connected to the chip's pins by `wiring.WIRING`.

    Args:
        board: the board; its monitor is on a DVI link, a transmitter, or a DAC with a clock.
        sources: the board's Verilog, the design's included; the last one is the top, with the pin file beside it.
        design: the design.
        frames: number of frames.
        directory: for the recording.
        simulator: one of `raycaster.sim.simulator.SIMULATORS`; only Icarus knows unknown bits.
        buttons: masks of the buttons that are held in each frame, the last one from then on; bits are in the order of
            `scene_player.BUTTONS`.
        late_ns: extra duration of reset.
        again: number of frames to record after a second reset, in the middle of a frame; they follow the others.
        placed: True if the Verilog is a netlist; then nothing checks when the symbols of a DVI link are sampled.
        blank: number of frames after each reset that have no picture yet; these are not among the others.
        sends: bytes that a computer sends to the serial port from the first frame on, 3 per cent slower than the design
            expects.

    Returns:
        The frames, each uint8 (visible lines, visible pixels, 3).

    Raises:
        UserError: the simulator, or the board's wiring, is missing.
        SimulationError: the simulation could not be built or run.
        VideoError: the output departs from the standard, is sampled while it may change, or is not blank where it
            must be.
    """
    screen, wiring = design.screen_geometry, wiring_of(board.name)
    per_pixel = SYMBOL_BITS if "link" in wiring.outputs else 1
    frame = screen.horizontal.total * screen.vertical.total * per_pixel
    masks = [*buttons, *[buttons[-1]] * (MASKS - len(buttons))]
    pressed = "".join(f"{mask:0{len(BUTTONS)}b}" for mask in reversed(masks))
    # Reset restarts the video before the first vertical sync, from which frames are counted.
    values = [(blank + count) * frame + frame // 8 for count in (frames, again)]
    if again:
        values[0] += frame // 2
    arguments = [f"+values={values[0]}", f"+again={values[1] if again else 0}", f"+pressed={pressed}"]
    arguments += [f"+each={frame}", f"+late_ns={late_ns}"]
    if sends:
        directory.mkdir(parents=True, exist_ok=True)
        (directory / "sends.txt").write_text("".join(f"{byte:02x}\n" for byte in sends))
        arguments += [f"+sends={len(sends)}", f"+bit_ps={round(1.03e12 / design.baud)}"]
    rates, recorded = _record(board, sources, design, directory, simulator, arguments, placed)
    seen = []
    for count, rate, lines in zip((frames, again), rates, recorded, strict=False):
        if abs(rate / per_pixel / screen.monitor_hz * 1e6 - 1) > ALLOWED:
            raise VideoError(f"pixel clock: {rate / per_pixel:.3f} MHz, expected {screen.monitor_hz / 1e6:g} MHz")
        found = pictures(symbols(wires(lines)), screen) if per_pixel > 1 else parallel_pictures(lines, screen)
        if len(found) < blank + count:
            raise VideoError(f"{len(found)} frames after reset, expected {blank + count}")
        if any(picture.any() for picture in found[:blank]):
            raise VideoError(f"a picture is shown before {blank} frames have passed")
        seen += found[blank : blank + count]
    return seen


def golden(design: Design, position: tuple[int, int, int] | None = None) -> np.ndarray:
    """Render what a monitor must show, from the scene's camera or another position; uint8 (lines, pixels, 3)."""
    scene = design.scene
    if position is not None:
        scene = scene.model_copy(update={"camera": scene.camera.model_copy(update={"position": position})})
    config = design.configuration
    return shown(model_of(config).render(scene, config.screen_geometry, design.reflections), config)


def _record(
    board: Board,
    sources: Sequence[Path],
    design: Configuration,
    directory: Path,
    simulator: str,
    arguments: Sequence[str],
    placed: bool,
) -> tuple[list[float], list[list[str]]]:
    """Return the number of values per microsecond, and the values in hexadecimal, of each recording.

    During the second reset a DAC or a transmitter gets no picture.
    """
    directory.mkdir(parents=True, exist_ok=True)
    program = build_program(
        f"{board.name}-board", "board_bench",
        [*sources, HERE / "models.v", _device(board, sources[-1], design, directory, placed), HERE / "bench.v"],
        simulator=simulator, flags=("-O3", "--output-split", "20000"), compiler=("-O1",),
    )  # fmt: skip
    done = subprocess.run([*program, *arguments], cwd=directory, capture_output=True, text=True, check=False)
    said = [line.split() for line in done.stdout.splitlines()]
    values = {name: [line[1] for line in said if line[0] == name] for name in ("unsteady", "rate", "held")}
    if done.returncode or len(values["unsteady"]) != 1:
        (directory / "board.log").write_text(done.stdout + done.stderr)
        raise SimulationError(f"the board's simulation failed; its log is {directory / 'board.log'}")
    if values["unsteady"] != ["0"]:
        raise VideoError(f"{values['unsteady'][0]} values change while they are sampled")
    recorded = [(directory / f"{at}.txt").read_text().split() for at in range(len(values["rate"]))]
    for lines in recorded:
        unknown = [at for at, line in enumerate(lines) if not re.fullmatch("[0-9a-f]+", line)]
        if unknown:
            raise VideoError(f"value {unknown[0]}: a wire is neither 0 nor 1")
    for held in values["held"]:
        screen = design.screen_geometry
        idle = f"{(not screen.horizontal.active_high) << 3 | (not screen.vertical.active_high) << 2:x}000000"
        if len(held) == len(idle) and held != idle:
            raise VideoError(f"in reset the monitor gets {held}, expected {idle}")
    return [float(rate) for rate in values["rate"]], recorded


def _device(board: Board, top: Path, design: Configuration, directory: Path, placed: bool) -> Path:
    """Write a module with the board in it, for the bench."""
    wiring = wiring_of(board.name)
    [pin_file] = [path for path in top.parent.glob(f"{top.stem}.*") if path.suffix[1:] in PIN_FILES]
    pins, _ = read_pin_file(pin_file)
    if "link" in wiring.outputs:
        pair = "{" + ", ".join(f"link[{at}] === ~link_n[{at}] ? link[{at}] : 1'bx" for at in (3, 2, 1, 0)) + "}"
        part = _LINK
        if placed:
            # Yosys keeps some of the net's names.
            part = _PLACED_LINK.replace("{shift_clk}", re.findall(r"\\board\.\S*shift_clk ", top.read_text())[0])
        inside = part.replace("{value}", pair if "link_n" in wiring.outputs else "link")
    elif "dac_clock" in wiring.outputs:
        inside = _PARALLEL.format(sync_n="sync_n" if "sync_n" in wiring.outputs else "1'b0")
    else:
        raise UserError(f"board: the {board.title} has a DAC without a clock, which is not simulated")
    if isinstance(board, QuartusBoard):
        inside += f"    defparam top.COLOUR_BITS = {design.colour_bits};\n"
    path = directory / "device.v"
    path.write_text(device(wiring, top.stem, pins, inside))
    return path


def wires(lines: Sequence[str]) -> np.ndarray:
    """Return the wires of a link, bool (4, bits): blue, green, red and clock."""
    values = np.array([int(line, 16) for line in lines], np.uint8)
    return np.stack([values >> channel & 1 for channel in range(len(_CHANNELS))]).astype(bool)


def parallel_pictures(lines: Sequence[str], screen: Screen) -> list[np.ndarray]:
    """Check the syncs and the blanking of every pixel of a parallel output, and return all whole frames."""
    words = np.array([int(line, 16) for line in lines], ">u4").view(np.uint8).reshape(-1, 4)
    return _frames(np.unpackbits(words, axis=1)[:, 4:], screen)


def symbols(wires: np.ndarray) -> np.ndarray:
    """Split wires, bool (4, bits), into symbols, int64 (3, pixels): blue, green, red; bit 0 was sent first.

    Raises:
        VideoError: the channels have no common alignment, or the link's clock is not a tenth of the bit rate.
    """

    def words(start: int) -> np.ndarray:
        whole = (wires.shape[1] - start) // SYMBOL_BITS * SYMBOL_BITS
        cut = wires[:, start : start + whole].reshape(len(_CHANNELS), -1, SYMBOL_BITS)
        return cut @ (1 << np.arange(SYMBOL_BITS))

    # Only where symbols start, control symbols follow one another.
    control = (np.isin(words(start)[:3], CONTROL_SYMBOLS) for start in range(SYMBOL_BITS))
    found = np.array([(one[:, 1:] & one[:, :-1]).mean(axis=1) > 0.05 for one in control])
    if (found.sum(axis=0) != 1).any():
        raise VideoError(f"control symbols are found at {found.sum(axis=0)} offsets, expected 1")
    starts = found.argmax(axis=0)
    if (starts != starts[0]).any():
        raise VideoError(f"the channels' symbols start at different bits: {starts}")
    *colours, clock = words(starts[0])
    if (clock != (1 << SYMBOL_BITS // 2) - 1).any():
        raise VideoError("the link's clock is not five ones and five zeros per symbol")
    return np.array(colours)


def pictures(words: np.ndarray, screen: Screen) -> list[np.ndarray]:
    """Decode `symbols`, check the syncs and the blanking of every pixel, and return all whole frames.

    Each frame is uint8 (visible lines, visible pixels, 3).

    Raises:
        VideoError: an invalid symbol, channels that disagree, or a departure from the standard.
    """
    table = np.full((1 << SYMBOL_BITS, 3), -1, dtype=np.int64)
    for symbol in range(1 << SYMBOL_BITS):
        with contextlib.suppress(ValueError):
            table[symbol] = decode(symbol)
    visible, data, control = np.moveaxis(table[words], -1, 0)
    if (visible < 0).any():
        channel, pixel = np.argwhere(visible < 0)[0]
        raise VideoError(f"{_CHANNELS[channel]}, pixel {pixel}: {words[channel, pixel]:010b} is not a symbol")
    if (visible != visible[0]).any():
        raise VideoError("the channels are not in blanking together")
    if control[1:].any():
        raise VideoError("green or red carries control bits")
    # A sync signal keeps its last level while picture data is sent.
    last = np.maximum.accumulate(np.where(visible[0] == 0, np.arange(words.shape[1]), 0))
    hs, vs = (control[0] & 1)[last], (control[0] >> 1)[last]
    samples = np.stack([hs, vs, visible[0], np.zeros_like(hs)])
    colours = np.unpackbits(data[::-1].astype(np.uint8)[..., None], axis=-1)  # red, green, blue
    bits = np.concatenate([samples.T, np.moveaxis(colours, 0, 1).reshape(len(hs), -1)], axis=1)
    return _frames(bits, screen)


def _frames(bits: np.ndarray, screen: Screen) -> list[np.ndarray]:
    """Return all whole frames of pixels, each HS, VS, BLANK_N, SYNC_N, red, green and blue, the first after reset.

    Raises:
        VideoError: the first frame comes late, or a departure from the standard.
    """
    line_starts, frame_starts = (
        np.flatnonzero(np.diff((levels == int(timing.active_high)).astype(int)) > 0) + 1
        for levels, timing in ((bits[:, 0], screen.horizontal), (bits[:, 1], screen.vertical))
    )
    # After reset the front porch comes first.
    latest = (screen.vertical.front + 1) * screen.horizontal.total
    if len(frame_starts) == 0 or frame_starts[0] > latest:
        first = f"{frame_starts[0]} pixels" if len(frame_starts) else "nowhere"
        raise VideoError(f"VS begins {first} after reset, expected at most {latest}")
    # In the format of the bench of the VGA output, which has the last sample first.
    cut = [bits[start:end] for start, end in pairwise(line_starts)]
    lines = [Line("".join(map(str, line[::-1].reshape(-1))), len(line), 0) for line in cut]
    firsts = [int(np.flatnonzero(line_starts == start)[0]) for start in frame_starts]
    frames = [lines[first : first + screen.vertical.total] for first in firsts]
    return [decode_frame(frame, screen, 8) for frame in frames if len(frame) == screen.vertical.total]
