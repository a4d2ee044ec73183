# SPDX-License-Identifier: MIT
"""Scene files: a camera and a room of axis-parallel mirror rectangles, in TOML, checked on the way in."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from raycaster.configuration import WORLD_SIZE
from raycaster.errors import UserError

Coordinate = Annotated[int, Field(strict=True, ge=0, lt=WORLD_SIZE)]
Point = tuple[Coordinate, Coordinate, Coordinate]


class SceneError(UserError):
    """A scene file that is refused: the file, the place in it, and what was expected."""


def _parse_colour(value: object) -> tuple[int, int, int]:
    if isinstance(value, str) and re.fullmatch("#[0-9a-fA-F]{6}", value):
        red, green, blue = bytes.fromhex(value[1:])
        return red, green, blue
    if isinstance(value, tuple):
        return value
    raise ValueError('must be a colour such as "#c8c8b4"')


Channel = Annotated[int, Field(strict=True, ge=0, le=255)]
Colour = Annotated[tuple[Channel, Channel, Channel], BeforeValidator(_parse_colour)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Camera(_Strict):
    position: Point


class Rectangle(_Strict):
    """A mirror between two opposite corners, parallel to one of the planes x = 0, y = 0, z = 0."""

    corners: tuple[Point, Point]
    colour: Colour
    name: str = ""

    @model_validator(mode="after")
    def _has_a_plane(self) -> Rectangle:
        first, second = self.corners
        if not any(a == b for a, b in zip(first, second, strict=True)):
            raise ValueError(
                f"corners: {list(first)} and {list(second)} must share a coordinate (the rectangle's plane); none is the same"
            )
        return self

    @property
    def axis(self) -> int:
        """0, 1 or 2: the first of x, y, z that is the same in both corners."""
        first, second = self.corners
        return next(axis for axis in range(3) if first[axis] == second[axis])


class Scene(_Strict):
    """A scene file's contents. Rectangles keep the file's order, which settles ties of depth."""

    title: Annotated[str, Field(strict=True)] = ""
    rows: Literal[240, 200, 180] = 240
    reflections: Annotated[int, Field(strict=True, ge=0, le=2)] = 1
    background: Colour = (0, 0, 0)
    camera: Camera
    rect: Annotated[tuple[Rectangle, ...], Field(min_length=1)]


def load_scene(path: Path | str, rectangles: int | None = None) -> Scene:
    """Read a scene file.

    Args:
        path: the TOML file.
        rectangles: how many the hardware holds, or None for no limit.

    Raises:
        SceneError: the file cannot be read, is not TOML, or is not a scene; one line says where and what was expected.
    """
    path = Path(path)
    try:
        contents = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise SceneError(f"{path}: is not UTF-8 text; a scene is a TOML file") from None
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"{path}: is not TOML: {error}") from None
    try:
        scene = Scene.model_validate(contents)
    except ValidationError as error:
        raise SceneError(f"{path}: {_first_complaint(error, contents)}") from None
    if rectangles is not None and len(scene.rect) > rectangles:
        raise SceneError(
            f"{path}: rect: {len(scene.rect)} rectangles, but the hardware holds {rectangles}; "
            f"remove some or build it with RECTANGLES={len(scene.rect)}"
        )
    return scene


def _first_complaint(error: ValidationError, contents: dict) -> str:
    """One line for the first thing that is wrong: its place, what was expected, and what stood there."""
    first = error.errors()[0]
    place = ""
    for key in first["loc"]:
        place += f"[{key}]" if isinstance(key, int) else f".{key}" if place else key
    if first["loc"][:1] == ("rect",) and len(first["loc"]) > 1:
        name = contents["rect"][first["loc"][1]].get("name") if isinstance(contents["rect"][first["loc"][1]], dict) else None
        if name:
            place += f' ("{name}")'
    match first["type"]:
        case "missing":
            expected = "is missing"
        case "extra_forbidden":
            expected = "is not a key of scene files here"
        case "value_error":
            expected = str(first["ctx"]["error"])
        case _:
            expected = first["msg"][0].lower() + first["msg"][1:]
    shown = repr(first["input"])
    given = "" if first["type"] in ("missing", "extra_forbidden") or len(shown) > 60 else f", not {shown}"
    return f"{place}: {expected}{given}"
