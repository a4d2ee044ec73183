# SPDX-License-Identifier: MIT
"""Designs that MyHDL would convert wrongly are refused with file and line, as are two things of one name in Verilog."""

import runpy
from textwrap import indent

import pytest
from conftest import KEPT, compare_kept
from hdl_blocks import Packed, Pair, converted, random_inputs

from raycaster.docs.refusals import MARK, REFUSALS, design_arguments, design_of, refusal_of
from raycaster.hdl.errors import UserError
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, unsigned


@pytest.mark.parametrize("row", REFUSALS, ids=lambda row: row.name)
def test_a_wrong_form_is_refused(row, tmp_path):
    line, _ = refusal_of(row.refused, tmp_path)
    assert line.endswith(MARK) or (MARK not in row.refused and line.startswith("def example("))


DECLARED = {
    "memory": "memory = [Signal(intbv(0)[4:]) for _ in range(4)]\n@always(clk.posedge)\ndef fill():\n"
    "    memory[index].next = a\n",
    "twin": "twin = unsigned(4)\nreader = add(twin, b, unconnected(4), unconnected(1))\n",
    "offset": "offset = Constant(intbv(-3, min=-8, max=8))\n",
    "step": "step = signed(4)\n@always(clk.posedge)\ndef turn():\n    step.next = a[3:]\n",
}
"""Signals of a process, declared if it has their name."""


def process(statements: str) -> str:
    declared = "".join(text for name, text in DECLARED.items() if name in statements)
    return f"{declared}@always_comb\ndef process():\n{indent(statements, '    ')}\n"


def test_other_wrong_forms_are_refused(tmp_path):
    """`kept/refusals.txt` has forms that are not in the manual's table, each above its error; \\n is a line's end.

    A form is a process, or has a block's declarations before `||`.
    """
    path, found = KEPT / "refusals.txt", []
    for form in path.read_text().splitlines()[::2]:
        declared, bars, statements = form.replace(r"\n", "\n").rpartition("||")
        body = declared + process(statements) * bool(statements or not bars)
        found += [form, f"    {refusal_of(body, tmp_path)[1]}"]
    compare_kept(path, "".join(f"{line}\n" for line in found))


@pytest.mark.parametrize(
    ("body", "settled"),
    [
        *(pytest.param(row.instead, 40, id=row.name) for row in REFUSALS),
        (process("if a == 3:\n    print('one\\r\\x0c\\u2028two')\nresult.next = a"), 40),
        (process("'''A\x0ctext\u2028of\rlines.'''\nresult.next = a"), 40),
        ("def same(x):\n    return x\n" + process("result.next = same(~a if b else ~index) % 16"), 40),
        (
            "@block\ndef inner(a, b, result):\n    @always_comb\n    def go():\n        result.next = a ^ (b >> 1)\n"
            "    return go\none = inner(a, a, result)\n",
            2,
        ),
    ],
)
def test_right_forms_convert(body, settled, tmp_path, random):
    """Both simulators agree about what is not refused."""
    function, _ = design_of(body, tmp_path)
    leaf = Leaf(function, design_arguments, tmp_path)
    leaf.run_both(random_inputs(leaf, random, 300), settled=settled)


PORTS = {"clk": bit, "pair": Pair, "packed": Packed}
"""Makers of ports by name; others are words of 4 bits."""

REGISTER = "@always(clk.posedge)\ndef keep():\n    {}.next = {}\n"
RESULT = "@always_comb\ndef combine():\n    result.next = {}\n"
STEPS = "".join(f"to_{out} = step(clk, value, value, {out}, unconnected(1))\n" for out in "ab")
STEP_1 = "@block\ndef step_1(value, result):\n" + indent(f"{RESULT.format('value')}return combine\n", "    ")
INSTANCES = "two instances would be called step_1"
CROSSED = "crossed = Pair()\ncrossing = swap(pair, crossed)\n"
TWO_THINGS = [
    ("clk pair result", "pair_high", "pair_high = unsigned(4)\n" + REGISTER.format("pair_high", "pair.low")
     + RESULT.format("pair_high ^ pair.high")),
    ("clk packed result", "packed_word", "packed_word = unsigned(9)\n"
     + REGISTER.format("packed_word", "packed.word") + RESULT.format("packed_word[4:]")),
    ("packed packed_count result", "packed_count", RESULT.format("packed_count ^ packed.count")),
    ("pair_high pair result", "pair_high", RESULT.format("pair_high")),
    ("clk packed result", "packed_count", "packed_count = [unsigned(4) for _ in range(8)]\n"
     + REGISTER.format("packed_count[packed.count]", "packed.count")
     + REGISTER.format("result", "packed_count[packed.count]").replace("keep", "fetch")),
    ("clk pair result", "swap_i", f"swap_i = unsigned(4)\n{CROSSED}"
     + REGISTER.format("swap_i", "crossed.low ^ crossed.high") + RESULT.format("swap_i")),
    ("clk pair result", "crossed_high", f"{CROSSED}crossed_high = unsigned(4)\n"
     + REGISTER.format("crossed_high", "crossed.low")
     + "second = step(clk, crossed.high, crossed_high, result, unconnected(1))\n"),
]  # fmt: skip
"""Ports, and bodies of a block with two things of one name: ports, signals, fields, memories, instances."""


@pytest.mark.parametrize(
    ("top", "ports", "said", "body"),
    [
        *(("top", ports, f"two things would be called {name} in Verilog", body) for ports, name, body in TWO_THINGS),
        ("top", "clk value a b result", INSTANCES, f"{STEP_1}{STEPS}other = step_1(value, result)\n"),
        ("top", "clk value a b result", INSTANCES, f"{STEP_1}other = step_1(value, result)\n{STEPS}"),
        ("buf", "word result", "buf is a keyword of Verilog", RESULT.format("word")),
        ("top", "reg result", "reg is a keyword of Verilog", RESULT.format("reg")),
        ("top", "logic result", "logic is a keyword of Verilog", RESULT.format("logic")),
        ("top", "Entity result", "Entity is a keyword of VHDL", RESULT.format("Entity")),
        ("Process", "word result", "Process is a keyword of VHDL", RESULT.format("word")),
    ],
)
def test_wrong_names_are_refused(top, ports, said, body, tmp_path):
    source = tmp_path / "names.py"
    source.write_text(
        "from hdl_blocks import Pair, step, swap\n"
        "from myhdl import Signal, always, always_comb, block, instances\n"
        "from raycaster.hdl.signals import unconnected, unsigned\n\n\n"
        f"@block\ndef {top}({', '.join(ports.split())}):\n{indent(body, '    ')}    return instances()\n"
    )
    signals = [PORTS[port]() if port in PORTS else unsigned(4) for port in ports.split()]
    with pytest.raises(UserError, match=rf"names\.py:\d+: {top}: {said}; rename"):
        converted(runpy.run_path(str(source))[top](*signals), tmp_path)
