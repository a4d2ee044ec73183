# SPDX-License-Identifier: MIT
"""Waveforms: reading them, recording a window of a frame, and what viewers get to open them with."""

from __future__ import annotations

from pathlib import Path

import pytest

from raycaster.errors import UserError
from raycaster.verif.waves import Waves, signed

VCD = """
$timescale 10ps $end
$scope module bench $end
$var reg 1 ! clk $end
$scope module dut $end
$var reg 3 " state [2:0] $end
$var reg 70 # wide [69:0] $end
$var reg 9 $ mem[1] [8:0] $end
$var real 1 % share $end
$upscope $end
$upscope $end
$enddefinitions $end
#500
$dumpvars
1!
bxxx "
bz #
b1 $
r0.5 %
$end
#1000
0!
#2000
1!
b001 "
b1000000000000000000000000000000000000000000000000000000000000000000001 #
#3000
0!
#4000
1!
b10x "
b10 $
#5000
0!
#6000
1!
b111 "
#7000
0!
"""


@pytest.fixture
def vcd(tmp_path: Path) -> Waves:
    """A small waveform, in the simplest of the formats."""
    path = tmp_path / "waves.vcd"
    path.write_text(VCD)
    return Waves(path)


def test_samples_stand_before_the_edge(vcd):
    samples = vcd.sample(["bench.dut.state", "bench.dut.wide", "bench.dut.mem[1]"])
    assert samples.times_ns == [20, 40, 60]
    assert samples.values == {
        "bench.dut.state": [None, 1, None],
        "bench.dut.wide": [None, (1 << 69) + 1, (1 << 69) + 1],
        "bench.dut.mem[1]": [1, 1, 2],
    }


def test_range_of_times(vcd):
    assert vcd.edges(40) == [40, 60]
    assert vcd.edges(0, 60) == [20, 40]
    assert vcd.sample(["bench.dut.mem[1]"], 60).values == {"bench.dut.mem[1]": [2]}
    assert vcd.span_ns() == (5, 70)


def test_value_at_a_time_is_after_its_changes(vcd):
    assert vcd.value("bench.dut.state", 20) == 1
    assert vcd.value("bench.dut.state", 19.99) is None
    assert vcd.value("bench.dut.state", 1) is None
    assert vcd.changes("bench.dut.mem[1]") == [(5, 1), (40, 2)]


def test_names(vcd):
    assert vcd.names == ("bench.clk", "bench.dut.state", "bench.dut.wide", "bench.dut.mem[1]")
    assert vcd.find("*.dut.st*") == "bench.dut.state"
    assert vcd.find("bench.*mem[1]") == "bench.dut.mem[1]"
    assert vcd.matching("bench.dut.*")[0] == "bench.dut.state"
    assert vcd.width("bench.dut.wide") == 70


def test_what_is_wrong_is_said_in_one_line(vcd, tmp_path):
    with pytest.raises(UserError, match=r"has no signal bench\.dut\.stat; there are bench\.dut\.state"):
        vcd.sample(["bench.dut.stat"])
    with pytest.raises(UserError, match=r"stands for 4 signals: bench\.clk, bench\.dut\.state \.\.\."):
        vcd.find("*")
    with pytest.raises(UserError, match="there is no such file"):
        Waves(tmp_path / "nothing.fst")
    (tmp_path / "text.fst").write_text("no waveform")
    with pytest.raises(UserError, match="not a waveform"):
        Waves(tmp_path / "text.fst")
    with pytest.raises(UserError, match="has no signal clock"):
        Waves(vcd.path, clock="clock").edges()


def test_twos_complement():
    assert [signed(value, 3) for value in (0, 3, 4, 7, None)] == [0, 3, -4, -1, None]
