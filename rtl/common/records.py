# SPDX-License-Identifier: MIT
"""Records of the ray tracer; see `raycaster.hdl.records`."""

from raycaster.configuration import CHANNEL_BITS, COORDINATE_BITS, Configuration
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    BASIS_BITS,
    CELL_BITS,
    DISTANCE_BITS,
    KIND_BITS,
    MIRROR_BITS,
    RGB_BITS,
    SHADE_BITS,
    WIDE_BITS,
    exact_slope_bits,
    eye_bits,
    fold_bits,
    index_bits,
    position_bits,
    shift_bits,
    walk_bits,
)


class Point(Record):
    """A camera position, in whole world units."""

    def __init__(self):
        super().__init__(dict.fromkeys("xyz", COORDINATE_BITS))


class Camera(Record):
    """The camera: the `Point` from which all rays start and, if the design has them, its basis and the light.

    The basis of a camera that turns is forward, right and up, times 256. The light has light_x, light_y, light_z, the
    eye of all shadow rays; light_on, low if everything is lit; and light_shade, the quarters of a colour that remain in
    the dark.
    """

    def __init__(self, turn: bool = False, light: bool = False):
        basis = (f"{vector}_{axis}" for vector in ("forward", "right", "up") for axis in "xyz")
        position = {f"light_{axis}": COORDINATE_BITS * light for axis in "xyz"}
        super().__init__(
            Point().layout
            | dict.fromkeys(basis, Signed(BASIS_BITS * turn))
            | position
            | {"light_shade": SHADE_BITS * light, "light_on": int(light)}
        )


def camera_of(config: Configuration) -> Camera:
    """Return a `Camera` sized for this configuration."""
    return Camera(config.turn, config.light)


class Origin(Record):
    """A point where a ray starts or hits, with the configuration's fraction bits."""

    def __init__(self, config: Configuration):
        super().__init__(dict.fromkeys("xyz", position_bits(config)))


class Signs(Record):
    """Signs of a ray's slope components, 1 if negative. A reflection changes one of them and no magnitude."""

    def __init__(self):
        super().__init__(dict.fromkeys(("dx", "dy", "dz"), 1))


class Ray(Record):
    """The parts of a ray that a reflection changes: its start, an `Origin`, and its `Signs`."""

    def __init__(self, config: Configuration):
        super().__init__(Origin(config).layout | Signs().layout)


class Colour(Record):
    """A colour with channels of full width; the word has the layout of registers and rectangles."""

    def __init__(self):
        super().__init__(dict.fromkeys(("red", "green", "blue"), CHANNEL_BITS))


class Pixel(Record):
    """A pixel as stored for the monitor: the top colour_bits of each channel."""

    def __init__(self, colour_bits: int):
        super().__init__(dict.fromkeys(("red", "green", "blue"), colour_bits))


def shown_of(config: Configuration) -> Pixel:
    """Return a record of the pixels shown in one clock: one, or two as the halves of each colour, as in `Vga`."""
    return Pixel(config.colour_bits * config.pixels)


class Look(Record):
    """The look of a rectangle: its colour and, if the design has them, its material and pattern.

    With materials, mirror: the mirrored share in quarters, 0..4. With patterns, kind: 0 plain, 1 checker, 2 rows, 3
    columns; cell: log2 of the cell size in world units, minus three; colour_2: the colour of every other cell.
    """

    def __init__(self, materials: bool = False, patterns: bool = False):
        super().__init__(look_fields(materials, patterns))


def look_fields(materials: bool, patterns: bool) -> dict[str, int]:
    """Return the field widths of a `Look`."""
    pattern = {"kind": KIND_BITS, "cell": CELL_BITS, "colour_2": RGB_BITS}
    return (
        {"colour": RGB_BITS}
        | {"mirror": MIRROR_BITS * materials}
        | {name: bits * patterns for name, bits in pattern.items()}
    )


class Surface(Record):
    """The data of a hit rectangle that its ray needs: the plane's axis (0, 1, 2 for x, y, z), position and `Look`."""

    def __init__(self, materials: bool = False, patterns: bool = False):
        super().__init__(surface_fields(COORDINATE_BITS, materials, patterns))


def surface_fields(coordinate_bits: int, materials: bool = False, patterns: bool = False) -> dict[str, int]:
    """Return the field widths of a `Surface`, with which a `Rect` also begins."""
    return {"axis": AXIS_BITS, "position": coordinate_bits} | look_fields(materials, patterns)


def surface_of(config: Configuration) -> Surface:
    """Return a `Surface` sized for this configuration."""
    return Surface(config.materials, config.patterns)


class Rect(Record):
    """A rectangle: its surface, and inclusive bounds on the two other axes, u before v in the order x, y, z."""

    def __init__(self, coordinate_bits: int = COORDINATE_BITS, materials: bool = False, patterns: bool = False):
        bounds = dict.fromkeys(("u_low", "u_high", "v_low", "v_high"), coordinate_bits)
        surface, below = surface_fields(coordinate_bits, materials, patterns), sum(bounds.values())
        look = below, sum(look_fields(materials, patterns).values())
        super().__init__(surface | bounds, {"surface": (below, sum(surface.values())), "look": look})


def rect_of(config: Configuration) -> Rect:
    """Return a `Rect` sized for this configuration."""
    return Rect(materials=config.materials, patterns=config.patterns)


class WideRect(Record):
    """A rectangle without colour, whose bounds may be one unit further out."""

    def __init__(self):
        bounds = dict.fromkeys(("u_low", "u_high", "v_low", "v_high"), Signed(WIDE_BITS))
        super().__init__({"axis": AXIS_BITS, "position": COORDINATE_BITS} | bounds)


class Mirror(Record):
    """The mirror that a ray left last, if `active`: the axis of its plane, and its distance from the eye.

    With corners, met_x, met_y, met_z: the axes of all mirrors that the ray met at that same point.
    """

    def __init__(self, distance_bits: int, corners: bool = False):
        met = dict.fromkeys(("met_x", "met_y", "met_z"), int(corners))
        super().__init__({"active": 1, "axis": AXIS_BITS, "distance": distance_bits} | met)


def mirror_of(config: Configuration) -> Mirror:
    """Return a `Mirror` sized for this configuration; corners need a second reflection."""
    return Mirror(eye_bits(config) - 1, corners=config.reflections > 1)


class Facet(Record):
    """A rectangle as seen by the rays of one row from the camera; see `Walk` for the axis q.

    usable: it may be hit; distance: n = k - E[a] from the camera to its plane. Unless the camera turns, way_q: n D[q],
    the same for all columns. Unless the facet is `bare`, its lowest bits are the rectangle's `Look`.
    """

    def __init__(
        self,
        way_bits: int,
        distance_bits: int = DISTANCE_BITS,
        *,
        turn: bool = False,
        materials: bool = False,
        patterns: bool = False,
        bare: bool = False,
    ):
        looks = {name: bits * (not bare) for name, bits in look_fields(materials, patterns).items()}
        seen = {"usable": 1, "axis": AXIS_BITS, "distance": Signed(distance_bits)}
        super().__init__(seen | {"way_q": Signed(way_bits * (not turn))} | looks)


def facet_of(config: Configuration) -> Facet:
    """Return a `Facet` sized for this configuration."""
    return Facet(walk_bits(config), turn=config.turn, materials=config.materials, patterns=config.patterns)


class Walk(Record):
    """The compared products that change with the column: n D[p], and (bound - E) D[a] for the four bounds.

    p is y, the axis along which the slope changes per column unless the camera turns, or x for a plane across y. q is
    the third axis; n D[q] changes only if the camera turns.
    """

    def __init__(self, bits: int, turn: bool = False):
        fields = dict.fromkeys(("way_p", "way_q", "low_p", "high_p", "low_q", "high_q"), Signed(bits))
        super().__init__(fields | {"way_q": Signed(bits * turn)})


def walk_of(config: Configuration) -> Walk:
    """Return a `Walk` sized for this configuration."""
    return Walk(walk_bits(config), config.turn)


def growth_of(config: Configuration) -> Walk:
    """Return a record for the change of a `Walk` per column: products if the camera turns, otherwise distances."""
    return walk_of(config) if config.turn else Walk(DISTANCE_BITS)


def stride_of(config: Configuration) -> Walk:
    """Return a record for the change of a `Walk` over all columns of a clock."""
    return walk_of(config) if config.turn else Walk(DISTANCE_BITS + config.pixels - 1)


class Reflector(Record):
    """A mirror that a ray left: its axis, and the distance from the camera to its plane.

    at_mirror: the ray met it at the same point as the mirror before it.
    """

    def __init__(self, distance_bits: int = DISTANCE_BITS):
        super().__init__({"at_mirror": 1, "axis": AXIS_BITS, "distance": Signed(distance_bits)})


class RoomImage(Record):
    """The image of the room in which a straight ray is after its mirrors so far; see `ray_fold`.

    met_x, met_y, met_z: a mirror on that axis was met at the point that the ray left last; back_x, back_y, back_z: the
    image is reversed along that axis; shift_x, shift_y, shift_z: T, the shift of the image.
    """

    def __init__(self, shift_bits: int):
        flags = dict.fromkeys(("met_x", "met_y", "met_z", "back_x", "back_y", "back_z"), 1)
        super().__init__({**flags, **dict.fromkeys(("shift_x", "shift_y", "shift_z"), Signed(shift_bits))})


def room_image_of(config: Configuration) -> RoomImage:
    """Return a `RoomImage` sized for this configuration."""
    return RoomImage(shift_bits(config))


class Fold(Record):
    """The folding of a straight ray through all mirrors so far back into the room; see `ray_fold`.

    It starts with the fields of a `RoomImage`, which together are `image`. mirror_back: the folded ray leaves the last
    mirror in the negative direction; p_x ..., q_x ...: for a rectangle on that axis, the offset added to its way along
    p and q (see `Walk`), plus one if the way is complemented; border_x ...: n D with the last mirror's n; axis,
    distance: those of the last mirror.
    """

    def __init__(self, product_bits: int, walk_width: int, shift_bits: int, distance: int = DISTANCE_BITS):
        image = RoomImage(shift_bits).layout
        others = (
            {"mirror_back": 1}
            | dict.fromkeys(("p_x", "p_y", "p_z", "q_x", "q_y", "q_z"), Signed(product_bits))
            | dict.fromkeys(("border_x", "border_y", "border_z"), Signed(walk_width))
            | {"axis": AXIS_BITS, "distance": Signed(distance)}
        )
        super().__init__(image | others, {"image": (sum(others.values()), sum(image.values()))})


def fold_of(config: Configuration) -> Fold:
    """Return a `Fold` sized for this configuration."""
    return Fold(fold_bits(config), walk_bits(config), shift_bits(config))


class Candidate(Record):
    """A hit, if `valid`, at t = numerator / denominator, on the rectangle `index`.

    at_mirror: the hit is in the plane of the mirror that the ray left last, which is another rectangle. With patterns,
    axis, cell: fields of the rectangle.
    """

    def __init__(self, numerator_bits: int, denominator_bits: int, index_width: int, patterns: bool = False):
        cell = {"axis": AXIS_BITS * patterns, "cell": CELL_BITS * patterns}
        hit = {"valid": 1, "at_mirror": 1, "numerator": numerator_bits, "denominator": denominator_bits}
        super().__init__({**hit, **cell, "index": index_width})


def candidate_of(config: Configuration) -> Candidate:
    """Return a `Candidate` sized for this configuration."""
    return Candidate(eye_bits(config) - 1, exact_slope_bits(config), index_bits(config), config.patterns)


class Winner(Record):
    """The rectangle that a ray sees, if `valid`; at_mirror: as in `Candidate`."""

    def __init__(self, index_width: int):
        super().__init__({"valid": 1, "at_mirror": 1, "index": index_width})


def winner_of(config: Configuration) -> Winner:
    """Return a `Winner` sized for this configuration."""
    return Winner(index_bits(config))


class Seen(Record):
    """The rectangle that a ray sees, if `found`: its colour and, if mirrors mix, the share that it mirrors."""

    def __init__(self, mixes: bool = False):
        super().__init__({"found": 1, "mirror": MIRROR_BITS * mixes, "colour": RGB_BITS})


def seen_of(config: Configuration) -> Seen:
    """Return a `Seen` sized for this configuration; without reflections, nothing mixes."""
    return Seen(config.materials and config.reflections > 0)


class Shade(Record):
    """A ray's contribution to its pixel: a `Colour` and, if mirrors mix, the share of the colour behind it."""

    def __init__(self, mixes: bool = False):
        super().__init__({"mirror": MIRROR_BITS * mixes} | Colour().layout)


def shade_of(config: Configuration) -> Shade:
    """Return a `Shade` sized for this configuration."""
    return Shade("mirror" in seen_of(config).layout)


class CellDivision(Record):
    """A division after its steps down to a bit place: the rest of the dividend, the divisor, and the cell size.

    cell: as in `Look`; odd: the quotient bit whose weight is the cell size, once it is known.
    """

    def __init__(self, divisor_bits: int, place: int):
        super().__init__({"rest": divisor_bits + place, "divisor": divisor_bits, "cell": CELL_BITS, "odd": 1})


class Sight(Record):
    """The rectangle that a ray sees, if `valid`, and the hit's pattern cell: odd_u, odd_v as in `pattern_colour`."""

    def __init__(self, index_width: int):
        super().__init__({"valid": 1, "odd_u": 1, "odd_v": 1, "index": index_width})
