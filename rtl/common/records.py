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

    def __init__(self, config: Configuration):
        basis = (f"{vector}_{axis}" for vector in ("forward", "right", "up") for axis in "xyz")
        light = {f"light_{axis}": COORDINATE_BITS for axis in "xyz"} | {"light_shade": SHADE_BITS, "light_on": 1}
        super().__init__(
            Point().layout
            | dict.fromkeys(basis, Signed(BASIS_BITS * config.turn))
            | {name: bits * config.light for name, bits in light.items()}
        )


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


class Look(Record):
    """The look of a rectangle: its colour and, if the design has them, its material and pattern.

    With materials, mirror: the mirrored share in quarters, 0..4. With patterns, kind: 0 plain, 1 checker, 2 rows, 3
    columns; cell: log2 of the cell size in world units, minus three; colour_2: the colour of every other cell.
    """

    def __init__(self, config: Configuration):
        super().__init__(look_fields(config))


def look_fields(config: Configuration) -> dict[str, int]:
    """Return the field widths of a `Look`."""
    pattern = {"kind": KIND_BITS, "cell": CELL_BITS, "colour_2": RGB_BITS}
    material = {"colour": RGB_BITS, "mirror": MIRROR_BITS * config.materials}
    return material | {name: bits * config.patterns for name, bits in pattern.items()}


class Surface(Record):
    """The data of a hit rectangle that its ray needs: the plane's axis (0, 1, 2 for x, y, z), position and `Look`."""

    def __init__(self, config: Configuration):
        super().__init__(surface_fields(config))


def surface_fields(config: Configuration, coordinate_bits: int = COORDINATE_BITS) -> dict[str, int]:
    """Return the field widths of a `Surface`, with which a `Rect` also begins."""
    return {"axis": AXIS_BITS, "position": coordinate_bits} | look_fields(config)


class Rect(Record):
    """A rectangle: its surface, and inclusive bounds on the two other axes, u before v in the order x, y, z."""

    def __init__(self, config: Configuration, coordinate_bits: int = COORDINATE_BITS):
        bounds = dict.fromkeys(("u_low", "u_high", "v_low", "v_high"), coordinate_bits)
        surface, below = surface_fields(config, coordinate_bits), sum(bounds.values())
        look = below, sum(look_fields(config).values())
        super().__init__(surface | bounds, {"surface": (below, sum(surface.values())), "look": look})


class WideRect(Record):
    """A rectangle without colour, whose bounds may be one unit further out."""

    def __init__(self):
        bounds = dict.fromkeys(("u_low", "u_high", "v_low", "v_high"), Signed(WIDE_BITS))
        super().__init__({"axis": AXIS_BITS, "position": COORDINATE_BITS} | bounds)


class Mirror(Record):
    """The mirror that a ray left last, if `active`: the axis of its plane, and its distance from the eye.

    With more than one reflection, met_x, met_y, met_z: the axes of all mirrors that the ray met at that same point.
    """

    def __init__(self, config: Configuration, distance_bits: int | None = None):
        met = dict.fromkeys(("met_x", "met_y", "met_z"), int(config.reflections > 1))
        super().__init__({"active": 1, "axis": AXIS_BITS, "distance": distance_bits or eye_bits(config) - 1} | met)


class Facet(Record):
    """A rectangle as seen by the rays of one row from the camera; see `Walk` for the axis q.

    usable: it may be hit; distance: n = k - E[a] from the camera to its plane. Unless the camera turns, way_q: n D[q],
    the same for all columns. Unless it has no `look`, its lowest bits are the rectangle's `Look`.
    """

    def __init__(self, config: Configuration, way: int | None = None, distance: int = DISTANCE_BITS, look: bool = True):
        looks = {name: bits * look for name, bits in look_fields(config).items()}
        way_q = Signed((way or walk_bits(config)) * (not config.turn))
        super().__init__({"usable": 1, "axis": AXIS_BITS, "distance": Signed(distance), "way_q": way_q} | looks)


class Walk(Record):
    """The compared products that change with the column: n D[p], and (bound - E) D[a] for the four bounds.

    p is y, the axis along which the slope changes per column unless the camera turns, or x for a plane across y. q is
    the third axis; n D[q] changes only if the camera turns.
    """

    def __init__(self, config: Configuration, bits: int | None = None):
        width = bits or walk_bits(config)
        fields = dict.fromkeys(("way_p", "way_q", "low_p", "high_p", "low_q", "high_q"), Signed(width))
        super().__init__(fields | {"way_q": Signed(width * config.turn)})


def growth_of(config: Configuration) -> Walk:
    """Return a record for the change of a `Walk` per column: products if the camera turns, otherwise distances."""
    return Walk(config, None if config.turn else DISTANCE_BITS)


def stride_of(config: Configuration) -> Walk:
    """Return a record for the change of a `Walk` over all columns of a clock."""
    return Walk(config, None if config.turn else DISTANCE_BITS + config.pixels - 1)


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

    def __init__(self, config: Configuration, shift: int | None = None):
        flags = dict.fromkeys(("met_x", "met_y", "met_z", "back_x", "back_y", "back_z"), 1)
        shifts = dict.fromkeys(("shift_x", "shift_y", "shift_z"), Signed(shift or shift_bits(config)))
        super().__init__({**flags, **shifts})


class Fold(Record):
    """The folding of a straight ray through all mirrors so far back into the room; see `ray_fold`.

    It starts with the fields of a `RoomImage`, which together are `image`. mirror_back: the folded ray leaves the last
    mirror in the negative direction; p_x ..., q_x ...: for a rectangle on that axis, the offset added to its way along
    p and q (see `Walk`), plus one if the way is complemented; border_x ...: n D with the last mirror's n; axis,
    distance: those of the last mirror.
    """

    def __init__(
        self,
        config: Configuration,
        product: int | None = None,
        walk: int | None = None,
        shift: int | None = None,
        distance: int = DISTANCE_BITS,
    ):
        image = RoomImage(config, shift).layout
        product, walk = product or fold_bits(config), walk or walk_bits(config)
        others = (
            {"mirror_back": 1}
            | dict.fromkeys(("p_x", "p_y", "p_z", "q_x", "q_y", "q_z"), Signed(product))
            | dict.fromkeys(("border_x", "border_y", "border_z"), Signed(walk))
            | {"axis": AXIS_BITS, "distance": Signed(distance)}
        )
        super().__init__(image | others, {"image": (sum(others.values()), sum(image.values()))})


class Candidate(Record):
    """A hit, if `valid`, at t = numerator / denominator, on the rectangle `index`.

    at_mirror: the hit is in the plane of the mirror that the ray left last, which is another rectangle. With patterns,
    axis, cell: fields of the rectangle.
    """

    def __init__(self, config: Configuration, numerator: int | None = None, denominator: int | None = None):
        numerator, denominator = numerator or eye_bits(config) - 1, denominator or exact_slope_bits(config)
        hit = {"valid": 1, "at_mirror": 1, "numerator": numerator, "denominator": denominator}
        cell = {"axis": AXIS_BITS * config.patterns, "cell": CELL_BITS * config.patterns}
        super().__init__({**hit, **cell, "index": index_bits(config)})


class Winner(Record):
    """The rectangle that a ray sees, if `valid`; at_mirror: as in `Candidate`."""

    def __init__(self, config: Configuration):
        super().__init__({"valid": 1, "at_mirror": 1, "index": index_bits(config)})


class Seen(Record):
    """The rectangle that a ray sees, if `found`: its colour and, if mirrors mix, the share that it mirrors."""

    def __init__(self, config: Configuration):
        mixes = config.materials and config.reflections > 0
        super().__init__({"found": 1, "mirror": MIRROR_BITS * mixes, "colour": RGB_BITS})


class Shade(Record):
    """A ray's contribution to its pixel: a `Colour` and, if mirrors mix, the share of the colour behind it."""

    def __init__(self, config: Configuration):
        super().__init__({"mirror": Seen(config).layout.get("mirror", 0)} | Colour().layout)


class CellDivision(Record):
    """A division after its steps down to a bit place: the rest of the dividend, the divisor, and the cell size.

    cell: as in `Look`; odd: the quotient bit whose weight is the cell size, once it is known.
    """

    def __init__(self, divisor_bits: int, place: int):
        super().__init__({"rest": divisor_bits + place, "divisor": divisor_bits, "cell": CELL_BITS, "odd": 1})


class Sight(Record):
    """The rectangle that a ray sees, if `valid`, and the hit's pattern cell: odd_u, odd_v as in `pattern_colour`."""

    def __init__(self, config: Configuration):
        super().__init__({"valid": 1, "odd_u": 1, "odd_v": 1, "index": index_bits(config)})
