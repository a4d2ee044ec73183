# SPDX-License-Identifier: MIT
"""Waveforms: reading them, viewers, and machines that cannot record FST. test_trace.py has recordings of designs."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest
from conftest import SMALL_SCENE, called, write_script

from raycaster.debug.probes import fields
from raycaster.debug.trace import main as trace
from raycaster.debug.wave import viewer
from raycaster.debug.wave_files import View, write_files
from raycaster.debug.waves import Samples, Waves
from raycaster.errors import UserError
from raycaster.rtl.common.records import Signs
from raycaster.sim.simulator import FST_HEADERS, has_headers

VCD = f"""
$timescale 10ps $end
$scope module bench $end
$var reg 1 ! clk $end
$scope module dut $end
$var reg 3 " state [2:0] $end
$var reg 70 # wide [69:0] $end
$var reg 9 $ mem[1] [8:0] $end
$upscope $end
$upscope $end
$enddefinitions $end
#500 $dumpvars 1! bxxx " bz # b1 $ $end
#1000 0!
#2000 1! b001 " b1{"0" * 68}1 #
#3000 0!
#4000 1! b10x " b10 $
#5000 0!
#6000 1! b111 "
#7000 0!
"""


@pytest.fixture
def vcd(tmp_path: Path) -> Waves:
    """Return a small waveform in the simplest format."""
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
    assert vcd.sample(["bench.dut.mem[1]"], 40) == Samples([40, 60], {"bench.dut.mem[1]": [1, 2]})


def test_bits_of_a_signal(vcd):
    high, low, element = "bench.dut.wide[69:68]", "bench.dut.wide[1:0]", "bench.dut.mem[1][1:1]"
    assert vcd.sample([high, low, element]).values == {high: [None, 2, 2], low: [None, 1, 1], element: [0, 0, 1]}
    assert (vcd.width(high), vcd.width(element)) == (2, 1)
    assert fields("bench.dut", "signs", ("dx", "dz:hex"), Signs()) == (
        "bench.dut.signs_word[2:2]", "bench.dut.signs_word[0:0]:hex",
    )  # fmt: skip
    for mistake in ("[70:0]", "[0:1]"):
        with pytest.raises(UserError, match=r"bench\.dut\.wide has 70 bits, which do not include \[\d+:\d\]$"):
            vcd.width(f"bench.dut.wide{mistake}")


def test_viewers_get_bits_of_signals(vcd):
    view = write_files(vcd, View({"control": ["bench.clk", "bench.dut.wide[69:68]:signed"]}, {}, 5, 70))
    bits = [f"({place})bench.dut.wide[69:0]" for place in (0, 1)]
    assert f"#{{wide[69:68]}} {' '.join(bits)}\n" in view.read_text()


def test_the_viewer_that_is_there_is_opened(tmp_path, monkeypatch):
    """GTKWave or Surfer is opened if there is a display."""
    waves, files = tmp_path / "waves.fst", tmp_path / "view.gtkw"
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv("DISPLAY", ":0")
    assert viewer(waves, files) is None
    for name in ("surfer", "gtkwave"):
        write_script(tmp_path, name)
        assert viewer(waves, files)[0] == name
    monkeypatch.delenv("DISPLAY")
    assert viewer(waves, files) is None


@pytest.mark.slow
def test_a_machine_without_headers_gets_vcd(tmp_path, monkeypatch):
    """Without the headers that Verilator's FST writer needs, `make trace` traces a recording in VCD."""
    for header in FST_HEADERS:
        (tmp_path / header).write_text("#error no such header here\n")
    write_script(tmp_path, "g++", f'exec {shutil.which("g++")} -I "{tmp_path}" "$@"')
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    assert has_headers(["stdio.h"])
    options = ["--pixel", "48,10", "--screen", "tiny", "--engine", "exact", "--units", "4", "--rectangles", "3"]
    done = called(str(SMALL_SCENE), *options, "--build", "build", cwd=tmp_path, program=trace)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "The hardware agrees with the golden model in every value of this pixel." in done.stdout
    assert [path.suffix for path in (tmp_path / "build" / "trace").rglob("waves.*")] == [".vcd"]
