# SPDX-License-Identifier: MIT
"""Blocks whose arguments differ are modules that differ; equal ones share a module."""

import numpy as np
import pytest
from hdl_blocks import Pair, inverted, step
from myhdl import always, always_comb, block

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import bit, unconnected, unsigned


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
    """value + mode, modulo the width of the result."""
    step_by = mode.number if isinstance(mode, Mode) else mode if isinstance(mode, int) else int(mode[len(mode) // 2])
    limit = 1 << len(moved)

    @always(clk.posedge)
    def work():
        moved.next = (value + step_by) % limit

    return (work,)


@block
def offsets(clk, value, first, second, modes):
    """Apply two offsets."""
    one = offset(clk, value, first, modes[0])
    two = offset(clk, value, second, modes[1])

    return one, two


ONE = Mode(1)
PEAK = np.eye(1, 3000, 1500)[0]


@pytest.mark.parametrize(
    ("modes", "widths", "apart", "moved"),
    [
        pytest.param((1, 1), (4, 4), False, [0, 0], id="equal"),
        pytest.param((1, 2), (4, 4), True, [0, 1], id="numbers"),
        pytest.param((1, True), (4, 4), True, [0, 0], id="types"),
        pytest.param((1, 1), (4, 5), True, [0, 16], id="widths"),
        pytest.param((ONE, ONE), (4, 4), False, [0, 0], id="one-object"),
        pytest.param((ONE, Mode(2)), (4, 4), True, [0, 1], id="objects-that-read-alike"),
        pytest.param((PEAK, 2 * PEAK), (4, 4), True, [0, 1], id="arrays-that-read-alike"),
    ],
)
def test_parameters_and_widths_that_differ_make_modules_that_differ(modes, widths, apart, moved, tmp_path):
    words = dict(zip(("first", "second"), widths, strict=True))
    leaf = Leaf(
        offsets,
        lambda: {
            "clk": bit(), "value": unsigned(4), **{name: unsigned(width) for name, width in words.items()},
            "modes": modes,
        },
        tmp_path,
    )  # fmt: skip
    assert leaf.modules[-1].instances == {"offset_0": "offset", "offset_1": "offset_1" if apart else "offset"}
    assert [module.name for module in leaf.modules] == ["offset", *["offset_1"] * apart, "offsets"]
    assert list(leaf.run_both([{"value": 15}] * 3, settled=2)[-1].values()) == moved


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
