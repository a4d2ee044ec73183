# SPDX-License-Identifier: MIT
"""Blocks whose arguments differ are modules that differ; equal ones share a module."""

import numpy as np
import pytest
from hdl_blocks import Pair, converted, inverted, step
from myhdl import always, always_comb, block

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import bit, unconnected, unsigned


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
