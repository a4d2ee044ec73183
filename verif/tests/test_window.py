# SPDX-License-Identifier: MIT
"""The window on the simulated hardware, on a dummy display."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pygame
import pytest
from conftest import BUILD, ROOT
from PIL import Image

from raycaster.design.decide import configure
from raycaster.errors import UserError
from raycaster.memory_map import BUTTON_NAMES
from raycaster.play import game, window
from raycaster.play.machine import Frame, Machine, build_machine
from raycaster.play.walk import Walker, design_to_walk
from raycaster.scene import UNTURNED, Camera, load_scene, packaged_scenes
from raycaster.sim.simulator import SimulationError

MIRROR_ROOM = ROOT / "raycaster" / "scenes" / "mirror_room.toml"


@pytest.fixture
def unseen(monkeypatch):
    """Use SDL's dummy display."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")


@pytest.mark.slow
def test_the_game_is_played(unseen, tmp_path, capsys):
    shot = tmp_path / "shot.png"
    window.main(["--screen", "tiny", "--frames", "12", "--screenshot", str(shot), "--build", str(BUILD)])
    said = capsys.readouterr().out
    assert "fire: space or return" in said and re.search(r"RayCaster \d+\.\d+", said), said
    assert re.search(
        r"^12 frames, .* in [1-9]\d* of them, compared with exact arithmetic, 0 pixels are wrong$", said, re.M
    )
    picture = np.array(Image.open(shot).convert("RGB"))
    assert picture.shape[0] > 96 and len(np.unique(picture.reshape(-1, 3), axis=0)) > 5


@pytest.mark.slow
def test_a_walk_is_played(unseen, monkeypatch, capsys):
    """A held key turns the camera in each frame."""
    held, look, frames = window.Window.held, window.Judge.look, []

    def press(shown: window.Window) -> int | None:
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_RIGHT))
        return held(shown)

    def watch(judge: window.Judge, frame: Frame) -> None:
        frames.append(frame)
        look(judge, frame)

    monkeypatch.setattr(window.Window, "held", press)
    monkeypatch.setattr(window.Judge, "look", watch)
    design = ["--screen", "tiny", "--units", "1", "--colour-bits", "5", "--build", str(BUILD)]
    window.main(["mirror_room", *design, "--frames", "16"])
    assert re.search(r"^16 frames, .* in [1-9]\d* of them, .* 0 pixels are wrong$", capsys.readouterr().out, re.M)
    room, shown = load_scene(MIRROR_ROOM), frames[-1].scene
    assert shown.rectangles.enabled.sum() == len(room.rect)
    assert shown.basis in [room.camera.model_copy(update={"yaw": 2.0 * turns}).basis for turns in range(1, 17)]


# Two clocks per pixel, and one, with and without a camera that turns.
@pytest.mark.slow_sets("span-False", "exact")
@pytest.mark.parametrize(("engine", "turn"), [("exact", True), ("span", False), ("span", True)])
def test_a_walk_is_judged(engine, turn):
    """Frames shown while the camera moves are compared with the scene in the registers."""
    scene = load_scene(MIRROR_ROOM)
    # Dropped colour bits do not count as wrong pixels.
    config = configure(engine=engine, screen="tiny", colour_bits=5, turn=turn)
    judge = window.Judge(config)
    walker = Walker(scene, config)
    path = [["turn right"]] * 3 + [["forward", "look down"]] * 4 + [["left", "rise"]] * 2 + [["rise", "sink"], []]
    with Machine(build_machine(config, BUILD, processor=False), config) as machine:
        machine.show(walker.load())
        for held in path:
            walker.move(held)
            frame = machine.show(walker.writes())
            assert frame.clocks == config.screen_geometry.frame_cycles
            assert 0 < frame.busy <= frame.clocks
            judge.look(frame)
            judge.finish()
            assert frame.scene.camera == walker.camera.position
            assert frame.scene.basis == (walker.camera.basis if turn else UNTURNED)
    assert (judge.pictures, judge.all_wrong) == (len(path), 0)
    torn = frame.picture.copy()
    torn[3, 5] ^= 255
    judge.look(replace(frame, picture=torn))
    judge.finish()
    assert judge.wrong == judge.all_wrong == 1


def drawn(arguments: list[str], tmp_path: Path, capsys) -> list[bytes]:
    """Draw four frames on the tiny screen by the command, which checks them; return the pictures."""
    output = tmp_path / "film"
    design = ["--screen", "tiny", "--units", "1", "--build", str(BUILD)]
    assert game.main([*arguments, "--frames", "4", *design, "--output", str(output)]) == 0
    assert "4 frames, 0 pixels differ from exact arithmetic" in capsys.readouterr().out
    assert (output / "game.webp").exists()
    return [(output / f"frame_{number:04}.png").read_bytes() for number in range(4)]


@pytest.mark.slow_sets("2")
@pytest.mark.parametrize("pixels", ["1", "2"])
def test_a_camera_looks_around(tmp_path, capsys, pixels):
    """The walk's design looks right, ahead, left and ahead again."""
    design = ["--colour-bits", "5", "--pixels", pixels]
    right, ahead, left, again = drawn(["mirror_room", *design], tmp_path, capsys)
    assert ahead == again and len({right, ahead, left}) == 3


@pytest.mark.slow
def test_a_light_goes_around_the_room(tmp_path, capsys):
    """A quarter of the circle per frame, with a camera that stands still."""
    assert len(set(drawn(["evening"], tmp_path, capsys))) == 4
    light = load_scene(ROOT / "raycaster" / "scenes" / "evening.toml").light
    places = [game.circling(light, quarters / 4).position for quarters in range(5)]
    assert places[0] == places[4] == light.position and len(set(places)) == 4
    assert all(0 <= value < 512 for place in places for value in place)
    with pytest.raises(UserError, match="seed engine"):
        game.main(["evening", "--screen", "tiny", "--engine", "seed", "--output", str(tmp_path / "none")])


def test_a_wrong_film_fails(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(game, "film_scene", Mock(return_value=3))
    monkeypatch.setattr(game, "write_animation", Mock())
    assert game.main(["mirror_room", "--output", str(tmp_path)]) == 1
    assert "3 pixels differ" in capsys.readouterr().out
    monkeypatch.setattr(game, "build_model", Mock())
    monkeypatch.setattr(game, "play", Mock(side_effect=SimulationError("frame 2: 3 pixels are wrong")))
    assert game.main(["--build", str(tmp_path)]) == 1
    assert capsys.readouterr().err == "frame 2: 3 pixels are wrong\n"


def test_a_simulation_that_ends():
    with pytest.raises(SimulationError, match="the simulated system ended"):
        Machine([sys.executable, "-c", ""], configure(engine="span", screen="tiny"))


@pytest.mark.slow
def test_a_walk_through_a_level():
    """The design has room for it, unless a size is given; each picture of a walk out of the court is right."""
    path, options = packaged_scenes()["hall_of_mirrors"], {"screen": "tiny", "units": "1"}
    with pytest.raises(UserError, match=r"113 rectangles, but the hardware holds 12; .* --rectangles 113$"):
        design_to_walk(path, {**options, "rectangles": "12"})
    design = design_to_walk(path, options)
    config = design.configuration
    assert (config.rectangles, config.units, config.turn) == (113, 1, True)
    walker = Walker(design.shown, config)
    with Machine(build_machine(config, BUILD, processor=False), config) as machine:
        machine.show(walker.load())
        for _ in range(8):
            for held in (["forward"], ["forward"], ["forward", "turn right"]):
                walker.move(held)
            assert machine.show(walker.writes()).wrong(config) == 0


def test_a_walk_goes_where_it_looks():
    scene = load_scene(MIRROR_ROOM)
    scene = scene.model_copy(update={"camera": Camera(position=(100, 200, 300), roll=5.0)})
    turning = Walker(scene, configure(engine="span", screen="tiny", turn=True))
    for _ in range(45):
        turning.move(["turn right"])
    turning.move([], (-80, 40))
    assert (turning.camera.yaw, turning.camera.pitch, turning.camera.roll) == (70.0, -10.0, 5.0)
    turning.move([], (80, -400))
    assert (turning.camera.yaw, turning.camera.pitch) == (90.0, 89.0)
    # The walk stays level, however steeply the camera looks.
    turning.move(["forward"])
    turning.move(["forward", "right"])
    assert turning.camera.position == (97, 206, 300)
    for _ in range(200):
        turning.move(["back", "rise"])
    assert turning.camera.position == (97, 0, 511)
    straight = Walker(scene, configure(engine="seed", screen="tiny"))
    straight.move(["turn right", "look up", "forward", "left"], (10, 10))
    assert (straight.camera.position, straight.camera.yaw, straight.camera.pitch) == ((103, 197, 300), 0.0, 0.0)


def test_keys_are_buttons(unseen):
    left, fire = (1 << BUTTON_NAMES.index(name) for name in ("left", "fire"))
    shown = window.Window(configure(engine="span", screen="tiny"), "test", window.GAME_KEYS, BUTTON_NAMES)

    def held(kind: int, *events: dict) -> int | None:
        for event in events:
            pygame.event.post(pygame.event.Event(kind, **event))
        return shown.held()

    try:
        assert shown.held() == 0
        keys = [{"key": key} for key in (pygame.K_LEFT, pygame.K_a, pygame.K_SPACE)]
        assert held(pygame.KEYDOWN, *keys) == left | fire
        # Another key still holds the same button.
        assert held(pygame.KEYUP, keys[0], keys[2]) == left
        moves = [((3, -4), 1), ((2, 1), 1), ((9, 9), 0)]
        dragged = [{"rel": rel, "buttons": (button, 0, 0), "pos": (0, 0)} for rel, button in moves]
        assert (held(pygame.MOUSEMOTION, *dragged), shown.drag) == (left, (5, -3))
        assert (shown.held(), shown.drag) == (left, (0, 0))
        assert held(pygame.KEYDOWN, {"key": pygame.K_ESCAPE}) is None
    finally:
        shown.close()


def test_without_a_display(monkeypatch):
    for name in window.DISPLAYS:
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(UserError, match=r"^there is no display to open a window on; raycaster game writes"):
        window.main([])
