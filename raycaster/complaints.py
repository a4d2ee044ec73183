# SPDX-License-Identifier: MIT
"""Texts for one-line error messages: a likely intended word, a refused value."""

from __future__ import annotations

import difflib
import os
import re
import reprlib
import shlex
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails


FROM_MAKE = "RAYCASTER_FROM_MAKE"
"""Environment variable with which the Makefile says that the user typed `make`."""

SHORT_NAMES = {"sim": "simulator"}
"""Options with another name as a make variable, by that name."""


def from_make() -> bool:
    """Return True if the user typed `make`, not the program's name."""
    return bool(os.environ.get(FROM_MAKE))


def as_typed(option: str, value: object = None) -> str:
    """Return an option as the user types it: `ENGINE=span` for make, `--engine span` for the program.

    Args:
        option: name of the option, as in `fraction_bits`.
        value: its value; True for a switch, None for the option alone.
    """
    if from_make():
        name = next((short for short, long in SHORT_NAMES.items() if long == option), option).upper()
        return name if value is None else f"{name}={shlex.quote(str(int(value) if isinstance(value, bool) else value))}"
    name = "--" + SHORT_NAMES.get(option, option).replace("_", "-")
    return name if value is None or value is True else f"{name} {shlex.quote(str(value))}"


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Suggest the known word nearest to an unknown one, as an addition to a message; empty if none is near."""
    near = difflib.get_close_matches(word, known, 1)
    return f" (did you mean {near[0]}?)" if near else ""


LONGEST_SHOWN = 60
"""Length in characters of the longest value that an error message shows in full."""

EXPECTED: Mapping[str, str] = {
    "literal_error": "{expected}",
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float"), "a whole number"),
    "int_parsing_size": "a number of fewer digits",
    **dict.fromkeys(("float_type", "float_parsing"), "a number"),
    **dict.fromkeys(("bool_type", "bool_parsing"), "1 or 0"),
    "string_type": "a string",
    "greater_than_equal": "{ge} or more",
    "less_than_equal": "{le} or less",
    "multiple_of": "a multiple of {multiple_of}",
    **dict.fromkeys(("dict_type", "model_type", "model_attributes_type"), "a table"),
    **dict.fromkeys(("list_type", "tuple_type"), "a list"),
    "missing": "a value",
    "path_type": "a path",
}
"""Descriptions of expected values, by pydantic's error type, to replace its own."""


def refusal(errors: Sequence[ErrorDetails], depth: int | None = None) -> str:
    """Return one line for the first value that pydantic refuses: its place, what was expected, and what was given.

    Args:
        errors: pydantic's list of errors.
        depth: number of leading keys that give the value's place; all by default.
    """
    unknown = ("extra_forbidden", "unexpected_keyword_argument")
    # A mistyped key also leaves the right one missing; report the mistyped one.
    first = next((one for one in errors if one["type"] in unknown), errors[0])
    keys = first["loc"][:depth]
    place = f"{'.'.join(map(str, keys))}: " if keys else ""
    if first["type"] in unknown:
        missing = [str(one["loc"][-1]) for one in errors if one["type"] == "missing"]
        return f"{place}is unknown{did_you_mean(str(keys[-1]), missing)}; remove it or correct its name"
    if first["type"] == "value_error":
        return f"{place}{first.get('ctx', {}).get('error')}"
    # A value that may be of several types has an error for each.
    expected = [
        EXPECTED[one["type"]].format_map(one.get("ctx", {})).replace("'", "")
        for one in errors
        if one["loc"][:depth] == keys
    ]
    text = f"{place}expected {' or '.join(dict.fromkeys(expected))}"
    if first["type"] == "missing":
        return text
    choices = re.findall("'([^']*)'", str(first.get("ctx", {}).get("expected", "")))
    given = reprlib.repr(first["input"]) if len(str(first["input"])) > LONGEST_SHOWN else first["input"]
    return f"{text}, got {'nothing' if given == '' else given}{did_you_mean(str(given), choices)}"
