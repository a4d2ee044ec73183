# SPDX-License-Identifier: MIT
"""A walk through a scene: what keys and the mouse do to its camera, and what a driver writes for that."""

from __future__ import annotations

import math
from collections.abc import Collection

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.program import basis_fields, scene_words
from raycaster.registers import register_map
from raycaster.scene import Camera, Scene

STEP = 3.0
"""World units that a held button moves the camera in a frame."""

TURN = 2.0
"""Degrees that a held button turns it in a frame."""

DRAG = 0.25
"""Degrees that the mouse turns it, a pixel of the window."""

STEEPEST = 89.0
"""Degrees up or down beyond which walking on would turn around."""

WALKS = ("forward", "back", "left", "right", "rise", "sink")
"""Buttons that move the camera: level along the view, level across it, and along z."""

TURNS = ("turn left", "turn right", "look up", "look down")
"""Buttons that turn it."""


class Walker:
    """A camera that walks where it looks, level, within the world; where the design's camera does not turn, along x.

    Args:
        scene: where it starts.
        config: the design.
    """

    def __init__(self, scene: Scene, config: Configuration):
        self._config, self._scene = config, scene
        self._place = [float(value) for value in scene.camera.position]
        self._yaw, self._pitch = scene.camera.yaw, scene.camera.pitch

    @property
    def camera(self) -> Camera:
        """The present one, as a scene file has it."""
        x, y, z = map(round, self._place)
        return Camera(position=(x, y, z), yaw=self._yaw, pitch=self._pitch, roll=self._scene.camera.roll)

    def move(self, held: Collection[str], drag: tuple[int, int] = (0, 0)) -> None:
        """A frame's time passes.

        Args:
            held: buttons of `WALKS` and `TURNS`.
            drag: pixels to the right and down by which the mouse was moved to turn the view.
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
        """Turn to the right."""
        self._yaw = math.remainder(self._yaw + degrees, 360)

    def load(self) -> list[tuple[int, int]]:
        """Word addresses and words that load the scene and start it."""
        return scene_words(self._scene, self._config)

    def writes(self) -> list[tuple[int, int]]:
        """The same for the camera alone; the last commits."""
        registers, camera = register_map(self._config.table), self.camera
        fields = [("camera", dict(zip("xyz", camera.position, strict=True)))]
        if self._config.turn:
            fields += basis_fields(camera.basis)
        return [(registers[name].address, registers[name].pack(**values)) for name, values in fields] + self.load()[-1:]
