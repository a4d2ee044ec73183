# SPDX-License-Identifier: MIT
"""Verilog comments for a module, its ports and its processes, from a block's docstring and comments."""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from raycaster.hdl.records import Interface, Record

CLOCK = "the clock."
"""Text of a clock that needs no comment."""


def split(purpose: str) -> tuple[str, Mapping[str, str]]:
    """Separate the arguments from the rest of a docstring.

    Args:
        purpose: the docstring as Verilog comments, one per line.

    Returns:
        The comments without the arguments, and the text of each argument by its name.
    """
    head, found, listed = purpose.partition("// Args:\n")
    if not found:
        return purpose, {}
    texts: dict[str, str] = {}
    name = ""
    for line in listed.splitlines():
        entry = re.match(r"//     (\w+): (.*)", line)
        if entry:
            name = entry[1]
        texts[name] = entry[2] if entry else f"{texts[name]} {line.removeprefix('//').strip()}"
    return re.sub(r"(?://\s*\n)+\Z", "", head), texts


def commented(
    ports: Sequence[str], texts: Mapping[str, str], block: Any, width: int, vocabulary: Mapping[str, Any]
) -> Mapping[str, str]:
    """Return the comment above each port.

    The text of an interface goes above the first of its ports, after a name for all of them, as in `vga_*`. Above each
    of its ports goes the class's text about that attribute. A record's port has the bits of each field.

    Args:
        ports: names, in order; those of a record or an interface begin with the argument's name.
        texts: texts of the arguments, by name.
        block: the block that has the ports.
        width: largest width of a line.
        vocabulary: as for `in_verilog`.
    """
    comments = dict.fromkeys(ports, "")
    given = _given(block)

    def add(port: str, text: str) -> None:
        text = _without_absent(in_verilog(text, block, vocabulary))
        lines = textwrap.wrap(text, width - len("    // "), break_long_words=False, break_on_hyphens=False)
        comments[port] += "".join(f"    // {line}\n" for line in lines)

    def add_layout(record: object, port: str) -> None:
        if isinstance(record, Record) and port in comments:
            add(port, f"{_layout(record)}.")

    for argument, text in texts.items():
        value = given.get(argument)
        first = next((port for port in ports if port == argument or port.startswith(f"{argument}_")), None)
        if first and text != CLOCK:
            add(first, f"{argument}_*: {text}" if isinstance(value, Interface) else text)
        add_layout(value, f"{argument}_word")
        for attribute, meaning in _attributes(value).items():
            port, record = f"{argument}_{attribute}", getattr(value, attribute)
            for name in {port, f"{port}_word"} & set(comments):
                add(name, meaning)
            add_layout(record, f"{port}_word")
    return comments


def _layout(record: Record) -> str:
    """Describe the bits of each field."""
    places = ((name, *record.slice(name)) for name in record.layout)
    return ", ".join(f"[{high}:{low}] {name}" if high > low else f"[{low}] {name}" for name, high, low in places)


def _attributes(value: object) -> Mapping[str, str]:
    """Read the text about each attribute from the docstring of an interface's class."""
    _, _, listed = (inspect.getdoc(type(value)) or "").partition("Attributes:\n")
    entries = re.findall(r"^    (\w+): (.*(?:\n        .*)*)", listed if isinstance(value, Interface) else "", re.M)
    return {name: " ".join(text.split()) for name, text in entries}


def _given(block: Any) -> Mapping[str, Any]:
    return inspect.signature(block.func).bind(*block.args, **block.kwargs).arguments


def in_verilog(text: str, block: Any, vocabulary: Mapping[str, Any]) -> str:
    """Replace Python names in a text by their Verilog counterparts.

    Names in backticks become numbers if a block's arguments or module have them, and a clock frequency becomes MHz; a
    function of the block's arguments is called. A name with dots that the vocabulary has, such as `config.turn`,
    becomes the text there. Any other attribute, `steps.add_colour`, becomes the signal `steps_add_colour`.

    Args:
        text: text from a docstring or comment, with names such as `config.units`, `unit_bits` and `SETUP_LATENCY`.
        block: the block that has the text.
        vocabulary: values of further names that may be in backticks, and texts for names with dots.
    """
    given = _given(block)
    known: Mapping[str, Any] = {**vocabulary, **block.func.__globals__, **given}

    def number(match: re.Match[str]) -> str:
        name, *attributes = match[1].split(".")
        value = known.get(name)
        for attribute in attributes:
            value = getattr(value, attribute, None)
        if inspect.isfunction(value) and (needed := inspect.signature(value).parameters.keys()) <= given.keys():
            value = value(**{name: given[name] for name in needed})
        if not isinstance(value, int) or isinstance(value, bool):
            return match[1] + match[2]
        return f"{value / 1e6:g} MHz" if match[2] else str(value)

    text = re.sub(r"`([\w.]+)`((?: Hz)?)", number, text)
    text = re.sub(r"\b\w+\.\w+\b", lambda match: str(vocabulary.get(match[0], match[0])), text)
    return re.sub(r"\b([a-z]\w*)\.([a-z]\w*)\b", r"\1_\2", text)


def _without_absent(text: str) -> str:
    """Leave out statements about ports that are None, as a port that is printed is not."""
    text = re.sub(r"(?<=\.) [^.;]*\bNone\b[^.]*\.", "", text)
    return re.sub(r"; [^.;]*\bNone\b[^.;]*", "", text)
