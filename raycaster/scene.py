# SPDX-License-Identifier: MIT
"""Scene files: a camera and a room of axis-parallel mirror rectangles, in TOML, checked when read."""

from __future__ import annotations

import importlib.util
import io
import json
import math
import re
import sys
import tomllib
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationError,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import CoreSchema, ErrorDetails

from raycaster.complaints import LONGEST_SHOWN, as_typed, did_you_mean
from raycaster.configuration import MOST_RECTANGLES, MOST_REFLECTIONS, WORLD_SIZE
from raycaster.errors import UserError, listed
from raycaster.places import is_byte

BASIS_SCALE = 256
"""Length of a vector in a camera's basis."""

UNTURNED = ((BASIS_SCALE, 0, 0), (0, BASIS_SCALE, 0), (0, 0, BASIS_SCALE))
"""Forward, right and up of a camera that is not turned."""

PATTERNS = ("plain", "checker", "rows", "columns")
"""Pattern names, in the order of their register codes."""

PATTERN_KEYS = ("colour2", "cell")
"""Keys of a rectangle that only a pattern has."""

CELLS = (8, 16, 32, 64, 128, 256)
"""Sizes of a pattern's cells, in world units, in the order of their register codes."""


class SceneError(UserError):
    """A refused scene file; the text names the file, the place in it, and what was expected."""


# Error messages, except those of the rules for values; the first four are listed by pydantic's error types.
COMPLAINTS = {
    "missing": "is missing",
    "extra_forbidden": "is not a key of scene files; the keys here are {keys}",
    "model_type": "must be a table",
    "string_type": "must be a string in quotes",
    "no_colour2": "a pattern has a second colour; give colour2 with {pattern}",
    "no_pattern": f"{{key}} is for a pattern; give pattern = {listed(map(json.dumps, PATTERNS[1:]))}",
    "too_many": (
        "rect: {count} rectangles, but the hardware holds {rectangles}; remove some or build it with {option}"
    ),
    "far_too_many": "rect: {count} rectangles, but no hardware holds more than {most}; remove some",
    "encoding": "is not UTF-8 text; a scene is a TOML file",
    "heading": "head each rectangle with [[rect]]",
    "syntax": "is not TOML at line {number}{line} ({reason})",
    "digits": "has a number of {count:,} digits at line {number}; no number of a scene has more than 3",
}

MOST_BYTES = 1_000_000
"""Size in bytes of the largest scene file that is read."""

MOST_DOTS_SQUARED = 10**7
"""Largest sum, over a file's lines, of the squared number of dots, which tomllib parses in a fraction of a second."""


_NO_NAME = re.compile("[\\0-\\x1f\\x7f-\\x9f\\ud800-\\udfff]")
"""Characters that are allowed in a file's name, but not in the simulators' results, which are XML."""


@dataclass(frozen=True, eq=False)
class _Check:
    """A rule for a value in a scene file, stated once: pydantic applies it, and the model's JSON schema contains it.

    In the schema, a checked value has a list `checks`: for each rule its `kind`, which is the function's name, its
    `expected`, `after` and parameters.

    Attributes:
        holds: returns True if a value keeps the rule with these parameters.
        expected: text about a value that breaks the rule.
        parameters: parameters of `holds`, by name.
        after: True if the rule applies to a value whose parts have been checked.
    """

    holds: Callable[..., bool]
    expected: str
    parameters: Mapping[str, object] = field(default_factory=dict)
    after: bool = False

    def __call__(self, value: object) -> object:
        """Return the value if it keeps the rule.

        Raises:
            ValueError: the value breaks the rule.
        """
        if not self.holds(value, **self.parameters):
            raise ValueError(self.expected)
        return value

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        validator = AfterValidator(self) if self.after else BeforeValidator(self)
        return validator.__get_pydantic_core_schema__(source, handler)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, object]:
        described: dict[str, Any] = handler(schema)
        rule = {"kind": self.holds.__name__.strip("_"), "expected": self.expected, "after": self.after}
        return {**described, "checks": [*described.get("checks", []), {**rule, **self.parameters}]}


def _whole(value: object, lowest: int, highest: int) -> bool:
    # A bool is an int to Python, but not to TOML.
    return type(value) is int and lowest <= value <= highest


def _items(value: object, count: int | None) -> bool:
    return isinstance(value, list | tuple) and (bool(value) if count is None else len(value) == count)


def _choice(value: object, choices: Sequence[object], whole: bool = False) -> bool:
    # A bool is a number to Python, but not to TOML.
    return value in choices and not isinstance(value, bool) and not (whole and isinstance(value, float))


def _angle(value: object, largest: int) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= largest


def _colour(value: object, pattern: str) -> bool:
    return isinstance(value, tuple) or (isinstance(value, str) and bool(re.fullmatch(pattern, value)))


def _plane(corners: tuple[Point, Point]) -> bool:
    return any(a == b for a, b in zip(*corners, strict=True))


def _integer(lowest: int, highest: int) -> _Check:
    return _Check(_whole, f"must be a whole number {lowest}..{highest}", {"lowest": lowest, "highest": highest})


def _channels(colour: str | tuple[int, int, int]) -> tuple[int, int, int]:
    red, green, blue = colour if isinstance(colour, tuple) else bytes.fromhex(colour[1:])
    return red, green, blue


Coordinate = Annotated[int, _integer(0, WORLD_SIZE - 1)]
Point = Annotated[tuple[Coordinate, Coordinate, Coordinate], _Check(_items, "must be a point, [x, y, z]", {"count": 3})]
Corners = Annotated[
    tuple[Point, Point],
    _Check(_items, "must be two opposite corners, [[x, y, z], [x, y, z]]", {"count": 2}),
    _Check(_plane, "must have the same x, y or z in both corners, the rectangle's plane", after=True),
]
Channel = Annotated[int, _integer(0, 255)]
Colour = Annotated[
    tuple[Channel, Channel, Channel],
    BeforeValidator(_channels),
    WithJsonSchema({"type": "string"}),
    _Check(_colour, 'must be a colour such as "#c8c8b4"', {"pattern": "#[0-9a-fA-F]{6}"}),
]
Rows = Annotated[
    Literal[240, 200, 180], _Check(_choice, "must be 240, 200 or 180", {"choices": (240, 200, 180), "whole": True})
]
Angle = Annotated[float, _Check(_angle, "must be an angle in degrees, -360..360", {"largest": 360})]
Shade = Annotated[float, _Check(_choice, "must be 0, 0.25, 0.5 or 0.75", {"choices": (0, 0.25, 0.5, 0.75)})]
Mirror = Annotated[float, _Check(_choice, "must be 0, 0.25, 0.5, 0.75 or 1", {"choices": (0, 0.25, 0.5, 0.75, 1)})]
if TYPE_CHECKING:
    PatternName = str
else:
    PatternName = Literal[*PATTERNS]
Pattern = Annotated[PatternName, _Check(_choice, f"must be {listed(map(json.dumps, PATTERNS))}", {"choices": PATTERNS})]
CellSize = Annotated[int, _Check(_choice, f"must be {listed(CELLS)}", {"choices": CELLS, "whole": True})]
Basis = tuple[tuple[int, int, int], tuple[int, int, int], tuple[int, int, int]]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


def _scaled(x: float, y: float, z: float) -> tuple[int, int, int]:
    return round(x * BASIS_SCALE), round(y * BASIS_SCALE), round(z * BASIS_SCALE)


class Camera(_Strict):
    """Position where all rays start, and angles of the view in degrees; unturned, it is along x with z up.

    Positive yaw turns from x towards y, positive pitch looks up, and positive roll lifts the right side. Roll is
    applied first, yaw last.
    """

    position: Point
    yaw: Angle = 0.0
    pitch: Angle = 0.0
    roll: Angle = 0.0

    @property
    def basis(self) -> Basis:
        """Forward, right and up as in the registers: x, y, z of each vector, times 256 and rounded."""
        angles = (math.radians(angle) for angle in (self.yaw, self.pitch, self.roll))
        (cy, sy), (cp, sp), (cr, sr) = ((math.cos(angle), math.sin(angle)) for angle in angles)
        forward = _scaled(cy * cp, sy * cp, sp)
        right = _scaled(-sy * cr - cy * sp * sr, cy * cr - sy * sp * sr, cp * sr)
        up = _scaled(sy * sr - cy * sp * cr, -cy * sr - sy * sp * cr, cp * cr)
        return forward, right, up

    @property
    def turned(self) -> bool:
        """True if the view is not along x, or not upright."""
        return self.basis != UNTURNED


class Light(_Strict):
    """A point light: points that it reaches keep their colour, all others keep the fraction `shade` of it."""

    position: Point
    shade: Shade = 0.5

    @property
    def quarters(self) -> int:
        """Fraction of the colour that is left in the dark, in quarters: 0..3."""
        return int(4 * self.shade)


class Rectangle(_Strict):
    """A rectangle between two opposite corners, parallel to one of the planes x = 0, y = 0, z = 0."""

    corners: Corners
    colour: Colour
    name: str = ""
    mirror: Mirror = 0.5
    pattern: Pattern = "plain"
    colour2: Colour | None = None
    cell: CellSize = 32

    @model_validator(mode="after")
    def _check_pattern(self) -> Rectangle:
        if self.pattern != "plain" and self.colour2 is None:
            raise ValueError(COMPLAINTS["no_colour2"].format(pattern=self.pattern))
        if self.pattern == "plain" and (useless := [key for key in PATTERN_KEYS if key in self.model_fields_set]):
            raise ValueError(COMPLAINTS["no_pattern"].format(key=useless[0]))
        return self

    @property
    def quarters(self) -> int:
        """Reflectivity in quarters: 0..4."""
        return int(4 * self.mirror)

    @property
    def kind(self) -> int:
        """Register code of the pattern, an index of `PATTERNS`."""
        return PATTERNS.index(self.pattern)

    @property
    def cell_code(self) -> int:
        """Register code of the cell's size: log2, minus three."""
        return CELLS.index(self.cell)

    @property
    def axis(self) -> int:
        """0, 1 or 2: the first of x, y, z that is the same in both corners."""
        first, second = self.corners
        return next(axis for axis in range(3) if first[axis] == second[axis])


class Scene(_Strict):
    """A scene file's contents. Rectangles keep the file's order; of two at equal depth, the earlier is seen."""

    title: str = ""
    rows: Rows = 240
    reflections: Annotated[int, _integer(0, MOST_REFLECTIONS)] = 1
    background: Colour = (0, 0, 0)
    camera: Camera
    light: Light | None = None
    rect: Annotated[
        tuple[Rectangle, ...], _Check(_items, "must be one or more tables, each headed [[rect]]", {"count": None})
    ]

    @property
    def needs(self) -> dict[str, bool]:
        """Configuration options for optional features of scenes, each True if the picture needs it."""
        return {
            "turn": self.camera.turned,
            "materials": any(rectangle.mirror != Rectangle.model_fields["mirror"].default for rectangle in self.rect),
            "patterns": any(rectangle.pattern != "plain" for rectangle in self.rect),
            "light": self.light is not None,
        }

    def lacks(self, features: Collection[str]) -> list[str]:
        """Return the options that the picture needs, except these."""
        return [name for name, is_needed in self.needs.items() if is_needed and name not in features]


def load_scene(path: Path | str, rectangles: int | None = None) -> Scene:
    """Read a scene file.

    Args:
        path: the TOML file.
        rectangles: number of rectangles that the hardware holds, or None for no limit.

    Raises:
        SceneError: the file cannot be read, is not TOML, or is not a scene; one line says where and what was expected.
    """
    path = Path(path)
    if any(map(is_byte, path.stem)):
        raise SceneError(f"{path}: has a name that is not UTF-8, which the simulators' results cannot have; rename it")
    if not path.stem.strip(".") or _NO_NAME.search(path.stem):
        raise SceneError(
            f"{path}: expected a name that is not all dots and has no control characters, for use in outputs; rename it"
        )
    text = ""
    try:
        if path.exists() and not path.is_file() and not path.is_dir():
            raise SceneError(f"{path}: is a pipe or a device, but a scene is read more than once; save it in a file")
        with path.open("rb") as file:
            read = file.read(MOST_BYTES + 1)
        if len(read) > MOST_BYTES:
            raise SceneError(
                f"{path}: is larger than {MOST_BYTES:,} bytes, the limit for scene files; remove some of it"
            )
        # An editor may have written a byte order mark, which tomllib refuses.
        text = io.TextIOWrapper(io.BytesIO(read), encoding="utf-8-sig").read()
        # The time that tomllib takes for a key grows with the square of the number of its parts.
        if sum(line.count(".") ** 2 for line in text.split("\n")) > MOST_DOTS_SQUARED:
            raise SceneError(f"{path}: has too many dots in a line; a key of a scene has one part")
        contents = tomllib.loads(text)
    except OSError as error:
        beside = [other.name for other in path.parent.glob("*.toml")]
        near = did_you_mean(path.name, beside) or did_you_mean(path.stem, packaged_scenes())
        near = "" if path.exists() else near
        raise SceneError(f"{path}: cannot be read: {error.strerror}{near}") from None
    except UnicodeDecodeError:
        raise SceneError(f"{path}: {COMPLAINTS['encoding']}") from None
    except (ValueError, RecursionError) as error:
        # Besides tomllib's own errors: numbers with thousands of digits, and nesting as deep.
        raise SceneError(f"{path}: {_syntax_complaint(str(error), text)}") from None
    try:
        scene = Scene.model_validate(contents)
    except ValidationError as error:
        raise SceneError(f"{path}: {_first_complaint(error, contents)}") from None
    if rectangles is not None and len(scene.rect) > rectangles:
        option = as_typed("rectangles", len(scene.rect))
        kind = "too_many" if len(scene.rect) <= MOST_RECTANGLES else "far_too_many"
        complaint = COMPLAINTS[kind].format(
            count=len(scene.rect), rectangles=rectangles, most=MOST_RECTANGLES, option=option
        )
        raise SceneError(f"{path}: {complaint}")
    return scene


def packaged_scenes(*, plain: bool = False) -> dict[str, Path]:
    """Return the packaged scenes by name; with plain, only those that every design can show."""
    spec = importlib.util.find_spec("raycaster.scenes")
    folders = (spec and spec.submodule_search_locations) or ()
    paths = [path for folder in folders for path in sorted(Path(folder).glob("*.toml"))]
    return {path.stem: path for path in paths if not (plain and any(load_scene(path).needs.values()))}


def find_scene(name: str) -> Path:
    """Return a scene file, given by its path or by the name of a packaged scene.

    Raises:
        SceneError: the name is neither.
    """
    path = Path(name)
    if path.suffix or path.exists():
        return path
    scenes = packaged_scenes()
    if name not in scenes:
        near = did_you_mean(name, scenes) or ": " + ", ".join(scenes)
        raise SceneError(f"{name}: no such file or packaged scene{near}")
    return scenes[name]


def dump_scene(scene: Scene) -> str:
    """Return the text of a scene file, from which `load_scene` reads the same scene."""

    def colour(channels: Colour) -> str:
        return f'"#{bytes(channels).hex()}"'

    lines = [
        f"title = {json.dumps(scene.title)}",
        f"rows = {scene.rows}",
        f"reflections = {scene.reflections}",
        f"background = {colour(scene.background)}",
        "[camera]",
        f"position = {list(scene.camera.position)}",
        *(
            f"{name} = {getattr(scene.camera, name)}"
            for name in ("yaw", "pitch", "roll")
            if getattr(scene.camera, name)
        ),
    ]
    if scene.light:
        lines += ["[light]", f"position = {list(scene.light.position)}", f"shade = {scene.light.shade}"]
    for rectangle in scene.rect:
        lines.append("[[rect]]")
        if rectangle.name:
            lines.append(f"name = {json.dumps(rectangle.name)}")
        lines.append(f"corners = {[list(corner) for corner in rectangle.corners]}")
        lines.append(f"colour = {colour(rectangle.colour)}")
        if rectangle.mirror != Rectangle.model_fields["mirror"].default:
            lines.append(f"mirror = {rectangle.mirror}")
        if rectangle.pattern != "plain" and rectangle.colour2:
            lines.append(f'pattern = "{rectangle.pattern}"')
            lines.append(f"colour2 = {colour(rectangle.colour2)}")
            lines.append(f"cell = {rectangle.cell}")
    return "\n".join(lines) + "\n"


def _syntax_complaint(said: str, text: str) -> str:
    """Return one line for an error of tomllib: its place in the text, and what tomllib expected."""
    if "digits" in said and (long := re.search(rf"\d[\d_]{{{sys.get_int_max_str_digits()},}}", text)):
        number = text.count("\n", 0, long.start()) + 1
        return COMPLAINTS["digits"].format(count=len(long[0].replace("_", "")), number=number)
    parts = re.fullmatch(r"(.+) \(at (?:line (\d+), column \d+|end of document)\)", said)
    if parts is None:
        return f"is not TOML: {said}"
    lines = text.rstrip(" \t\n").split("\n")
    # An error at the end is reported for the last line that is not empty.
    number = min(int(parts[2] or len(lines)), len(lines))
    line = lines[number - 1].strip(" \t")
    shown = f": {line}" if line.isprintable() and len(line) <= LONGEST_SHOWN else ""
    # With [rect] in some places, a table is declared twice or is not a list.
    reason = COMPLAINTS["heading"] if re.match(r"\[+rect\]+", line) else parts[1]
    return COMPLAINTS["syntax"].format(number=number, line=shown, reason=reason)


def _first_complaint(error: ValidationError, contents: Mapping) -> str:
    """Return one line for the first error: its place, what was expected, and what was given."""
    errors = error.errors()
    # A mistyped key also leaves the right one missing; report the mistyped one.
    first = next((details for details in errors if details["type"] == "extra_forbidden"), errors[0])
    return f"{_place(first, contents)}: {_expected(first)}"


def _place(details: ErrorDetails, contents: Mapping) -> str:
    """Return the keys and indices of the mistake, with the rectangle's name: `rect[0] ("floor") corners[1]`."""
    place = ""
    separator = ""
    for depth, key in enumerate(details["loc"]):
        if isinstance(key, int):
            place += f"[{key}]"
        else:
            # Quoted keys in TOML may contain anything.
            place += separator + (key if re.fullmatch("[A-Za-z0-9_-]+", key) else json.dumps(key))
        separator = "."
        if depth == 1 and details["loc"][0] == "rect":
            rectangle = contents["rect"][key]
            if isinstance(rectangle, Mapping) and isinstance(rectangle.get("name"), str):
                place += f" ({json.dumps(rectangle['name'], ensure_ascii=False)})"
                separator = " "
    return place


def _expected(details: ErrorDetails) -> str:
    match details["type"]:
        case "missing" as kind:
            return COMPLAINTS[kind]
        case "extra_forbidden" as kind:
            table = {"camera": Camera, "light": Light, "rect": Rectangle}.get(str(details["loc"][0]), Scene)
            table = table if len(details["loc"]) > 1 else Scene
            return COMPLAINTS[kind].format(keys=", ".join(table.model_fields))
        case "value_error":
            expected = str(details.get("ctx", {}).get("error"))
        case kind:
            expected = COMPLAINTS[kind]
    return expected + _given(details["input"])


def _given(value: object) -> str:
    try:
        text = json.dumps(value, ensure_ascii=False, default=str)
    except (RecursionError, ValueError):
        # Nesting, or an integer's number of digits, beyond Python's limits.
        return ""
    return f", not {text}" if len(text) <= LONGEST_SHOWN else ""
