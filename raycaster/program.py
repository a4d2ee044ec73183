# SPDX-License-Identifier: MIT
"""Words that software writes to load a scene, in the order in which they go over the bus."""

from __future__ import annotations

from collections.abc import Iterator

from raycaster.configuration import Configuration
from raycaster.registers import register_map
from raycaster.scene import Basis, Light, Rectangle, Scene


def rectangle_fields(index: int, rectangle: Rectangle, config: Configuration) -> Iterator[tuple[str, dict[str, int]]]:
    """Yield the registers of an enabled rectangle and their fields; the one that enables it is last."""
    for corner, position in enumerate(rectangle.corners):
        yield f"rectangle[{index}].corner_{corner}", dict(zip("xyz", position, strict=True))
    if config.patterns:
        red, green, blue = rectangle.colour2 or (0, 0, 0)
        pattern = {"kind": rectangle.kind, "cell": rectangle.cell_code}
        yield f"rectangle[{index}].pattern", {"red": red, "green": green, "blue": blue, **pattern}
    red, green, blue = rectangle.colour
    look = {"red": red, "green": green, "blue": blue, "mirror": rectangle.quarters}
    yield f"rectangle[{index}].surface", {"enable": 1, **look}


def basis_fields(basis: Basis) -> Iterator[tuple[str, dict[str, int]]]:
    """Yield the registers of a camera's basis and their fields."""
    registers = register_map(1)
    for name, vector in zip(("forward", "right", "up"), basis, strict=True):
        widths = (field.width for field in registers[name].fields.values())
        parts = (part % (1 << width) for part, width in zip(vector, widths, strict=True))
        yield name, dict(zip("xyz", parts, strict=True))


def light_fields(light: Light | None) -> Iterator[tuple[str, dict[str, int]]]:
    """Yield the register of the light and its fields."""
    where = dict(zip("xyz", light.position, strict=True)) | {"shade": light.quarters} if light else {}
    yield "light", {**where, "on": int(light is not None)}


def scene_fields(scene: Scene, config: Configuration) -> Iterator[tuple[str, dict[str, int]]]:
    """Yield the registers of a whole scene and their fields; unused entries of the table are disabled.

    Args:
        scene: scene with at most as many rectangles as the table has entries; fixed rectangles are not written.
        config: the design; registers of features that it lacks are not written.
    """
    red, green, blue = scene.background
    yield "background", {"red": red, "green": green, "blue": blue}
    yield "camera", dict(zip("xyz", scene.camera.position, strict=True))
    if config.turn:
        yield from basis_fields(scene.camera.basis)
    if config.light:
        yield from light_fields(scene.light)
    for index, rectangle in enumerate(scene.rect if config.table else ()):
        yield from rectangle_fields(index, rectangle, config)
    for index in range(len(scene.rect), config.table):
        yield f"rectangle[{index}].surface", {"enable": 0}


def scene_words(scene: Scene, config: Configuration, reflections: int | None = None) -> list[tuple[int, int]]:
    """Return the word addresses and words that load a scene and start it; the last one commits.

    Args:
        scene: see `scene_fields`.
        config: see `scene_fields`.
        reflections: number of reflections, instead of the scene's own.
    """
    registers = register_map(*config.map)
    bounces = scene.reflections if reflections is None else reflections
    start = ("control", {"run": 1, "commit": 1, "reflections": bounces})
    return [
        (registers[name].address, registers[name].pack(**fields))
        for name, fields in (*scene_fields(scene, config), start)
    ]
