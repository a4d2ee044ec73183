# SPDX-License-Identifier: MIT
"""Command-line options, shared by all commands, with those of a configuration."""

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

from raycaster.complaints import FROM_MAKE, SHORT_NAMES, as_typed, did_you_mean, from_make
from raycaster.configuration import Configuration
from raycaster.design.decide import OPTIONS
from raycaster.errors import UserError
from raycaster.hdl.errors import fault_in_block
from raycaster.output import printable
from raycaster.runs.tools import ToolError
from raycaster.scene import find_scene

BUILD = Path("build")
"""Default directory for all output."""

USUAL = ("engine", "rows", "reflections", "screen")
"""Configuration options in each command's help; `raycaster options` explains all."""

TYPED = "1"
"""Value of `FROM_MAKE` in the program that make itself has started."""


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
"""Advice about operating system errors, by error number."""


class CommandParser(argparse.ArgumentParser):
    """Parser for a subcommand's options, also given as make variables: `ENGINE=span` for `--engine span`."""

    def __init__(self, name: str, doc: str | None, example: str):
        """Set up what the help of all commands has in common.

        Args:
            name: name of the subcommand, or subcommands, after `raycaster`.
            doc: docstring of the module, whose first line says what the command does.
            example: arguments of an example.
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
        """Return the example, what the command does, and its options."""
        return f"{self.example}\n\n{super().format_help()}"

    def parse_args(self, args: Sequence[str] | None = None) -> argparse.Namespace:
        """Parse words with argparse, after translating make variables to options.

        Raises:
            UserError: one line that names the wrong word.
        """
        words = sys.argv[1:] if args is None else args
        self._refuse_environment(words)
        given = [one for word in words for one in self._translated(str(word))]
        self._refuse_unknown(given)
        arguments = super().parse_intermixed_args(given)
        arguments.command_line = shlex.join([*self.prog.split(), *given])
        return arguments

    def error(self, message: str) -> NoReturn:
        """Raise one line instead of printing argparse's usage; Python reads no number of thousands of digits."""
        message = re.sub(r"'[+-]?(\d{20,})'", lambda number: f"a number of {len(number[1]):,} digits", message)
        raise UserError(f"{message}; see {_program()} {self.name} --help")

    def _refuse_environment(self, words: Sequence[str]) -> None:
        """Refuse options of this command in the environment of make, where make has variables but the program none.

        Raises:
            UserError: names the first one, and the command to type.
        """
        if os.environ.get(FROM_MAKE) != TYPED:
            return
        os.environ[FROM_MAKE] = "called"  # programs that this one starts get their options from it
        for name in ("SCENE", *map(_variable, self._option_string_actions)):
            value = os.environ.get(name)
            if value and not any(word.startswith(f"{name}=") for word in words):
                target = _target(self.name)
                typed = " ".join([target, *map(shlex.quote, words), f"{name}={shlex.quote(value)}"])
                raise UserError(
                    f"{name}={value} is in the environment, but {target} takes only what follows it; run {typed}, or "
                    f"unset {name}"
                )

    def _refuse_unknown(self, words: Sequence[str]) -> None:
        """Refuse unknown options, before their values are taken for scenes.

        Raises:
            UserError: an option is unknown.
        """
        for word in words:
            option = word.partition("=")[0]
            known = (name.startswith(option) for name in self._option_string_actions)
            if re.fullmatch(r"--[a-z][a-z0-9_-]*", option) and not any(known):
                near = did_you_mean(option, self._option_string_actions)
                raise UserError(f"unknown option: {option}{near}; see {_program()} {self.name} --help")

    def _translated(self, word: str) -> list[str]:
        """Translate a make variable to an option, or to nothing if it is empty or a switch that is off."""
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
            taker = _target(self.name) if from_make() else self.prog
            near = did_you_mean(match[1], map(_variable, self._option_string_actions))
            raise UserError(f"{match[1]}: {taker} does not take it{near}; see {_program()} {self.name} --help")
        if action.nargs == 0:
            return [option] if value != "0" else []
        return [option, value]


class _Help(argparse.HelpFormatter):
    """Help without the less usual options of the configuration."""

    def add_argument(self, action: argparse.Action) -> None:
        if action.dest not in OPTIONS or action.dest in USUAL:
            super().add_argument(action)


def _help_width() -> int:
    return min(120, shutil.get_terminal_size().columns)


def _variable(option: str) -> str:
    """Return the make variable for an option."""
    name = option.lstrip("-").replace("-", "_")
    return next((variable for variable, long in SHORT_NAMES.items() if long == name), name).upper()


def _target(name: str) -> str:
    """Return how make runs a subcommand."""
    return "make verify-all" if name == "verify all" else f"make {name.rsplit(maxsplit=1)[-1]}"


def outside_make() -> dict[str, str]:
    """Return the environment without the settings of a make that runs this program."""
    return {
        name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS", FROM_MAKE)
    }


def _program() -> str:
    """Return the program's name as the user types it; make installs it below `.venv`."""
    return ".venv/bin/raycaster" if from_make() else "raycaster"


def command_line(name: str, scene: Path | str | None = None, options: Mapping[str, Any] | None = None) -> str:
    """Return a command for the user to run next, in the form that they use: make or the program.

    Args:
        name: name of the subcommand.
        scene: scene to pass.
        options: values of options by name, as in `fraction_bits`; a switch is True.
    """
    given = {
        option: int(value)
        if option in OPTIONS and isinstance(value, bool) and not _is_switch(OPTIONS[option])
        else value
        for option, value in (options or {}).items()
    }
    words = [as_typed(option, value) for option, value in given.items() if value is not False]
    if from_make():
        return " ".join([_target(name), *([as_typed("scene", scene)] if scene else []), *words])
    return " ".join(["raycaster", name, *([shlex.quote(str(scene))] if scene else []), *words])


def add_scene_argument(parser: argparse.ArgumentParser, what: str, *, many: bool = False, default: Any = None) -> None:
    """Add `scene`, for one or several scenes: a file, or the name of a packaged scene."""
    parser.add_argument(
        "scene", nargs="*" if many else "?", type=find_scene, default=default, metavar="SCENE",
        help=f"{what}: a file, or a name listed by `raycaster scenes`, such as boxes",
    )  # fmt: skip


def add_build_option(parser: argparse.ArgumentParser) -> None:
    """Add `--build`."""
    parser.add_argument("--build", type=Path, default=BUILD, metavar="DIR", help="output directory (%(default)s)")


def add_configuration_options(parser: argparse.ArgumentParser) -> None:
    """Add `--units`, `--fraction-bits` and the other options, each with the configuration's description."""
    group = parser.add_argument_group("design", "all design options: raycaster options")
    for name in OPTIONS:
        field = OPTIONS[name]
        option = "--" + name.replace("_", "-")
        help_text = f"{field.description} (default: {shown_default(field)})"
        if _is_switch(field):
            group.add_argument(option, action="store_true", default=None, help=help_text)
        else:
            group.add_argument(option, metavar="VALUE", help=help_text)


def shown_default(field: FieldInfo) -> str:
    """Return an option's default as shown in help."""
    if field.default is None:
        return "automatic"
    return str(int(field.default) if isinstance(field.default, bool) else field.default)


def _is_switch(field: FieldInfo) -> bool:
    """Return True if an option takes no value, because its field can only be true or false."""
    return field.annotation in (bool, "bool")


def given_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the configuration options given on the command line, by field name."""
    values = vars(arguments)
    return {name: values[name] for name in OPTIONS if values.get(name) is not None}


def as_options(config: Configuration) -> list[str]:
    """Return the options that make a configuration: those whose values differ from the defaults."""
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
    """Run a command's body; errors that the user can fix become one line on standard error and exit code 2."""
    os.environ.setdefault("PATH", os.defpath)  # a service manager may leave it out, and cocotb reads it
    try:
        if sys.flags.optimize:
            raise UserError(
                "Python's option -O and PYTHONOPTIMIZE leave out checks, and texts that become the Verilog's comments; "
                "run it without them"
            )
        code = _flushed(main)
    except UserError as error:
        print(f"error: {printable(error, lines=isinstance(error, ToolError))}", file=sys.stderr)
        code = 2
    except BrokenPipeError:  # the reader has gone, as with `| head`
        code = 128 + signal.SIGPIPE
    except OSError as error:
        print(f"error: {printable(_complaint(error))}", file=sys.stderr)
        code = 2
    except Exception as error:
        fault = fault_in_block(error, ("raycaster.convert.",))
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
        # Python would flush again at exit, and complain.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(code)


def _flushed(main: Callable[[], int | None]) -> int | str | None:
    """Run a body with streams that take any text, flush what it printed, and return its exit code."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # a shell may have closed it
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal may lack characters
    try:
        code = main() or 0
    except SystemExit as ended:  # argparse exits after help
        code = ended.code
    try:
        sys.stdout.flush()
    except OSError as error:
        error.filename = "standard output"
        raise
    return code


def _complaint(error: OSError) -> str:
    """Return one line for an operating system error: the place, the reason, and what to do."""
    place = " -> ".join(str(name) for name in (error.filename, error.filename2) if name is not None)
    said = f"{place or 'output'}: {error.strerror or error}"
    return f"{said}; {ADVICE[error.errno]}" if error.errno in ADVICE else said
