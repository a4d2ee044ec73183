# SPDX-License-Identifier: MIT
"""Walk through a scene: move its camera with keys and the mouse, and list what a driver writes for that."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.design.for_scene import Design, design_for
from raycaster.play.system import play_options
from raycaster.program import basis_fields, light_fields, scene_words
from raycaster.registers import register_map
from raycaster.rtl.engines import ENGINES
from raycaster.scene import Camera, Light, Scene

STEP = 3.0
"""World units per frame that a held button moves the camera."""

TURN = 2.0
"""Degrees per frame that a held button turns it."""

DRAG = 0.25
"""Degrees that the mouse turns it per pixel of the window."""

STEEPEST = 89.0
"""Steepest pitch in degrees, up or down; beyond the vertical, walking would change direction."""

WALKS = ("forward", "back", "left", "right", "rise", "sink")
"""Buttons that move the camera: level along the view, level across it, and along z."""

TURNS = ("turn left", "turn right", "look up", "look down")
"""Buttons that turn it."""


def design_to_walk(path: Path, options: Mapping[str, Any]) -> Design:
    """Choose the hardware for a walk through a scene: by default the fastest that holds it, with a camera that turns.

    Args:
        path: the scene file.
        options: the configuration's options, as given.

    Raises:
        UserError: the scene or an option is wrong; one line.
    """
    chosen = play_options(options)
    engine = ENGINES.get(chosen["engine"])
    if engine and "turn" in engine.facts.features:
        chosen = {"turn": True} | chosen
    return design_for(path, options, chosen)


class Walker:
    """A camera that walks level where it looks, within the world; along x if the design's camera does not turn.

    Args:
        scene: where it starts.
        config: the design.

    Attributes:
        light: the light, in a design that has one; None for none. It may be replaced between frames.
    """

    def __init__(self, scene: Scene, config: Configuration):
        self._config, self._scene = config, scene
        self._place = [float(value) for value in scene.camera.position]
        self._yaw, self._pitch = scene.camera.yaw, scene.camera.pitch
        self.light: Light | None = scene.light

    @property
    def camera(self) -> Camera:
        """The current camera, as in a scene file."""
        x, y, z = map(round, self._place)
        return Camera(position=(x, y, z), yaw=self._yaw, pitch=self._pitch, roll=self._scene.camera.roll)

    def move(self, held: Collection[str], drag: tuple[int, int] = (0, 0)) -> None:
        """Move and turn the camera for one frame.

        Args:
            held: the held buttons, of `WALKS` and `TURNS`.
            drag: pixels to the right and down that the mouse was dragged to turn the view.
        """
        if self._config.turn:
            yaw = TURN * (("turn right" in held) - ("turn left" in held)) + DRAG * drag[0]
            pitch = TURN * (("look up" in held) - ("look down" in held)) - DRAG * drag[1]
            self.turn(yaw)
            self._pitch = max(-STEEPEST, min(STEEPEST, self._pitch + pitch))
        angle = math.radians(self._yaw)
        along, across, upwards = (
            STEP * ((more in held) - (less in held)) for more, less in (WALKS[:2], WALKS[3:1:-1], WALKS[4:])
        )
        steps = (
            along * math.cos(angle) - across * math.sin(angle),
            along * math.sin(angle) + across * math.cos(angle),
            upwards,
        )
        self._place = [
            max(0, min(WORLD_SIZE - 1, place + step)) for place, step in zip(self._place, steps, strict=True)
        ]

    def turn(self, degrees: float) -> None:
        """Turn to the right by some degrees."""
        self._yaw = math.remainder(self._yaw + degrees, 360)

    def load(self) -> list[tuple[int, int]]:
        """List the word addresses and words that load the scene and start it."""
        return scene_words(self._scene, self._config)

    def writes(self) -> list[tuple[int, int]]:
        """List the word addresses and words that update the camera and the light; the last one commits."""
        registers, camera = register_map(*self._config.map), self.camera
        fields = [("camera", dict(zip("xyz", camera.position, strict=True)))]
        if self._config.turn:
            fields += basis_fields(camera.basis)
        if self._config.light:
            fields += light_fields(self.light)
        return [(registers[name].address, registers[name].pack(**values)) for name, values in fields] + self.load()[-1:]
