# SPDX-License-Identifier: MIT
"""Designs that MyHDL would convert wrongly are refused with file and line; the other form of each converts."""

from textwrap import indent

import numpy as np
import pytest

from raycaster.docs.hdl import PAGE, rendered
from raycaster.docs.refusals import MARK, REFUSALS, design_arguments, design_of, refusal_of
from raycaster.hdl.leaf import Leaf

PORTS = {"a": 4, "b": 4, "index": 2}


def vectors(random: np.random.Generator, count: int = 300) -> list[dict[str, int]]:
    return [{name: int(random.integers(1 << width)) for name, width in PORTS.items()} for _ in range(count)]


@pytest.mark.parametrize("row", REFUSALS, ids=lambda row: row.name)
def test_a_wrong_form_is_refused_and_the_other_converts(row, tmp_path, random):
    line, _ = refusal_of(row.refused, tmp_path)
    assert line.endswith(MARK) or (MARK not in row.refused and line.startswith("def example("))
    function, _ = design_of(row.instead, tmp_path)
    Leaf(function, design_arguments, tmp_path).run_both(vectors(random), settled=2)


def test_the_generated_parts_of_the_manual_are_current():
    assert rendered(PAGE.read_text()) == PAGE.read_text(), "run python -m raycaster.docs.hdl"


DECLARED = {
    "memory": "memory = [Signal(intbv(0)[4:]) for _ in range(4)]\n@always(clk.posedge)\ndef fill():\n"
    "    memory[index].next = a\n",
    "offset": "offset = Constant(intbv(-3, min=-8, max=8))\n",
    "step": "step = signed(4)\n@always(clk.posedge)\ndef turn():\n    step.next = a[3:]\n",
}
"""Signals of a process, declared if it has their name."""


def process(statements: str) -> str:
    declared = "".join(text for name, text in DECLARED.items() if name in statements)
    return f"{declared}@always_comb\ndef process():\n{indent(statements, '    ')}\n"


@pytest.mark.parametrize(
    "statements",
    [
        "result.next = abs(a)",
        "result.next = sum([a, b])",
        "result.next = a if a + b else b",
        "result.next[index + a] = 1",
        "while a - b:\n    result.next = 0",
        "if a:\n    if b:\n        result.next = 0\n    elif (a << 1) == b:\n        result.next = 1",
        "result.next = (a * b) >> index",
        "result.next = step + a > b",
        "result.next = (a & b)[4:]",
        "result.next = (a + b)[0]",
        "result.next = ~index",
        "def helper(c):\n    pass\nresult.next = a",
        "result.next = [a, b][0]",
    ],
)
def test_other_wrong_forms_are_refused(statements, tmp_path):
    """These are not in the manual's table."""
    assert refusal_of(process(statements), tmp_path)


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("lost = bit()\n" + process("lost.next = a[0]\nresult.next = b"), "lost: Signal is driven but not read"),
        (
            "part = b(4, 0)\nadding = add(a, index, part, unconnected(1))\n",
            "Signal has multiple drivers: total; connect",
        ),
        ("adding = add(a, b, result, unconnected(1))\n" + process("result.next = a"), "result has two drivers"),
        ("both = [a, b]\n" + process("result.next = both[index]"), "a process indexes both, but both[0] is also a"),
    ],
)
def test_a_signal_that_cannot_be_printed_is_refused(body, reason, tmp_path):
    assert refusal_of(body, tmp_path)[1].startswith(reason)


@pytest.mark.parametrize(
    "statements",
    [
        "result.next = (a + b) % 16",
        "result.next = (a - b + 3) % 16",
        "result.next = (a + b + 1) & 15",
        "result.next = (a + b) % 8",
        "result.next = (a >> 1) ^ a",
        "result.next = a + b > 20",
        "result.next = (a + b) // 3",
        "result.next = ((a * b) // 3) % 16",
        "result.next = ((a + b + 1) >> index) % 16",
        "result.next = (~a & b) | 3",
        "result.next = a[4:2] * b[2:] + index - a[4:2] * b[2:]",
        "result.next = memory[index]",
        "result.next = a ^ intbv(5)[4:]",
        "result.next = (a[2:] + offset + 8) % 16",
        "result.next = a[3:].signed() == step",
        "result.next = step + step < step - 1",
        "if (a < b) and not (a == 3):\n    result.next = concat(a[3:], b[3])\nelse:\n    result.next = index",
        "for i in range(4):\n    result.next[i] = a[3 - i] and (b + i) % 2 == 1",
        "'''A text.'''\nresult.next = a",
    ],
)
def test_right_forms_convert(statements, tmp_path, random):
    """Both simulators agree about what is not refused."""
    function, _ = design_of(process(statements), tmp_path)
    Leaf(function, design_arguments, tmp_path).run_both([*vectors(random)], settled=40)
