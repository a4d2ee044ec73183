# SPDX-License-Identifier: MIT
"""A scene as what software writes: words, in the order in which they go over the bus."""

from __future__ import annotations

from collections.abc import Iterator

from raycaster.registers import register_map
from raycaster.scene import Rectangle, Scene


def rectangle_fields(index: int, rectangle: Rectangle) -> Iterator[tuple[str, dict[str, int]]]:
    """The registers of an enabled rectangle and their fields, the one that enables it last."""
    for corner, position in enumerate(rectangle.corners):
        yield f"rectangle[{index}].corner_{corner}", dict(zip("xyz", position, strict=True))
    red, green, blue = rectangle.colour
    yield f"rectangle[{index}].surface", {"enable": 1, "red": red, "green": green, "blue": blue}


def scene_fields(scene: Scene, rectangles: int) -> Iterator[tuple[str, dict[str, int]]]:
    """The registers of a whole scene and their fields; entries of the table that it leaves are disabled.

    Args:
        scene: at most `rectangles` rectangles.
        rectangles: entries of the hardware's table; 0 where its rectangles are fixed, which takes those of any scene.
    """
    red, green, blue = scene.background
    yield "background", {"red": red, "green": green, "blue": blue}
    yield "camera", dict(zip("xyz", scene.camera.position, strict=True))
    for index, rectangle in enumerate(scene.rect if rectangles else ()):
        yield from rectangle_fields(index, rectangle)
    for index in range(len(scene.rect), rectangles):
        yield f"rectangle[{index}].surface", {"enable": 0}


def scene_words(scene: Scene, rectangles: int, reflections: int | None = None) -> list[tuple[int, int]]:
    """Word addresses and words that load a scene and start it: the last one commits.

    Args:
        scene: as for `scene_fields`.
        rectangles: as for `scene_fields`.
        reflections: instead of the scene's own.
    """
    registers = register_map(rectangles)
    bounces = scene.reflections if reflections is None else reflections
    start = ("control", {"run": 1, "commit": 1, "reflections": bounces})
    return [
        (registers[name].address, registers[name].pack(**fields))
        for name, fields in (*scene_fields(scene, rectangles), start)
    ]
