# SPDX-License-Identifier: MIT
"""The command-line options of a configuration: one home for every command that takes one."""

from __future__ import annotations

import argparse
import errno
import io
import os
import re
import shlex
import shutil
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

from pydantic.fields import FieldInfo

from raycaster.complaints import did_you_mean, fault_in_block
from raycaster.configuration import OPTIONS, Configuration
from raycaster.errors import UserError
from raycaster.output import printable
from raycaster.scene import find_scene
from raycaster.tools import ToolError

BUILD = Path("build")
"""Where everything that is made goes, unless told otherwise."""

SHORT_NAMES = {"sim": "simulator"}
"""Options by what make's variables call them, where that is another name."""

USUAL = ("engine", "rows", "reflections", "screen")
"""Of the configuration, what each command's help explains; `raycaster options` explains all."""

FROM_MAKE = "RAYCASTER_FROM_MAKE"
"""The environment variable by which the Makefile says that the user typed `make`."""


_ELSEWHERE = "choose another place for the output"
ADVICE = {
    errno.EACCES: f"give yourself access to it, or {_ELSEWHERE}",
    errno.EPERM: f"give yourself access to it, or {_ELSEWHERE}",
    errno.EROFS: _ELSEWHERE,
    errno.EEXIST: f"move away what is there, or {_ELSEWHERE}",
    errno.ENOTDIR: f"move away the file that is where a directory must be, or {_ELSEWHERE}",
    errno.EISDIR: "move away the directory that is where a file must be",
    errno.ENAMETOOLONG: "give it a shorter name",
    errno.ENOSPC: f"free some space, or {_ELSEWHERE}",
    errno.EDQUOT: f"free some space, or {_ELSEWHERE}",
}
"""What to do about an error of the system, by its number."""


class CommandParser(argparse.ArgumentParser):
    """The options of a subcommand, which may be given as make's variables too: `ENGINE=beam` for `--engine beam`."""

    def __init__(self, name: str, doc: str | None, example: str):
        """Begin with what every command's help begins with.

        Args:
            name: of the subcommand, or subcommands, behind `raycaster`.
            doc: the module's docstring, whose first line says what it does.
            example: arguments that are worth trying.
        """
        purpose = re.sub(r"^`raycaster [\w ]+`: |: `make [\w ]+`", "", (doc or name).strip().splitlines()[0])
        super().__init__(
            prog=f"raycaster {name}",
            usage=argparse.SUPPRESS,
            description=purpose,
            add_help=False,
            formatter_class=lambda prog: _Help(prog, max_help_position=24, width=_help_width()),
        )
        self.add_argument("-h", "--help", action="help", help=argparse.SUPPRESS)
        self.name = name
        self.example = f"raycaster {name} {example}".rstrip()

    def format_help(self) -> str:
        """The example, what the command does, and its options."""
        return f"{self.example}\n\n{super().format_help()}"

    def parse_args(self, args: Sequence[str] | None = None) -> argparse.Namespace:
        """What `argparse` makes of the words.

        Raises:
            UserError: one line that says which word is wrong.
        """
        words = sys.argv[1:] if args is None else args
        given = [one for word in words for one in self._translated(str(word))]
        self._refuse_unknown(given)
        arguments = super().parse_intermixed_args(given)
        arguments.command_line = shlex.join([*self.prog.split(), *map(str, words)])
        return arguments

    def error(self, message: str) -> NoReturn:
        """One line instead of argparse's usage."""
        raise UserError(f"{message}; see {_program()} {self.name} --help")

    def _refuse_unknown(self, words: Sequence[str]) -> None:
        """Look for options that there are not, before their values are taken for scenes.

        Raises:
            UserError: there is one.
        """
        for word in words:
            option = word.partition("=")[0]
            known = (name.startswith(option) for name in self._option_string_actions)
            if re.fullmatch(r"--[a-z][a-z0-9_-]*", option) and not any(known):
                near = did_you_mean(option, self._option_string_actions)
                raise UserError(f"unknown option: {option}{near}; see {_program()} {self.name} --help")

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
            taker = f"make {self.name.split()[-1]}" if _from_make() else self.prog
            near = did_you_mean(match[1], map(_variable, self._option_string_actions))
            raise UserError(f"{match[1]}: {taker} does not take it{near}; see {_program()} {self.name} --help")
        if action.nargs == 0:
            return [option] if value != "0" else []
        return [option, value]


class _Help(argparse.HelpFormatter):
    """Help without those options of the configuration that are seldom asked for."""

    def add_argument(self, action: argparse.Action) -> None:
        if action.dest not in OPTIONS or action.dest in USUAL:
            super().add_argument(action)


def _help_width() -> int:
    return min(120, shutil.get_terminal_size().columns)


def _variable(option: str) -> str:
    """What make calls an option."""
    name = option.lstrip("-").replace("-", "_")
    return next((variable for variable, long in SHORT_NAMES.items() if long == name), name).upper()


def _from_make() -> bool:
    return bool(os.environ.get(FROM_MAKE))


def _program() -> str:
    """How the user calls the program, which make installs below `.venv`."""
    return ".venv/bin/raycaster" if _from_make() else "raycaster"


def command_line(name: str, scene: Path | str | None = None, options: Mapping[str, Any] | None = None) -> str:
    """A command for the user to run next, in the form that they use: make's, or the program's.

    Args:
        name: of the subcommand.
        scene: its scene.
        options: by name, as in `fraction_bits`; a switch is True.
    """
    given = {
        option: int(value)
        if option in OPTIONS and isinstance(value, bool) and not _is_switch(OPTIONS[option])
        else value
        for option, value in (options or {}).items()
    }
    given = {option: value for option, value in given.items() if value is not False}
    if _from_make():
        words = [f"SCENE={shlex.quote(str(scene))}"] if scene else []
        values = {option: int(value) if isinstance(value, bool) else value for option, value in given.items()}
        words += [f"{option.upper()}={shlex.quote(str(value))}" for option, value in values.items()]
        return " ".join(["make", name.rsplit(maxsplit=1)[-1], *words])
    words = [shlex.quote(str(scene))] if scene else []
    for option, value in given.items():
        words.append("--" + SHORT_NAMES.get(option, option).replace("_", "-"))
        words += [] if value is True else [shlex.quote(str(value))]
    return " ".join(["raycaster", name, *words])


def add_scene_argument(parser: argparse.ArgumentParser, what: str, *, many: bool = False, default: Any = None) -> None:
    """Add `scene`, or `scenes` for several: a file, or one of the packaged scenes by its name."""
    parser.add_argument(
        "scene", nargs="*" if many else "?", type=find_scene, default=default, metavar="SCENE",
        help=f"{what}: a file, or a name, such as boxes, that `raycaster scenes` lists",
    )  # fmt: skip


def add_build_option(parser: argparse.ArgumentParser) -> None:
    """Add `--build`."""
    parser.add_argument("--build", type=Path, default=BUILD, metavar="DIR", help="where output goes (%(default)s)")


def add_configuration_options(parser: argparse.ArgumentParser) -> None:
    """Add `--units`, `--fraction-bits` and the others, each with the configuration's own description."""
    group = parser.add_argument_group("design", "more of it: raycaster options")
    for name in OPTIONS:
        field = OPTIONS[name]
        option = "--" + name.replace("_", "-")
        help_text = f"{field.description} (default: {shown_default(field)})"
        if _is_switch(field):
            group.add_argument(option, action="store_true", default=None, help=help_text)
        else:
            group.add_argument(option, metavar="VALUE", help=help_text)


def shown_default(field: FieldInfo) -> str:
    """What an option is where it is not given."""
    if field.default is None:
        return "what suits the rest"
    return str(int(field.default) if isinstance(field.default, bool) else field.default)


def _is_switch(field: FieldInfo) -> bool:
    """Whether an option has no value, as its field is yes or no and nothing else."""
    return field.annotation in (bool, "bool")


def given_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """The configuration's options that stood on the command line, by field name."""
    values = vars(arguments)
    return {name: values[name] for name in OPTIONS if values.get(name) is not None}


def as_options(config: Configuration) -> list[str]:
    """The options that make a configuration: those whose values are not the defaults."""
    words = []
    for name in OPTIONS:
        value = getattr(config, name)
        if value != OPTIONS[name].default:
            words.append("--" + name.replace("_", "-"))
            if _is_switch(OPTIONS[name]):
                continue
            words.append(str(int(value)) if isinstance(value, bool) else str(value))
    return words


def run_command(main: Callable[[], int | None]) -> NoReturn:
    """Run a command's body; what the user can mend becomes one line on standard error and exit code 2."""
    try:
        code = _flushed(main)
    except UserError as error:
        print(f"error: {printable(error, lines=isinstance(error, ToolError))}", file=sys.stderr)
        code = 2
    except BrokenPipeError:  # nobody reads any more, as after `| head`
        code = 128 + signal.SIGPIPE
    except OSError as error:
        print(f"error: {printable(_complaint(error))}", file=sys.stderr)
        code = 2
    except Exception as error:
        fault = fault_in_block(error)
        if fault is None:
            raise
        print(f"error: {printable(fault)}", file=sys.stderr)
        code = 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        code = 130
    try:
        sys.stdout.flush()
    except OSError:
        # Python would try once more at its end, and complain.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(code)


def _flushed(main: Callable[[], int | None]) -> int | str | None:
    """Run it, with streams that take any text, and see that all it printed has gone; its exit code."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # a shell may have closed it
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal need not have every character
    try:
        code = main() or 0
    except SystemExit as ended:  # argparse ends so after help
        code = ended.code
    try:
        sys.stdout.flush()
    except OSError as error:
        error.filename = "standard output"
        raise
    return code


def _complaint(error: OSError) -> str:
    """One line for what the system refused: the place, the reason, and what to do."""
    place = " -> ".join(str(name) for name in (error.filename, error.filename2) if name is not None)
    said = f"{place or 'output'}: {error.strerror or error}"
    return f"{said}; {ADVICE[error.errno]}" if error.errno in ADVICE else said
