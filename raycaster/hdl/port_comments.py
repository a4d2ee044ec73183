# SPDX-License-Identifier: MIT
"""Verilog comments for a module, its ports and its processes, from a block's docstring and comments."""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import Any

from myhdl import ResetSignal

from raycaster.hdl.records import Interface, Record

CLOCK = "the clock."
"""Text of a clock that needs no comment."""


class Comments:
    """Comments of one block, in which names of Verilog replace those of Python.

    Names in backticks become numbers if a block's arguments or module have them, and a clock frequency becomes MHz; a
    function of the block's arguments is called. A name with dots that the vocabulary has, such as `config.turn`,
    becomes the text there. Any other attribute, `steps.add_colour`, becomes the signal `steps_add_colour`.
    """

    def __init__(self, block: Any, vocabulary: Mapping[str, Any], width: int):
        """Read a block's docstring.

        Args:
            block: the block that has the texts, with names such as `config.units`, `unit_bits` and `SETUP_LATENCY`.
            vocabulary: values of further names that may be in backticks, and texts for names with dots.
            width: largest width of a line.
        """
        self._vocabulary, self._width = vocabulary, width
        self._given = inspect.signature(block.func).bind(*block.args, **block.kwargs).arguments
        self._known: Mapping[str, Any] = {**vocabulary, **block.func.__globals__, **self._given}
        purpose, self._texts = _sections(block.func, "Args")
        self.purpose = "".join(f"// {self._in_verilog(line)}\n" for line in purpose.splitlines())
        """The text above the module."""

    def of_process(self, function: Any) -> str:
        """Return the comment above a process, as one line."""
        lines = inspect.findsource(function)[0][: function.__code__.co_firstlineno - 1]
        above = [*takewhile(lambda line: line.lstrip().startswith("#"), reversed(lines))]
        words = " ".join(line.strip().lstrip("# ") for line in reversed(above))
        return f"// {self._in_verilog(words)}\n" if words else ""

    def of_ports(self, ports: Sequence[str]) -> Mapping[str, str]:
        """Return the comment above each port.

        The text of an interface goes above the first of its ports, after a name for all of them, as in `vga_*`. Above
        each of its ports goes the class's text about that attribute. A record's port has the bits of each field.

        A reset that has no text gets one from its signal.

        Args:
            ports: names, in order; those of a record or an interface begin with the argument's name.
        """
        comments = dict.fromkeys(ports, "")
        resets = {
            name: f"{'a' * one.isasync}synchronous, active {'high' if one.active else 'low'}."
            for name, one in self._given.items()
            if isinstance(one, ResetSignal)
        }

        def add(port: str | None, text: str) -> None:
            if port in comments:
                # Without statements about ports that are None, as a port that is printed is not.
                text = re.sub(r"(?<=\.) [^.;]*\bNone\b[^.]*\.|; [^.;]*\bNone\b[^.;]*", "", self._in_verilog(text))
                lines = textwrap.wrap(text, self._width - 7, break_long_words=False, break_on_hyphens=False)
                comments[port] += "".join(f"    // {line}\n" for line in lines)

        def add_layout(port: str, value: object) -> None:
            if isinstance(value, Record):
                places = ((name, *value.slice(name)) for name in value.layout)
                bits = (f"[{high}:{low}] {name}" if high > low else f"[{low}] {name}" for name, high, low in places)
                add(f"{port}_word", f"{', '.join(bits)}.")

        for argument, text in {**resets, **self._texts}.items():
            value = self._given.get(argument)
            is_group = isinstance(value, Interface)
            if text != CLOCK:
                first = next((port for port in ports if port == argument or port.startswith(f"{argument}_")), None)
                add(first, f"{argument}_*: {text}" if is_group else text)
            add_layout(argument, value)
            attributes = _sections(type(value), "Attributes")[1] if is_group else {}
            for attribute, meaning in attributes.items():
                port = f"{argument}_{attribute}"
                add(port, meaning)
                add(f"{port}_word", meaning)
                add_layout(port, getattr(value, attribute, None))  # some designs may lack it
        return comments

    def _in_verilog(self, text: str) -> str:
        """Replace Python names in a text by their Verilog counterparts."""

        def number(match: re.Match[str]) -> str:
            name, *attributes = match[1].split(".")
            value = self._known.get(name)
            for attribute in attributes:
                value = getattr(value, attribute, None)
            if inspect.isfunction(value):
                parameters = inspect.signature(value).parameters.values()
                if all(one.name in self._given for one in parameters if one.default is one.empty):
                    value = value(**{one.name: self._given[one.name] for one in parameters if one.name in self._given})
            if not isinstance(value, int) or isinstance(value, bool):
                return match[1] + match[2]
            return f"{value / 1e6:g} MHz" if match[2] else str(value)

        # Tools would take these words at the beginning of a comment for instructions.
        text = re.sub(r"^\s*(?:synthesis|synopsys|pragma|verilator)\b", lambda match: match[0].title(), text)
        text = re.sub(r"`([\w.]+)`((?: Hz)?)", number, text)
        text = re.sub(r"\b\w+\.\w+\b", lambda match: str(self._vocabulary.get(match[0], match[0])), text)
        return re.sub(r"\b([a-z]\w*)\.([a-z]\w*)\b", r"\1_\2", text)


def _sections(what: Any, title: str) -> tuple[str, Mapping[str, str]]:
    """Return the docstring of a function or a class up to a section, and the section's entries: texts by name."""
    head, _, listed = (inspect.getdoc(what) or "").partition(f"{title}:\n")
    entries = re.findall(r"^    (\w+): (.*(?:\n {8,}.*)*)", listed, re.M)
    return head.rstrip(), {name: " ".join(text.split()) for name, text in entries}
