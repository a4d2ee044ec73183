# SPDX-License-Identifier: MIT
"""The system with a processor boots a program that drives the ray tracer and the serial port and reads the buttons."""

from __future__ import annotations

import re

import numpy as np
import pytest
from conftest import BUILD, ROOT, SMALL_SCENE, broken
from PIL import Image
from small_program import write_program

from raycaster.design.decide import configure
from raycaster.errors import UserError
from raycaster.golden.frames import scene_cycles
from raycaster.memory_map import BUTTON_NAMES, MEMORY_WORDS
from raycaster.play import game
from raycaster.play.system import FASTEST, check_program, play
from raycaster.scene import load_scene
from raycaster.sim.simulator import SYSTEM_BENCH, SimulationError, build_model, convert

MIRROR_ROOM = ROOT / "raycaster" / "scenes" / "mirror_room.toml"

LEFT, RIGHT, UP, _, FIRE = (1 << index for index in range(len(BUTTON_NAMES)))

SPAN = {"engine": "span", "screen": "tiny"}
EXACT = {"engine": "exact", "screen": "tiny", "rectangles": 3}
RUNS = {
    "span": ("verilator", {**SPAN, "units": 6}, MIRROR_ROOM, [0, 0, LEFT, LEFT, LEFT, RIGHT, RIGHT, LEFT | FIRE, UP]),
    "late": ("verilator", SPAN, MIRROR_ROOM, [0, *12 * [LEFT]]),
    "play": ("verilator", FASTEST, MIRROR_ROOM, [0, 0, LEFT, LEFT, RIGHT | FIRE]),
    "seed": ("verilator", {"engine": "seed", "screen": "tiny"}, MIRROR_ROOM, [0, 0, LEFT, LEFT, RIGHT]),
    "exact": ("icarus", EXACT, SMALL_SCENE, [0, 0, LEFT, 0]),
}
"""Simulator, options of the design, scene, and buttons of each frame."""


@pytest.mark.slow_sets(quick=["exact"])
@pytest.mark.parametrize("run", RUNS)
def test_a_program_runs(run, output, tmp_path):
    """Every pixel matches the golden model of the committed words; text and pictures are as the program makes them.

    A frame drawn into a list is shown a frame later or, if it is late, some more.
    """
    simulator, options, scene, held = RUNS[run]
    configuration = configure(**options)
    program = write_program(scene, configuration, tmp_path)
    model = build_model(configuration, simulator, build=BUILD, bench=SYSTEM_BENCH)
    result = play(model, program, held, output / "play")
    assert result["frames"] == len(held)
    assert (result["again"] > 0) == (run == "late")
    delay = 1
    if configuration.facts.whole_frames:
        refresh = configuration.screen_geometry.frame_cycles
        delay += scene_cycles(load_scene(scene), configuration) // refresh + 1
    assert result["shown"] == len(held) - delay
    greeting, letters = (output / "play" / "uart.txt").read_text().split("\n")
    assert greeting == "RAYCMEgo"
    # Buttons held when a frame starts are sent in it; the greeting delays the first, and the last is not yet sent.
    sent = "".join(chr(ord("@") + one) for one in held)
    assert len(letters) >= len(held) - 2 and letters in sent
    if run == "late":
        return
    # Buttons held in a frame move the camera of the next.
    frames = [np.array(Image.open(output / "play" / f"frame_{number:04}.png")) for number in range(len(held))]
    for number in range(delay + 1, len(held)):
        moves = held[number - delay] & 3 != 0
        assert (frames[number] != frames[number - 1]).any() == moves, number


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "right", "wrong", "complaint"),
    [
        ("uart_transmitter", "bits_left <= 10;", "bits_left <= 9;", "start or stop bit"),
        ("camera_mem", "    lives_0[18:10],", "    lives_0[18:10] ^ 9'd1,", "pixels are wrong"),
        ("word_memory", "word <= memory[address];", "word <= ~memory[address];", "the processor halted"),
        ("scene_word", "if (bus_go_live) begin", "if (1'b1) begin", "pixels are wrong"),
    ],
    ids=["serial-port", "camera", "memory", "torn-commit"],
)
def test_a_fault_is_noticed(module, right, wrong, complaint, output, tmp_path):
    """The bench finds faults behind the ray tracer's bus; faults in front of it show in text and pictures."""
    configuration = configure(**EXACT)
    program = write_program(SMALL_SCENE, configuration, tmp_path)
    files = broken(convert(configuration, BUILD, system=True), tmp_path, module, right, wrong)
    model = build_model(configuration, "icarus", build=tmp_path, verilog=files, bench=SYSTEM_BENCH)
    with pytest.raises(SimulationError, match=complaint):
        play(model, program, [0, 0, 0], output / "play")


@pytest.mark.parametrize("text", ["hello", "100000000", "0\n" * (MEMORY_WORDS + 1)])
def test_a_bad_program_file_is_refused(text, tmp_path):
    path = tmp_path / "program.hex"
    path.write_text(text)
    with pytest.raises(UserError, match=r"program\.hex: expected "):
        check_program(path)
    with pytest.raises(UserError, match="nowhere"):
        check_program(tmp_path / "nowhere.hex")


@pytest.mark.slow
def test_a_recorded_game(capsys, tmp_path):
    """The command writes pictures drawn by the firmware on the tiny screen."""
    assert game.main(["--screen", "tiny", "--frames", "14", "--build", str(BUILD), "--output", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert re.search(r"RayCaster \d+\.\d+, engine span, units 3,", said), said
    assert "ray tracer:" not in said
    assert len(list(tmp_path.glob("frame_*.png"))) == 14
    # The animation merges identical frames.
    assert 2 <= Image.open(tmp_path / game.ANIMATION).n_frames <= 14
    assert Image.open(tmp_path / game.SHEET).size == (3 * 320 + 2 * 8, 3 * 240 + 2 * 8)
