# SPDX-License-Identifier: MIT
"""Blocks become modules, connected as in MyHDL."""

import re

import pytest
from hdl_blocks import Pair, converted, everything, everything_arguments, inverted, step
from myhdl import ConcatSignal, always_comb, block

from raycaster.hdl.hierarchy import Port
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, tied, unconnected, unsigned
from raycaster.sim.simulator import find_tool


@pytest.mark.parametrize("simulator", ["icarus", "verilator"])
def test_every_kind_of_connection_works(simulator, tmp_path, monkeypatch, random):
    """Both simulators of Verilog agree with MyHDL."""
    for name, value in find_tool("verilator").environment.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(Leaf, "simulator", simulator)
    leaf = Leaf(everything, everything_arguments, tmp_path)
    names = {"word": 256, "pair_high": 16, "pair_low": 16}
    stimulus = [{name: int(random.integers(limit)) for name, limit in names.items()} for _ in range(200)]
    outputs = leaf.run_both(stimulus, settled=4)
    for cycle in range(4, 200):
        word, pair = stimulus[cycle - 1]["word"], stimulus[cycle]
        joined = (word + 3) % 16 | ((word >> 4) + 15) % 16 << 4
        assert outputs[cycle]["joined"] == joined
        assert outputs[cycle]["swapped_high"] == pair["pair_low"]
        assert outputs[cycle]["swapped_low"] == pair["pair_high"]
        # The previous cycle's carry clears the counter's input.
        carried = outputs[cycle - 1]["count"] == 0
        assert outputs[cycle]["count"] == (1 if carried else (word % 16 + 1) % 16)


def test_modules_ports_and_instances(tmp_path):
    modules = converted(everything(**everything_arguments()), tmp_path)
    assert list(modules) == ["step", "swap", "everything"], "each follows those that it instantiates, equal ones once"
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
    assert re.findall(r"^\w+ (\w+)_i \($", text, re.M) == list(modules["everything"].instances)
    assert text.count(".wrapped()") == 2, "two of the carries are not read"
    assert "// A register.\nalways @(posedge clk) begin" in modules["step"].path.read_text()


def test_a_block_converts_alike_wherever_it_stands(tmp_path):
    within = converted(everything(**everything_arguments()), tmp_path / "within")
    alone = converted(step(bit(), unsigned(4), unsigned(4), unsigned(4), bit()), tmp_path / "alone")
    assert within["step"].path.read_text() == alone["step"].path.read_text()


@block
def passed_on(word, result):
    inner = inverted(word, result)

    return (inner,)


@block
def side_by_side_elsewhere(pair, first, second, third, fourth):
    """Connect joined signals, with and without a variable and constants; one instance passes its own on."""
    both = ConcatSignal(pair.high, pair.low)
    mixed = ConcatSignal(True, pair.high(3, 0), "1010")
    one = inverted(both, first)
    two = passed_on(both, second)
    three = inverted(mixed, third)
    four = inverted(ConcatSignal(pair.low, tied(5, 4)), fourth)

    return one, two, three, four


def test_signals_side_by_side_may_be_a_port(tmp_path):
    names = ("first", "second", "third", "fourth")
    leaf = Leaf(side_by_side_elsewhere, lambda: {"pair": Pair()} | {name: unsigned(8) for name in names}, tmp_path)
    assert [module.name for module in leaf.modules] == ["inverted", "passed_on", "side_by_side_elsewhere"]
    outputs = leaf.run_both([{"pair_high": 5, "pair_low": 12}])[-1]
    assert tuple(outputs.values()) == (0xA3, 0xA3, 0x25, 0x3A)


@block
def swap_low(pair, swapped):
    """Do half of `swap`."""

    @always_comb
    def cross():
        swapped.high.next = pair.low

    return (cross,)


@block
def sliced_elsewhere(clk, pair, swapped, narrow):
    """Pass a whole interface to one instance, and a slice of a signal that it does not read to another."""
    crossing = swap_low(pair, swapped)
    stepping = step(clk, pair.high(2, 0), pair.high(2, 0), narrow, unconnected(1))

    return crossing, stepping


def test_a_slice_elsewhere_is_no_port_here(tmp_path):
    modules = converted(sliced_elsewhere(bit(), Pair(), Pair(), unsigned(2)), tmp_path)
    assert [port.name for port in modules["swap_low"].ports] == ["pair_low", "swapped_high"]
