# SPDX-License-Identifier: MIT
"""Interfaces of blocks that are not yet ported to `interfaces` and `records`."""

from raycaster.configuration import CHANNEL_BITS, COORDINATE_BITS, Configuration
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    DISTANCE_BITS,
    LANES,
    RGB_BITS,
    SLOPE_BITS,
    TURN_BITS,
    WIDE_BITS,
    WORD_BITS,
    bit,
    exact_slope_bits,
    eye_bits,
    fold_bits,
    index_bits,
    position_bits,
    signed,
    unsigned,
    walk_bits,
)


class Interface:
    """A group of signals; generated Verilog names them group_signal."""

    is_interface = True


class Point(Interface):
    """A camera position, in whole world units."""

    def __init__(self):
        self.x, self.y, self.z = (unsigned(COORDINATE_BITS) for _ in range(3))


class Origin(Interface):
    """Where a ray starts, or hits, with the configuration's fraction bits."""

    def __init__(self, config: Configuration):
        self.x, self.y, self.z = (unsigned(position_bits(config)) for _ in range(3))


class Signs(Interface):
    """Which components of a ray's slope are negative. A reflection changes one of them, and nothing else."""

    def __init__(self):
        self.dx, self.dy, self.dz = (bit() for _ in range(3))


class Slope(Interface):
    """Magnitudes of a ray's slope; they are the same before and after a reflection."""

    def __init__(self, bits: int = SLOPE_BITS):
        self.dx, self.dy, self.dz = (unsigned(bits) for _ in range(3))


class Plane(Interface):
    """What starts an intersection: the axis (0, 1, 2 for x, y, z) and the coordinate of the rectangle's plane."""

    def __init__(self):
        self.axis = unsigned(AXIS_BITS)
        self.position = unsigned(COORDINATE_BITS)


class Rect(Interface):
    """What ends an intersection: the plane again, the bounds on the two other axes in the order x, y, z, the colour."""

    def __init__(self):
        self.axis = unsigned(AXIS_BITS)
        self.position, self.u_low, self.u_high, self.v_low, self.v_high = (unsigned(COORDINATE_BITS) for _ in range(5))
        self.colour = unsigned(RGB_BITS)


class WideRect(Interface):
    """A rectangle whose bounds may be a unit further out, two's complement; it has no colour."""

    def __init__(self):
        self.axis = unsigned(AXIS_BITS)
        self.position = unsigned(COORDINATE_BITS)
        self.u_low, self.u_high, self.v_low, self.v_high = (signed(WIDE_BITS) for _ in range(4))


class Colour(Interface):
    """A colour's channels at the full width."""

    def __init__(self):
        self.red, self.green, self.blue = (unsigned(CHANNEL_BITS) for _ in range(3))


class RaySteps(Interface):
    """The control signals that operate all ray units in step.

    screen_to_ray: load the primary ray; initial_ray: trace it, and not a reflected one; find_intersection: start on the
    rectangle at hand; reset_z_buf, write_z_buf: forget, and offer, a hit; reset_colour, add_colour: forget, and add,
    what the ray saw; store_ray: keep the reflected ray. All but initial_ray are strobes of a cycle.
    """

    def __init__(self):
        self.screen_to_ray, self.initial_ray, self.find_intersection = (bit() for _ in range(3))
        self.reset_z_buf, self.write_z_buf, self.reset_colour, self.add_colour, self.store_ray = (
            bit() for _ in range(5)
        )


class Steps(RaySteps):
    """Those of the seed engine: load_divider and store_quotient move what was started through the divider."""

    def __init__(self):
        super().__init__()
        self.load_divider, self.store_quotient = (bit() for _ in range(2))


class Outlook(Interface):
    """What a unit's ray may still meet. alive: it has hit something since reset_z_buf, and at every bounce before.
    ahead, of an impatient design: it has at every bounce before, and runs towards the plane that find_intersection
    started on in the cycle before.
    """

    def __init__(self):
        self.ahead, self.alive = bit(), bit()


class Prospects(Outlook):
    """The same of any unit's ray; possible: a bit for each rectangle, 1 where a primary ray of the group may hit it."""

    def __init__(self, config: Configuration):
        super().__init__()
        self.possible = unsigned(config.rectangles)


class Eye(Interface):
    """The camera, mirrored in all mirrors so far: two's complement, in whole world units."""

    def __init__(self, bits: int):
        self.x, self.y, self.z = (signed(bits) for _ in range(3))


class Mirror(Interface):
    """What a reflected ray left last, if `active`: the axis and the coordinate of the mirror's plane."""

    def __init__(self):
        self.active = bit()
        self.axis = unsigned(AXIS_BITS)
        self.position = unsigned(COORDINATE_BITS)


class Surface(Interface):
    """What a ray that hits a rectangle must know of it."""

    def __init__(self):
        self.axis = unsigned(AXIS_BITS)
        self.position = unsigned(COORDINATE_BITS)
        self.colour = unsigned(RGB_BITS)


class Facet(Interface):
    """A rectangle as one row's rays from the camera see it, u being y unless the plane is on y, then x, and v the rest.

    distance: n = k - E[a] from the camera to its plane; way_v: n D[v], the same for all columns. usable: it may be hit.
    """

    def __init__(self, config: Configuration):
        self.usable = bit()
        self.axis = unsigned(AXIS_BITS)
        self.distance = signed(DISTANCE_BITS)
        self.way_v = signed(walk_bits(config))
        self.colour = unsigned(RGB_BITS)


class Walk(Interface):
    """What cross-multiplication compares, and the column changes: n D[u], and (bound - E) D[a] for the four bounds."""

    def __init__(self, bits: int):
        self.way_u, self.low_u, self.high_u, self.low_v, self.high_v = (signed(bits) for _ in range(5))


class Reflector(Interface):
    """A mirror that a ray left, if `active`: its axis, and the distance from the camera to its plane."""

    def __init__(self):
        self.active = bit()
        self.axis = unsigned(AXIS_BITS)
        self.distance = signed(DISTANCE_BITS)


class Fold(Interface):
    """How a straight ray through all mirrors so far folds back into the room; see `ray_fold`.

    back_x, back_y, back_z: the folded ray runs the other way there; turn_x ...: T, what is added to it there; u_x ...,
    v_x ...: for a rectangle on the axis, what is added to its way along u, and v, one more where that is complemented;
    border_x ...: n D of the last mirror's n. mirror: the last one; mirror_back: the folded ray runs down from it.
    """

    def __init__(self, config: Configuration):
        self.back_x, self.back_y, self.back_z, self.mirror_back = (bit() for _ in range(4))
        self.turn_x, self.turn_y, self.turn_z = (signed(TURN_BITS) for _ in range(3))
        self.u_x, self.u_y, self.u_z, self.v_x, self.v_y, self.v_z = (signed(fold_bits(config)) for _ in range(6))
        self.border_x, self.border_y, self.border_z = (signed(walk_bits(config)) for _ in range(3))
        self.active = bit()
        self.axis = unsigned(AXIS_BITS)
        self.distance = signed(DISTANCE_BITS)


class Candidate(Interface):
    """A hit, if `valid`, at t = numerator / denominator, on the rectangle `index`."""

    def __init__(self, config: Configuration):
        self.valid = bit()
        self.numerator = unsigned(eye_bits(config) - 1)
        self.denominator = unsigned(exact_slope_bits(config))
        self.index = unsigned(index_bits(config))


class SceneBus(Interface):
    """What the registers tell the scene memories: a write, or where to read, and when the shadow moves on.

    write: strobe; address: word address, for write and for reading back; data, mask: the word and which of its bits to
    write; commit: shadow to pending; go_live: pending to live. Both copy at the end of the cycle.
    """

    def __init__(self, address_bits: int):
        self.write, self.commit, self.go_live = bit(), bit(), bit()
        self.address = unsigned(address_bits)
        self.data, self.mask = unsigned(WORD_BITS), unsigned(WORD_BITS)


class SequentialRects(Interface):
    """One live rectangle at a time: sorted, a cycle after `fetch` with its `index`, held until the next fetch.

    usable: a bit for each rectangle, 1 where it is enabled and has a plane.
    """

    def __init__(self, config: Configuration):
        self.usable = unsigned(config.rectangles)
        self.index = unsigned(index_bits(config))
        self.fetch = bit()
        self.rect = Rect()


class PipelinedRects(SequentialRects):
    """The same, but the rectangle comes two cycles after fetch with its index; a new one may be fetched each cycle."""


class ParallelRects(Interface):
    """All live rectangles at once, as they were written; word i of each vector belongs to rectangle i."""

    def __init__(self, config: Configuration):
        self.usable = unsigned(config.rectangles)
        self.corner_0, self.corner_1, self.surface = (unsigned(WORD_BITS * config.rectangles) for _ in range(3))


class ProcessorBus(Interface):
    """PicoRV32's native memory interface: one access at a time, each held still from `valid` to `ready`.

    address: of a byte, a multiple of four; data: what is written, and strobe which of its bytes, or 0 for a read; word:
    what was read, while ready.
    """

    def __init__(self):
        self.valid, self.ready = bit(), bit()
        self.address, self.data, self.word = (unsigned(WORD_BITS) for _ in range(3))
        self.strobe = unsigned(LANES)
