# SPDX-License-Identifier: MIT
"""Waveforms: reading them, recording a window of a frame, and the save files for viewers."""

from __future__ import annotations

import io
import os
import re
import shutil
from pathlib import Path

import pytest
from conftest import BUILD, SMALL_SCENE, called

from raycaster.debug.probes.ray import Ray, fields
from raycaster.debug.recorder import build_and_record
from raycaster.debug.trace import main as trace
from raycaster.debug.wave import main, viewer, write_view
from raycaster.debug.wave_files import View, write_files
from raycaster.debug.waves import Waves, signed
from raycaster.design import Design, design_for
from raycaster.errors import UserError
from raycaster.output import Console
from raycaster.rtl.common.records import Signs
from raycaster.rtl.engine.ray_sequencer import RayState
from raycaster.sim.monitor import CLOCK_NS
from raycaster.sim.simulator import FST_HEADERS, has_headers

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
    files = write_files(vcd, View({"control": ["bench.clk", "bench.dut.wide[69:68]:signed"]}, {}, 5, 70))
    gtkwave, surfer = (path.read_text() for path in files)
    bits = [f"({place})bench.dut.wide[69:0]" for place in (0, 1)]
    assert f"#{{wide[69:68]}} {' '.join(bits)}\n" in gtkwave
    assert "variable_add bench.dut.wide\n" in surfer


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


def test_wrong_names_and_files_get_one_line(vcd, tmp_path):
    with pytest.raises(UserError, match=r"has no signal bench\.dut\.stat; similar names: bench\.dut\.state"):
        vcd.sample(["bench.dut.stat"])
    with pytest.raises(UserError, match=r"matches 4 signals: bench\.clk, bench\.dut\.state \.\.\."):
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


SCENE = Path(__file__).with_name("tall.toml")

# Options other than the defaults, with which every traced waveform must have the signals that a viewer shows.
OPTIONS = {
    "seed": {"units": "8", "culling": "0", "rounding": "nearest"},
    "exact": {"engine": "exact"},
    "beam": {"engine": "beam", "reflections": "2"},
}
PIXEL = (48, 2)


@pytest.fixture(scope="module", params=OPTIONS)
def wave(request, tmp_path_factory) -> tuple[Design, Ray, Waves, list[Path]]:
    """Record a window of each engine's frame in Icarus, which builds quickly, and write the viewers' files."""
    design = design_for(SCENE, {"screen": "tiny", "rectangles": "3", **OPTIONS[request.param]})
    ray = Ray(design, PIXEL[1], PIXEL[0])
    target = tmp_path_factory.mktemp("wave") / "tall"
    waves = build_and_record(design, "icarus", (1, 3), target, build=BUILD, console=Console(file=io.StringIO()))
    files = write_view(waves, design, ray)
    return design, ray, Waves(waves), files


@pytest.mark.slow_sets("beam", "seed")
def test_window_has_its_rows_alone(wave):
    """It runs from the start of the first row's computation until the last row has been shown."""
    design, _, waves, _ = wave
    row_ns = design.configuration.screen_geometry.row_cycles * CLOCK_NS
    begin, end = waves.span_ns()
    rows = 4 if design.configuration.engine != "beam" else 3
    assert rows * row_ns < end - begin < (rows + 0.2) * row_ns
    assert [path.name for path in waves.path.parent.parent.iterdir()] == ["tall"], "nothing half-written is left"


def test_viewers_show_what_there_is(wave):
    """The waveform has every signal of the save files, with its width; groups are ordered and labels are unique."""
    _, _, waves, (gtkwave, surfer) = wave
    # Bits of a word are shown as bits or as the whole word.
    shown = re.findall(r"^(?:\+\{.*\} |#\{.*\} (?:.*\(\d+\)|\(\d+\)))?(bench\.\S+)$", gtkwave.read_text(), re.MULTILINE)
    assert len(shown) > 30
    for name in shown:
        signal, _, last_bit = name.removesuffix(":0]").partition("[")
        assert waves.width(signal) == int(last_bit or 0) + 1, name
    added = re.findall(r"^variable_add (\S+)$", surfer.read_text(), re.MULTILINE)
    assert added == [name.partition("[")[0] for name in shown]
    groups = re.findall(r"^divider_add (\S+)$", surfer.read_text(), re.MULTILINE)
    assert groups[0] == "control"
    assert groups[-2:] == ["video", "bus"]
    labels = re.findall(r"^[+#]\{(.*?)\}", gtkwave.read_text(), re.MULTILINE)
    assert len(set(labels)) == len(labels), "two signals have one label"


def test_states_have_their_names(wave):
    """The viewers get a file with the names from the enumeration in the hardware's source."""
    design, _, waves, (gtkwave, surfer) = wave
    names = [f"{item._val} {name}" for name, item in ((name, getattr(RayState, name)) for name in RayState._names)]
    filters = re.findall(r"^\^\d+ (\S+)$", gtkwave.read_text(), re.MULTILINE)
    if design.configuration.engine == "beam":
        assert not filters, "it has no states"
        return
    assert [Path(path).read_text().split("\n")[:-1] for path in filters] == [names]
    assert "item_set_format ray_sequencer.state\n" in surfer.read_text()
    mapping = (waves.path.parent / ".surfer" / "mappings" / "ray_sequencer.state.txt").read_text()
    assert mapping.startswith("Name = ray_sequencer.state\nBits = 3\n0 IDLE\n1 GENERATE\n")
    state = waves.find("*.ray_sequencer_i.state")
    assert {value for _, value in waves.changes(state)} == set(range(len(names))), "every state is passed through"


def test_cursor_is_at_the_pixel(wave):
    """The pixel's ray starts at the cursor."""
    design, ray, waves, (gtkwave, surfer) = wave
    (units,) = re.findall(r"^\*-\d+\.\d+ (\d+) ", gtkwave.read_text(), re.MULTILINE)
    (ticks,) = re.findall(r"^cursor_set (\d+)$", surfer.read_text(), re.MULTILINE)
    assert int(units) == int(ticks) * waves.tick_units
    time_ns = int(ticks) / waves.ticks(1)
    if design.configuration.engine == "beam":
        assert waves.value("bench.dut.beam_renderer_i.row", time_ns) == ray.row
        assert waves.value("bench.dut.beam_renderer_i.scan_next_column", time_ns) == 1
        return
    assert waves.value("bench.dut.ray_caster_renderer_i.place_row", time_ns) == ray.row
    assert waves.value("bench.dut.ray_caster_renderer_i.place_column_offset", time_ns) == ray.offset
    assert waves.value(waves.find("*.ray_sequencer_i.steps_screen_to_ray"), time_ns) == 1


def test_a_missing_signal_is_reported(wave):
    """An error is better than a file that the viewer would complain about."""
    _, _, waves, _ = wave
    with pytest.raises(UserError, match=r"has no signal bench\.dut\.nothing"):
        write_files(waves, View({"control": ["bench.dut.nothing"]}, {}, 0, 1))
    with pytest.raises(UserError, match="unknown number format: octal"):
        write_files(waves, View({"control": ["bench.clk:octal"]}, {}, 0, 1))


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--pixel", "3,3", "--span", "4,5"), "span: rows 4 to 5 do not include the pixel's row 3"),
        (("--pixel", "3,3", "--span", "0,48"), "span: expected rows from 0 to 47 in rising order, got 0,48"),
        (("--pixel", "3,3", "--span", "few"), "span: expected the first and the last row"),
        (("--pixel", "3,48"), "pixel: expected column from 0 to 63 and row from 0 to 47, got 3,48"),
        (("--simulator", "questa"), "simulator: expected verilator or icarus, got questa"),
    ],
)
def test_mistakes(refuses, options, complaint):
    """The error is one line without a traceback."""
    assert complaint in refuses(main, "--screen", "tiny", *options)


def test_the_viewer_that_is_there_is_opened(tmp_path, monkeypatch):
    """GTKWave or Surfer is opened if there is a display."""
    waves, files = tmp_path / "waves.fst", [tmp_path / "view.gtkw", tmp_path / "view.sucl"]
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv("DISPLAY", ":0")
    assert viewer(waves, files) is None
    for name in ("surfer", "gtkwave"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
        assert viewer(waves, files)[0] == name
    monkeypatch.delenv("DISPLAY")
    assert viewer(waves, files) is None


@pytest.fixture
def no_fst_headers(tmp_path, monkeypatch):
    """Emulate a machine without the headers that Verilator's FST writer needs."""
    for header in FST_HEADERS:
        (tmp_path / header).write_text("#error no such header here\n")
    compiler = tmp_path / "g++"
    compiler.write_text(f'#!/bin/sh\nexec {shutil.which("g++")} -I "{tmp_path}" "$@"\n')
    compiler.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")


def test_headers_that_are_not_there_are_not_found(no_fst_headers):
    assert not has_headers(FST_HEADERS)
    assert not has_headers(["no_such_header.h"])
    assert has_headers(["stdio.h"])


def test_a_machine_without_headers_gets_vcd(no_fst_headers, tmp_path):
    """There, `make trace` builds a model that records VCD, and traces the recording."""
    options = ["--pixel", "48,10", "--screen", "tiny", "--engine", "exact", "--rectangles", "3", "--build", "build"]
    done = called(str(SMALL_SCENE), *options, cwd=tmp_path, program=trace)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "The hardware agrees with the golden model." in done.stdout
    assert [path.suffix for path in (tmp_path / "build" / "trace").rglob("waves.*")] == [".vcd"]
