# SPDX-License-Identifier: MIT
"""Contract of the hierarchical conversion, which relies on MyHDL's internals."""

import ast
import filecmp
import importlib.metadata
import inspect
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from myhdl import ConcatSignal, Constant, Signal, always, always_comb, block, intbv
from myhdl._simulator import _signals
from test_project import MAY_IMPORT

from raycaster import rtl
from raycaster.configuration import configure
from raycaster.convert import write
from raycaster.convert.take_home import FILE_LIST
from raycaster.convert.vocabulary import VOCABULARY
from raycaster.convert.write import write_verilog
from raycaster.hdl.elaboration import _DEEPEST, elaboration
from raycaster.hdl.given import given_verilog, load_words
from raycaster.hdl.hierarchy import HierarchyError, Module, Port, convert_hierarchy
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import Signed, bit, signed, tied, unconnected, unsigned
from raycaster.output import emptied
from raycaster.rtl.common.clock_gate import clock_gate, rests_on
from raycaster.rtl.common.interfaces import Place
from raycaster.rtl.common.records import Signs
from raycaster.verif.seeds import repeat, seed


class Pair(Interface):
    """Two nibbles."""

    def __init__(self):
        self.high, self.low = unsigned(4), unsigned(4)


@block
def swap(pair, swapped):
    """Swap the nibbles."""

    @always_comb
    def cross():
        swapped.high.next = pair.low
        swapped.low.next = pair.high

    return (cross,)


@block
def step(clk, value, step_by, stepped, wrapped, gain=1):
    """stepped = value + gain * step_by, one cycle after value and two after step_by; wrapped is the carry."""
    width = len(stepped)
    limit = 1 << width
    product = unsigned(width)
    total = unsigned(width + 1)

    # The step is registered, since a constant never triggers a combinational process.
    @always(clk.posedge)
    def multiply():
        product.next = (step_by * gain) % limit

    # Keep the carry.
    @always_comb
    def add():
        total.next = value + product

    # A register.
    @always(clk.posedge)
    def keep():
        stepped.next = total[width:]
        wrapped.next = total[width]

    return multiply, add, keep


@block
def everything(clk, word, pair, joined, swapped, count):
    """Connect blocks in every way: by slices, lists, interfaces and constants, and not at all."""
    halves = [unsigned(4) for _ in range(2)]
    carries = [unconnected(1), unconnected(1)]
    lower, upper = word(4, 0), word(8, 4)
    amounts = [tied(3, 4), tied(15, 4)]
    one = tied(1, 4)
    both = ConcatSignal(*reversed(halves))
    carry = bit()
    total = unsigned(4)

    first = step(clk, lower, amounts[0], halves[0], carries[0])
    second = step(clk, upper, amounts[1], halves[1], carries[1])
    third = step(clk, total, one, count, carry)
    crossing = swap(pair, swapped)

    # Both halves side by side.
    @always_comb
    def join():
        joined.next = both

    # A process reads an output of an instance.
    @always_comb
    def choose():
        if carry:
            total.next = 0
        else:
            total.next = word[4:]

    return first, second, third, crossing, join, choose


def everything_arguments() -> dict:
    signals = {"clk": bit(), "word": unsigned(8), "pair": Pair(), "joined": unsigned(8), "swapped": Pair()}
    return signals | {"count": unsigned(4)}


def converted(top, directory: Path, **options) -> dict[str, Module]:
    directory.mkdir(exist_ok=True)
    return {module.name: module for module in convert_hierarchy(top, directory, "// {module}", **options)}


def test_every_kind_of_connection_works(tmp_path):
    leaf = Leaf(everything, everything_arguments, tmp_path)
    random = np.random.default_rng(seed())
    names = {"word": 256, "pair_high": 16, "pair_low": 16}
    stimulus = [{name: int(random.integers(limit)) for name, limit in names.items()} for _ in range(200)]
    outputs = leaf.run_both(stimulus, settled=4)
    for cycle in range(4, 200):
        word, pair = stimulus[cycle - 1]["word"], stimulus[cycle]
        joined = (word + 3) % 16 | ((word >> 4) + 15) % 16 << 4
        assert outputs[cycle]["joined"] == joined, repeat()
        assert outputs[cycle]["swapped_high"] == pair["pair_low"], repeat()
        assert outputs[cycle]["swapped_low"] == pair["pair_high"], repeat()
        # The previous cycle's carry clears the counter's input.
        carried = outputs[cycle - 1]["count"] == 0
        assert outputs[cycle]["count"] == (1 if carried else (word % 16 + 1) % 16), repeat()


def test_modules_ports_and_instances(tmp_path):
    modules = converted(everything(**everything_arguments()), tmp_path)
    assert list(modules) == ["step", "swap", "everything"], "each follows those that it instantiates, equal ones once"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["everything.v", "step.v", "swap.v"]
    assert modules["everything"].instances == {"step_0": "step", "step_1": "step", "step_2": "step", "swap": "swap"}
    assert modules["step"].instances == {}
    assert set(modules["everything"].ports) == {
        Port("clk", 1, False, False),
        Port("word", 8, False, False),
        Port("pair_high", 4, False, False),
        Port("pair_low", 4, False, False),
        Port("joined", 8, False, True),
        Port("swapped_high", 4, False, True),
        Port("swapped_low", 4, False, True),
        Port("count", 4, False, True),
    }
    text = modules["everything"].path.read_text()
    assert re.findall(r"^(\w+) (\w+_i) \($", text, re.M) == [
        ("step", "step_0_i"),
        ("step", "step_1_i"),
        ("step", "step_2_i"),
        ("swap", "swap_i"),
    ]
    assert text.count(".wrapped()") == 2, "two of the carries are not read"
    assert "// A register.\nalways @(posedge clk) begin" in modules["step"].path.read_text()


@block
def few_words(clk, value, kept, both, either, stepped):
    """Connect processes that are mostly self-explanatory."""

    @always(clk.posedge)
    def keep():
        kept.next = value

    @always_comb
    def join():
        both.next = kept & value

    # The reason for this one is not plain.
    @always_comb
    def choose():
        either.next = kept | value

    stepping = step(clk, value, kept, stepped, unconnected(1))

    return keep, join, choose, stepping


@block
def with_documented_ports(clk, value, slope, pair, cycles: int, config=None):
    """Do nothing, `config.units` times in `SETUP_LATENCY` cycles.

    Without config.turn it is `slope.dx` that is not read, whatever config.rounding says.

    Args:
        clk: the clock, `config.screen_geometry.clock_hz` Hz.
        value: flag; read for `unit_bits` units with slope.dy,
            or not at all; None with config.turn, and where nothing reads it.
        slope: `Signs`. None where there is no ray. Read `cycles` cycles later.
        pair: `Place`; output.
        cycles: no port.
        config: the design.
    """

    # With config.materials a row has `config.screen_geometry.doubling` lines.
    @always(clk.posedge)
    def copy():
        pair.row.next = value + slope.dz
        pair.column_offset.next = value

    return copy


def test_ports_have_their_comments(tmp_path):
    """Each argument's text precedes its first port, with numbers, options and Verilog names instead of Python's."""
    config = configure(units=32)
    top = with_documented_ports(bit(), bit(), Signs(), Place(config), 3, config)
    modules = converted(top, tmp_path, vocabulary=VOCABULARY)
    head, _, body = modules["with_documented_ports"].path.read_text().partition(");\n\n")
    assert (
        head[head.index("// Do") :]
        == """// Do nothing, 32 times in 5 cycles.
//
// Without TURN=1 it is slope_dx that is not read, whatever ROUNDING says.
module with_documented_ports (
    // the clock, 50 MHz.
    input  wire       clk,
    // flag; read for 5 units with slope_dy, or not at all.
    input  wire       value,
    // Signs. Read 3 cycles later.
    // [2] dx, [1] dy, [0] dz.
    input  wire [2:0] slope_word,
    // pair_*: Place; output.
    // row of rays, 0 at the top.
    output reg  [7:0] pair_row,
    // number of the group in its row.
    output reg  [3:0] pair_column_offset
"""
    )
    assert "// With MATERIALS=1 a row has 2 lines.\nalways @" in body


@pytest.mark.parametrize(
    "path", [path for path in Path(rtl.__file__).parent.glob("*/*.py")], ids=lambda path: path.stem
)
def test_each_port_of_the_hardware_is_documented(path):
    """The docstring of each block lists its arguments in order."""
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.FunctionDef) and any(ast.unparse(one) == "block" for one in node.decorator_list):
            _, _, listed = (ast.get_docstring(node) or "").partition("Args:\n")
            given = [argument.arg for argument in [*node.args.args, *node.args.kwonlyargs]]
            assert re.findall(r"^    (\w+): ", listed, re.M) == given, f"{path}:{node.lineno}"


def test_a_process_needs_no_comment(tmp_path):
    modules = converted(few_words(bit(), *(unsigned(4) for _ in range(5))), tmp_path)
    _, _, body = modules["few_words"].path.read_text().partition(");\n\n")
    assert (
        body
        == """always @(posedge clk) begin
    kept <= value;
end

assign both = kept & value;

// The reason for this one is not plain.
assign either = kept | value;

step step_i (
    .clk(clk),
    .value(value),
    .step_by(kept),
    .stepped(stepped),
    .wrapped()
);

endmodule
"""
    )


def test_a_signed_port_is_signed(tmp_path):
    @block
    def double(value, doubled):
        @always_comb
        def add():
            doubled.next = value + value

        return (add,)

    modules = converted(double(signed(4), signed(5)), tmp_path)
    assert modules["double"].ports == (Port("value", 4, True, False), Port("doubled", 5, True, True))


def test_a_block_converts_alike_wherever_it_stands(tmp_path):
    within = converted(everything(**everything_arguments()), tmp_path / "within")
    alone = converted(step(bit(), unsigned(4), unsigned(4), unsigned(4), bit()), tmp_path / "alone")
    again = converted(everything(**everything_arguments()), tmp_path / "again")
    assert within["step"].path.read_text() == alone["step"].path.read_text()
    for name, module in within.items():
        assert module.path.read_text() == again[name].path.read_text()


@block
def two_steps(clk, value, by, first, second, gains, widths):
    steps = [
        step(clk, value, by, out, unconnected(1), gain=gain)
        for out, gain, _ in zip((first, second), gains, widths, strict=True)
    ]

    return (steps,)


def two_steps_of(gains: tuple[int, int], widths: tuple[int, int]):
    outputs = [unsigned(width) for width in widths]
    return two_steps(bit(), unsigned(4), unsigned(4), *outputs, gains, widths)


def test_one_name_is_one_module(tmp_path):
    assert list(converted(two_steps_of((2, 2), (4, 4)), tmp_path)) == ["step", "two_steps"]


@pytest.mark.parametrize(("gains", "widths"), [((1, 2), (4, 4)), ((1, 1), (4, 5))])
def test_one_block_with_two_meanings_is_two_modules(gains, widths, tmp_path):
    leaf = Leaf(
        two_steps,
        lambda: {
            "clk": bit(), "value": unsigned(4), "by": unsigned(4), "first": unsigned(widths[0]),
            "second": unsigned(widths[1]), "gains": gains, "widths": widths,
        },
        tmp_path,
    )  # fmt: skip
    assert [module.name for module in leaf.modules] == ["step", "step_1", "two_steps"]
    assert leaf.modules[-1].instances == {"step_0": "step", "step_1": "step_1"}
    outputs = leaf.run_both([{"value": 9, "by": 7}] * 4, settled=3)
    assert outputs[-1] == {
        name: (9 + 7 * gain % (1 << width)) % (1 << width)
        for name, gain, width in zip(("first", "second"), gains, widths, strict=True)
    }


def another_step():
    """Return a different block with the name and ports of `step`."""

    @block
    def step(clk, value, step_by, stepped, wrapped, gain=1):
        @always(clk.posedge)
        def keep():
            stepped.next = value ^ step_by
            wrapped.next = False

        return (keep,)

    return step


@block
def two_kinds(clk, value, by, first, second, other):
    """Instantiate two different blocks named `step`."""
    ours = step(clk, value, by, first, unconnected(1))
    theirs = other(clk, value, by, second, unconnected(1))

    return ours, theirs


def test_two_blocks_of_one_name_are_two_modules(tmp_path):
    other = another_step()
    leaf = Leaf(
        two_kinds,
        lambda: {
            "clk": bit(), "value": unsigned(4), "by": unsigned(4), "first": unsigned(4), "second": unsigned(4),
            "other": other,
        },
        tmp_path,
    )  # fmt: skip
    assert leaf.modules[-1].instances == {"step_0": "step", "step_1": "step_1"}
    assert leaf.run_both([{"value": 6, "by": 3}] * 4, settled=3)[-1] == {"first": 9, "second": 5}


class Mirrored(Pair):
    """Pair that a block can recognise by its class."""


@block
def halve(pair, half):
    """Select the high nibble, or the low one of a `Mirrored`."""
    chosen = pair.low if isinstance(pair, Mirrored) else pair.high

    @always_comb
    def choose():
        half.next = chosen

    return (choose,)


@block
def halve_both(pair, mirrored, first, second):
    """Halve a pair of each class."""
    one = halve(pair, first)
    other = halve(mirrored, second)

    return one, other


def test_interfaces_of_different_classes_make_two_modules(tmp_path):
    leaf = Leaf(
        halve_both,
        lambda: {"pair": Pair(), "mirrored": Mirrored(), "first": unsigned(4), "second": unsigned(4)},
        tmp_path,
    )
    assert [module.name for module in leaf.modules] == ["halve", "halve_1", "halve_both"]
    assert leaf.run_both([{"pair_high": 3, "mirrored_low": 12}])[-1] == {"first": 3, "second": 12}


@block
def mix(clk, left, right, mixed):
    """Mix two ports that the conversion might confuse."""

    @always(clk.posedge)
    def work():
        mixed.next = left ^ right

    return (work,)


@block
def mixes(clk, value, other, first, second):
    """Connect one signal to both ports, and then two signals."""
    alike = mix(clk, value, value, first)
    apart = mix(clk, value, other, second)

    return alike, apart


def test_one_signal_at_two_ports_is_no_module_for_two(tmp_path):
    leaf = Leaf(
        mixes,
        lambda: {
            "clk": bit(), "value": unsigned(4), "other": unsigned(4), "first": unsigned(4), "second": unsigned(4),
        },
        tmp_path,
    )  # fmt: skip
    assert leaf.run_both([{"value": 9, "other": 5}] * 3, settled=2)[-1] == {"first": 0, "second": 12}


class Mode:
    """Parameter whose representation hides its value."""

    def __init__(self, number: int):
        self.number = number

    def __repr__(self):
        return "a mode"


@block
def offset(clk, value, moved, mode):
    """value + mode, modulo 16."""
    step_by = mode.number if isinstance(mode, Mode) else int(mode[len(mode) // 2])

    @always(clk.posedge)
    def work():
        moved.next = (value + step_by) % 16

    return (work,)


@block
def offsets(clk, value, first, second, modes):
    """Apply two offsets."""
    one = offset(clk, value, first, modes[0])
    two = offset(clk, value, second, modes[1])

    return one, two


def offsets_of(*modes):
    return lambda: {
        "clk": bit(), "value": unsigned(4), "first": unsigned(4), "second": unsigned(4), "modes": modes,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("modes", "moved"),
    [((Mode(1), Mode(2)), [8, 9]), ((np.eye(1, 3000, 1500)[0], 2 * np.eye(1, 3000, 1500)[0]), [8, 9])],
    ids=["object", "array"],
)
def test_parameters_that_read_alike_are_two_modules(modes, moved, tmp_path):
    leaf = Leaf(offsets, offsets_of(*modes), tmp_path)
    assert [module.name for module in leaf.modules] == ["offset", "offset_1", "offsets"]
    assert list(leaf.run_both([{"value": 7}] * 3, settled=2)[-1].values()) == moved


def test_one_parameter_is_one_module(tmp_path):
    mode = Mode(1)
    assert len(Leaf(offsets, offsets_of(mode, mode), tmp_path).modules) == 2
    assert len(Leaf(offsets, offsets_of((1, 2), (1, 2)), tmp_path).modules) == 2
    assert len(Leaf(offsets, offsets_of((1, 2), (True, 2)), tmp_path).modules) == 3


class Halves(Record):
    """A byte in two parts of variable width."""

    def __init__(self, high: int):
        super().__init__({"high": high, "low": 8 - high})


class Late(Interface):
    """A nibble and a constant to add to it."""

    def __init__(self, amount: int):
        self.value, self.amount = unsigned(4), amount


@block
def upper_part(halves, late, high, sum):
    """Read a field of a layout, and an attribute that is not a signal."""
    amount = late.amount

    @always_comb
    def cut():
        high.next = halves.high

    @always_comb
    def add():
        sum.next = (late.value + amount) % 16

    return cut, add


@block
def upper_parts(halves, others, late, later, high, higher, sum, more):
    """Connect ports of the same shape with different layouts and attributes."""
    one = upper_part(halves, late, high, sum)
    two = upper_part(others, later, higher, more)

    return one, two


@pytest.mark.parametrize(("cuts", "amounts"), [((3, 5), (1, 1)), ((4, 4), (1, 2))])
def test_layouts_and_attributes_of_interfaces_distinguish_modules(cuts, amounts, tmp_path):
    leaf = Leaf(
        upper_parts,
        lambda: {
            "halves": Halves(cuts[0]), "others": Halves(cuts[1]), "late": Late(amounts[0]), "later": Late(amounts[1]),
            "high": unsigned(8), "higher": unsigned(8), "sum": unsigned(4), "more": unsigned(4),
        },
        tmp_path,
    )  # fmt: skip
    [outputs] = leaf.run_both(
        [{"halves_high": 6, "halves_low": 1, "others_high": 9, "others_low": 1, "late_value": 3, "later_value": 3}]
    )
    assert outputs == {"high": 6, "higher": 9, "sum": 3 + amounts[0], "more": 3 + amounts[1]}


@block
def fields_apart(packed, first, second):
    """Connect a different field to each of two instances."""
    one = inverted(packed.high, first)
    two = inverted(packed.low, second)

    return one, two


def test_fields_of_one_shape_are_no_two_modules(tmp_path):
    leaf = Leaf(fields_apart, lambda: {"packed": Halves(4), "first": unsigned(4), "second": unsigned(4)}, tmp_path)
    assert [module.name for module in leaf.modules] == ["inverted", "fields_apart"]
    assert leaf.run_both([{"packed_high": 5, "packed_low": 12}])[-1] == {"first": 10, "second": 3}


def test_the_top_keeps_its_name(tmp_path):
    inner = another_step()

    @block
    def step(clk, value, by, result):
        part = inner(clk, value, by, result, unconnected(1))
        return (part,)

    modules = converted(step(bit(), unsigned(4), unsigned(4), unsigned(4)), tmp_path)
    assert list(modules) == ["step_1", "step"]
    assert modules["step"].instances == {"step": "step_1"}
    assert re.search(r"^step_1 step_i \($", modules["step"].path.read_text(), re.M)


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
        with pytest.raises(HierarchyError, match="parent: two instances would be called step_1; rename a block"):
            converted(parent(bit(), *(unsigned(4) for _ in range(4)), last), tmp_path)


class Packed(Record):
    """Record with one field of each kind."""

    def __init__(self):
        super().__init__({"flag": 1, "count": 3, "offset": Signed(5)})


@block
def records(clk, packed, index, kept, sum, negative):
    """Store and copy records, and read signed and unsigned fields."""
    memory = [unsigned(len(packed.word)) for _ in range(4)]

    @always(clk.posedge)
    def store():
        if packed.flag:
            memory[index].next = packed.word
        kept.word.next = memory[index]

    @always_comb
    def compute():
        sum.next = kept.offset + packed.offset
        negative.next = kept.offset < 0

    return store, compute


def test_a_record_is_one_word(tmp_path):
    leaf = Leaf(
        records,
        lambda: {
            "clk": bit(), "packed": Packed(), "index": unsigned(2), "kept": Packed(), "sum": signed(6),
            "negative": bit(),
        },
        tmp_path,
    )  # fmt: skip
    text = leaf.verilog[-1].read_text()
    assert re.search(r"^    input  wire \[8:0\] +packed_word,$", text, re.M)
    assert "wire signed [4:0] kept_offset = kept_word[4:0];" in text
    assert "kept_flag" not in text, "fields that are not read are left out"
    random = np.random.default_rng(seed())
    stimulus = [{"packed_flag": 1, "packed_count": index, "packed_offset": index, "index": index} for index in range(4)]
    stimulus += [
        {name: int(random.integers(1 << bits)) for name, bits in
         (("packed_flag", 1), ("packed_count", 3), ("packed_offset", 5), ("index", 2))}
        for _ in range(200)
    ]  # fmt: skip
    memory: dict[int, int] = {}
    kept = None
    for cycle, (inputs, outputs) in enumerate(zip(stimulus, leaf.run_both(stimulus, settled=5), strict=True)):
        if kept is not None and cycle >= 5:
            assert outputs["kept_offset"] == kept, repeat()
            first, second = (value - 32 * (value > 15) for value in (kept, inputs["packed_offset"]))
            assert outputs["sum"] == (first + second) % 64, repeat()
            assert outputs["negative"] == (first < 0), repeat()
        kept = memory.get(inputs["index"])
        if inputs["packed_flag"]:
            memory[inputs["index"]] = inputs["packed_offset"]


@block
def signal_like_port(clk, pair, result):
    pair_high = unsigned(4)

    @always(clk.posedge)
    def keep():
        pair_high.next = pair.low

    @always_comb
    def join():
        result.next = pair_high ^ pair.high

    return keep, join


@block
def signal_like_passed_port(clk, pair, result):
    pair_high, crossed = unsigned(4), Pair()
    crossing = swap(pair, crossed)

    @always(clk.posedge)
    def keep():
        pair_high.next = crossed.low

    @always_comb
    def join():
        result.next = pair_high ^ crossed.high

    return crossing, keep, join


@block
def signal_like_word(clk, packed, result):
    packed_word = unsigned(9)

    @always(clk.posedge)
    def keep():
        packed_word.next = packed.word

    @always_comb
    def cut():
        result.next = packed_word[4:]

    return keep, cut


@block
def signal_like_field(clk, packed, result):
    packed_count = unsigned(3)

    @always(clk.posedge)
    def keep():
        packed_count.next = packed.count

    @always_comb
    def pad():
        result.next = packed_count

    return keep, pad


@block
def port_like_field(packed, packed_count, result):
    @always_comb
    def join():
        result.next = packed_count ^ packed.count

    return (join,)


@block
def port_like_port(pair_high, pair, result):
    @always_comb
    def copy():
        result.next = pair_high

    return (copy,)


@block
def memory_like_field(clk, packed, result):
    packed_count = [unsigned(4) for _ in range(8)]

    @always(clk.posedge)
    def keep():
        packed_count[packed.count].next = packed.count
        result.next = packed_count[packed.count]

    return (keep,)


@block
def signal_like_instance(clk, pair, result):
    crossed = Pair()
    swap_i = unsigned(4)
    crossing = swap(pair, crossed)

    @always(clk.posedge)
    def keep():
        swap_i.next = crossed.low ^ crossed.high

    @always_comb
    def copy():
        result.next = swap_i

    return crossing, keep, copy


@block
def signal_between_instances(clk, pair, result):
    inner, inner_high = Pair(), unsigned(4)
    first = swap(pair, inner)

    @always(clk.posedge)
    def keep():
        inner_high.next = inner.low

    second = step(clk, inner.high, inner_high, result, unconnected(1))

    return first, keep, second


@pytest.mark.parametrize(
    ("function", "name", "arguments"),
    [
        (signal_like_port, "pair_high", lambda: (bit(), Pair(), unsigned(4))),
        (signal_like_passed_port, "pair_high", lambda: (bit(), Pair(), unsigned(4))),
        (signal_like_word, "packed_word", lambda: (bit(), Packed(), unsigned(4))),
        (signal_like_field, "packed_count", lambda: (bit(), Packed(), unsigned(4))),
        (port_like_field, "packed_count", lambda: (Packed(), unsigned(4), unsigned(4))),
        (port_like_port, "pair_high", lambda: (unsigned(4), Pair(), unsigned(4))),
        (memory_like_field, "packed_count", lambda: (bit(), Packed(), unsigned(4))),
        (signal_like_instance, "swap_i", lambda: (bit(), Pair(), unsigned(4))),
        (signal_between_instances, "inner_high", lambda: (bit(), Pair(), unsigned(4))),
    ],
    ids=lambda value: value.func.__name__ if hasattr(value, "func") else None,
)
def test_two_things_of_one_verilog_name_are_refused(function, name, arguments, tmp_path):
    complaint = f"{function.func.__name__}: two things would be called {name} in Verilog; rename one"
    with pytest.raises(HierarchyError, match=complaint):
        converted(function(*arguments()), tmp_path)


@block
def careless(clk, value, result, undriven, unread):
    """Read an undriven signal or drive an unread one, on request."""
    nothing, lost = unsigned(4), unsigned(4)

    @always(clk.posedge)
    def copy():
        result.next = value

    if undriven:

        @always(clk.posedge)
        def work():
            result.next = value ^ nothing

    elif unread:

        @always(clk.posedge)
        def work():
            lost.next = value

    else:
        return (copy,)

    return (work,) if undriven else (copy, work)


@block
def careless_parent(clk, value, result, undriven, unread):
    """Connect an undriven or unread signal to an instance, on request."""
    nothing, carry = unsigned(4), bit()
    given = nothing if undriven else value
    lost = carry if unread else unconnected(1)
    stepping = step(clk, value, given, result, lost)

    return (stepping,)


@pytest.mark.parametrize("function", [careless, careless_parent])
@pytest.mark.parametrize(
    ("undriven", "unread", "complaint"),
    [(True, False, "not driven"), (False, True, "not read"), (False, False, None)],
)
def test_a_signal_without_a_driver_or_reader_is_refused(function, undriven, unread, complaint, tmp_path):
    top = function(bit(), unsigned(4), unsigned(4), undriven, unread)
    if complaint is None:
        converted(top, tmp_path)
    else:
        with pytest.raises(HierarchyError, match=f"{function.__name__}: .*{complaint}"):
            converted(top, tmp_path)


@block
def slices_in_a_list(value, result):
    """MyHDL declares a memory for the slices and writes only `s[0] <= 0;` to it, at the start."""
    halves = [value(2, 0), value(4, 2)]

    @always_comb
    def swap():
        for i in range(2):
            result.next[2 * i] = halves[i][0]

    return (swap,)


@block
def below_zero(value, result):
    """MyHDL writes `4'd-3`."""
    offset = Constant(intbv(-3, min=-8, max=8))

    @always_comb
    def add():
        result.next = value ^ offset

    return (add,)


@pytest.mark.parametrize(
    ("function", "line", "complaint"),
    [
        (slices_in_a_list, "halves = [value(2", "a process indexes halves"),
        (below_zero, "offset = Con", "offset is -3, and a con"),
    ],
)
def test_values_that_myhdl_gets_wrong_are_refused(function, line, complaint, tmp_path):
    lines = Path(__file__).read_text().splitlines()
    [number] = [number for number, text in enumerate(lines, 1) if text.startswith(f"    {line}")]
    with pytest.raises(HierarchyError, match=rf"^{re.escape(__file__)}:{number}: {complaint}"):
        converted(function(unsigned(4), unsigned(4)), tmp_path)


def test_a_connection_without_a_name_is_refused(tmp_path):
    @block
    def nameless(clk, value, result):
        # No variable names the first instance's result.
        first = step(clk, value, value, unsigned(4), unconnected(1))
        second = step(clk, value, value, result, unconnected(1))

        return first, second

    with pytest.raises(HierarchyError, match=r"nameless: the signal that step\.stepped connects to has no name"):
        converted(nameless(bit(), unsigned(4), unsigned(4)), tmp_path)


ADDER = """// Adds, a cycle late.
module adder #(parameter STEP = 1, parameter WIDTH = 8) (
    input clk, input [3:0] value, output reg [WIDTH-1:0] sum, output unused
);
always @(posedge clk) sum <= value + STEP;
endmodule
"""


def adder_of(source: Path, outputs: tuple[str, ...] = ("sum",)):
    @given_verilog(lambda: source, outputs)
    @block
    def adder(clk, value, sum, STEP, WIDTH):
        return ()

    return adder


@block
def two_adders(clk, value, first, second, doubled, adder):
    """Chain two instances of given Verilog and read the first sum in a process."""
    one = adder(clk, value, first, STEP=3, WIDTH=4)
    two = adder(clk, first, second, STEP=3, WIDTH=4)

    # A process reads an output of given Verilog.
    @always_comb
    def double():
        doubled.next = first + first

    return one, two, double


def two_adders_of(adder):
    return two_adders(bit(), unsigned(4), unsigned(4), unsigned(4), unsigned(5), adder)


def test_given_verilog_stands_in_the_design_as_it_is(tmp_path):
    source = tmp_path / "given.v"
    source.write_text(ADDER)
    modules = converted(two_adders_of(adder_of(source)), tmp_path / "verilog")
    assert list(modules) == ["adder", "two_adders"], "two instances with equal parameters share a module"
    assert modules["adder"].path.read_text() == ADDER
    assert modules["adder"].parameters == (("STEP", "3"), ("WIDTH", "4"))
    assert modules["adder"].ports == (
        Port("clk", 1, False, False), Port("value", 4, False, False), Port("sum", 4, False, True),
    )  # fmt: skip
    assert modules["two_adders"].instances == {"adder_0": "adder", "adder_1": "adder"}
    text = modules["two_adders"].path.read_text()
    assert "adder #(\n    .STEP(3),\n    .WIDTH(4)\n) adder_0_i (\n    .clk(clk),\n    .value(value)," in text
    (tmp_path / "bench.v").write_text(
        """module bench;
reg clk = 0;
wire [3:0] first, second;
wire [4:0] doubled;
two_adders dut (.clk(clk), .value(4'd5), .first(first), .second(second), .doubled(doubled));
initial begin
    repeat (4) #1 clk = ~clk;
    $display("%0d %0d %0d", first, second, doubled);
end
endmodule
"""
    )
    files = [str(module.path) for module in modules.values()]
    compiled = str(tmp_path / "bench")
    subprocess.run(["iverilog", "-g2005", "-o", compiled, str(tmp_path / "bench.v"), *files], check=True)
    done = subprocess.run(["vvp", "-n", compiled], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["8", "11", "16"]


@block
def hold(clk, value, held):
    @always(clk.posedge)
    def take():
        held.next = value

    return take


@block
def two_clocks(clk, awake, value, steady, resting):
    """A register on the free-running clock, and one on a gated clock."""
    resting_clk = bit()
    going_on = hold(clk, value, steady)
    at_rest = hold(clk, value, resting)
    gate = clock_gate(clk, awake, resting_clk)
    rests_on(resting_clk, at_rest)

    return going_on, at_rest, gate


def two_clocks_arguments():
    nibbles = {name: unsigned(4) for name in ("value", "steady", "resting")}
    return {"clk": bit(), "awake": bit(), **nibbles}


RESTING_BENCH = """`timescale 1ns / 1ns
module bench;
reg clk = 0, awake = 0;
wire [3:0] steady, resting;
reg [3:0] value;
integer cycle;
two_clocks dut (.clk(clk), .awake(awake), .value(value), .steady(steady), .resting(resting));
realtime rose;
always @(posedge dut.resting_clk) rose = $realtime;
always @(negedge dut.resting_clk)
    if ($realtime > 0 && $realtime - rose != 5)
        $display("a pulse of %0d ns", $realtime - rose);
// Awake in cycles 2, 3 and 5 of 8, changing just after an edge, as a register does.
initial begin
    for (cycle = 0; cycle < 8; cycle = cycle + 1) begin
        #1 value = cycle;
        awake = cycle == 2 || cycle == 3 || cycle == 5;
        #4 clk = 0;
        #5 clk = 1;
    end
    #1 $display("%0d %0d", steady, resting);
end
endmodule
"""


@pytest.mark.parametrize(
    ("options", "follows", "said"),
    [
        pytest.param((), "!clk", ["7 7"], id="goes-on"),
        pytest.param(("-DCLOCK_GATING",), "!clk", ["7 5"], id="rests"),
        pytest.param(("-DCLOCK_GATING",), "1'b1", ["a pulse of 4 ns", "a pulse of 1 ns"], id="cut"),
    ],
)
def test_a_clock_rests(tmp_path, options, follows, said):
    modules = converted(two_clocks(**two_clocks_arguments()), tmp_path / "verilog")
    gate = modules["clock_gate"].path
    gate.write_text(gate.read_text().replace("if (!clk)", f"if ({follows})"))
    (tmp_path / "bench.v").write_text(RESTING_BENCH)
    files = [str(module.path) for module in modules.values()]
    compiled = str(tmp_path / "bench")
    subprocess.run(["iverilog", "-g2005", *options, "-o", compiled, str(tmp_path / "bench.v"), *files], check=True)
    done = subprocess.run(["vvp", "-n", compiled], capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert set(said) <= set(lines), lines
    assert len(said) > 1 or lines == said


def test_a_clock_that_rests_goes_on_in_myhdl(tmp_path):
    leaf = Leaf(two_clocks, two_clocks_arguments, tmp_path)
    stimulus = [{"awake": value % 2, "value": value} for value in range(16)]
    outputs = leaf.run_both(stimulus, settled=1)
    assert [cycle["resting"] for cycle in outputs[1:]] == [cycle["steady"] for cycle in outputs[1:]] == [*range(15)]


@block
def adders(clk, value, first, second, one_adder, other_adder, steps):
    one = one_adder(clk, value, first, STEP=steps[0], WIDTH=4)
    two = other_adder(clk, value, second, STEP=steps[1], WIDTH=4)

    return one, two


def adders_of(one_adder, other_adder, steps=(3, 4)):
    return adders(bit(), unsigned(4), unsigned(4), unsigned(4), one_adder, other_adder, steps)


def test_given_verilog_takes_two_sets_of_parameters(tmp_path):
    source = tmp_path / "given.v"
    source.write_text(ADDER)
    adder = adder_of(source)
    modules = converted(adders_of(adder, adder), tmp_path / "verilog")
    assert list(modules) == ["adder", "adders"]
    text = modules["adders"].path.read_text()
    for number, step_by in enumerate((3, 4)):
        assert f"adder #(\n    .STEP({step_by}),\n    .WIDTH(4)\n) adder_{number}_i (" in text


def test_given_verilog_keeps_its_name(tmp_path):
    source = tmp_path / "given.v"
    source.write_text(ADDER)

    @block
    def adder(clk, value, sum, STEP, WIDTH):
        @always(clk.posedge)
        def work():
            sum.next = value

        return (work,)

    given = adder_of(source)
    modules = converted(adders_of(given, adder), tmp_path / "verilog")
    assert modules["adders"].instances == {"adder_0": "adder", "adder_1": "adder_1"}
    assert modules["adder"].path.read_text() == ADDER
    for others in ((adder, given), (given, adder_of(source))):
        with pytest.raises(HierarchyError, match="adder is the name of given Verilog, which stays, and of"):
            converted(adders_of(*others), tmp_path / "verilog")


def test_a_top_does_not_take_the_name_of_given_verilog(tmp_path):
    source = tmp_path / "given.v"
    source.write_text(ADDER)
    given = adder_of(source)

    @block
    def adder(clk, value, sum):
        inner = given(clk, value, sum, STEP=1, WIDTH=4)
        return (inner,)

    with pytest.raises(HierarchyError, match="adder is the name of given Verilog, which stays"):
        converted(adder(bit(), unsigned(4), unsigned(4)), tmp_path / "verilog")


def test_given_verilog_has_its_module(tmp_path):
    source = tmp_path / "given.v"
    source.write_text(ADDER.replace("module adder", "module adders"))
    with pytest.raises(HierarchyError, match=r"adder: .*given\.v has no module of this name"):
        converted(two_adders_of(adder_of(source)), tmp_path / "verilog")


def test_an_output_of_given_verilog_must_be_an_argument(tmp_path):
    adder = adder_of(tmp_path / "given.v", ("sum", "carry"))
    with pytest.raises(HierarchyError, match=r"adder: carry is listed as an output, but no argument"):
        converted(two_adders_of(adder), tmp_path / "verilog")


@block
def word_table(clk, index, word, values, file):
    """A memory whose initial words come from a file; `values` has the same words."""
    words = [Signal(intbv(value)[8:]) for value in values]

    loading = load_words(words, file)

    @always(clk.posedge)
    def fetch():
        word.next = words[index]

    return loading, fetch


def test_a_memory_holds_a_files_words(tmp_path):
    values, file = [7, 250, 0, 99], tmp_path / "words.hex"
    file.write_text("".join(f"{value:x}\n" for value in values))
    leaf = Leaf(
        word_table,
        lambda: {"clk": bit(), "index": unsigned(2), "word": unsigned(8), "values": values, "file": str(file)},
        tmp_path,
    )
    outputs = leaf.run_both([{"index": index} for index in (3, 0, 1, 2, 0)], settled=1)
    assert [output["word"] for output in outputs[1:]] == [99, 7, 250, 0]
    text = leaf.verilog[-1].read_text()
    assert text.count(f'// Initial contents of the memory.\ninitial $readmemh("{file}", words);\n') == 1


@block
def sliced_elsewhere(clk, pair, swapped, narrow):
    """Pass a whole interface to one instance, and a slice of a signal that it does not read to another."""
    crossing = swap_low(pair, swapped)
    stepping = step(clk, pair.high(2, 0), pair.high(2, 0), narrow, unconnected(1))

    return crossing, stepping


@block
def inverted(word, result):
    """~word."""

    @always_comb
    def invert():
        result.next = ~word

    return (invert,)


@block
def side_by_side_elsewhere(pair, first, second):
    """Connect two concatenated signals to one port of two instances; one passes it on to a submodule."""
    both = ConcatSignal(pair.high, pair.low)
    one = inverted(both, first)
    two = passed_on(both, second)

    return one, two


@block
def passed_on(word, result):
    inner = inverted(word, result)

    return (inner,)


def test_signals_side_by_side_may_be_a_port(tmp_path):
    leaf = Leaf(side_by_side_elsewhere, lambda: {"pair": Pair(), "first": unsigned(8), "second": unsigned(8)}, tmp_path)
    assert [module.name for module in leaf.modules] == ["inverted", "passed_on", "side_by_side_elsewhere"]
    assert leaf.run_both([{"pair_high": 5, "pair_low": 12}])[-1] == {"first": 0xA3, "second": 0xA3}


@block
def swap_low(pair, swapped):
    """Do half of `swap`."""

    @always_comb
    def cross():
        swapped.high.next = pair.low

    return (cross,)


def test_a_slice_elsewhere_is_no_port_here(tmp_path):
    modules = converted(sliced_elsewhere(bit(), Pair(), Pair(), unsigned(2)), tmp_path)
    assert [port.name for port in modules["swap_low"].ports] == ["pair_low", "swapped_high"]


def test_elaboration_leaves_nothing_behind():
    before = inspect.stack
    slow = [(frame[0], frame[3]) for frame in inspect.stack()][:_DEEPEST]
    lines, file = inspect.getsourcelines(swap_low.func), inspect.getsourcefile(swap_low.func)
    known = len(_signals)
    with elaboration():
        assert inspect.stack is not before
        # MyHDL reads these parts of a frame.
        assert [(frame[0], frame[3]) for frame in inspect.stack()] == slow
        assert [(frame[0], frame[3]) for frame in inspect.getouterframes(inspect.currentframe())] == slow
        for _ in range(2):
            assert (inspect.getsourcelines(swap_low.func), inspect.getsourcefile(swap_low.func)) == (lines, file)
        signal = bit()
        assert _signals[-1] is signal
    assert inspect.stack is before
    assert len(_signals) == known


def test_two_threads_convert_as_one_after_the_other(tmp_path):
    """Two threads elaborate and convert several designs concurrently, which MyHDL alone cannot do."""

    def convert_all(directory: Path) -> dict[str, str]:
        directory.mkdir(parents=True)
        found = {}
        for number in range(4):
            with elaboration():
                top = everything(**everything_arguments())
            for name, module in converted(top, directory / str(number)).items():
                found[f"{number}/{name}"] = module.path.read_text()
        return found

    before = inspect.stack
    alone = convert_all(tmp_path / "alone")
    with ThreadPoolExecutor(2) as threads:
        together = list(threads.map(convert_all, (tmp_path / "first", tmp_path / "second")))
    assert together == [alone, alone]
    assert inspect.stack is before


def test_myhdls_internals_are_imported_in_few_places():
    found = set()
    for folder in MAY_IMPORT:
        for path in (ROOT / folder).rglob("*.py"):
            if re.search(r"^\s*(?:from|import) myhdl\.(?:_|conversion)", path.read_text(), re.M):
                found.add(path.relative_to(ROOT).with_suffix("").as_posix())
    outside = {"convert/write", "docs/blocks", "verif/tests/test_hierarchy"}
    inside = {"elaboration", "hierarchy", "inside", "records", "signals", "verilog_style"}
    assert found == outside | {f"hdl/{name}" for name in inside}


def test_myhdl_is_the_version_that_this_was_written_for():
    pins = [line for line in importlib.metadata.requires("raycaster") if line.startswith("myhdl")]
    assert pins == [f"myhdl=={importlib.metadata.version('myhdl')}"]


# The whole design ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("units", [1, 8])
def test_a_unit_is_one_module_and_many_instances(units, tmp_path):
    config = configure(units=units, screen="tiny", rectangles=2, allow_underrun=True)
    files = write_verilog(config, tmp_path / "verilog")
    names = [path.stem for path in files]
    assert len(set(names)) == len(names)
    for module in ("ray_unit", "line_buffer"):
        assert names.count(module) == 1
        instances = [re.findall(rf"^{module} {module}(_\d+)?_i \($", path.read_text(), re.M) for path in files]
        assert sum(map(len, instances)) == units
    defined = {path: re.findall(r"^module (\w+)", path.read_text(), re.M) for path in files}
    assert defined == {path: [path.stem] for path in files}
    assert names[-1] == "ray_caster_module"
    assert (tmp_path / "verilog" / FILE_LIST).read_text().split() == [path.name for path in files]


def test_every_module_is_made_of_nothing_unknown(tmp_path):
    """In the file list, each module follows those that it instantiates."""
    files = write_verilog(configure(screen="tiny", units=2, rectangles=2, allow_underrun=True), tmp_path / "verilog")
    known = set()
    for path in files:
        used = set(re.findall(r"^(\w+) \w+_i \($", path.read_text(), re.M))
        assert used <= known, path.name
        known.add(path.stem)


def test_the_header_says_what_and_never_when(tmp_path):
    config = configure(screen="tiny", units=2, rectangles=2, fraction_bits=1, allow_underrun=True)
    files = write_verilog(config, tmp_path / "verilog")
    given = {path for path in files if path.stem in ("clock_gate", "by_axis")}
    assert len(given) == 2
    assert all(path.read_text() == Path(rtl.__path__[0], "common", path.name).read_text() for path in given)
    for path in set(files) - given:
        lines = path.read_text().splitlines()
        assert lines[:2] == [f"// RayCaster: {path.stem}", f"// Configuration: {config.name}"]
        assert "// SPDX-License-Identifier: MIT" in lines
        assert not re.search(r"\b20\d\d-|(?<!\[)\b\d\d:\d\d|MyHDL|Generated", path.read_text())


@pytest.mark.slow
def test_any_process_writes_the_same_bytes(tmp_path):
    # MyHDL iterates over Python sets, whose order depends on the hash seed.
    numbers = ("1", "2", "3", "4")
    for number in numbers:
        command = [sys.executable, "-m", "raycaster.cli", "verilog", "--output", str(tmp_path / number)]
        command += ["--screen", "tiny", "--units", "4", "--rectangles", "5", "--allow-underrun"]
        subprocess.run(command, env={**os.environ, "PYTHONHASHSEED": number}, check=True, capture_output=True)
    first, *others = (
        sorted(str(path.relative_to(tmp_path / number)) for path in (tmp_path / number).rglob("*") if path.is_file())
        for number in numbers
    )
    assert first
    for number, files in zip(numbers[1:], others, strict=True):
        assert files == first
        assert filecmp.cmpfiles(tmp_path / "1", tmp_path / number, first, shallow=False) == (first, [], [])


def test_a_directory_is_replaced_as_a_whole(tmp_path):
    directory = tmp_path / "verilog"
    config = configure(screen="tiny", units=2, rectangles=2, allow_underrun=True)
    write_verilog(config, directory)
    (directory / "ray_unit_of_yesterday.v").write_text("module ray_unit;")
    write_verilog(config, directory)
    assert not list(directory.glob("*yesterday*"))
    assert [path.name for path in tmp_path.iterdir()] == ["verilog"], "nothing else is left"


def test_a_conversion_that_fails_leaves_what_was_there(tmp_path, monkeypatch):
    directory = emptied(tmp_path / "verilog")
    (directory / "kept.v").write_text("module kept;")

    def fail(*_):
        raise HierarchyError("broken")

    monkeypatch.setattr(write, "convert_hierarchy", fail)
    with pytest.raises(HierarchyError):
        write_verilog(configure(screen="tiny", units=2, rectangles=2, allow_underrun=True), directory)
    assert [path.name for path in directory.glob("*.v")] == ["kept.v"]
    assert [path.name for path in tmp_path.iterdir()] == ["verilog"]
