# SPDX-License-Identifier: MIT
"""The window on the simulated hardware, on a display that nobody sees."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from conftest import BUILD, ROOT
from PIL import Image

from raycaster.configuration import configure
from raycaster.errors import UserError
from raycaster.memory_map import BUTTON_NAMES
from raycaster.play import window
from raycaster.play.machine import Machine, build_machine
from raycaster.rtl.system import scene_player
from raycaster.rtl.system.camera_axis import STEP
from raycaster.scene import load_scene

MIRROR_ROOM = ROOT / "scenes" / "mirror_room.toml"
pygame = pytest.importorskip("pygame", reason="the extra play is not installed")


@pytest.fixture
def unseen(monkeypatch):
    """A display that SDL only pretends to have."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")


def test_the_game_is_played(unseen, tmp_path, capsys):
    pytest.importorskip("ziglang", reason="the extra firmware is not installed")
    shot = tmp_path / "shot.png"
    window.main(["--screen", "tiny", "--frames", "12", "--screenshot", str(shot), "--build", str(BUILD)])
    said = capsys.readouterr().out
    assert "fire: space or return" in said and "RayCaster 0." in said
    assert re.search(
        r"^12 frames, .* in [1-9]\d* of them, held against exact arithmetic, 0 pixels are wrong$", said, re.M
    )
    picture = np.array(Image.open(shot).convert("RGB"))
    assert picture.shape[0] > 96 and len(np.unique(picture.reshape(-1, 3), axis=0)) > 5


# Two clocks a pixel, and one.
@pytest.mark.parametrize("engine", ["exact", "beam"])
def test_a_walk_is_judged(engine):
    """What is shown while the camera moves is held against the scene that its registers hold."""
    scene = load_scene(MIRROR_ROOM)
    # Lost bits of a colour are no wrong pixels.
    config = configure(engine=engine, screen="tiny", colour_bits=5)
    judge = window.Judge(config)
    named = {name: 1 << bit for bit, name in enumerate(scene_player.BUTTONS)}
    path = [named["forward"]] * 4 + [named["left"] | named["up"]] * 2 + [named["up"] | named["down"]] + [0] * 3
    with Machine(build_machine(config, scene, BUILD), config) as machine:
        for held in path:
            frame = machine.frame(held)
            assert frame.clocks == config.screen_geometry.frame_cycles
            assert 0 < frame.busy < frame.clocks
            judge.look(frame)
            judge.finish()
    x, y, z = scene.camera.position
    assert frame.scene.camera == (x + 4 * STEP, y - 2 * STEP, z + 2 * STEP)
    assert (judge.pictures, judge.all_wrong) == (len(path), 0)
    torn = frame.picture.copy()
    torn[3, 5] ^= 255
    judge.look(replace(frame, picture=torn))
    judge.finish()
    assert judge.wrong == judge.all_wrong == 1


def test_keys_are_buttons(unseen):
    config = configure(engine="beam", screen="tiny")
    shown = window.Window(config, "test", window.GAME_KEYS, BUTTON_NAMES)
    try:
        assert shown.held() == 0
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_LEFT))
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_a))
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_SPACE))
        assert shown.held() == 1 << BUTTON_NAMES.index("left") | 1 << BUTTON_NAMES.index("fire")
        pygame.event.post(pygame.event.Event(pygame.KEYUP, key=pygame.K_LEFT))
        pygame.event.post(pygame.event.Event(pygame.KEYUP, key=pygame.K_SPACE))
        assert shown.held() == 1 << BUTTON_NAMES.index("left")
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_ESCAPE))
        assert shown.held() is None
    finally:
        shown.close()


def test_where_there_is_no_display(monkeypatch):
    for name in window.DISPLAYS:
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(UserError, match=r"^there is no display to open a window on; make game writes an animation"):
        window.main([])
