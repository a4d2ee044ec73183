# SPDX-License-Identifier: MIT
"""Comments of ports in Verilog, from the `Args:` of a block's docstring."""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from raycaster.engines import beam, engine, exact
from raycaster.rtl.common import widths
from raycaster.rtl.common.interfaces import Interface

_SHARED = {name: value for module in (engine, beam, exact, widths) for name, value in vars(module).items()}
"""Latencies and widths, which a docstring may name without need of them in its code."""


def split(purpose: str) -> tuple[str, Mapping[str, str]]:
    """Take the arguments out of a docstring.

    Args:
        purpose: the docstring as Verilog comments, a line each.

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


def commented(ports: Sequence[str], texts: Mapping[str, str], block: Any, width: int) -> Mapping[str, str]:
    """Find the comment that stands above each port.

    The text of a record or an interface goes above the first of its ports. Above each port of an interface goes what
    the class says about that attribute.

    Args:
        ports: names, in order; those of a record or an interface begin with the argument's name.
        texts: of the arguments, by name.
        block: whose ports they are.
        width: of a line, at most.
    """
    comments = dict.fromkeys(ports, "")

    def add(port: str, text: str) -> None:
        lines = textwrap.wrap(text, width - len("    // "), break_long_words=False, break_on_hyphens=False)
        comments[port] += "".join(f"    // {line}\n" for line in lines)

    given = _given(block)
    for argument, text in texts.items():
        first = next((port for port in ports if port == argument or port.startswith(f"{argument}_")), None)
        if first and first != "clk":
            add(first, text)
        for attribute, meaning in _attributes(given.get(argument)).items():
            if f"{argument}_{attribute}" in comments:
                add(f"{argument}_{attribute}", with_numbers(meaning, block))
    return comments


def _attributes(value: object) -> Mapping[str, str]:
    """Read the text about each attribute from the docstring of an interface's class."""
    _, _, listed = (inspect.getdoc(type(value)) or "").partition("Attributes:\n")
    entries = re.findall(r"^    (\w+): (.*(?:\n        .*)*)", listed if isinstance(value, Interface) else "", re.M)
    return {name: " ".join(text.split()) for name, text in entries}


def _given(block: Any) -> Mapping[str, Any]:
    return inspect.signature(block.func).bind(*block.args, **block.kwargs).arguments


def with_numbers(text: str, block: Any) -> str:
    """Replace the names that stand in backticks by their numbers, where a block's configuration or module has them.

    Args:
        text: a docstring or a part of one, with names such as `config.units`, `unit_bits` and `SETUP_LATENCY`.
        block: whose docstring it is.
    """
    known: Mapping[str, Any] = _SHARED | block.func.__globals__ | {"config": _given(block).get("config")}

    def number(match: re.Match[str]) -> str:
        name, *attributes = match[1].split(".")
        value = known.get(name)
        for attribute in attributes:
            value = getattr(value, attribute, None)
        if inspect.isfunction(value) and known["config"] and [*inspect.signature(value).parameters] == ["config"]:
            value = value(known["config"])
        return str(value) if isinstance(value, int) and not isinstance(value, bool) else match[1]

    return re.sub(r"`([\w.]+)`", number, text)
