# SPDX-License-Identifier: MIT
"""Boards supported by the open tools: descriptions, pin files, PLLs, decoded DVI output, and bitstreams."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, SMALL_SCENE, plant
from engine_vectors import small_config
from small_program import write_program

from raycaster.design.decide import configure
from raycaster.design.for_scene import Design, ProcessorDesign, design_for
from raycaster.errors import UserError
from raycaster.fit.fixing import fix
from raycaster.fpga import bitstream, quartus
from raycaster.fpga.bitstream import Outcome, make_bitstream, synthesise, write_project
from raycaster.fpga.board import Board, BoardError, OpenBoard, board_names, find_board, load_board
from raycaster.fpga.flows import FLOWS, clocks_for
from raycaster.fpga.netlist import left_to_logic
from raycaster.golden.engines import model_of
from raycaster.golden.frames import screens_before
from raycaster.golden.picture import shown
from raycaster.program import scene_words
from raycaster.rtl.system.camera_axis import STEP
from raycaster.rtl.system.scene_player import BUTTONS
from raycaster.scene import load_scene
from raycaster.screens import Screen, Span
from raycaster.serial_frames import LEAD, framed, writes
from raycaster.sim.monitor import VideoError
from raycaster.sim.netlist import as_verilog
from raycaster.verif.dvi.watch import golden, watch

BOARDS = [find_board(name, OpenBoard) for name in board_names(OpenBoard)]
ULX3S = find_board("ulx3s", OpenBoard)
CLOCKS, SERIALISER, LANE, TOP = "board_clocks.v", "dvi_serialiser.v", "dvi_lane.v", "dvi_board.v"
ENCODERS, ENCODER = "dvi_encoder.v", "tmds_encoder.v"
MODELS = ROOT / "verif" / "dvi" / "models.v"


# Descriptions ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "right", "wrong", "complaint"),
    [
        ("icepi_zero", 'pins = "K15"', 'pins = "R13"', "R13 is both gpdi[0] and serial_tx"),
        ("icepi_zero", 'pins = "K15"', 'pins = "15K"', 'serial_tx.pins: must be a pin such as "N2", not "15K"'),
        ("icepi_zero", '{ standard = "LVCMOS33", options = { DRIVE = "4" }, pins = "K15"', '{ pins = "K15"',
         "serial_tx.standard: expected"),
        ("icepi_zero", 'serial_tx = "serial"', 'serial_out = "serial"', "outputs: serial_out is not among the signals"),
        ("icepi_zero", 'serial_tx = "serial"', "", "serial_tx is neither the clock nor used in inputs or outputs"),
        ("icepi_zero", '"~gpio[3]"', '"~gpio[4]"', "down: ~gpio[4] is not a bit of a signal here, or is an output"),
        ("icepi_zero", '"~gpio[3]"', '"gpdi[3]"', "down: gpdi[3] is not a bit of a signal here, or is an output"),
        ("icepi_zero", "down =", "fire =", "inputs: fire is not one of reset, forward, back, left, right, up, down"),
        ("icepi_zero", 'clock = "clk50"', 'clock = "clk"', "clk is missing, but is one of the board's clocks"),
        ("icepi_zero", 'flow = "ecp5"', 'flow = "ecp4"', "expected ecp5, ice40 or gowin, got ecp4 (did you"),
        ("icepi_zero", 'flow = "ecp5"', 'flow = "', "is not TOML"),
        ("icepi_zero", 'PULLMODE = "NONE"', 'PULLMODE = ["NONE", "UP"]', "PULLMODE has 2 values for"),
        ("de10_lite", '["B8", "A7"]', "[]", 'signals.KEY.pins: must be a pin such as "N2", or a list of them'),
        ("de2", 'dac_clock = "VGA_CLK"', 'dac_clock = "DAC"', "DAC is missing, but is one of the board's clocks"),
        ("de10_lite", 'VGA_HS = "vga_hs"', 'VGA_HS = "hs"', "outputs: hs is not one of vga_r, "),
        ("de10_lite", 'VGA_R = "vga_r"', 'VGA_R = "vga_g"', "outputs: none is vga_r"),
        ("de2", '"P25"]', '"P25", "AE14"]', "SW[3] is neither the clock nor used in inputs or outputs"),
        ("de10_lite", "family =", "familiy =", "familiy: is unknown (did you mean family?)"),
    ],
)  # fmt: skip
def test_a_wrong_description_is_refused(tmp_path, name, right, wrong, complaint):
    """One line gives the file and the mistake."""
    path = shutil.copytree(find_board(name, Board).directory, tmp_path / name) / "board.toml"
    plant(path, right, wrong)
    with pytest.raises(BoardError, match=rf"board\.toml: .*{re.escape(complaint)}") as error:
        load_board(path.parent)
    assert "\n" not in str(error.value)


def test_a_description_is_missing(tmp_path):
    with pytest.raises(BoardError, match=r"board\.toml: cannot be read: No such file or directory$"):
        load_board(tmp_path)


@pytest.mark.parametrize(
    ("mhz", "options", "complaint"),
    [
        (12, {}, "^rows: the .* takes one clock per pixel; choose --rows 120, 96 or 60, or --engine span$"),
        (12, {"engine": "span", "screen": "play"}, "^screen: play is for simulation only"),
        (12, {"engine": "span", "rows": 180, "scale": 6, "pixels": 2}, "^pixels: "),
        (9, {"engine": "exact", "rows": 60}, "^screen: the .* makes no pixel clock near 25.175 MHz; choose "),
    ],
)
def test_unsupported_clocks(mhz, options, complaint):
    board = find_board("icebreaker", OpenBoard).model_copy(update={"clock_mhz": mhz})
    with pytest.raises(UserError, match=complaint):
        clocks_for(board, configure(**options))


@pytest.mark.parametrize(
    ("name", "options", "most"),
    [
        # 18,432 bits of a block are 2,048 places of 9 bits, four of which have a column of 640 and 24 bits of colour.
        ("ulx3s", {}, 51 * 2048 // 2),
        ("icepi_zero", {"scale": 1}, 13 * 2048 // 2),
        # Two queues take two rows of 640 columns each.
        ("ulx3s", {"units": 2}, 49 * 2048 // 2),
    ],
)
def test_lists_fit_the_chip(name, options, most):
    """The usual list is shortened to the RAM blocks that the chip has; a longer one that is asked for is refused."""
    board, config = find_board(name, OpenBoard), configure(engine="span", **options)
    whole = Design(SMALL_SCENE, load_scene(SMALL_SCENE), config, 1)
    assert bitstream.with_list(board, whole, {}).configuration.list == most < config.list
    short = replace(whole, configuration=replace(config, list=most - 2))
    for given in ({}, {"list": most - 2}):
        assert bitstream.with_list(board, short, given) == short
    with pytest.raises(UserError, match=f"^list: the block RAM of the .* holds lists of {most:,} runs, and"):
        bitstream.with_list(board, whole, {"list": config.list})


def test_lists_fill_single_ports():
    """A list that needs more block RAM than the chip has fills two RAMs with a single port, of 16,384 x 16 bits.

    A run has 9 bits for a column of 320 and 12 of colour, so three blocks of 512 x 8 bits side by side hold 512 runs.
    The scene needs 16 of the 30 blocks.
    """
    board = find_board("icebreaker", OpenBoard)
    config = configure(engine="span", scale=1, colour_bits=4)
    whole, most = Design(SMALL_SCENE, load_scene(SMALL_SCENE), config, 1), 4 * 512 // 2
    for asked, made in ((most, most), (most + 2, 16384), (16384, 16384), (None, 16384)):
        given = {} if asked is None else {"list": asked}
        design = replace(whole, configuration=replace(config, **given))
        assert bitstream.with_list(board, design, given).configuration.list == made
    with pytest.raises(UserError, match=r"^list: the block RAM of the .* holds lists of 16,384 runs, and 16,386"):
        bitstream.with_list(board, replace(whole, configuration=replace(config, list=16386)), {"list": 16386})


def test_a_scene_with_too_many_runs_is_refused():
    """Its frame would never be whole; nothing is converted."""
    options = {"board": "icebreaker", "engine": "span", "rows": 240, "scale": 1, "list": 1024}
    words = ["mirror_room", *(word for name, value in options.items() for word in (f"--{name}", str(value)))]
    with pytest.raises(UserError, match=r"mirror_room\.toml: a frame has 2,495 runs of .* holds 1,024;"):
        bitstream.main(words)


def test_the_smallest_products_are_left_to_logic():
    """Products of one size go by name; a product wider than a factor takes more than one multiplier."""
    cells = (("a", 9, 9), ("b", 20, 9), ("c", 9, 8), ("d", 8, 9), ("e", 3, 3))
    text = "".join(
        f"  cell $mul \\{name}\n    parameter \\A_SIGNED 0\n"
        f"    parameter \\A_WIDTH {a}\n    parameter \\B_WIDTH {b}\n  end\n"
        for name, a, b in cells
    )
    for most, factor_bits, left in ((6, 18, ""), (5, 18, "e"), (4, 18, "ec"), (1, 18, "ecdab"), (4, 20, "e")):
        assert "".join(left_to_logic(text, most, factor_bits)) == left


# Video ----------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def design() -> Design:
    """A small design whose camera the buttons move, with more reflections than the scene asks for."""
    return design_for(SMALL_SCENE, {"engine": "exact", "screen": "tiny", "rectangles": 4, "reflections": 2})


def small_design(board: OpenBoard, **options: int) -> Design:
    """Make a design with a built-in scene, as small as the board's monitor allows; each pixel is drawn in time."""
    screen = {"screen": "tiny"} if board.video == "dvi" and "rows" not in options else {"rows": 60}
    return fix(SMALL_SCENE, board.configuration | {"engine": "exact"} | screen | options, "all").design


def watched(
    board: OpenBoard, design: Design, directory: Path, *fault: str, frames: int = 1, **more: Any
) -> list[np.ndarray]:
    """Return the first frames that a DVI monitor sees, with a text in one file replaced."""
    files = write_project(board, design, directory)
    if fault:
        name, right, wrong = fault
        [path] = [file for file in files if file.name == name]
        plant(path, right, wrong)
    return watch(board, files, design.configuration, frames, directory / "run", **{"simulator": "icarus"} | more)


# A reset that ends one clock later moves the pixels relative to the cycles of the shift clock.
@pytest.mark.slow_sets(quick=["ulx3s-verilator", "tang"])
@pytest.mark.parametrize(
    ("name", "simulator", "frames", "late_ns"),
    [
        ("ulx3s", "icarus", 2, 0),
        ("ulx3s", "icarus", 1, 20),
        ("ulx3s", "verilator", 2, 0),
        *((board.name, "icarus", 1, 0) for board in BOARDS if board.video == "dvi" and board != ULX3S),
    ],
)
def test_the_dvi_stream_is_golden(design, tmp_path, name, simulator, frames, late_ns):
    board = find_board(name, OpenBoard)
    built = design if board == ULX3S else small_design(board)
    for frame in watched(board, built, tmp_path, frames=frames, simulator=simulator, late_ns=late_ns):
        assert np.array_equal(frame, golden(built))


BOARD_SCREEN = Screen(
    columns=16, rows=8, horizon_row=4, doubling=2,
    horizontal=Span(32, 8, 24, 20, active_high=False), vertical=Span(16, 4, 2, 6, active_high=True),
)  # fmt: skip
"""A small screen with a front porch that is long enough for a PLL to lock."""

BOARD_SCENE = """
[camera]
position = [100, 256, 100]
[[rect]]
corners = [[102, 256, 60], [102, 300, 140]]
colour = "#4080c0"
[[rect]]
corners = [[150, 240, 90], [150, 272, 100]]
colour = "#f0a010"
"""
"""A near rectangle that is to the right, and a farther one whose edge is in the middle."""


@pytest.mark.slow_sets(quick=["ulx3s-exact", "icebreaker"])
@pytest.mark.parametrize(
    ("name", "engine"),
    [("ulx3s", "exact"), ("ulx3s", "span"), ("icebreaker", "span"), ("de2", "exact"), ("de2_115", "exact"),
     ("de1_soc", "exact")],
)  # fmt: skip
def test_a_board_is_played_and_reset(tmp_path, name, engine):
    """Each button moves the camera by a step in the next frame; reset in the middle of a frame starts all anew.

    A design that draws whole frames shows all of it a frame later.
    """
    board = find_board(name, Board)
    own = {key: value for key, value in board.configuration.items() if key == "colour_bits"}
    config = small_config(BOARD_SCREEN, engine=engine, rectangles=2, reflections=1, allow_underrun=True, **own)
    scene = tmp_path / "scene.toml"
    scene.write_text(BOARD_SCENE)
    small = Design(scene, load_scene(scene), config, reflections=1)
    if isinstance(board, OpenBoard):
        files = write_project(board, small, tmp_path)
    else:
        quartus.write_project(board, config, small.shown, tmp_path / "project")
        files = sorted((tmp_path / "project").rglob("*.v"), key=lambda path: path.stem == quartus.TOP)
    # Each of these steps changes the picture.
    order = [button for button in ("up", "right", "left", "forward", "back", "down") if button in board.inputs]
    frames = watch(
        board, files, config, 1 + len(order), tmp_path / "run", simulator="icarus",
        buttons=[*(1 << BUTTONS.index(button) for button in order), 0], again=1,
        blank=screens_before(small.scene, config),
    )  # fmt: skip
    places = [small.scene.camera.position]
    for button in order:
        x, y, z = (place + STEP * way for place, way in zip(places[-1], MOVES[button], strict=True))
        places.append((x, y, z))
    for frame, place in zip(frames, [*places, places[0]], strict=True):
        assert np.array_equal(frame, golden(small, place)), place
    assert not any(np.array_equal(*two) for two in pairwise(frames[: len(places)]))


def test_rooms_over_the_serial_port(tmp_path):
    """A computer sends rooms to a board, which shows each from some frame on, and black before.

    Noise, a room whose cable is pulled, one with a wrong bit, and two that are sent at once change nothing.
    """
    board, scene = ULX3S, tmp_path / "scene.toml"
    scene.write_text(BOARD_SCENE)
    config = small_config(
        BOARD_SCREEN, engine="exact", rectangles=2, reflections=1, allow_underrun=True, bus="uart", baud=2_000_000
    )
    small = Design(scene, load_scene(scene), config, reflections=1)
    rooms = [small.shown, small.shown.model_copy(update={"background": (255, 0, 255)})]
    first, second = (framed(writes(scene_words(room, config))) for room in rooms)
    wrong = second[:20] + bytes([second[20] ^ 4]) + second[21:]
    # On a line that is high when idle, a host's low bits win.
    both = bytes(one & other for one, other in zip(first[3:30], second, strict=False))
    disturbed = Random(1).randbytes(9) + second[:-40] + wrong + both
    sends = bytes([LEAD]) + bytes([LEAD]).join((first, disturbed, second))
    files = write_project(board, small, tmp_path)
    frames = watch(board, files, config, 15, tmp_path / "run", simulator="icarus", sends=sends)
    shown = [golden(small), golden(replace(small, scene=rooms[1]))]
    shown.insert(0, np.zeros_like(shown[0]))
    order = [[np.array_equal(frame, picture) for picture in shown].index(True) for frame in frames]
    assert order == sorted(order) and {*order} == {0, 1, 2}, order


MOVES = {"forward": (1, 0, 0), "back": (-1, 0, 0), "left": (0, -1, 0), "right": (0, 1, 0), "up": (0, 0, 1),
         "down": (0, 0, -1)}  # fmt: skip
"""Direction of each button's step."""


PROGRAM_STEP = 8
"""World units per frame by which the small program moves the camera."""


@pytest.mark.slow
def test_a_processor_on_the_board(tmp_path):
    """The program writes to the serial port and shows its scene; the board's buttons move the camera."""
    config = configure(engine="exact", screen="tiny", rectangles=4)
    scene = load_scene(SMALL_SCENE)
    program = write_program(SMALL_SCENE, config, tmp_path)
    project = tmp_path / "project"
    project.mkdir()
    files = write_project(ULX3S, ProcessorDesign(program, config), project)
    right = 1 << BUTTONS.index("right")
    frames = watch(ULX3S, files, config, 6, project, simulator="verilator", buttons=(right,))
    # The screen is blank until the program has started; an interrupt waits by then, so the first picture is a step on.
    blank, *drawn = frames
    assert not blank.any()
    x, y, z = scene.camera.position
    for step, frame in enumerate(drawn, 1):
        camera = scene.camera.model_copy(update={"position": (x, y + step * PROGRAM_STEP, z)})
        picture = model_of(config).render(scene.model_copy(update={"camera": camera}), config.screen_geometry)
        assert np.array_equal(frame, shown(picture, config)), step
    # Buttons are sent as letters.
    assert (project / "serial.txt").read_text().startswith("RAYCMEgo\nBBB")


LINKED = ".blue({}),\n    .green(green),\n    .red({}),\n    .pixel(pixel),\n    .link"


@pytest.mark.slow_sets(quick=["flag"])
@pytest.mark.parametrize(
    ("file", "right", "wrong", "complaint"),
    [
        (TOP, LINKED.format("blue", "red"), LINKED.format("red", "blue"), "carries control bits"),
        (LANE, ".bits(pair)", ".bits({pair[0], pair[1]})", "control symbols"),
        (SERIALISER, "symbol(red)", "symbol({red[8:0], red[9]})", "different bits"),
        (SERIALISER, "DETECTED = 5'b00001", "DETECTED = 5'b00100", "change while they are sampled"),
        (SERIALISER, "!phase[2] && !phase[3] && !phase[4]", "!phase[3]", "five ones and five zeros"),
        (SERIALISER, "10'b0000011111", "10'b0000111111", "five ones and five zeros"),
        (CLOCKS, ".CLK_DIV(10)", ".CLK_DIV(8)", "change while they are sampled"),
        (ENCODER, "encoded = {invert,", "encoded = {!invert,", ""),
        (ENCODERS, "syncs = {vga_vs, vga_hs}", "syncs = {vga_hs, vga_hs}", "lines|frames|VS"),
        (ENCODERS, ".data(vga_g)", ".data(vga_r)", ""),
    ],
    ids=["channels", "bits", "alignment", "crossing", "jitter", "clock", "pll", "flag", "syncs", "colour"],
)
def test_a_broken_link_is_noticed(design, tmp_path, file, right, wrong, complaint):
    if complaint:
        with pytest.raises(VideoError, match=complaint):
            watched(ULX3S, design, tmp_path, file, right, wrong)
    else:
        [frame] = watched(ULX3S, design, tmp_path, file, right, wrong)
        assert not np.array_equal(frame, golden(design))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ulx3s", "icebreaker", "tang_nano_20k"])
def test_the_placed_netlist_draws_the_picture(tmp_path, name):
    """The netlist that nextpnr places, of a whole board of each family, shows the scene."""
    board = find_board(name, OpenBoard)
    built = small_design(board)
    elsewhere = re.findall(r"^module (\w+)", MODELS.read_text(), re.MULTILINE)
    cells, netlist = as_verilog(synthesise(board, built, tmp_path), board.flow, elsewhere)
    sources = [cells, netlist.replace(tmp_path / f"{name}.v")]
    [frame] = watch(board, sources, built.configuration, 1, tmp_path / "run", placed=True)
    assert np.array_equal(frame, golden(built))


# Bitstreams -----------------------------------------------------------------------------------------------------------


@pytest.mark.slow_sets(quick=["icebreaker"])
@pytest.mark.parametrize("board", BOARDS, ids=lambda board: board.name)
def test_a_small_bitstream(board, tmp_path):
    """The whole flow runs within the board's cells, and every clock is fast enough."""
    flow, output = FLOWS[board.flow], tmp_path / "out"
    outcome = make_bitstream(board, small_design(board, rows=60, units=1, allow_underrun=True), output)
    assert not outcome.missed
    report = json.loads((output / "report.json").read_text())
    logic, _, multipliers, memories = flow.cells
    assert outcome.cells[logic][0] > 300
    assert outcome.cells[logic][1] == board.elements
    assert outcome.cells[multipliers][1] == board.multipliers
    assert 0 < outcome.cells[multipliers][0] <= board.multipliers
    assert report["utilization"][memories]["available"] == board.memories
    assert len((output / f"{board.name}.{flow.bitstream}").read_bytes()) > 10_000
    assert json.loads((output / "result.json").read_text())["clocks"]["clk"] == list(outcome.clocks["clk"])
    if board.flow != "gowin":
        # nextpnr derives the clocks from the oscillator, by its own knowledge of PLLs.
        derived = report["fmax"]
        for net, (_, required) in outcome.clocks.items():
            [constraint] = [found["constraint"] for name, found in derived.items() if re.search(rf"\b{net}\b", name)]
            assert constraint == pytest.approx(required, rel=1e-3)
    if board == ULX3S:
        assert outcome.crossings["clk to shift_clk"][1] == pytest.approx(1000 / 125.9, rel=1e-3)
        # No simulation covers the PLL's charge pump and filter, and the pairs of pins.
        config = (output / "ulx3s.config").read_text()
        for setting in ("ICP_CURRENT 01100", "LPF_RESISTOR 0001000", "MFG_ENABLE_FILTEROPAMP 1", "MFG_GMCREF_SEL 10"):
            assert f"word: {setting}\n" in config
        assert config.count("BASE_TYPE OUTPUT_LVCMOS33D\nenum: PIOA.DATAMUX_ODDR IOLDO\n") == 4


@pytest.mark.parametrize(
    ("clk", "shift_clk", "crossing", "missed"),
    [(49.9, 300.0, 2.0, "clk"), (60.0, 124.0, 2.0, "shift_clk"), (60.0, 300.0, 8.1, "clk to shift_clk")],
)
def test_too_slow_gets_one_line(tmp_path, monkeypatch, capsys, clk, shift_clk, crossing, missed):
    clocks = {"clk": (clk, 50.0), "shift_clk": (shift_clk, 125.0)}
    outcome = Outcome({"TRELLIS_FF": (1, 2)}, clocks, {"clk to shift_clk": (crossing, 8.0)}, {})
    monkeypatch.setattr(bitstream, "make_bitstream", lambda *_, **__: outcome)
    with pytest.raises(UserError, match=f"^too slow: {missed}; the reports are in .+$"):
        bitstream.main([str(SMALL_SCENE), "--output", str(tmp_path)])
    assert capsys.readouterr().out.count("MISSED") == 1
