# SPDX-License-Identifier: MIT
"""The ULX3S: what its DVI connector sends, decoded and held against golden, and the way to its bitstream."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import SMALL_SCENE

from raycaster.design import Design, design_for
from raycaster.fpga.bitstream import BOARDS, make_bitstream, write_project
from raycaster.golden import seed_engine
from raycaster.verif.dvi import SYMBOL_BITS, pictures, record, symbols
from raycaster.verif.monitor import VideoError

ULX3S = BOARDS["ulx3s"]
PLL, SERIALISER, TOP = "ulx3s_pll.v", "dvi_serialiser.v", "ulx3s.v"


@pytest.fixture
def design() -> Design:
    return design_for(SMALL_SCENE, {"screen": "tiny", "units": 8, "rectangles": 4})


def shown(design: Design, directory: Path, *fault: str) -> list[np.ndarray]:
    """The frames that a DVI monitor sees, with a text in one file replaced by another."""
    directory.mkdir()
    sources = write_project(ULX3S, design, directory)
    if fault:
        name, right, wrong = fault
        [path] = [source for source in sources if source.name == name]
        assert right in path.read_text()
        path.write_text(path.read_text().replace(right, wrong))
    screen = design.configuration.screen_geometry
    frame = screen.horizontal.total * screen.vertical.total * SYMBOL_BITS
    # Two whole frames, wherever the recording starts.
    return pictures(symbols(record(sources, 3 * frame + frame // 8, directory / "run")), screen)


def expected(design: Design) -> np.ndarray:
    screen = design.configuration.screen_geometry
    picture = seed_engine.render(design.scene, screen, reflections=design.reflections)
    return picture.repeat(screen.doubling, axis=0).repeat(screen.doubling, axis=1)


def test_the_dvi_stream_is_golden(design, tmp_path):
    frames = shown(design, tmp_path / "board")
    assert len(frames) >= 2
    for frame in frames:
        assert np.array_equal(frame, expected(design))


LINKED = ".blue({}),\n    .green(green),\n    .red({}),\n    .pixel(pixel),\n    .gpdi_dp"


@pytest.mark.parametrize(
    ("file", "right", "wrong", "complaint"),
    [
        (TOP, LINKED.format("blue", "red"), LINKED.format("red", "blue"), "carries control bits"),
        (SERIALISER, "D0(shift_red[0]), .D1(shift_red[1])", "D0(shift_red[1]), .D1(shift_red[0])", "control symbols"),
        (SERIALISER, "10'b0000011111", "10'b0000111111", "five ones and five zeros"),
        (PLL, ".CLKOS_DIV(10)", ".CLKOS_DIV(8)", "control symbols|different bits|no symbol|five ones"),
        ("dvi_encoder.v", ".data(vga_g)", ".data(vga_r)", ""),
    ],
    ids=["channels", "bits", "clock", "pll", "colour"],
)
def test_a_broken_link_is_noticed(design, tmp_path, file, right, wrong, complaint):
    board = tmp_path / "board"
    if complaint:
        with pytest.raises(VideoError, match=complaint):
            shown(design, board, file, right, wrong)
    else:
        frames = shown(design, board, file, right, wrong)
        assert not any(np.array_equal(frame, expected(design)) for frame in frames)


def test_a_small_bitstream(tmp_path):
    """All the way; the same seed gives the same bytes, and every clock is fast enough."""
    design = design_for(SMALL_SCENE, {"screen": "tiny", "units": 1, "rectangles": 4, "allow_underrun": True})
    bitstreams = []
    for name in ("first", "second"):
        outcome = make_bitstream(ULX3S, design, tmp_path / name)
        assert not outcome.missed
        assert outcome.cells["TRELLIS_IO"][0] >= 21
        assert outcome.cells["MULT18X18D"][0] == 2
        assert {name: required for name, (_, required) in outcome.clocks.items()} == {"clk": 50.0, "shift_clk": 125.0}
        assert json.loads((tmp_path / name / "result.json").read_text())["clocks"]["clk"] == list(outcome.clocks["clk"])
        bitstreams.append((tmp_path / name / "ulx3s.bit").read_bytes())
    assert bitstreams[0] == bitstreams[1]
    assert len(bitstreams[0]) > 10_000


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--board", "ice40"), "error: board: ice40 is not known here; choose one of ulx3s"),
        (("--scene", "nowhere.toml"), "error: nowhere.toml: cannot be read"),
        (("--scene", str(SMALL_SCENE), "--colour-bits", "4"), "error: colour_bits: a DVI link carries 8 bits"),
    ],
)
def test_bad_options_get_one_line(tmp_path, options, complaint):
    command = (sys.executable, "-m", "raycaster.fpga.bitstream", *options)
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith(complaint)
    assert done.stderr.count("\n") == 1
    assert not list(tmp_path.rglob("*.bit"))
