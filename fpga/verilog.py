# SPDX-License-Identifier: MIT
"""`python -m raycaster.fpga.verilog`: the design as Verilog, a file a module, with what other flows want beside it."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console

from raycaster.convert.take_home import FILE_LIST
from raycaster.convert.write import write_verilog
from raycaster.fit.fixing import add_fix_option, configuration_of
from raycaster.options import add_configuration_options, given_options, run_command


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m raycaster.fpga.verilog", description=__doc__)
    parser.add_argument("--output", type=Path, default=Path("build/verilog"), help="(default: %(default)s)")
    parser.add_argument("--scene", type=Path, help="what to build in; with --fix")
    add_fix_option(parser)
    add_configuration_options(parser)
    arguments = parser.parse_args()
    config = configuration_of(arguments.scene, given_options(arguments), arguments.fix, Console())
    files = write_verilog(config, arguments.output)
    print(f"{len(files)} modules of {config.name} in {arguments.output}/, listed in {arguments.output / FILE_LIST}")


if __name__ == "__main__":
    run_command(main)
