# SPDX-License-Identifier: MIT
"""Designs that MyHDL would convert wrongly are refused with file and line, as are two things of one name in Verilog."""

import runpy
from textwrap import indent

import pytest
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


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        *(
            (process(statements), "")
            for statements in (
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
                "def helper(c):\n    pass\nresult.next = a",
                "result.next = [a, b][0]",
            )
        ),
        *(
            (process(statements), reason)
            for statements, reason in (
                ("result.next = a in range(1, 3)", "Verilog has no in; write == or != for each value"),
                ("result.next = a is b", "Verilog has no a is b; decide it outside of the process"),
                ("print(f'{a}')\nresult.next = a", "Verilog has no f'{a}'; write it otherwise"),
                ("if (n := a + 1) > 3:\n    result.next = n", "Verilog has no (n := (a + 1))"),
                ("n: int = 3\nresult.next = a ^ n", "Verilog has no n: int = 3"),
                ("with a:\n    result.next = b", "Verilog has no with a:"),
                ("result.next = 0\nwhile a > result:\n    result.next = b", "synthesis has no such loop"),
                (
                    "n = 0\nfor k in range(2):\n    for k in range(3):\n        n = n + a[k]\nresult.next = n & b",
                    "k is the variable of the loop around it; take another name",
                ),
                (
                    "f = intbv(0)[4:]\ng = intbv(0)[4:]\nf = g\ng[:] = a\nresult.next = f",
                    "f would be g itself in Python; write f[:] = g",
                ),
                (
                    "result.next = a\nif result.next == 3:\n    result.next = b",
                    "a signal's next value cannot be read in Verilog; keep it in a variable",
                ),
                (
                    "for k in range(4):\n    if a[k]:\n        continue\n    result.next[k] = b[k]",
                    "result keeps its value in some cases, which makes a latch",
                ),
                (
                    "if a[0]:\n    result.next[2:] = index\nelse:\n    result.next[4:2] = index",
                    "result keeps its value in some cases, which makes a latch",
                ),
                ("result.next[index] = a[0]", "result keeps its value in some cases, which makes a latch"),
                (
                    "n = 0\nfor k in range(40):\n    n = n * 2 + a[0]\nresult.next = n",
                    "n is an integer of 32 bits in Verilog, and has 43 here",
                ),
                ("result.next = 0\nif a == '0101':\n    result.next = 1", "a signal never equals a text"),
                ("result.next = clk[0]", "clk is a bit; write it without an index"),
                ("result.next[3:] = index", "bit 3 of result keeps its value in some cases"),
                (
                    "if index == 0:\n    result.next = a\nelif index == 1:\n    result.next = b",
                    "result keeps its value",
                ),
                ("result.next = b[9]", "bit 9 is beyond the highest bit, 3"),
                ("result.next = b[6:2]", "bits 5 to 2 are not all within 0 to 3"),
                ("result.next = a << (index - a)", "the number of places may be below 0"),
                ("result.next = None if a else b", "tristate signals are not supported"),
                ("result.next = 0\nresult.next[2:] = index - 1", "MyHDL changes higher bits too if the value is"),
                ("m = [intbv(0)[4:] for _ in range(4)]\nresult.next = m[index]", "a process has no list of its own"),
                ("n = a.val\nresult.next = n", "n would be a.val itself in Python; write n[:] = a.val"),
                ("result == a\nresult.next = a", "result == a changes nothing; assign it to something, or remove it"),
                ("concat(result, result).next = a", "Verilog has no assignment to concat(result, result)"),
                *(
                    (line, f"Verilog has no {said}; assign to one signal or variable at a time, or to different whole ")
                    for line, said in (
                        ("result.next, twin.next = a", "assignment to (result.next, twin.next)"),
                        ("result.next, twin.next = a, b, a", "assignment to (result.next, twin.next)"),
                        ("result.next, result.next = a, b", "assignment to (result.next, result.next)"),
                        ("result.next = twin.next = result.next = a", "result.next = twin.next = result.next = a"),
                        ("result.next[2:], twin.next = index, b", "assignment to (result.next[2:], twin.next)"),
                        ("n, m = a, b\nresult.next = n & m", "assignment to (n, m)"),
                        ("n = m = 1\nresult.next = a & n & m", "n = m = 1"),
                    )
                ),
                ("result.next, twin.next = a, a + b > index", "the result has 5 bits, and loses some"),
                ("twin.next = result.next = memory[a - b]", "the index may be below 0"),
                ("result.next = a[1:3]", "these bounds enclose no bits"),
                ("result.next = a[-1:]", "these bounds enclose no bits"),
                ("result.next = a[4:-1]", "the lowest bit may be below 0"),
                ("result.next = a[index + 2:index]", "bit 4 may be among these, and the highest bit is 3"),
                ("for k in range(4):\n    result.next[k] = a[k + 2:k] > 1", "bit 4 may be among these"),
                (
                    "match a[0]:\n    case True:\n        result.next = a\n    case _:\n        result.next = 0",
                    "a signal never is True, even if it equals it; write case 1 and case 0",
                ),
                ("result.next = a and b", "and, or, not: an operand is a word, not a bit; compare it with != 0"),
                ("result.next = 2 ** index", "2 ** index: Verilog has no such operator here"),
                ("result.next = concat(a + b, a)", "concat needs operands of a known width; assign it to a signal"),
                ("result.next = a[2 * index:index]", "the number of these bits must be constant"),
                (
                    "for k in range(0, 4, a[0]):\n    result.next = k",
                    "synthesis needs a constant step of a loop; write a number",
                ),
                (
                    "result.next = a\nfor k in range(4):\n    k = 2\n    result.next[k] = b[0]",
                    "k is the variable of a loop; assign to another one",
                ),
                *(
                    (f"result.next = b\nmatch index:\n    case {value}:\n        result.next = a", said)
                    for value, said in (
                        ("9", "index is never 9; leave out this case"),
                        ("'a'", "Verilog's case has numbers and states only; write if and elif"),
                    )
                ),
            )
        ),
        (
            "joined = ConcatSignal(a)\n" + process("result.next = joined"),
            "MyHDL expects len(args) >= 2 here",
        ),
        (
            "def read(m, k):\n    return m[k]\n" + process("result.next = read(memory, index)"),
            "memory is a list, which no function of Verilog takes",
        ),
        (
            "from myhdl import enum\nSTATES = enum('A', 'B')\nstate = Signal(STATES.A)\n"
            "@always(clk.posedge)\ndef turn():\n    state.next = STATES.B\n"
            + process("result.next = 1 if not state else 0"),
            "state is a state, which Python always takes as true; compare it with ==",
        ),
        (
            "table = (3, 1, 2, 0)\n" + process("result.next = table[step]"),
            "the index may be below 0",
        ),
        *(
            (
                "table = [3, 1, 2, 0]\n" + process(f"table[{at}] = 2\nresult.next = table[index]"),
                "the numbers of a table",
            )
            for at in ("1", "index")
        ),
        (
            "def five():\n    return 5\n" + process("result.next = five() + a"),
            "a function in Verilog needs an argument",
        ),
        (
            "def same(same):\n    return same\n" + process("result.next = same(a)"),
            "same is the function and a variable of it; rename one",
        ),
        ("def double(x):\n    result.next = x\n" + process("double(a)"), "a function cannot drive"),
        (
            "def first(x):\n    for k in range(4):\n        if x[k]:\n            return k\n    return 4\n"
            + process("result.next = first(a)"),
            "Verilog has no return within a loop; assign the result, and return it last",
        ),
        (
            "def plus(x, k=None):\n    return x ^ k\n" + process("result.next = plus(a)"),
            "k may have no value here; assign to it first",
        ),
        ("share = 0.5\n" + process("result.next = a if share < b else b"), "share, of type float, has no value in Ver"),
        (
            "@always(a)\ndef go():\n    result.next = a ^ b\n",
            "it does not wait for b, as synthesis does; write @always_comb, or wait for all that it reads",
        ),
        (
            "one, other = tied(1, 4), tied(2, 4)\n"
            + process("if one:\n    result.next = other\nelse:\n    result.next = 0"),
            "process reads constants only, and Verilog would never run it",
        ),
        (
            "words = [unsigned(4) for _ in range(2)]\n@always_comb\ndef go():\n    words[0].next = a\n"
            + process("result.next = words[0] ^ words[index[0]]"),
            "words[1]: Signal is not driven; drive it as the others",
        ),
        (
            "def flip(x):\n    return ~x\n" + process("result.next = flip(a > b)"),
            "the result is one bit in Verilog, and may be -2 to -1 here",
        ),
        (
            "def either(x):\n    return x if x else 1\n" + process("result.next = ~either(index)"),
            "~ inverts the bits that either(index) has in Python, which is not known here; assign it to a signal first",
        ),
        (
            "def flip(x):\n    return ~x\n" + process("result.next = flip(a if b else index)"),
            "~ inverts the bits that x has in Python, which is not known here; assign it to a signal first",
        ),
        (
            "def flip(x):\n    return ~x\n" + process("result.next = flip(~a) % 16"),
            "the result holds 0 to 15 in Verilog, and may be -16 to -1 here; use an intbv(0, min=..., max=...)",
        ),
        (
            "def flip(x):\n    return ~x\n" + process("result.next = flip(clk) % 16"),
            "the result is one bit in Verilog, and may be -2 to -1 here",
        ),
        (
            process("part = a[2:]\nresult.next = ~part"),
            "~ inverts the bits that part has in Python, which is not known here; assign it to a signal first",
        ),
        (
            "def same(x):\n    return x + 0\n" + process("result.next = same(~(a > b))"),
            "x holds 0 to 1 in Verilog, and may be -2 to -1 here",
        ),
        (
            "größe = unsigned(4)\n"
            + process("result.next = größe").replace("process", "other")
            + "@always_comb\ndef go():\n    größe.next = a\n",
            "größe has letters that Verilog does not know",
        ),
        (
            "words = [unsigned(4) for _ in range(2)]\n@always_comb\ndef first():\n    words[0].next = a\n"
            "@always(clk.posedge)\ndef second():\n    words[1].next = b\n" + process("result.next = words[1]"),
            "words has different kinds of drivers; drive all of it",
        ),
        (
            "words = [unsigned(4) for _ in range(2)]\n@always_comb\ndef first():\n    words[0].next = a\n"
            "@always_comb\ndef second():\n    words[1].next = 1\n    if a > b:\n        words[1].next = b\n"
            + process("result.next = words[1]"),
            "words has different kinds of drivers; drive all of it",
        ),
        (
            "words = [unsigned(4) for _ in range(4)]\n@block\ndef inner(clk, index, a):\n    @always(clk.posedge)\n"
            "    def go():\n        words[index].next = a\n    return go\none = inner(clk, index, a)\n"
            + process("result.next = words[index]"),
            "inner: words is used by another block too; pass it as an argument",
        ),
        (
            "words = [unsigned(4) for _ in range(4)]\n@block\ndef inner(clk, index, get, result):\n    mine = get()\n"
            "    @always(clk.posedge)\n    def go():\n        result.next = mine[index]\n    return go\n"
            "one = inner(clk, index, lambda: words[::-1], result)\n"
            "@always(clk.posedge)\ndef put():\n    words[index].next = a\n",
            "inner: mine is used by another block too; pass it as an argument",
        ),
        (
            "class Counter:\n    def __init__(self):\n        self.count = unsigned(4)\n"
            "    @block\n    def turn(self, clk):\n        @always(clk.posedge)\n        def go():\n"
            "            self.count.next = (self.count + 1) % 16\n        return go\n"
            "it = Counter()\none = it.turn(clk)\n" + process("result.next = it.count"),
            "turn: self_count is used by another block too; pass it as an argument",
        ),
        (
            "word = unsigned(4)\n@block\ndef inner(clk, index, result):\n    def get(k):\n        return word ^ k\n"
            "    @always(clk.posedge)\n    def go():\n        result.next = get(index)\n    return go\n"
            "one = inner(clk, index, result)\n@always(clk.posedge)\ndef put():\n    word.next = a\n",
            "inner: word is driven by another block; pass it as an argument",
        ),
        (
            "words = Unset(4, 4)\n@always(clk.posedge)\ndef store():\n    words[index].next = a\n"
            + process("result.next = words[index]"),
            "process reads words, whose words are unknown at power-up; use a clock",
        ),
        (
            "kept = intbv(0)[4:]\n" + process("result.next = kept\nkept[:] = a"),
            "kept keeps its value from run to run, which makes a latch",
        ),
        (
            "def same(x):\n    return x\n"
            + process("f = intbv(0)[4:]\nf[:] = a\ng = same(f)\ng[0] = 1\nresult.next = f"),
            "g would be same(f) itself in Python",
        ),
        (
            "@always(clk.posedge, clk.negedge)\ndef go():\n    result.next = a\n",
            "go waits for both edges of a signal",
        ),
        (
            "table = ((1, 2), (3, 4))\n" + process("result.next = table[a[0]][b[0]]"),
            "Verilog has no tables of tables; put the numbers of table[a[0]] into one tuple",
        ),
        ("@block\ndef inner(a):\n    return 5\none = inner(a)\n", "a block returns its processes and instances"),
        (
            "def make():\n    @always_comb\n    def go():\n        result.next = a\n    return go\n"
            "@block\ndef inner():\n    one = make()\n    return one\ntwo = inner()\n",
            "make makes processes or instances; mark it as a @block",
        ),
        (
            "bare = Signal(intbv(0))\n@block\ndef inner(a, bare, result):\n    @always_comb\n    def go():\n"
            "        result.next = a + bare\n    return go\none = inner(a, bare, result)\n",
            "inner: bare has no width",
        ),
        ("part = a(1, 3)\n" + process("result.next = part"), "intbv[i:j] requires i > j i, j == 1, 3 (ValueError)"),
        ("lost = bit()\n" + process("lost.next = a[0]\nresult.next = b"), "lost: Signal is driven but not read"),
        (
            "part = b(4, 0)\nadding = add(a, index, part, unconnected(1))\n",
            "total or a signal that it is cut from has two drivers",
        ),
        ("adding = add(a, b, result, unconnected(1))\n" + process("result.next = a"), "result has two drivers"),
        (
            "both = [a, unsigned(4)]\n" + process("result.next = both[index]"),
            "a process indexes both, but both[0] is al",
        ),
    ],
)
def test_other_wrong_forms_are_refused(body, reason, tmp_path):
    """These are not in the manual's table; a reason is the beginning of the error."""
    assert refusal_of(body, tmp_path)[1].startswith(reason)


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
