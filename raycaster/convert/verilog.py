# SPDX-License-Identifier: MIT
"""`raycaster verilog`: write the design as Verilog, one file per module, with the files that other flows need."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from raycaster.convert.take_home import PREFIX
from raycaster.convert.write import write_verilog
from raycaster.design.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.fit.fixing import add_fix_option, configuration_of
from raycaster.output import Console, printable


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verilog", __doc__, "--engine exact")
    parser.add_argument("--output", type=Path, default=Path("build/verilog"), help="output directory (%(default)s)")
    parser.add_argument("--prefix", default=PREFIX, help="prefix of all module names (default: %(default)s)")
    add_scene_argument(parser, "scene to build in with --fix")
    add_fix_option(parser)
    add_configuration_options(parser)
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    config = configuration_of(arguments.scene, given_options(arguments), arguments.fix, Console())
    files = write_verilog(config, arguments.output, arguments.prefix)
    where = f"{arguments.output}/, listed in {files[-1].with_suffix('.f')}"
    print(printable(f"{len(files)} modules of {config.name} in {where}"))
