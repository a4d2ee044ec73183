# SPDX-License-Identifier: MIT
"""Scenes that strain fixed-point arithmetic, each with a name and a description of the strain.

They are made for the full screen, whose rays have slopes (100, -160..159, -49..190).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from raycaster.configuration import WORLD_SIZE
from raycaster.scene import Camera, Light, Rectangle, Scene

LAST = WORLD_SIZE - 1
MIDDLE = WORLD_SIZE // 2

Corner = tuple[int, int, int]
Corners = tuple[Corner, Corner]

_PALETTE = (
    (200, 200, 180), (230, 80, 60), (60, 160, 80), (70, 100, 220), (240, 200, 60), (160, 70, 180),
    (60, 190, 200), (250, 140, 40), (120, 120, 130), (220, 120, 160), (140, 180, 60), (90, 60, 40),
)  # fmt: skip
"""Colours for rectangles in turn; no two blend alike."""


@dataclass(frozen=True)
class Case:
    """An entry of the catalogue."""

    name: str
    strain: str
    """The case's purpose, in a few words."""

    scene: Scene


def catalogue(features: Collection[str] = ()) -> list[Case]:
    """Return all cases that need no options of `FEATURES` except these.

    Every scene has at most 12 rectangles, and two reflections; a design with more reflections may show it with more.
    """
    cases = [_case(*entry) for family in _FAMILIES for entry in family()]
    found = [case for case in cases if not case.scene.lacks(features)]
    names = [case.name for case in found]
    if len(set(names)) != len(names):
        raise ValueError("two cases have the same name")
    return found


_Look = Mapping[str, Any]
_Rectangles = Sequence[Corners | tuple[Corners, _Look]]
_Entry = tuple[str, str, Corner | Camera, _Rectangles, *tuple[Light, ...]]
"""A rectangle may have a look: its keys in a scene file, except corners and colour. There is at most one light."""


def _case(name: str, strain: str, camera: Corner | Camera, rectangles: _Rectangles, *lights: Light) -> Case:
    looked: list[tuple[Any, Any]] = [one if isinstance(one[1], Mapping) else (one, {}) for one in rectangles]
    coloured = [
        Rectangle(corners=corners, colour=_PALETTE[index % len(_PALETTE)], **look)
        for index, (corners, look) in enumerate(looked)
    ]
    if not isinstance(camera, Camera):
        camera = Camera(position=camera)
    scene = Scene(
        title=f"{name}: {strain}", reflections=2, camera=camera, rect=tuple(coloured), light=next(iter(lights), None)
    )
    return Case(name, strain, scene)


def _plane(axis: int, position: int, low: tuple[int, int] = (0, 0), high: tuple[int, int] = (LAST, LAST)) -> Corners:
    """Return a rectangle across an axis; its extent is given on the two other axes in the order x, y, z."""

    def corner(extent: tuple[int, int]) -> Corner:
        coordinates = list(extent)
        coordinates.insert(axis, position)
        x, y, z = coordinates
        return x, y, z

    return corner(low), corner(high)


def _box(low: Corner, high: Corner) -> list[Corners]:
    """Return the six sides of a box."""
    sides = []
    for axis in range(3):
        others = [other for other in range(3) if other != axis]
        extent = [(corner[others[0]], corner[others[1]]) for corner in (low, high)]
        sides += [_plane(axis, corner[axis], *extent) for corner in (low, high)]
    return sides


_WORLD = _box((0, 0, 0), (LAST, LAST, LAST))
_BACK = _plane(0, LAST)
_FLOOR = _plane(2, 0)


def _grazing() -> Iterator[_Entry]:
    """Yield cases with e = 1: the quotient is slope times distance, so an error of the origin is multiplied too."""
    for name, axis, step in (("right", 1, 1), ("left", 1, -1), ("ceiling", 2, 1), ("floor", 2, -1)):
        camera = (0, MIDDLE, MIDDLE)
        for distance in (1, 2, 5):
            plane = _plane(axis, camera[axis] + step * distance)
            yield f"grazing_{name}_{distance}", f"e = 1 on a plane {distance} away", camera, [plane, _BACK]
    low = (0, MIDDLE, 0)
    yield "grazing_190", "e = 1 against b = 190, the steepest ray", low, [_plane(1, 257), _BACK]
    yield "grazing_380", "e = 1 against b = 190, over two units", low, [_plane(1, 258), _BACK]
    yield (
        "grazing_after_floor", "a mirror rounds the point on the floor, a grazed wall multiplies its error",
        (0, 250, 40), [_FLOOR, _plane(1, 254), _plane(1, 246), _BACK],
    )  # fmt: skip
    yield (
        "grazing_after_back", "a mirror rounds the point on the back wall, a grazed wall multiplies its error",
        (200, 250, 100), [_plane(0, 400), _plane(1, 253), _plane(1, 247), _plane(0, 0)],
    )  # fmt: skip
    yield (
        "grazing_after_side", "a mirror rounds the point on the side wall, a grazed floor multiplies its error",
        (0, 500, 40), [_plane(1, 505), _plane(2, 36), _plane(2, 44), _BACK],
    )  # fmt: skip


def _parallel() -> Iterator[_Entry]:
    """Yield cases with e = 0."""
    camera = (0, MIDDLE, MIDDLE)
    yield "parallel_in_plane", "e = 0 and n = 0: rays run within a plane", camera, [_plane(1, MIDDLE), _BACK]
    yield (
        "parallel_beside", "e = 0 between two walls one unit away",
        camera, [_plane(1, MIDDLE - 1), _plane(1, MIDDLE + 1), _BACK],
    )  # fmt: skip
    yield (
        "parallel_between", "e = 0 between floor and ceiling one unit away",
        camera, [_plane(2, MIDDLE - 1), _plane(2, MIDDLE + 1), _BACK],
    )  # fmt: skip
    yield "parallel_cross", "e = 0 on two axes at once", camera, [_plane(1, MIDDLE), _plane(2, MIDDLE), _BACK]


def _camera_on() -> Iterator[_Entry]:
    """Yield cases with n = 0: the camera touches walls."""
    camera = (100, 200, 300)
    for axis, name in enumerate("xyz"):
        plane = _plane(axis, camera[axis])
        yield f"camera_on_{name}_plane", f"n = 0 along {name}", camera, [plane, *_WORLD]
    yield "camera_on_edge", "the camera on the edge of two rectangles", camera, [
        _plane(1, 200, (100, 0), (LAST, 300)), _plane(2, 300, (100, 200), (LAST, LAST)), _BACK,
    ]  # fmt: skip
    for name, corner in (
        ("origin", (0, 0, 0)), ("left_top", (0, 0, LAST)), ("right_floor", (0, LAST, 0)),
        ("right_top", (0, LAST, LAST)), ("far", (LAST, LAST, LAST)), ("far_floor", (LAST, 0, 0)),
    ):  # fmt: skip
        yield f"camera_in_corner_{name}", "the camera in a corner of the world", corner, _WORLD


def _boxes() -> Iterator[_Entry]:
    """Yield closed boxes, in which every ray is reflected as often as it may be."""
    middle = (MIDDLE, MIDDLE, MIDDLE)
    for half in (1, 2, 10, 100):
        low, high = MIDDLE - half, MIDDLE + half
        sides = _box((low, low, low), (high, high, high))
        yield f"box_{2 * half}", f"inside a box of mirrors of {2 * half} units", middle, sides
    yield "box_world", "inside the whole world", middle, _WORLD
    yield (
        "box_off_centre",
        "inside a box of mirrors, next to a wall",
        (101, 299, 201),
        _box((100, 200, 200), (140, 300, 260)),
    )
    yield (
        "box_in_box",
        "a mirror box within mirrored walls",
        (20, 250, 100),
        [*_WORLD, *_box((200, 200, 80), (260, 300, 140))],
    )


def _extreme_coordinates() -> Iterator[_Entry]:
    """Yield cases whose rectangles have only the coordinates 0 and 511."""
    zero, last = (0, 0, 0), (LAST, LAST, LAST)
    lines = [_plane(axis, 0, (0, 0), (0, LAST)) for axis in range(3)]
    yield "all_0", "every coordinate 0 or along an axis", zero, [(zero, zero), *lines, _plane(0, 0), _FLOOR]
    yield "all_511", "every coordinate 511", (0, LAST, LAST), [(last, last), *(_plane(axis, LAST) for axis in range(3))]
    edges = [
        _plane(axis, position, (0, other), (LAST, other))
        for axis in range(3)
        for position in (0, LAST)
        for other in (0, LAST)
    ]
    yield "world_edges", "lines along the edges of the world", (0, MIDDLE, MIDDLE), edges


def _quotients() -> Iterator[_Entry]:
    """Yield cases with the divider's greatest quotient, and with the smallest that overflows."""
    yield "quotient_511", "100 x 511 / 100: the greatest quotient", (0, 0, 0), [_BACK]
    yield "quotient_512", "100 x 128 / 25: the smallest that overflows", (0, MIDDLE, 128), [_FLOOR, _BACK]
    yield (
        "quotient_511_6",
        "100 x 220 / 43: 511.6, which nearest rounds out of the world",
        (0, MIDDLE, 220),
        [_FLOOR, _BACK],
    )
    yield "quotient_negative_511", "as much to the left", (0, LAST, 0), [_BACK]
    yield "quotient_huge", "190 x 511 / 1: far more than fits", (0, 0, 0), [_plane(1, LAST), _BACK]


def _close_planes() -> Iterator[_Entry]:
    """Yield cases with depths that differ by one."""
    for axis, name, camera in ((0, "x", (0, MIDDLE, 100)), (1, "y", (0, 0, 100)), (2, "z", (0, MIDDLE, 0))):
        yield (
            f"far_pair_{name}",
            "two planes one unit apart, far away",
            camera,
            [_plane(axis, LAST), _plane(axis, LAST - 1)],
        )
    yield "far_stack", "twelve planes one unit apart", (0, MIDDLE, 100), [
        _plane(0, LAST - index, (40 * index, 0), (LAST, LAST)) for index in range(12)
    ]  # fmt: skip
    yield (
        "near_pair",
        "two planes one and two units away",
        (100, MIDDLE, 100),
        [_plane(0, 102), _plane(0, 101, (0, 100), (LAST, LAST))],
    )
    yield "camera_beside_edge_of_world", "misses at y = 511.01, which truncation turns into hits", (400, LAST, 100), [
        _plane(0, 401),
    ]  # fmt: skip


def _slits() -> Iterator[_Entry]:
    """Yield cases with slits and strips one unit wide."""
    camera = (0, MIDDLE, 100)
    for name, x in (("near", 20), ("far", 500)):
        yield f"slit_y_{name}", "a gap of one unit between two walls", camera, [
            _plane(0, x, (0, 0), (MIDDLE, LAST)), _plane(0, x, (MIDDLE + 1, 0), (LAST, LAST)), _BACK,
        ]  # fmt: skip
        yield f"slit_z_{name}", "a gap of one unit above a sill", camera, [
            _plane(0, x, (0, 0), (LAST, 100)), _plane(0, x, (0, 101), (LAST, LAST)), _BACK,
        ]  # fmt: skip
        yield f"strips_{name}", "strips one unit wide, one unit apart", camera, [
            *(_plane(0, x, (MIDDLE - 10 + 2 * index, 0), (MIDDLE - 9 + 2 * index, LAST)) for index in range(10)), _BACK,
        ]  # fmt: skip


def _shared() -> Iterator[_Entry]:
    """Yield cases with ties."""
    camera = (0, MIDDLE, 100)
    wall = _plane(0, 300, (100, 50), (400, 300))
    yield "coincident", "one rectangle three times", camera, [wall, wall, wall]
    yield (
        "coincident_part",
        "two that overlap in one plane",
        camera,
        [wall, _plane(0, 300, (200, 0), (LAST, 200)), _FLOOR],
    )
    yield "shared_edge", "two walls that meet in an edge", camera, [
        _plane(0, 300, (0, 0), (300, LAST)), _plane(1, 300, (100, 0), (300, LAST)), _FLOOR,
    ]  # fmt: skip
    yield "shared_corner", "three that meet in a corner", camera, [
        _plane(0, 300, (0, 0), (300, 200)), _plane(1, 300, (100, 0), (300, 200)), _plane(2, 200, (100, 0), (300, 300)),
    ]  # fmt: skip
    yield "tiles", "tiles in one plane that share edges and corners", camera, [
        _plane(0, LAST, (100 * column, 120 * row), (100 * column + 100, 120 * row + 120))
        for column in range(4) for row in range(3)
    ]  # fmt: skip


def _thin() -> Iterator[_Entry]:
    """Yield cases with rectangles that have no extent: points and lines."""
    camera = (0, MIDDLE, 100)
    yield "points", "rectangles of one point, some of them on a ray", camera, [
        (point, point)
        for step in (1, 2, 3) for offset, rise in ((0, 0), (10, 20), (-33, 7), (40, -15))
        for point in [(100 * step, MIDDLE + offset * step, 100 + rise * step)]
    ]  # fmt: skip
    for axis, name in enumerate("xyz"):
        starts = ((100, MIDDLE - 60, 60), (200, MIDDLE + 40, 130), (400, MIDDLE, 100), (500, MIDDLE + 1, 101))
        yield f"lines_{name}", f"lines along {name}, one of them on a ray", camera, [
            (start, (x, y, z)) for start in starts
            for x, y, z in [[min(LAST, value + 200) if axis == other else value for other, value in enumerate(start)]]
        ]  # fmt: skip


def _mirror_edges() -> Iterator[_Entry]:
    """Yield cases with rays near a mirror's edge, where a hit or a miss decides everything after it."""
    camera = (0, MIDDLE, 100)
    yield "mirror_edge", "a mirror that ends where rays arrive at whole units", camera, [
        _plane(0, 200, (MIDDLE - 40, 60), (MIDDLE + 40, 140)), _plane(0, 0), _BACK, _FLOOR,
    ]  # fmt: skip
    yield "mirror_strip", "a mirror one unit wide before a wall", camera, [
        _plane(0, 300, (MIDDLE, 0), (MIDDLE + 1, LAST)), _plane(0, 0), _BACK,
    ]  # fmt: skip
    yield "mirror_floor_edge", "a mirror on the floor that ends next to a wall", camera, [
        _plane(2, 0, (100, 100), (400, 300)), _plane(1, 301), _plane(0, 401), _plane(2, LAST),
    ]  # fmt: skip


def _facing() -> Iterator[_Entry]:
    """Yield cases with facing mirrors, which carry the error from one to the next."""
    for width in (1, 4, 40, 400):
        low = MIDDLE - (width + 1) // 2
        sides = [_plane(1, low), _plane(1, low + width + 1)]
        yield f"facing_y_{width}", f"mirrors {width + 1} apart, side by side", (0, MIDDLE, 100), [*sides, _BACK]
    yield "facing_z", "mirrors above and below", (0, MIDDLE, 100), [_plane(2, 90), _plane(2, 112), _BACK]
    yield "facing_x", "mirrors before and behind", (300, MIDDLE, 100), [_plane(0, 290), _plane(0, 330), _FLOOR]
    ends = [_plane(0, 0), _plane(0, LAST)]
    yield "facing_ends", "mirrors at the ends of the world, from one of them", (0, MIDDLE, MIDDLE), ends
    for axis, name, angles in ((0, "x", {"yaw": 180}), (1, "y", {"yaw": 90}), (2, "z", {"pitch": 90})):
        end = LAST if angles.get("yaw") == 180 else 0
        x, y, z = (end if axis == other else MIDDLE for other in range(3))
        yield (
            f"facing_ends_{name}", f"mirrors at the ends of the world, along {name}",
            Camera(position=(x, y, z), **angles), [_plane(axis, 0), _plane(axis, LAST)],
        )  # fmt: skip
    yield "corner_reflector", "three mirrors that send every ray back", (0, 300, 200), [
        _plane(0, 400), _plane(1, 400), _plane(2, 100), _plane(0, 0),
    ]  # fmt: skip
    yield "periscope", "two small mirrors above each other", (100, MIDDLE, 100), [
        _plane(0, 300, (MIDDLE - 50, 50), (MIDDLE + 50, 150)), _plane(0, 40, (100, 100), (400, 400)), _plane(2, LAST),
    ]  # fmt: skip


def _corners() -> Iterator[_Entry]:
    """Yield cases with planes that rays meet in one point, twice as far as the viewing rectangle."""
    camera = (100, 100, 200)
    walls = [_plane(0, 300), _plane(1, 140)]
    yield "corner_of_two", "rays into the edge of two walls", camera, [*walls, _plane(0, 50), _FLOOR]
    yield "corner_of_two_swapped", "the same with the other wall first", camera, [*walls[::-1], _plane(0, 50), _FLOOR]
    yield "corner_of_three", "a ray into the corner of three walls", camera, [*walls, _plane(2, 220), _plane(0, 50)]
    yield "corner_after_mirror", "a mirror sends rays into an edge", (200, 100, 200), [
        _plane(0, 300), _plane(0, 100), _plane(1, 160), _FLOOR,
    ]  # fmt: skip
    yield "corner_outside", "the edges and corners of a box, from outside", camera, [
        *_box((300, 140, 210), (400, 300, 250)), *_WORLD[::2],
    ]  # fmt: skip
    yield "corner_of_lines", "lines in the edge of two walls", camera, [
        ((300, 140, 0), (300, 140, 190)), *walls, ((300, 140, 210), (300, 140, LAST)), _plane(0, 50),
    ]  # fmt: skip
    yield "corner_that_ends", "walls that end where they meet, and one that ends a unit before", camera, [
        _plane(0, 300, (0, 0), (140, LAST)), _plane(1, 140, (0, 0), (300, 210)),
        _plane(1, 140, (0, 211), (299, LAST)), _plane(0, 50),
    ]  # fmt: skip


def _turned() -> Iterator[_Entry]:
    """Yield cases with turned cameras: every sign of each slope component, and each component 0."""
    place = (200, 250, 300)

    def camera(yaw: float = 0, pitch: float = 0, roll: float = 0, position: Corner = place) -> Camera:
        return Camera(position=position, yaw=yaw, pitch=pitch, roll=roll)

    inner = [*_WORLD, *_box((100, 150, 250), (120, 180, 280))]
    for name, angles in (
        ("right", (90, 0, 0)), ("left", (-90, 0, 0)), ("back", (180, 0, 0)), ("up", (0, 90, 0)), ("down", (0, -90, 0)),
        ("on_its_side", (0, 0, 90)), ("upside_down", (0, 0, 180)), ("down_on_its_side", (0, -90, 90)),
    ):  # fmt: skip
        yield f"turned_{name}", "rays along two axes' planes, and along one axis", camera(*angles), inner
    for axis, name, angles in (
        (0, "x", (90, 30, 0)),
        (1, "y", (0, 30, 0)),
        (2, "z", (30, 0, 90)),
        (0, "x_up", (0, 90, 0)),
    ):
        yield (
            f"turned_along_{name}", "the camera on a plane along which it looks: e = 0 and n = 0",
            camera(*angles), [_plane(axis, place[axis]), *_WORLD],
        )  # fmt: skip
    yield "turned_diagonal", "equal components", camera(45, 45, 0, (MIDDLE, MIDDLE, MIDDLE)), _WORLD
    yield "turned_any", "three angles at once", camera(131, -35.5, 20), inner
    yield "turned_little", "a basis that is off by one", camera(0.2, -0.2, 0.2), inner
    yield "turned_grazing", "walls that are grazed from behind a corner", camera(180, 0, 0, (400, MIDDLE, MIDDLE)), [
        _plane(1, MIDDLE + 1), _plane(1, MIDDLE - 2), _plane(2, MIDDLE - 1), _plane(0, 0),
    ]  # fmt: skip
    yield (
        "turned_into_corner",
        "closed, and rays into its corners",
        camera(225, 0, 0, (300, 300, 300)),
        _box((100, 100, 100), (400, 400, 400)),
    )
    yield "turned_behind_x_0", "a wall at x = 0", camera(180, 0, 0, (1, 250, 100)), [_plane(0, 0), _plane(0, 2), _FLOOR]


def _surfaces() -> Iterator[_Entry]:
    """Yield cases with points on the border of two cells, and with every weight of mirrors."""
    camera = (0, MIDDLE, 128)
    pattern = {"pattern": "checker", "colour2": (250, 250, 250), "cell": 8}
    for kind, cell in (("checker", 8), ("checker", 256), ("rows", 16), ("columns", 64)):
        look = {**pattern, "pattern": kind, "cell": cell}
        yield f"cells_{kind}_{cell}", "points on the borders of cells of each axis", camera, [
            (_plane(0, 400, (100, 0), (400, 300)), look), (_plane(1, 256 + 128), look), (_plane(2, 0), look),
            (_plane(0, LAST), look),
        ]  # fmt: skip
    yield "cells_of_lines", "lines and points with cells", camera, [
        (((100, MIDDLE, 128), (100, MIDDLE, 400)), pattern), (((50, 200, 60), (500, 200, 60)), pattern),
        (((200, MIDDLE, 128), (200, MIDDLE, 128)), pattern), (_FLOOR, {**pattern, "pattern": "rows"}),
    ]  # fmt: skip
    yield "cells_reflected", "cells in a mirror, on their borders too", (100, MIDDLE, 128), [
        (_plane(0, 300), {"mirror": 1.0}), (_plane(0, 0), pattern), (_FLOOR, pattern), (_plane(1, 0), pattern),
    ]  # fmt: skip
    mirrors = (0.0, 0.25, 0.75, 1.0)
    yield "mirrors", "every weight after every other", (MIDDLE, MIDDLE, MIDDLE), [
        (side, {"mirror": mirrors[index % 4]}) for index, side in enumerate(_WORLD)
    ]  # fmt: skip
    for name, order in (("first", (0.0, 1.0)), ("second", (1.0, 0.0))):
        yield f"corner_matte_{name}", "one of two walls that meet ends the ray", (100, 100, 200), [
            (_plane(0, 300), {"mirror": order[0]}), (_plane(1, 140), {"mirror": order[1]}), _plane(0, 50),
        ]  # fmt: skip
    yield "turned_cells", "cells behind a camera's back", Camera(position=(400, 250, 100), yaw=200, pitch=-20), [
        (_FLOOR, pattern), (_plane(0, 0), {**pattern, "mirror": 0.25, "cell": 32}), (_plane(1, 0), {"mirror": 1.0}),
    ]  # fmt: skip


def _lights() -> Iterator[_Entry]:
    """Yield cases with the light in planes, on edges, in corners, behind slits, and edge-on to surfaces."""
    camera = (0, MIDDLE, 128)

    def light(x: int, y: int, z: int, shade: float = 0.25) -> Light:
        return Light(position=(x, y, z), shade=shade)

    box = _box((200, 220, 0), (260, 300, 100))
    for name, strain, place in (
        ("in_a_plane", "the light in the plane of a wall that it grazes", (300, 0, 300)),
        ("on_a_face", "the light on a face of a box", (200, 250, 50)),
        ("on_an_edge", "the light on an edge of a box", (200, 220, 60)),
        ("in_a_corner", "the light in a corner of a box", (200, 220, 100)),
        ("in_the_world_corner", "the light in the room's corner", (0, 0, LAST)),
        ("at_the_camera", "no shadow is seen from the light", camera),
        ("beside_the_camera", "shadows a unit wide", (0, MIDDLE + 1, 128)),
        ("in_a_box", "a closed box around the light", (230, 260, 50)),
    ):
        yield f"light_{name}", strain, camera, [*_WORLD, *box], light(*place)
    yield "light_outside", "a closed box around the camera", (230, 260, 50), [*_WORLD, *box], light(400, 100, 400)
    for width in (0, 1, 2):
        slit = [_plane(2, 200, high=(LAST, MIDDLE)), _plane(2, 200, low=(0, MIDDLE + width))]
        name = ("closed", "one", "two")[width]
        strain = f"a slit of {width} units in a ceiling"
        yield f"light_slit_{name}", strain, camera, [*_WORLD, *slit], light(250, MIDDLE, LAST)
    yield "light_line", "lines and points cast shadows", camera, [
        *_WORLD, ((200, 200, 60), (200, 300, 60)), ((220, MIDDLE, 0), (220, MIDDLE, 200)),
        ((240, 280, 90), (240, 280, 90)),
    ], light(230, 250, 200)  # fmt: skip
    yield (
        "light_a_unit_above", "a receiver seen edge-on by the light", camera,
        [_FLOOR, _BACK, *box[:4]], light(100, 200, 1),
    )  # fmt: skip
    yield (
        "light_on_the_floor", "the light in the receiver's plane", camera,
        [_FLOOR, _BACK, *box[:4]], light(100, 200, 0),
    )  # fmt: skip
    yield (
        "light_behind", "the light on the other side of what is seen", camera,
        [_plane(0, 300), _FLOOR], light(400, 256, 200),
    )  # fmt: skip
    yield "light_coplanar", "rectangles of one plane do not shade each other", camera, [
        _plane(2, 0, (0, 0), (300, LAST)), _plane(2, 0, (200, 0), (LAST, LAST)), _plane(2, 50, (200, 200), (300, 300)),
        _BACK,
    ], light(250, 250, 300, 0)  # fmt: skip
    yield "light_two_layers", "one shadow within another", camera, [
        *_WORLD, _plane(2, 100, (150, 150), (350, 350)), _plane(2, 150, (200, 200), (300, 300)),
    ], light(250, 250, LAST, 0.75)  # fmt: skip
    mirrors = [(_plane(1, 100), {"mirror": 1.0}), (_plane(1, 400), {"mirror": 0.75}), (_FLOOR, {"mirror": 0.0})]
    yield "light_no_image", "two facing mirrors, whose images of the light do not light", camera, [
        *mirrors, *box, (_BACK, {"mirror": 0.0}),
    ], light(150, 250, 300)  # fmt: skip
    yield "light_in_a_mirror", "the light in a mirror's plane", camera, [*mirrors, *box, _BACK], light(150, 100, 300)
    yield "light_through_a_corner", "rays from the light through the edges of walls that meet", (100, 250, 200), [
        _plane(0, 300, (0, 0), (140, LAST)), _plane(1, 140, (100, 0), (300, LAST)), _plane(0, 400), _plane(1, 400),
        _FLOOR,
    ], light(200, 40, 300)  # fmt: skip
    yield "light_turned", "shadows behind a camera's back", Camera(position=(300, 250, 150), yaw=160, pitch=-30), [
        *_WORLD, *_box((100, 200, 0), (160, 260, 120)),
    ], light(250, 100, 400)  # fmt: skip
    diagonal = Camera(position=(MIDDLE, MIDDLE, MIDDLE), yaw=45, pitch=45)
    yield "light_diagonal", "shadows along diagonals of pixels", diagonal, [
        *_WORLD, *_box((300, 300, 300), (340, 340, 340)),
    ], light(MIDDLE, MIDDLE, MIDDLE - 1)  # fmt: skip


_FAMILIES = (
    _grazing, _parallel, _camera_on, _boxes, _extreme_coordinates, _quotients, _close_planes, _slits, _shared, _thin,
    _mirror_edges, _facing, _corners, _turned, _surfaces, _lights,
)  # fmt: skip
