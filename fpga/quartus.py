# SPDX-License-Identifier: MIT
"""`raycaster quartus`: write a Quartus project that shows a scene on a board.

Neither Quartus nor a board was available: the projects are checked as text, and with Yosys, simulators and Tcl. The
board's SRAM, which the original design used, is not needed: there is no processor, and the scene is a table in logic.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.convert.take_home import clock_period
from raycaster.convert.write import write_scene_system
from raycaster.design.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.errors import UserError
from raycaster.fit.fixing import add_fix_option, design_of
from raycaster.fpga.board import CHANNELS, TOP, VGA, QuartusBoard, board_names, find_board
from raycaster.output import Console, replaced
from raycaster.scene import Scene, find_scene

VERILOG = "verilog"
"""Subfolder of a project for the generated modules."""

HELPER = Path(__file__).with_name("channel_pins.v")

_SETUP_NS, _HOLD_NS = 0.2, 1.5
"""Setup and hold of the ADV7123's inputs: t1 and t2 in its data sheet (rev. D), 3.3 V timing specifications."""

_CLOCK_REGISTER = "*|video_generator:*|pixel_end"
"""Quartus's name of the register that drives vga_clk."""


def write_project(board: QuartusBoard, config: Configuration, scene: Scene, directory: Path) -> None:
    """Write a Quartus project.

    Args:
        board: target board.
        config: configuration of the hardware.
        scene: scene to show, with no more rectangles than the hardware holds.
        directory: output directory, replaced as a whole once everything is generated.

    Raises:
        UserError: the engine needs the pixel clock, which the projects lack.
    """
    if config.screen_geometry.clocks_per_pixel == 1:
        raise UserError(
            f"engine: the boards' projects run at 50 MHz, but the {config.engine} engine needs the pixel clock; use "
            "make verilog, with a PLL, and a DDR output register instead of ray_caster_pixel_clock"
        )
    with replaced(directory) as written:
        modules = write_scene_system(config, scene, written / VERILOG)
        sources = [f"{VERILOG}/{path.name}" for path in modules] + [HELPER.name, f"{TOP}.v"]
        shutil.copyfile(HELPER, written / HELPER.name)
        (written / f"{TOP}.v").write_text(top_of(board))
        (written / f"{TOP}.qpf").write_text(f'PROJECT_REVISION = "{TOP}"\n')
        (written / f"{TOP}.qsf").write_text(_settings(board, config, sources))
        (written / f"{TOP}.sdc").write_text(_constraints(board, config))


def _settings(board: QuartusBoard, config: Configuration, sources: list[str]) -> str:
    """Generate the settings file: the chip, the sources, and the pin and standard of each bit of the top's ports."""
    settings = {
        "FAMILY": board.family,
        "DEVICE": board.chip,
        "TOP_LEVEL_ENTITY": TOP,
        "PROJECT_OUTPUT_DIRECTORY": "output_files",
        "VERILOG_INPUT_VERSION": "VERILOG_2001",
        # Registers without a reset, which generate the reset itself, must start at 0.
        "ALLOW_POWER_UP_DONT_CARE": "OFF",
        **board.settings,
    }
    lines = [f"# RayCaster, {config.name}, on the {board.title}", "# SPDX-License-Identifier: MIT"]
    lines += [f'set_global_assignment -name {name} "{value}"' for name, value in settings.items()]
    lines += [f'set_global_assignment -name VERILOG_FILE "{source}"' for source in sources]
    lines.append(f'set_global_assignment -name SDC_FILE "{TOP}.sdc"')
    lines.append(f"set_parameter -name COLOUR_BITS {config.colour_bits}")
    for name, signal in board.signals.items():
        for bit, pin in board.bits(name).items():
            lines.append(f"set_location_assignment PIN_{pin} -to {bit}")
            lines.append(f'set_instance_assignment -name IO_STANDARD "{signal.standard}" -to {bit}')
    return "\n".join(lines) + "\n"


def top_of(board: QuartusBoard) -> str:
    """Generate the top, which connects the board's pins to `scene_system`."""
    controls = "".join(
        f"// {name}: {bit.removeprefix('~')} {'low' if bit.startswith('~') else 'high'}.\n"
        for name, bit in board.inputs.items()
    )
    driven = {source: name for name, source in board.outputs.items()}
    video = ",\n    ".join(f".{port}({port if port in CHANNELS else driven.get(port, '')})" for port in VGA)
    pins = "".join(
        f"channel_pins #(.BITS(COLOUR_BITS), .PINS({len(board.bits(driven[channel]))})) {channel}_pins "
        f"(.channel({channel}), .pins({driven[channel]}));\n"
        for channel in CHANNELS
    )
    return f"""// SPDX-License-Identifier: MIT

`timescale 1ns/10ps

// RayCaster on the pins of a {board.title}, named as in its manual. These bits control it, at this level:
{controls}module {TOP} #(
    parameter COLOUR_BITS = 8
) (
{board.port_list}
);

wire [COLOUR_BITS-1:0] {", ".join(CHANNELS)};

scene_system system (
    .clk({board.clock}),
    .ready(!({board.pressed("reset")})),
    .buttons({board.buttons}),
    {video}
);

{pins}
endmodule
"""


def _constraints(board: QuartusBoard, config: Configuration) -> str:
    """Generate the timing constraints."""
    period, divided = clock_period(config), config.screen_geometry.clocks_per_pixel
    buttons = _patterns(board, lambda name: name not in (*board.outputs, board.clock))
    # Outputs that no register captures: all if there is no DAC, which the sync signals bypass.
    free = _patterns(board, lambda name: name in (("VGA_HS", "VGA_VS") if board.dac_clock else board.outputs))
    text = f"""# SPDX-License-Identifier: MIT
# RayCaster, {config.name}, on the {board.title}.
create_clock -name clk -period {period} [get_ports {board.clock}]
derive_clock_uncertainty

# Buttons and switches are asynchronous, and are synchronised.
set_false_path -from [get_ports {{{buttons}}}]

# The monitor sees each change of these outputs. A limit of half a pixel keeps them aligned.
set_max_delay -to [get_ports {{{free}}}] {period}
set_min_delay -to [get_ports {{{free}}}] 0.000
"""
    if board.dac_clock is None:
        return text
    taken = _patterns(board, lambda name: name in board.outputs and name not in ("VGA_HS", "VGA_VS", board.dac_clock))
    return f"""{text}
# The pixel clock comes from a register and drives the DAC's pin.
create_generated_clock -name vga_clk -divide_by {divided} -source [get_ports {board.clock}] \\
    [get_registers {{{_CLOCK_REGISTER}}}]
create_generated_clock -name dac_clk -source [get_registers {{{_CLOCK_REGISTER}}}] [get_ports {board.dac_clock}]

# Setup and hold of the ADV7123 at 3.3 V. Data changes at the falling edge, a whole period of clk before the rising edge
# that captures it, and then holds for a pixel: the hold check is not at the edge that the clocks alone suggest.
set_output_delay -clock dac_clk -max {_SETUP_NS:.3f} [get_ports {{{taken}}}]
set_output_delay -clock dac_clk -min {-_HOLD_NS:.3f} [get_ports {{{taken}}}]
set_multicycle_path -hold -start -from [get_clocks clk] -to [get_clocks dac_clk] {divided - 1}
"""


def _patterns(board: QuartusBoard, chosen: Callable[[str], bool]) -> str:
    """Return Tcl patterns of the chosen ports, such as `KEY[*] VGA_HS`."""
    ports = ((name, "" if isinstance(signal.pins, str) else "[*]") for name, signal in board.signals.items())
    return " ".join(f"{name}{bits}" for name, bits in ports if chosen(name))


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("quartus", __doc__, "boxes --board de1_soc")
    parser.add_argument("--board", default="", help=f"board: {', '.join(board_names(QuartusBoard))}")
    add_scene_argument(parser, "scene to show (default: mirror_room)", default=find_scene("mirror_room"))
    parser.add_argument("--output", type=Path, default=Path("build/quartus"), help="output directory (%(default)s)")
    add_fix_option(parser)
    add_configuration_options(parser)
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    board = find_board(arguments.board, QuartusBoard)
    console = Console()
    design = design_of(arguments.scene, given_options(arguments), arguments.fix, console, **board.configuration)
    directory = arguments.output / arguments.board
    write_project(board, design.configuration, design.shown, directory)
    screen = design.configuration.screen_geometry
    if screen.standard_hz:
        made, standard = screen.pixel_hz / 1e6, screen.standard_hz / 1e6
        print(f"pixel clock: {made:g} MHz; the standard has {standard:g} MHz, and a monitor may refuse this one")
    console.print(
        f"{directory / TOP}.qpf was never compiled; it is for {board.quartus}: quartus_sh --flow compile {TOP}",
        soft_wrap=True,
    )
