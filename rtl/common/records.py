# SPDX-License-Identifier: MIT
"""Records of the ray tracer; see `raycaster.hdl.records`."""

from collections.abc import Mapping

from raycaster.configuration import CHANNEL_BITS, COORDINATE_BITS, Configuration
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    BASIS_BITS,
    CELL_BITS,
    KIND_BITS,
    MIRROR_BITS,
    RGB_BITS,
    SHADE_BITS,
)


class Point(Record):
    """A camera position, in whole world units."""

    def __init__(self):
        super().__init__(dict.fromkeys("xyz", COORDINATE_BITS))


class Camera(Record):
    """The camera: the `Point` from which all rays start and, if the design has them, its basis and the light.

    The basis of a camera that turns is forward, right and up, times 256. The light has light_x, light_y, light_z, the
    eye of all shadow rays; light_on, low if everything is lit; and light_shade, the quarters of a colour that remain in
    the dark. A camera that never changes is given the fields' values.
    """

    def __init__(self, config: Configuration, fixed: Mapping[str, int] | None = None):
        basis = (f"{vector}_{axis}" for vector in ("forward", "right", "up") for axis in "xyz")
        light = {f"light_{axis}": COORDINATE_BITS for axis in "xyz"} | {"light_shade": SHADE_BITS, "light_on": 1}
        super().__init__(
            Point().layout
            | dict.fromkeys(basis, Signed(BASIS_BITS * config.turn))
            | {name: bits * config.light for name, bits in light.items()}
        )
        if fixed is not None:
            self.tie(fixed)


class Signs(Record):
    """Signs of a ray's slope components, 1 if negative. A reflection changes one of them and no magnitude."""

    def __init__(self):
        super().__init__(dict.fromkeys(("dx", "dy", "dz"), 1))


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
