# SPDX-License-Identifier: MIT
"""`raycaster verify dvi`: decode the DVI output of a simulated board, as a monitor does.

The timing is checked against the standard, and every pixel is compared with the golden model.
"""

from __future__ import annotations

import contextlib
import re
import subprocess
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from PIL import Image

from raycaster.design import Design
from raycaster.fit.fixing import add_fix_option, design_of
from raycaster.fpga.bitstream import write_project
from raycaster.fpga.board import OpenBoard, board_names, find_board
from raycaster.golden.engines import model_of
from raycaster.golden.picture import count_wrong, shown
from raycaster.golden.tmds import CONTROL_SYMBOLS, decode
from raycaster.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.output import Console, emptied, printable
from raycaster.rtl.system.scene_player import BUTTONS
from raycaster.scene import find_scene
from raycaster.screens import Screen
from raycaster.sim.monitor import Line, VideoError, decode_frame
from raycaster.sim.simulator import SimulationError, add_simulator_option, build_program

SYMBOL_BITS = 10
HERE = Path(__file__).parent
_CHANNELS = ("blue", "green", "red", "clock")


def watch(
    board: OpenBoard,
    sources: Sequence[Path],
    screen: Screen,
    frames: int,
    directory: Path,
    *,
    simulator: str = "verilator",
    buttons: int = 0,
    late_ns: int = 0,
) -> list[np.ndarray]:
    """Simulate the board and return the first frames that its DVI connector sends after reset, as `pictures` does.

    Args:
        board: the board.
        sources: the board's Verilog, the design's included.
        screen: the design's screen.
        frames: number of frames.
        directory: for the recording.
        simulator: one of `raycaster.sim.simulator.SIMULATORS`; only Icarus knows unknown bits.
        buttons: a bit for each button that is held all the time, in the order of `scene_player.BUTTONS`.
        late_ns: extra duration of reset.

    Raises:
        UserError: the simulator is missing.
        SimulationError: the simulation could not be built or run.
        VideoError: the output departs from the standard, or the board samples symbols while they may change.
    """
    frame = screen.horizontal.total * screen.vertical.total * SYMBOL_BITS
    # Reset restarts the video before the first vertical sync, from which frames are counted.
    bits = frames * frame + frame // 8
    arguments = [f"+bits={bits}", f"+buttons={buttons:b}", f"+late_ns={late_ns}"]
    found = pictures(symbols(_record(board, sources, directory, simulator, arguments)), screen)
    if len(found) < frames:
        raise VideoError(f"{len(found)} frames in {bits} bits, expected {frames}")
    return found[:frames]


def golden(design: Design, position: tuple[int, int, int] | None = None) -> np.ndarray:
    """Render what a monitor must show, from the scene's camera or another position; uint8 (lines, pixels, 3)."""
    scene = design.scene
    if position is not None:
        scene = scene.model_copy(update={"camera": scene.camera.model_copy(update={"position": position})})
    config = design.configuration
    return shown(model_of(config).render(scene, config.screen_geometry, design.reflections), config)


def _record(
    board: OpenBoard, sources: Sequence[Path], directory: Path, simulator: str, arguments: Sequence[str]
) -> np.ndarray:
    """Record the output of the board's DVI connector: bool (4, bits), blue, green, red and clock."""
    directory.mkdir(parents=True, exist_ok=True)
    device = directory / "dvi_device.v"
    device.write_text(_device(board))
    program = build_program(
        f"{board.name}-dvi", "dvi_bench", [*sources, HERE / "models.v", device, HERE / "bench.v"], simulator=simulator,
        flags=("-O3", "--output-split", "20000"), compiler=("-O1",),
    )  # fmt: skip
    done = subprocess.run([*program, *arguments], cwd=directory, capture_output=True, text=True, check=False)
    if done.returncode:
        (directory / "dvi.log").write_text(done.stdout + done.stderr)
        raise SimulationError(f"the board's simulation failed; its log is {directory / 'dvi.log'}")
    unsteady = re.search(r"^unsteady (\d+)$", done.stdout, re.MULTILINE)
    if unsteady is None or int(unsteady[1]):
        raise VideoError(f"{unsteady[1] if unsteady else 'all'} symbols change while they are sampled")
    digits = (directory / "gpdi.txt").read_text()
    if unknown := re.search("[^0-9a-f]", digits):
        raise VideoError(f"bit {unknown.start()}: a wire is neither 0 nor 1")
    values = np.array([int(digit, 16) for digit in digits], np.uint8)
    return np.stack([values >> channel & 1 for channel in range(len(_CHANNELS))]).astype(bool)


def _device(board: OpenBoard) -> str:
    """Return a module with the board in it and the same ports for any board. Without a reset button, its PLL resets."""
    lines, connections = [], []
    for name, signal in board.signals.items():
        bits = f" [{len(signal.pins) - 1}:0]" if isinstance(signal.pins, tuple) else ""
        lines.append(f"    {'wire' if name in board.outputs else 'reg'}{bits} {name};")
        connections.append(f".{name}({name})")
    lines.append(f"    initial {board.clock} = 1'b0;")
    lines.append(f"    always #({500 / board.clock_mhz}) {board.clock} = ~{board.clock};")
    for name, value in board.inputs.items():
        pressed = "reset" if name == "reset" else f"buttons[{BUTTONS.index(name)}]"
        lines.append(f"    always @* {value.removeprefix('~')} = {'~' * value.startswith('~')}{pressed};")
    for port, value in (("link", "link_p"), ("serial", "serial")):
        [name] = [name for name, driven in board.outputs.items() if driven == value]
        lines.append(f"    assign {port} = {name};")
    body = "\n".join(lines)
    return f"""`timescale 1ns / 1ps

module dvi_device (
    input  wire reset,
    input  wire [{len(BUTTONS) - 1}:0] buttons,
    output wire [3:0] link,
    output wire serial
);
{body}
    {board.name} top ({", ".join(connections)});
endmodule
"""


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
    line_starts, frame_starts = (
        np.flatnonzero(np.diff((levels == int(timing.active_high)).astype(int)) > 0) + 1
        for levels, timing in ((hs, screen.horizontal), (vs, screen.vertical))
    )
    # In the format of the bench of the VGA output, which has the last sample first.
    cut = [bits[start:end] for start, end in pairwise(line_starts)]
    lines = [Line("".join(map(str, line[::-1].reshape(-1))), len(line), 0) for line in cut]
    firsts = [int(np.flatnonzero(line_starts == start)[0]) for start in frame_starts]
    frames = [lines[first : first + screen.vertical.total] for first in firsts]
    return [decode_frame(frame, screen, 8) for frame in frames if len(frame) == screen.vertical.total]


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify dvi", __doc__, "boxes")
    parser.add_argument("--board", default="ulx3s", help=f"{', '.join(board_names(OpenBoard))} (default: %(default)s)")
    add_scene_argument(parser, "what to show (mirror_room)", default=find_scene("mirror_room"))
    parser.add_argument("--frames", type=int, default=1, help="number of frames to check (default: %(default)s)")
    add_simulator_option(parser)
    parser.add_argument("--output", type=Path, default=Path("build/dvi"), help="output directory (%(default)s)")
    add_fix_option(parser)
    add_configuration_options(parser)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    board = find_board(arguments.board, OpenBoard)
    console = Console()
    design = design_of(arguments.scene, given_options(arguments), arguments.fix, console, **board.configuration)
    output = arguments.output / board.name / design.name
    emptied(output)
    screen = design.configuration.screen_geometry
    try:
        with console.waiting(f"{board.name}, {design.configuration.name}: building and simulating"):
            sources = write_project(board, design, output)
            frames = watch(board, sources, screen, arguments.frames, output, simulator=arguments.simulator)
    except (SimulationError, VideoError) as error:
        print(printable(error), file=sys.stderr)
        return 1
    expected = golden(design)
    wrong = sum(count_wrong(frame, expected) for frame in frames)
    Image.fromarray(frames[-1]).save(output / "frame.png")
    console.print(
        f"{board.name}, {design.configuration.name}, {design.path}: {wrong} of {len(frames) * expected[..., 0].size:,} "
        f"pixels are wrong; the last frame is {output / 'frame.png'}",
        soft_wrap=True,
    )
    return int(wrong > 0)
