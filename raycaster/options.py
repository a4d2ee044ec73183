# SPDX-License-Identifier: MIT
"""The command-line options of a configuration: one home for every command that takes one."""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

from pydantic.fields import FieldInfo

from raycaster.configuration import OPTION_NAMES, Configuration
from raycaster.errors import UserError


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
