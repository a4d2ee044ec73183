# SPDX-License-Identifier: MIT
"""Designs that MyHDL converts to wrong Verilog, or to none, and that `raycaster.hdl` refuses: a table of the manual.

Each has another form, which converts, and which gives the same outputs in MyHDL's simulator and in Verilog.
"""

from __future__ import annotations

import runpy
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import indent
from typing import Any, NamedTuple

from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.errors import UserError, faults_in_one_line
from raycaster.hdl.hierarchy import convert_hierarchy
from raycaster.hdl.signals import bit, unsigned
from raycaster.runs.outcomes import table

MODULE = """\
from myhdl import ConcatSignal, Constant, Signal, always, always_comb, block, concat, instances, intbv

from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed, Unset, bit, signed, tied, unconnected, unsigned


@block
def add(a, b, total, carry):
    wide = unsigned(5)

    @always_comb
    def compute():
        wide.next = a + b

    @always_comb
    def part():
        total.next = wide[4:]
        carry.next = wide[4]

    return instances()


@block
def example(clk, a, b, index, result, flag):
{body}

    @always(clk.posedge)
    def keep():
        flag.next = a[0] ^ b[0] ^ index[0]

    return instances()
"""

MARK = "  # refused"
"""End of the line that an error names; without it, that is the line of the block."""


class Refusal(NamedTuple):
    """Bodies of a block: one that is refused, and what to write instead."""

    name: str
    refused: str
    instead: str


def design_of(body: str, directory: Path) -> tuple[Callable[..., Any], str]:
    """Return the block with a body, and its source, which is written to a directory."""
    text = MODULE.format(body=indent(body, "    "))
    path = directory / "example.py"
    path.write_text(text)
    return runpy.run_path(str(path))["example"], text


def design_arguments() -> dict[str, Any]:
    """Return new signals for the block's ports."""
    words = {name: unsigned(width) for name, width in (("a", 4), ("b", 4), ("index", 2), ("result", 4))}
    return {"clk": bit(), **words, "flag": bit()}


def refusal_of(body: str, directory: Path) -> tuple[str, str]:
    """Return the source line that the error of a body names, and the error without its place.

    Raises:
        ValueError: the body is not refused.
    """
    function, text = design_of(body, directory)
    try:
        with elaboration(), faults_in_one_line():
            convert_hierarchy(function(**design_arguments()), directory, "")
    except UserError as error:
        place, number, reason = str(error).split(":", 2)
        assert Path(place) == directory / "example.py"
        return text.splitlines()[int(number) - 1].strip(), reason.strip().removeprefix("example: ")
    raise ValueError(f"not refused: {body}")


def refusal_table() -> str:
    """Return the manual's table."""
    rows = []
    for row in REFUSALS:
        with TemporaryDirectory() as directory:
            line, reason = refusal_of(row.refused, Path(directory))
            rows.append([f"`{line.removesuffix(MARK)}`", reason])
    return table(["line", "error, after file and line"], rows)


def _process(statements: str, declared: str = "") -> str:
    return f"{declared}\n@always_comb\ndef process():\n{indent(statements, '    ')}\n"


WIDE = "wide = unsigned(5)\n@always_comb\ndef add_up():\n    wide.next = a + b\n"
APART = "apart = signed(5)\n@always_comb\ndef subtract():\n    apart.next = a - b\n"
BOTH = "both = unsigned(8)\n@always_comb\ndef join():\n    both.next = concat(a, b)\n"
PAIR = "pair = Record({'high': 2, 'low': 2})\n"

REFUSALS = (
    Refusal("compared", _process("result.next = a + b > index  # refused"),
            _process("result.next = wide > index", WIDE)),
    Refusal("condition", _process("if a + b:  # refused\n    result.next = 1\nelse:\n    result.next = 0"),
            _process("if wide:\n    result.next = 1\nelse:\n    result.next = 0", WIDE)),
    Refusal("shifted", _process("result.next = (a + b) >> 1  # refused"), _process("result.next = wide >> 1", WIDE)),
    Refusal("sign", _process("result.next = a - b - index < b  # refused"),
            _process("result.next = below < b", "below = signed(6)\n@always_comb\ndef subtract():\n"
                     "    below.next = a - b - index\n")),
    Refusal("index", _process("result.next = b[index - a]  # refused"), _process("result.next = b[index]")),
    Refusal("bits", _process("result.next = concat(a, b)[6:2]  # refused"),
            _process("result.next = both[6:2]", BOTH)),
    Refusal("function", _process("result.next = max(a, b)  # refused"),
            _process("if a > b:\n    result.next = a\nelse:\n    result.next = b")),
    Refusal("return", _process("result.next = b\nif a == 0:\n    return  # refused\nresult.next = a"),
            _process("result.next = b\nif a != 0:\n    result.next = a")),
    Refusal("latch", _process("if index[0]:\n    result.next = a  # refused"),
            _process("result.next = b\nif index[0]:\n    result.next = a")),
    Refusal("copy", _process("result[4:2].next = index  # refused\nresult.next[2:] = index"),
            _process("result.next[4:2] = index\nresult.next[2:] = index")),
    Refusal("loop", _process("result.next = a\nfor i in range(index):  # refused\n    result.next = b"),
            _process("result.next = a\nfor i in range(4):\n    if i < index:\n        result.next = b")),
    Refusal("integer", _process("n = 0\nn = a * 4294967296  # refused\nresult.next = n >> 32"),
            _process("n = intbv(0)[36:]\nn[:] = a * 4294967296\nresult.next = n >> 32")),
    Refusal("words", "words = [unsigned(4) for _ in range(4)]  # refused\n"
            "@always(clk.posedge)\ndef fill():\n    words[index].next = a\n"
            "@always(clk.posedge)\ndef empty():\n    words[b[2:]].next = 0\n" + _process("result.next = words[index]"),
            "words = [unsigned(4) for _ in range(4)]\n@always(clk.posedge)\ndef fill():\n    words[index].next = a\n"
            "    words[b[2:]].next = 0\n" + _process("result.next = words[index]")),
    Refusal("rounded", _process("result.next = apart // (index + 1)  # refused", APART),
            _process("result.next = apart[5:1]", APART)),
    Refusal("undriven", _process("result.next = a ^ nothing", "nothing = unsigned(4)  # refused\n"),
            _process("result.next = a ^ nothing", "nothing = tied(0, 4)\n")),
    Refusal("two drivers", "one = add(a, b, result, unconnected(1))\ntwo = add(a, index, result, unconnected(1))\n",
            "one = add(a, b, result, unconnected(1))\ntwo = add(a, index, unconnected(4), unconnected(1))\n"),
    Refusal("driven constant", "part = tied(0, 4)  # refused\none = add(a, index, part, unconnected(1))\n"
            + _process("result.next = a ^ part"),
            "part = unsigned(4)\none = add(a, index, part, unconnected(1))\n" + _process("result.next = a ^ part")),
    Refusal("outside", _process("result.next = concat(zero, index)  # refused", "zero = intbv(0)[2:]\n"),
            _process("result.next = concat(zero, index)", "zero = tied(0, 2)\n")),
    Refusal("width", _process("result.next = a ^ count", "count = Signal(intbv(0))  # refused\n"
            "@always(clk.posedge)\ndef keep_count():\n    count.next = b\n"),
            _process("result.next = a ^ count", "count = Signal(intbv(0)[4:])\n"
            "@always(clk.posedge)\ndef keep_count():\n    count.next = b\n")),
    Refusal("list", _process("result.next = mixed[index[0]]", "mixed = [unsigned(4), unsigned(2)]  # refused\n"
            "@always(clk.posedge)\ndef fill():\n    mixed[0].next = a\n    mixed[1].next = index\n"),
            _process("result.next = mixed[index[0]]", "mixed = [unsigned(4), unsigned(4)]\n"
            "@always(clk.posedge)\ndef fill():\n    mixed[0].next = a\n    mixed[1].next = index\n")),
    Refusal("unread", "carry = bit()  # refused\nadding = add(a, b, result, carry)\n",
            "adding = add(a, b, result, unconnected(1))\n"),
    Refusal("slices", _process("for i in range(2):\n    result.next[i] = halves[i][0]",
                               "halves = [a(2, 0), a(4, 2)]  # refused\n"),
            _process("for i in range(2):\n    result.next[i] = a[2 * i]\nresult.next[4:2] = 0")),
    Refusal("names", _process("result.next = pair.high ^ pair_high", f"{PAIR}pair_high = unsigned(2)  # refused\n"
            "@always(clk.posedge)\ndef take():\n    pair.word.next = a\n    pair_high.next = index\n"),
            _process("result.next = pair.high ^ other", f"{PAIR}other = unsigned(2)\n"
            "@always(clk.posedge)\ndef take():\n    pair.word.next = a\n    other.next = index\n")),
    Refusal("keyword", _process("result.next = table", "table = unsigned(4)  # refused\n"
            "@always_comb\ndef look_up():\n    table.next = a\n"),
            _process("result.next = place", "place = unsigned(4)\n@always_comb\ndef look_up():\n    place.next = a\n")),
    Refusal("nameless", "one = add(a, b, unsigned(4), unconnected(1))\ntwo = add(a, b, result, unconnected(1))\n",
            "one = add(a, b, unconnected(4), unconnected(1))\ntwo = add(a, b, result, unconnected(1))\n"),
    Refusal("not in MyHDL", _process("result.next = a / b  # refused"), _process("result.next = a")),
)  # fmt: skip
"""A design for each thing that is refused."""
