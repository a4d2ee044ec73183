# SPDX-License-Identifier: MIT
"""Names in Verilog are those of variables; two things of one name are refused."""

import re
import runpy
from textwrap import indent

import pytest
from hdl_blocks import Pair, another_inverted, converted, step
from myhdl import always, block

from raycaster.hdl.errors import UserError
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed, bit, unconnected, unsigned


def test_the_top_keeps_its_name(tmp_path):
    @block
    def inverted(word, result):
        part = another_inverted(word, result)
        return (part,)

    modules = converted(inverted(unsigned(4), unsigned(4)), tmp_path)
    assert list(modules) == ["inverted_1", "inverted"]
    assert modules["inverted"].instances == {"inverted": "inverted_1"}
    assert re.search(r"^inverted_1 inverted_i \($", modules["inverted"].path.read_text(), re.M)


def test_two_instances_of_one_name_are_refused(tmp_path):
    """The second instance of `step` and an instance of block `step_1` share a name, whichever comes first."""

    @block
    def step_1(clk, value, result):
        @always(clk.posedge)
        def work():
            result.next = ~value

        return (work,)

    @block
    def parent(clk, value, a, b, c, last):
        stepping = [step(clk, value, value, out, unconnected(1)) for out in (a, b)]
        other = step_1(clk, value, c)
        return (stepping, other) if last else (other, stepping)

    for last in (False, True):
        with pytest.raises(UserError, match="parent: two instances would be called step_1; rename a block"):
            converted(parent(bit(), *(unsigned(4) for _ in range(4)), last), tmp_path)


PORTS = {name: lambda: unsigned(4) for name in ("pair_high", "packed_count", "result")} | {
    "clk": bit,
    "pair": Pair,
    "packed": lambda: Record({"flag": 1, "count": 3, "offset": Signed(5)}),
}
REGISTER = "@always(clk.posedge)\ndef keep():\n    {}.next = {}\n"
RESULT = "@always_comb\ndef combine():\n    result.next = {}\n"
CROSSED = "crossed = Pair()\ncrossing = swap(pair, crossed)\n"


@pytest.mark.parametrize(
    ("ports", "name", "body"),
    [
        ("clk pair result", "pair_high", "pair_high = unsigned(4)\n" + REGISTER.format("pair_high", "pair.low")
         + RESULT.format("pair_high ^ pair.high")),
        ("clk pair result", "pair_high", f"pair_high = unsigned(4)\n{CROSSED}"
         + REGISTER.format("pair_high", "crossed.low") + RESULT.format("pair_high ^ crossed.high")),
        ("clk packed result", "packed_word", "packed_word = unsigned(9)\n"
         + REGISTER.format("packed_word", "packed.word") + RESULT.format("packed_word[4:]")),
        ("clk packed result", "packed_count", "packed_count = unsigned(3)\n"
         + REGISTER.format("packed_count", "packed.count") + RESULT.format("packed_count")),
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
    ],
    ids=["port", "passed-port", "word", "field", "port-and-field", "port-and-port", "memory", "instance", "between"],
)  # fmt: skip
def test_two_things_of_one_verilog_name_are_refused(ports, name, body, tmp_path):
    with pytest.raises(UserError, match=rf"clash\.py:\d+: clash: two things would be called {name} in Verilog; rename"):
        convert_text("clash", ", ".join(ports.split()), body, [PORTS[port]() for port in ports.split()], tmp_path)


def convert_text(name: str, ports: str, body: str, signals: list, directory) -> None:
    """Convert a block from its text."""
    source = directory / "clash.py"
    source.write_text(
        "from hdl_blocks import Pair, step, swap\n"
        "from myhdl import Signal, always, always_comb, block, instances\n"
        "from raycaster.hdl.signals import unconnected, unsigned\n\n\n"
        f"@block\ndef {name}({ports}):\n{indent(body, '    ')}    return instances()\n"
    )
    converted(runpy.run_path(str(source))[name](*signals), directory)


@pytest.mark.parametrize(
    ("name", "port", "said"),
    [
        ("buf", "word", "buf is a keyword of Verilog"), ("top", "reg", "reg is a keyword of Verilog"),
        ("top", "logic", "logic is a keyword of Verilog"), ("top", "Entity", "Entity is a keyword of VHDL"),
        ("Process", "word", "Process is a keyword of VHDL"),
    ],
)  # fmt: skip
def test_keywords_are_no_names(name, port, said, tmp_path):
    with pytest.raises(UserError, match=rf"clash\.py:\d+: {name}: {said}; rename it"):
        convert_text(name, f"{port}, result", RESULT.format(port), [unsigned(4), unsigned(4)], tmp_path)
