# SPDX-License-Identifier: MIT
"""Commands of `raycaster` and their modules.

This file needs only the standard library, so that `make help` can run it before anything is installed.
"""

from __future__ import annotations

import difflib
import sys
from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Command:
    """A subcommand.

    Attributes:
        module: the module with its `main`, imported only when the command is called.
        purpose: its description in the overview.
        extra: the extra of pyproject.toml that it needs.
    """

    module: str
    purpose: str
    extra: str = ""


COMMANDS: Mapping[str, Command] = {
    "sim": Command("raycaster.sim.scenes", "draw scenes with the hardware and check every pixel"),
    "scenes": Command("raycaster.cli.scenes", "list the packaged scenes"),
    "import": Command("raycaster.cli.import_level", "make a scene from a map of characters"),
    "options": Command("raycaster.cli.design_options", "list the options of a design, such as --engine"),
    "play": Command("raycaster.play.window", "play the game, or walk through a scene, in a window", "play"),
    "game": Command("raycaster.play.game", "run a recorded game and check every frame", "play"),
    "send": Command("raycaster.play.send", "show a room on a board with a serial port", "board"),
    "walk": Command("raycaster.play.board_walk", "walk through a room on a board, with keys", "board"),
    "web": Command("raycaster.web.site", "write a page that runs the hardware in the browser", "play"),
    "trace": Command("raycaster.debug.trace", "follow one pixel through the hardware"),
    "wave": Command("raycaster.debug.wave", "write the waveform of some rows"),
    "verilog": Command("raycaster.convert.verilog", "write the hardware as Verilog"),
    "fit": Command("raycaster.fpga.fit", "find the smallest hardware for a scene", "fpga"),
    "area": Command("raycaster.fpga.area", "count the cells of a design", "fpga"),
    "bitstream": Command("raycaster.fpga.bitstream", "make a bitstream for a board", "fpga"),
    "quartus": Command("raycaster.fpga.quartus", "write a Quartus project for an Intel board"),
    "registers": Command("raycaster.convert.register_views", "write the register map as a C header and a page"),
    "report": Command("raycaster.report.__main__", "compare error, run time and size of designs", "report"),
    "docs": Command("raycaster.docs.__main__", "build the manual", "docs"),
    "results": Command("raycaster.docs.results", "measure the engines and write the manual's tables", "docs"),
    "completion": Command("raycaster.cli.completion", "print shell completions for bash, zsh or tcsh"),
    "verify all": Command("raycaster.verif.everything", "run all tests, including the slow ones", "test"),
    "verify soak": Command("raycaster.verif.soak.soak", "compare random scenes at full size"),
    "verify prove": Command("raycaster.verif.formal.prove", "prove properties of the Verilog", "formal"),
    "verify mutate": Command("raycaster.verif.mutation.mutate", "plant faults that the tests must notice", "formal"),
    "verify gate": Command("raycaster.verif.gate", "check that tests still notice planted faults", "test"),
    "verify coverage": Command("raycaster.verif.coverage", "list lines and branches that no frame or bench reaches"),
}


NOT_OF_MAKE = ("completion", "import", "options", "results", "verify coverage")
"""Commands that are not make targets; `.venv/bin/raycaster` runs them."""


def overview(*, from_make: bool = False) -> str:
    """Return an overview of all commands, one per line; the `verify` commands share a line.

    Args:
        from_make: list make's targets, in make's notation.
    """
    chosen = [name for name in COMMANDS if not (from_make and name in NOT_OF_MAKE)]
    checks = [name.removeprefix("verify ") for name in chosen if name.startswith("verify ")]
    others = [name for name in chosen if not name.startswith("verify ")]
    lines = [(name, COMMANDS[name].purpose) for name in others]
    if from_make:
        head = "make sim SCENE=mirror_room ENGINE=span PYTHON3=python3.12"
        lines += [
            (", ".join("verify-all" if check == "all" else check for check in checks), ""),
            ("test, lint, clean", "run most tests; check the sources; remove generated files"),
        ]
    else:
        head = "raycaster sim mirror_room      raycaster COMMAND --help explains a command"
        lines.append(("verify", ", ".join(checks)))
    return "\n".join([head, *(f"  {name:<11} {purpose}".rstrip() for name, purpose in lines)])


def verify_overview() -> str:
    """Return an overview of the `verify` commands."""
    lines = [f"  {name:<18} {each.purpose}" for name, each in COMMANDS.items() if name.startswith("verify ")]
    return "\n".join(["raycaster verify soak --seeds 10", "", *lines])


OF_MAKE_ALONE = ("help", "test", "lint", "clean")
"""Make targets that are not commands of the program."""


def unknown_command(asked: str, *, from_make: bool = False) -> str:
    """Return the error message for an unknown command, with the most similar known one.

    Args:
        asked: the unknown name.
        from_make: it was given to make, which names a check by its last word.
    """
    names = {word: name for name in COMMANDS for word in (name, name.removeprefix("verify "))}
    if from_make:
        names = {word: word for word in (*names, *OF_MAKE_ALONE) if " " not in word}
        names |= {name.split()[-1]: f".venv/bin/raycaster {name}" for name in NOT_OF_MAKE}
        names |= {"all": "verify-all", "verify-all": "verify-all", "verify": "verify-all"}
    near = difflib.get_close_matches(asked, names, 1)
    meant = f" (did you mean {names[near[0]]}?)" if near else ""
    return f"unknown command: {asked}{meant}; {'make help' if from_make else 'raycaster --help'} lists all"


if __name__ == "__main__":
    if sys.argv[1:]:
        sys.exit(f"error: {unknown_command(sys.argv[1], from_make=True)}")
    sys.stdout.write(overview(from_make=True) + "\n")
