# SPDX-License-Identifier: MIT
"""Programs of every kind that the converter accepts do the same in MyHDL, Icarus and Verilator; Yosys reads them."""

import pytest
from hdl_blocks import Pair, random_inputs, swap
from myhdl import (
    Signal,
    always,
    always_comb,
    always_seq,
    block,
    concat,
    downrange,
    enum,
    instance,
    instances,
    intbv,
    modbv,
)

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.records import Record
from raycaster.hdl.signals import bit, reset_signal, signed, unsigned
from raycaster.runs.tools import run_yosys
from raycaster.sim.simulator import find_tool

PROGRAMS = []
"""Blocks with the makers of their arguments."""


def program(**makers):
    """Return a decorator that makes a block a program; a number is the width of a port, below 0 if it is signed."""

    def add(decorated):
        PROGRAMS.append(pytest.param(block(decorated), makers, id=decorated.__name__))
        return decorated

    return add


def argument(maker):
    """Return a new argument of a program."""
    if not isinstance(maker, int):
        return maker()
    return bit() if maker == 1 else unsigned(maker) if maker > 0 else signed(-maker)


STATES = enum("IDLE", "end", "go")


@program(a=-4, b=-3, q=4, r=3, flag=1, y=-12, narrow=3, less=1, more=1, wide=-37, far=1, chosen=-7)
def signs_are_mixed(a, b, q, r, flag, y, narrow, less, more, wide, far, chosen):
    @always_comb
    def combine():
        if r == 0:
            y.next = a + (q & 3) + r
        elif r == 1:
            y.next = a - (q >> 1) + int(r) + (q < r)
        elif r == 2:
            y.next = q.signed() + q - b * r + (not flag)
        elif r == 3:
            y.next = (q | 1) * a + q[3:1] + concat(flag, r)
        elif r == 4:
            y.next = (a if flag else q) + ~r - -q
        elif r == 5:
            y.next = (a + q) >> 1
        elif r == 6:
            y.next = (a - q) % 8 + ((q - r) % 4)
        else:
            y.next = (q ^ a) + (a & r) + (b << r[2:])

    @always_comb
    def compare():
        less.next = a < (q & r)
        more.next = (q - r > b) and (a > -3 or q != 15) and (q > -1)
        narrow.next = (a + q + r) % 8

    @always_comb
    def go_far():
        chosen.next = (a if flag else q) * 2 if r[0] else b
        wide.next = a * 2147483648 - 4294967296 * flag
        far.next = (wide > -2147483649) and (wide < 2147483648) and (wide != -4294967295)

    return instances()


@program(a=4, q=4, y=6, z=8, up=-9, clk=1, kept=5)
def functions_with_results(clk, a, q, y, z, up, kept):
    def total(x, z):
        result = intbv(0)[6:]
        result[:] = x + z
        return result

    def largest(first, second, third):
        if first > second and first > third:
            return first
        if second > third:
            return second
        return third

    def double(x, less=3, factor=2):
        return x * factor - less

    def bump(v):
        v[:] = (v + 3) % 32

    @always_comb
    def combine():
        y.next = total(a, total(q, a))
        z.next = largest(a, q, a) + total(q, q)
        up.next = double(a) * 3 if a > 3 else double(factor=2, x=q) >> 1

    @always(clk.posedge)
    def keep():
        count = intbv(0)[5:]
        count[:] = a
        bump(count)
        bump(count)
        kept.next = count

    return instances()


@program(clk=1, a=4, only=4, around=4, gate=1, y=4, kept=4, late=4, held=4, low=lambda: Signal(intbv(8)[4:]))
def functions_and_latches_read_signals(clk, a, only, around, gate, y, kept, late, held, low):
    part = signed(6)

    def mixed(word):
        result = intbv(0)[4:]
        result[:] = word ^ around
        return result

    def half(word):
        return word >> 1

    @always(clk.posedge)
    def keep():
        part.next = a - 9
        kept.next = mixed(a)
        late.next = half(only & 13)

    @always_comb
    def combine():
        y.next = half(part & 15)

    @always(a, gate)
    def hold():
        if gate:
            held.next = a

    # MyHDL does not run it before a changes, so low begins as a = 0 makes it.
    @always(a)
    def cut():
        low.next[2:] = a[2:]

    return instances()


@block
def reads_words(clk, words, index, y):
    @always(clk.posedge)
    def fetch():
        y.next = words[index]

    return instances()


class Sides:
    def __init__(self):
        self.left, self.right = Pair(), Pair()


@program(unused=3, sides=Sides)
def interfaces_in_an_interface(unused, sides):
    inner = Sides()
    entering = swap(sides.left, inner.left)
    leaving = swap(inner.left, sides.right)
    return instances()


@program(clk=1, a=12, index=4, k=2, y=12, bits=4, picked=5, kept=4, mode=-3)
def bits_and_variables(clk, a, index, k, y, bits, picked, kept, mode):
    steps = (2, 5, -9, 14)
    upper = a(12, 4)

    @always_comb
    def cut():
        for i in range(6):
            y.next[2 * i + 2 : 2 * i] = a[2 * i + 2 : 2 * i] ^ (i % 4)
        bits.next[0] = a[index]
        bits.next[1] = upper[7] ^ upper[index[3:]] ^ upper[(index ^ k) & 7]
        bits.next[4:2] = a[(index ^ k[0]) // 2 + 4 : (index ^ k[0]) // 2 + 2]

    @always_comb
    def pick():
        n = 0
        for i in range(4):
            n += a[i]
        if mode == -1:
            picked.next = n + steps[1]
        elif mode == 2:
            picked.next = n * steps[0]
        else:
            picked.next = n

    @instance
    def keep():
        count = intbv(9)[4:]
        while True:
            yield clk.posedge
            count[:] = (count + k) % 16
            kept.next = count

    return instances()


@program(a=6, first=4, third=4, pairs=4, ones=4, exact=5, narrow=4, both=1, rest=2)
def loops_end_early(a, first, third, pairs, ones, exact, narrow, both, rest):
    @always_comb
    def find():
        first.next = 9
        for k in range(6):
            if a[k]:
                first.next = k
                break

    @always_comb
    def count():
        zeros = 0
        for k in range(6):
            if a[k]:
                continue
            zeros = zeros + 1
            if zeros == 3:
                break
        third.next = zeros

    @always_comb
    def nest():
        steps = 0
        for i in range(3):
            for j in range(2):
                if a[i * 2 + j]:
                    break
                steps = steps + 1
            if steps > 3:
                break
        pairs.next = steps

    def leading(word):
        result = intbv(0)[4:]
        for k in downrange(6):
            if word[k]:
                break
            result[:] = result + 1
        return result

    @always_comb
    def lead():
        ones.next = leading(~a)

    @always_comb
    def wrap():
        exact.next = (a[3:] + a[6:3] + 1) % (1 << 3)
        narrow.next = (a + 9) % (1 << 4)
        both.next = not (not a[0]) and a[6:3] != 2  # noqa: SIM208
        rest.next = 4294967297 % (1 << 2)

    return instances()


@program(a=4, mode=2, y=4, z=4, w=2)
def loops_and_cases_of_one_name(a, mode, y, z, w):
    @always_comb
    def go():
        z.next = 0
        for k in range(1, 4):
            z.next[k] = a[k - 1]
        for k in range(4):
            y.next[k] = a[3 - k]

    @always_comb
    def choose():
        match mode:
            case 0 | 1:
                w.next = 1
            case 2 | 3:
                w.next = 2

    return instances()


@program(k_goes_on=1, a=4, y=3)
def a_flag_has_a_name_of_its_own(k_goes_on, a, y):
    @always_comb
    def find():
        y.next = 4
        for k in range(4):
            if a[k] and k_goes_on:
                y.next = k
                break

    return instances()


@program(clk=1, i=2, a=4, y=4, z=4)
def names_and_constants(clk, i, a, y, z):
    initial_values = unsigned(4)
    mem = [Signal(intbv(7)[4:]) for _ in range(4)]

    @always(clk.posedge)
    def go():
        mem[i].next = a
        initial_values.next = mem[i]
        if __debug__:
            print("a", a)
        if i > 3:
            raise ValueError("never")

    # synthesis translate_off
    @always_comb
    def look():
        y.next = initial_values
        z.next = a ^ intbv(0xABC)[8:4]

    return instances()


@program(clk=1, index=2, y=4, z=4)
def tables_are_arguments(clk, index, y, z):
    rising, falling = ([Signal(intbv(start + step * n)[4:]) for n in range(4)] for start, step in ((3, 2), (15, -4)))
    first = reads_words(clk, rising, index, y)
    second = reads_words(clk, falling, index, z)

    return instances()


@block
def delays(clk, d, q):
    @always(clk.posedge)
    def keep():
        q.next = d

    return keep


class Wires:
    """Only a list of signals, four objects down; each also refers to itself."""

    def __init__(self, depth=0):
        self.itself = self
        if depth:
            self.more = Wires(depth - 1)
        else:
            self.words = [Signal(intbv(3 + k)[4:]) for k in range(3)]


@block
def shifts(clk, a, row, y):
    @always(clk.posedge)
    def go():
        row[0].next = a
        for k in range(1, 3):
            row[k].next = row[k - 1]

    @always_comb
    def last():
        y.next = row[-1]

    return instances()


@program(clk=1, a=4, index=1, given=lambda: [unsigned(4) for _ in range(2)], y=4, z=4, v=4, w=4)
def lists_driven_in_parts(clk, a, index, given, y, z, v, w):
    chain = [unsigned(4) for _ in range(4)]
    links = [delays(clk, chain[k], chain[k + 1]) for k in range(3)]
    low, high = Signal(intbv(3)[4:]), Signal(intbv(5)[4:])
    both = [low, high]
    rows = [[unsigned(4) for _ in range(3)] for _ in range(2)]
    shifting = shifts(clk, a, rows[1], w)
    wires = Wires(3)
    passing = shifts(clk, chain[1], wires.more.more.more.words, v)

    @always_comb
    def begin():
        chain[0].next = a

    @always(clk.posedge)
    def keep():
        low.next = a
        high.next = low

    @always_comb
    def end():
        y.next = chain[3]
        z.next = both[index] ^ given[index]

    return instances()


class Totals:
    width = 4


@block
def totals(clk, a, y):
    total = Signal(modbv(0)[Totals.width :])

    @always(clk.posedge)
    def go():
        total.next = total + a

    @always_comb
    def out():
        y.next = total

    return instances()


@block
def either(clk, a, b, y):
    chosen = delays(clk, a if Totals.width == 4 else b, y)
    return chosen


@program(clk=1, a=4, b=4, y=6, z=6, v=4, w=4)
def blocks_that_read_a_global_differ(clk, a, b, y, z, v, w):
    Totals.width = 4
    small, left = totals(clk, a, y), either(clk, a, b, v)
    Totals.width = 6
    large, right = totals(clk, a, z), either(clk, a, b, w)
    return instances()


@program(clk=1, k=2, a=4, y=4)
def a_memory_is_called_i(clk, k, a, y):
    i = [Signal(intbv(3)[4:]) for _ in range(4)]

    @always(clk.posedge)
    def go():
        i[k].next = a
        y.next = i[k]

    return instances()


LONG = "a_name_as_generated_code_has_it_for_the_sake_of_uniqueness_which_no_line_can_hold_with_another_" + "x" * 20


@program(clk=1, a=4, b=4, y=4)
def a_record_with_a_long_name(clk, a, b, y):
    item = Record({LONG: 4, "short": 4})
    word = item.joined(**{LONG: a, "short": b})
    long = getattr(item, LONG)

    @always(clk.posedge)
    def put():
        item.word.next = word

    @always_comb
    def get():
        y.next = item.short ^ long

    return instances()


@program(a=4, s=1, y=4, z=4)
def a_loop_in_a_branch(a, s, y, z):
    @always_comb
    def process():
        y.next = 0
        if s:
            for i in range(4):
                y.next[i] = a[3 - i]
                if a[i]:
                    break

    @always(a, s, a)
    def twice():
        z.next = a
        if s:
            z.next = 0

    return instances()


@program(clk=1, reset=reset_signal, a=4, b=4, turn=1, low=4, high=4, total=5, apart=-5, first=4, second=4, count=5)
def signals_are_assigned_together(clk, reset, a, b, turn, low, high, total, apart, first, second, count):
    def halved(word, places=1):
        return word >> places

    @always_comb
    def combine():
        total.next, apart.next = a + b, a - b

    @always_comb
    def order():
        low.next = high.next = halved(a) if turn else a
        if a > b:
            low.next, high.next = b, a
        elif a < b:
            high.next = b

    @always_seq(clk.posedge, reset=reset)
    def keep():
        if turn:
            first.next, second.next = second ^ 1, first
        else:
            first.next = second.next = count.next = a

    return instances()


@program(clk=1, reset=reset_signal, a=4, y=4, z=4, kept=4)
def branches_that_constants_decide(clk, reset, a, y, z, kept):
    mode, wide, extra, unused = "plain", False, None, Signal(intbv(5)[4:])
    if wide:
        absent = unsigned(4)

    def flipped(x):
        if wide:
            return absent
        return x ^ 1

    @always_comb
    def choose():
        if mode == "plain" and extra is None:
            y.next = a
        else:
            y.next = extra
        z.next = a[9] if wide else flipped(a)
        for k in range(len(a), 4):
            z.next[k] = a[k - 9]
        if len(a) > 4 or (wide and a[7]):
            z.next = a[6:2]

    @always_seq(clk.posedge, reset=reset)
    def keep():
        if wide:
            unused.next = a
        elif a[0]:
            kept.next = a ^ unused

    return instances()


@program(a=8, i=3, k=-4, y=8, n=8, found=1, half=4, top=1, some=2, last=4)
def conditions_and_loops_bound_indices(a, i, k, y, n, found, half, top, some, last):
    table, chosen = (3, 1, 4, 1), (1, 5)

    @always_comb
    def count():
        total = 0
        for row in range(8):
            odd = 0
            for column in range(row):
                odd = odd + a[row - column - 1]
            for column in range(8):
                if column <= row:
                    odd = odd + a[row - column]
            for column in range(7, row, -2):
                odd = odd + a[column]
            y.next[row] = odd % 2
            if row > 0:
                n.next[row - 1] = a[row - 1]
            if row in chosen:
                total = total + a[row]
        n.next[7] = a[0]
        some.next = total

    @always_comb
    def find():
        place = 0
        place = k + 1
        if i == 0 or not i < 7:
            found.next = a[0]
        elif i == 6:
            found.next = a[1]
        elif i == 5:
            found.next = a[2]
        else:
            found.next = a[i - 1]
        half.next = (a - 3) >> 5 if 3 <= a < 128 else 0
        top.next = k >= 0 and a[k]
        last.next = 0
        if place > 1:
            last.next = table[place >> 2]

    return instances()


@program(a=-5, i=2, y=5, n=-7, z=-12, w=-8)
def tables_and_quotients_below_0(a, i, y, n, z, w):
    weights, powers = [-8, 3, 0, 7], {"base": 1, "step": 3}

    @always_comb
    def go():
        y.next = (a - powers["step"]) % 10
        n.next = (a - max(powers["base"], 3)) // 3
        w.next = weights[i] * 2 + (weights[1] - (3, 1, 4, 1)[2])
        total = intbv(0, min=-2048, max=2048)
        for k in range(4):
            total += (a + k) * weights[3 - k]
        z.next = total

    return instances()


@program(clk=1, a=4, b=4, y=6, parity=1, carry=1, pairs=8, kept=4)
def functions_and_bits_of_the_block(clk, a, b, y, parity, carry, pairs, kept):
    mode, table = "odd", (3, 1, 2, 9)

    def more(x):
        return x + 1 if mode == "odd" else x[9]

    def twice(x):
        return more(more(x)) + (table[x % 4] if x > 3 else 2)

    def least(x):
        return x - 3 if x > 3 else 0

    def mixed(x):
        return x ^ b

    def flipped(x):
        return mixed(x) ^ 1

    @always_comb
    def add():
        y.next = twice(a) + more(b) - least(a)
        odd = a[0] ^ a[1]
        chain = False
        for k in range(4):
            chain = (a[k] & b[k]) | (chain & (a[k] ^ b[k]))
            pairs.next[2 * k + 2 : 2 * k] = concat(a[k], b[3 - k])
        carry.next = chain
        parity.next = (odd ^ a[2]) and not (b[0] | b[1])

    @always(clk.posedge)
    def keep():
        kept.next = flipped(a)

    return instances()


class Row:
    def __init__(self):
        self.words = [unsigned(4) for _ in range(3)]


@program(clk=1, go=1, a=-6, b=6, x=Row, y=10, z=8, w=3)
def seldom_forms(clk, go, a, b, x, y, z, w):
    state = Signal(STATES.go)

    @always_comb
    def choose():
        assert b < 64
        total = 0
        for k in range(len(x.words)):
            total = total + x.words[k] if k < 2 else total
        match state:
            case STATES.IDLE:
                y.next = concat(True, "01", b[4:2]) + a[:2] + 8
            case STATES.end:
                y.next = (+(a - b) if bool(b) else (b[:3] & a)) % 64 + total
            case STATES.go:
                y.next = (int(a) ^ -b) & 63
        z.next = ((b - 40) // 4) & 255
        w.next = concat(go and b[0], state != STATES.IDLE, b[go + 1 : go])

    @always(clk.posedge)
    def turn():
        state.next = STATES.end if go else STATES.IDLE
        print("state", state, go, b)

    return instances()


@program(clk=1, go=1, y=2, z=2)
def a_state_in_all_cases(clk, go, y, z):
    state = Signal(STATES.IDLE)

    @always(clk.posedge)
    def turn():
        if state in (STATES.IDLE, STATES.go):
            state.next = STATES.end
        elif go:
            state.next = STATES.go

    @always_comb
    def choose():
        if go == 0:
            z.next = 3
        elif go == 1:
            z.next = y
        for k in range(3):
            if k == 0:
                z.next[k] = y[1]
            elif k == 2:
                z.next[k - 1] = y[0]

    @always_comb
    def look():
        if state == STATES.IDLE:
            y.next = 1
        elif state == STATES.end:
            y.next = 2
        elif state == STATES.go:
            y.next = 3

    return instances()


@pytest.mark.parametrize(("function", "makers"), PROGRAMS)
def test_programs_do_what_myhdl_computes(function, makers, tmp_path, random, monkeypatch):
    leaf = Leaf(function, lambda: {name: argument(maker) for name, maker in makers.items()}, tmp_path)
    stimulus = random_inputs(leaf, random, 300)
    leaf.run_both(stimulus)
    for name, value in find_tool("verilator").environment.items():
        monkeypatch.setenv(name, value)
    leaf._call("verilator", "--lint-only", "-Wno-fatal", *(str(path) for path in leaf.verilog))
    sources = " ".join(path.name for path in leaf.verilog)
    unlatched = ["select -assert-none t:$dlatch"] * ("latches" not in function.__name__)
    top = f"hierarchy -check -top {leaf.modules[-1].name}"
    run_yosys(tmp_path, "read", [f"read_verilog {sources}", top, "proc", "check -assert", *unlatched])
