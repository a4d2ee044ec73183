# SPDX-License-Identifier: MIT
"""`raycaster`: a subcommand's name, and then its own options."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from raycaster.errors import UserError
from raycaster.options import run_command
from raycaster.scene import load_scene, packaged_scenes


@dataclass(frozen=True)
class Command:
    """A subcommand: the module whose `main` it is, which is only loaded where it is called, and what it does."""

    module: str
    purpose: str


COMMANDS: Mapping[str, Command] = {
    "sim": Command("raycaster.sim.scenes", "show scenes through the converted hardware, every pixel checked"),
    "scenes": Command(__name__, "list the scenes that come with it"),
    "play": Command(
        "raycaster.play.window", "the game on the simulated hardware in a window, or a scene to walk through"
    ),
    "game": Command("raycaster.play.game", "a recorded game on the simulated system, every pixel checked"),
    "wave": Command("raycaster.debug.wave", "a waveform of some rows for GTKWave and Surfer"),
    "trace": Command("raycaster.debug.trace", "the life of one pixel, golden's values beside the hardware's"),
    "verilog": Command("raycaster.fpga.verilog", "the hardware as Verilog, with what other flows want beside it"),
    "fit": Command("raycaster.fpga.fit", "the smallest hardware that shows a scene"),
    "area": Command("raycaster.fpga.area", "the cells of a design in three families of chips"),
    "quartus": Command("raycaster.fpga.quartus", "a Quartus project for a board, compiled where Quartus is"),
    "bitstream": Command("raycaster.fpga.bitstream", "a bitstream for a board, with what pip installs"),
    "registers": Command("raycaster.register_views", "the register map for C and for people"),
    "report": Command("raycaster.report.__main__", "error against run time and cells"),
    "docs": Command("raycaster.docs.__main__", "the documentation, its diagrams and numbers made anew"),
    "results": Command("raycaster.docs.results", "measure what the README's table says, and write it there"),
    "commands": Command("raycaster.docs.commands", "run every command of the documentation"),
    "verify soak": Command("raycaster.verif.soak.soak", "random scenes at full size"),
    "verify prove": Command("raycaster.verif.formal.prove", "proofs of the converted Verilog"),
    "verify mutate": Command("raycaster.verif.mutation.mutate", "faults in every module that has leaf tests"),
    "verify exhaustive": Command("raycaster.verif.exhaustive.run", "the arithmetic at a volume for compiled benches"),
    "verify coverage": Command("raycaster.verif.coverage.measure", "code and functional coverage"),
    "verify dvi": Command("raycaster.verif.dvi.watch", "the DVI output of a board's simulated top, decoded"),
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run a subcommand; returns its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    if not words or words[0] in ("-h", "--help"):
        _overview(COMMANDS)
        return 0
    if words[0] == "verify" and (len(words) == 1 or words[1] in ("-h", "--help")):
        _overview({name: command for name, command in COMMANDS.items() if name.startswith("verify ")})
        return 0
    for taken in (2, 1):
        command = COMMANDS.get(" ".join(words[:taken]))
        if command is not None:
            rest = words[taken:]
            return _scenes() if command.module == __name__ else importlib.import_module(command.module).main(rest) or 0
    raise UserError(f"{words[0]}: is none of raycaster's commands; raycaster --help lists them")


def _overview(commands: Mapping[str, Command]) -> None:
    table = Table(box=SIMPLE_HEAD, show_header=False, pad_edge=False)
    for name, command in commands.items():
        table.add_row(name, command.purpose)
    console = Console(highlight=False)
    console.print("raycaster sim mirror_room     draws a scene; raycaster COMMAND --help tells more of a command")
    console.print(table)


def _scenes() -> int:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("scene", "title", "rows", "reflections", "rectangles"):
        table.add_column(heading, justify="left" if heading in ("scene", "title") else "right")
    for name, path in packaged_scenes().items():
        scene = load_scene(path)
        table.add_row(name, scene.title, str(scene.rows), str(scene.reflections), str(len(scene.rect)))
    Console(highlight=False).print(table)
    return 0


def run() -> None:
    """The program."""
    run_command(main)


if __name__ == "__main__":
    run()
