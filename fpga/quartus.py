# SPDX-License-Identifier: MIT
"""`raycaster quartus`: a Quartus project that shows a scene on a board, compiled where Quartus is found.

No Quartus and no board were at hand: the projects are checked as text, and with Yosys, simulators and Tcl.
What the original design had beside the ray tracer: its SRAM has no successor, as nothing needs one, with no processor
and the scene as a table in logic; for its debugging over JTAG, Platform Designer's "JTAG to Avalon Master Bridge" on
avs_s0 reads every register of ray_caster_module.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.convert.take_home import clock_period
from raycaster.convert.write import write_scene_system
from raycaster.errors import UserError
from raycaster.fit.fixing import add_fix_option, design_of
from raycaster.fpga.board import TOP, QuartusBoard, board_names, check_project, find_board, top_ports
from raycaster.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.output import Console, printable, replaced
from raycaster.scene import Scene, find_scene
from raycaster.tools import find_program, run_program

VERILOG = "verilog"
"""Folder of the generated modules, within the project's."""

HELPER = Path(__file__).with_name("channel_pins.v")
OUTPUT_FILES = "output_files"
"""Where Quartus puts what it makes."""

TIMEOUT = 4 * 3600
"""Seconds after which a compilation that should have ended long ago is stopped."""

_SETUP_NS, _HOLD_NS = 0.2, 1.5
"""Of the ADV7123's data and control inputs: t1 and t2 of its data sheet (rev. D), 3.3 V timing specifications."""

_CLOCK_REGISTER = "*|video_generator:*|pixel_end"
"""What drives vga_clk, as Quartus names it."""


def write_project(board: QuartusBoard, config: Configuration, scene: Scene, directory: Path) -> None:
    """Write a Quartus project.

    Args:
        board: what it is for.
        config: the hardware.
        scene: what it shows; it has no more rectangles than the hardware.
        directory: replaced as a whole, once everything is generated.

    Raises:
        BoardError: the board's pins and its top do not agree; nothing is generated.
    """
    top = (board.directory / board.top).read_text()
    ports = top_ports(top)
    pins = _pin_assignments(board, ports)
    check_project(board, top, pins)
    if config.screen_geometry.clocks_per_pixel == 1:
        raise UserError(
            f"engine: the boards' projects run at 50 MHz, and the {config.engine} engine at the pixel clock; take "
            "make verilog, a PLL, and a DDR output register in place of ray_caster_pixel_clock"
        )
    with replaced(directory) as written:
        modules = write_scene_system(config, scene, written / VERILOG)
        sources = [f"{VERILOG}/{path.name}" for path in modules] + [HELPER.name, f"{TOP}.v"]
        shutil.copyfile(HELPER, written / HELPER.name)
        (written / f"{TOP}.v").write_text(top)
        (written / f"{TOP}.qpf").write_text(f'PROJECT_REVISION = "{TOP}"\n')
        (written / f"{TOP}.qsf").write_text(_settings(board, config, sources) + pins)
        (written / f"{TOP}.sdc").write_text(_constraints(board, config, ports))


def compile_project(board: QuartusBoard, directory: Path) -> Path:
    """Compile a project with the Quartus that is on the path.

    Returns:
        The file for the chip.

    Raises:
        UserError: there is none, or it failed; one line.
    """
    quartus = find_program("quartus_sh")
    if quartus is None:
        raise UserError(
            f"quartus_sh is not on the path, and the {board.title} needs {board.quartus}; "
            f"the project is {directory / TOP}.qpf"
        )
    print(printable(f"{quartus} compiles {directory / TOP}.qpf; that takes a while"), flush=True)
    try:
        done = run_program([quartus, "--flow", "compile", TOP], directory, TIMEOUT)
    except subprocess.TimeoutExpired:
        raise UserError(f"Quartus took more than {TIMEOUT // 3600} hours on {directory / TOP}.qpf") from None
    log = directory / "quartus.log"
    log.write_text(done.stdout + done.stderr)
    if done.returncode:
        first = re.search(r"^\s*(Error.*)$", log.read_text(), re.M)
        said = first[1] if first else f"exit code {done.returncode}"
        raise UserError(f"Quartus failed, see {log}: {said}")
    return directory / OUTPUT_FILES / f"{TOP}.sof"


def _settings(board: QuartusBoard, config: Configuration, sources: list[str]) -> str:
    """The settings file but for the pins: the chip and the sources."""
    settings = {
        "FAMILY": board.family,
        "DEVICE": board.device,
        "TOP_LEVEL_ENTITY": TOP,
        "PROJECT_OUTPUT_DIRECTORY": OUTPUT_FILES,
        "VERILOG_INPUT_VERSION": "VERILOG_2001",
        # Registers without a reset, of which the reset itself is made, rely on 0.
        "ALLOW_POWER_UP_DONT_CARE": "OFF",
        **board.settings,
    }
    lines = [f"# RayCaster, {config.name}, on the {board.title}", "# SPDX-License-Identifier: MIT"]
    lines += [f'set_global_assignment -name {name} "{value}"' for name, value in settings.items()]
    lines += [f'set_global_assignment -name VERILOG_FILE "{source}"' for source in sources]
    lines.append(f'set_global_assignment -name SDC_FILE "{TOP}.sdc"')
    lines.append(f"set_parameter -name COLOUR_BITS {config.colour_bits}")
    return "\n".join(lines) + "\n"


def _pin_assignments(board: QuartusBoard, ports: dict[str, str]) -> str:
    """The rest of it: pin and standard of each bit of the top's ports that the board has."""
    pins = board.pins
    lines = []
    for bit in ports:
        if bit in pins:
            lines.append(f"set_location_assignment PIN_{pins[bit]} -to {bit}")
            standard = board.signals[bit.partition("[")[0]].standard
            lines.append(f'set_instance_assignment -name IO_STANDARD "{standard}" -to {bit}')
    return "".join(f"{line}\n" for line in lines)


def _constraints(board: QuartusBoard, config: Configuration, ports: dict[str, str]) -> str:
    """The timing constraints."""
    asynchronous = _patterns(bit for bit, direction in ports.items() if direction == "input" and bit != board.clock)
    start = f"""# SPDX-License-Identifier: MIT
# RayCaster, {config.name}, on the {board.title}.
create_clock -name clk -period {clock_period(config)} [get_ports {board.clock}]
derive_clock_uncertainty

# Buttons and switches know no clock, and are synchronised.
set_false_path -from [get_ports {{{asynchronous}}}]
"""
    sync = ["VGA_HS", "VGA_VS"]
    divided = config.screen_geometry.clocks_per_pixel
    if board.dac_clock is None:
        pins = _patterns(bit for bit, direction in ports.items() if direction == "output")
        return f"""{start}
# Nothing takes these at a clock: the monitor sees them change. Half a pixel keeps them together.
set_max_delay -to [get_ports {{{pins}}}] {clock_period(config)}
set_min_delay -to [get_ports {{{pins}}}] 0.000
"""
    taken = _patterns(
        bit for bit, direction in ports.items() if direction == "output" and bit not in (*sync, board.dac_clock)
    )
    return f"""{start}
# The pixel clock is a register, and goes to the DAC's pin.
create_generated_clock -name vga_clk -divide_by {divided} -source [get_ports {board.clock}] \\
    [get_registers {{{_CLOCK_REGISTER}}}]
create_generated_clock -name dac_clk -source [get_registers {{{_CLOCK_REGISTER}}}] [get_ports {board.dac_clock}]

# Setup and hold of the ADV7123 at 3.3 V. Data changes at the falling edge, a whole period of clk before the rising one
# that takes it, and again only a pixel later: hold is not at the edge that the clocks alone suggest.
set_output_delay -clock dac_clk -max {_SETUP_NS:.3f} [get_ports {{{taken}}}]
set_output_delay -clock dac_clk -min {-_HOLD_NS:.3f} [get_ports {{{taken}}}]
set_multicycle_path -hold -start -from [get_clocks clk] -to [get_clocks dac_clk] {divided - 1}

# The sync goes past the DAC to the monitor: half a pixel keeps it with the picture.
set_max_delay -to [get_ports {{{" ".join(sync)}}}] {clock_period(config)}
set_min_delay -to [get_ports {{{" ".join(sync)}}}] 0.000
"""


def _patterns(bits: Iterable[str]) -> str:
    """Names of whole ports for Tcl: `KEY[*] VGA_HS`."""
    return " ".join(dict.fromkeys(re.sub(r"\[\d+\]$", "[*]", bit) for bit in bits))


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("quartus", __doc__, "boxes --board de1_soc")
    parser.add_argument("--board", default="", help=", ".join(board_names(QuartusBoard)))
    add_scene_argument(parser, "what to show (mirror_room)", default=find_scene("mirror_room"))
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("build/quartus"),
        metavar="DIR",
        help="where a folder for the board is made (default: %(default)s)",
    )
    add_fix_option(parser)
    add_configuration_options(parser)
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    arguments = command_parser().parse_args(argv)
    board = find_board(arguments.board, QuartusBoard)
    design = design_of(arguments.scene, given_options(arguments), arguments.fix, Console(), **board.configuration)
    directory = arguments.output / arguments.board
    write_project(board, design.configuration, design.shown, directory)
    print(printable(compile_project(board, directory)))
