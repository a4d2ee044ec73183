# SPDX-License-Identifier: MIT
"""The window on the simulated hardware, on a display that nobody sees."""

from __future__ import annotations

import time

import numpy as np
import pytest
from conftest import BUILD, ROOT
from PIL import Image

from raycaster.configuration import configure
from raycaster.errors import UserError
from raycaster.golden import exact
from raycaster.memory_map import BUTTON_NAMES
from raycaster.rtl import scene_player
from raycaster.rtl.camera_axis import STEP
from raycaster.scene import load_scene
from raycaster.verif import window
from raycaster.verif.machine import Machine, build_machine

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
    assert "fire: space or return" in said and "RayCaster 0." in said and "12 frames, " in said
    picture = np.array(Image.open(shot).convert("RGB"))
    assert picture.shape[0] > 96 and len(np.unique(picture.reshape(-1, 3), axis=0)) > 5


def test_a_walk_is_followed():
    """Where the window takes the camera to be, the hardware has it: a picture from there is exact."""
    scene = load_scene(MIRROR_ROOM)
    # Lost bits of a colour are no wrong pixels.
    config = configure(engine="beam", screen="tiny", colour_bits=5)
    walk = window.Walk(scene, config)
    named = {name: 1 << bit for bit, name in enumerate(scene_player.BUTTONS)}
    with Machine(build_machine(config, scene, BUILD), config) as machine:
        path = [named["forward"]] * 4 + [named["left"] | named["up"]] * 2 + [named["up"] | named["down"]]
        for held in path:
            walk.follow(held, machine.frame(held))
        x, y, z = scene.camera.position
        assert walk.camera == (x + 4 * STEP, y - 2 * STEP, z + 2 * STEP)
        assert walk.wrong is None
        deadline = time.monotonic() + 60
        while walk.wrong is None and time.monotonic() < deadline:
            frame = machine.frame(0)
            walk.follow(0, frame)
            assert frame.clocks == config.screen_geometry.frame_cycles
        assert walk.wrong == 0
        assert walk._count(frame.picture, scene.camera.position) > 0, "the camera did not move"
    assert frame.picture.shape == exact.render(scene, config.screen_geometry).shape


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
