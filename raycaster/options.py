# SPDX-License-Identifier: MIT
"""The command-line options of a configuration: one home for every command that takes one."""

from __future__ import annotations

import argparse
import re
import shlex
import shutil
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

from pydantic.fields import FieldInfo

from raycaster.configuration import OPTION_NAMES, Configuration
from raycaster.errors import UserError
from raycaster.scene import find_scene, packaged_scenes

BUILD = Path("build")
"""Where everything that is made goes, unless told otherwise."""

SHORT_NAMES = {"sim": "simulator"}
"""Options by what make's variables call them, where that is another name."""


class CommandParser(argparse.ArgumentParser):
    """The options of a subcommand, which may be given as make's variables too: `ENGINE=beam` for `--engine beam`."""

    def __init__(self, name: str, doc: str, example: str):
        """Begin with what every command's help begins with.

        Args:
            name: of the subcommand, or subcommands, behind `raycaster`.
            doc: the module's docstring, whose first line says what it does.
            example: arguments that are worth trying.
        """
        purpose = re.sub(r"^`raycaster [\w ]+`: |: `make [\w ]+`", "", doc.strip().splitlines()[0])
        super().__init__(
            prog=f"raycaster {name}",
            usage=f"raycaster {name} [options], for example: raycaster {name} {example}".rstrip(),
            description=purpose,
            formatter_class=lambda prog: argparse.HelpFormatter(prog, max_help_position=30, width=_help_width()),
        )

    def parse_args(self, args: Sequence[str] | None = None) -> argparse.Namespace:
        """What `argparse` makes of the words.

        Raises:
            UserError: one line that says which word is wrong.
        """
        words = sys.argv[1:] if args is None else args
        return super().parse_intermixed_args([one for word in words for one in self._translated(str(word))])

    def error(self, message: str) -> NoReturn:
        """One line instead of argparse's usage."""
        raise UserError(f"{message}; see {self.prog} --help")

    def _translated(self, word: str) -> list[str]:
        """A variable of make's as an option; nothing where it is empty, or a switch that is off."""
        match = re.fullmatch(r"([A-Z][A-Z_]*)=(.*)", word, re.DOTALL)
        if not match:
            return [word]
        name, value = match[1].lower(), match[2]
        if not value:
            return []
        if name == "scene":
            return [value]
        option = "--" + SHORT_NAMES.get(name, name).replace("_", "-")
        action = self._option_string_actions.get(option)
        if action is None:
            raise UserError(f"{match[1]}: {self.prog} does not take it; see {self.prog} --help")
        if action.nargs == 0:
            return [option] if value != "0" else []
        return [option, value]


def _help_width() -> int:
    return min(120, shutil.get_terminal_size().columns)


def add_scene_argument(parser: argparse.ArgumentParser, what: str, *, many: bool = False, default: Any = None) -> None:
    """Add `scene`, or `scenes` for several: a file, or one of the packaged scenes by its name."""
    parser.add_argument(
        "scene", nargs="*" if many else "?", type=find_scene, default=default, metavar="SCENE",
        help=f"{what}: a file, or {', '.join(packaged_scenes())}",
    )  # fmt: skip


def add_build_option(parser: argparse.ArgumentParser) -> None:
    """Add `--build`."""
    parser.add_argument("--build", type=Path, default=BUILD, metavar="DIR", help="where output goes (%(default)s)")


def add_configuration_options(parser: argparse.ArgumentParser) -> None:
    """Add `--units`, `--fraction-bits` and the others, each with the configuration's own description."""
    group = parser.add_argument_group("configuration")
    fields: dict[str, FieldInfo] = Configuration.__pydantic_fields__
    for name in OPTION_NAMES:
        field = fields[name]
        option = "--" + name.replace("_", "-")
        shown = "what suits the rest" if field.default is None else field.default
        help_text = f"{field.description} (default: {shown})"
        if _is_switch(field):
            group.add_argument(option, action="store_true", default=None, help=help_text)
        else:
            group.add_argument(option, metavar=name.upper(), help=help_text)


def _is_switch(field: FieldInfo) -> bool:
    """Whether an option has no value, as its field is yes or no and nothing else."""
    return field.annotation in (bool, "bool")


def given_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """The configuration's options that stood on the command line, by field name."""
    values = vars(arguments)
    return {name: values[name] for name in OPTION_NAMES if values.get(name) is not None}


def as_options(config: Configuration) -> list[str]:
    """The options that make a configuration: those whose values are not the defaults."""
    fields: dict[str, FieldInfo] = Configuration.__pydantic_fields__
    words = []
    for name in OPTION_NAMES:
        value = getattr(config, name)
        if value != fields[name].default:
            words.append("--" + name.replace("_", "-"))
            if _is_switch(fields[name]):
                continue
            words.append(str(int(value)) if isinstance(value, bool) else str(value))
    return words


def as_make_variables(options: Mapping[str, Any]) -> list[str]:
    """Options by field name, as `given_options` returns them, in the form in which make takes them."""
    values = ((name, int(value) if isinstance(value, bool) else value) for name, value in options.items())
    return [f"{name.upper()}={shlex.quote(str(value))}" for name, value in values]


def run_command(main: Callable[[], int | None]) -> NoReturn:
    """Run a command's body; what the user can mend becomes one line on standard error and exit code 2."""
    try:
        code = main() or 0
    except UserError as error:
        print(f"error: {error}", file=sys.stderr)
        code = 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        code = 130
    sys.exit(code)
