# SPDX-License-Identifier: MIT
"""Records and groups of signals of the span engine."""

from typing import Any

from raycaster.configuration import Configuration
from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import Signed, bit, signed, tied, unsigned
from raycaster.rtl.common.interfaces import Group
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    CELL_BITS,
    KIND_BITS,
    PLACE_BITS,
    RGB_BITS,
    column_bits,
    count_bits,
    divisor_bits,
    eye_bits,
    eye_distance_bits,
    index_bits,
    line_bits,
    line_factor_bits,
    operand_bits,
    operand_growth_bits,
    weight_bits,
)

AHEAD, U_LOW, U_HIGH, V_LOW, V_HIGH, BEYOND = range(6)
"""Numbers of a rectangle's half-lines: ahead of the eye, within its four bounds, and beyond the last mirror."""

NUMBER_BITS = 3


class Chain(Record):
    """The mirrors that a ray has met, and the columns in which all rays have met them.

    start, stop: the columns, half-open; eye_x ...: the camera mirrored in all of them; back_x ...: the slope's
    component has changed its sign. With reflections: mirrored: there is a last mirror; axis, back, distance: it is met
    at t = distance / e, with e the slope's component on that axis, negated if back; met_x ...: axes of the mirrors
    met in that point; weight: of the next colour, in units of 4 ** -reflections of the picture.
    """

    def __init__(self, config: Configuration):
        columns, some = column_bits(config), int(config.most_reflections > 0)
        super().__init__(
            {"start": columns, "stop": columns}
            | dict.fromkeys(("eye_x", "eye_y", "eye_z"), Signed(eye_bits(config)))
            | dict.fromkeys(("back_x", "back_y", "back_z", "mirrored"), some)
            | {"axis": AXIS_BITS * some, "back": some, "distance": eye_distance_bits(config) * some}
            | dict.fromkeys(("met_x", "met_y", "met_z"), some)
            | {"weight": weight_bits(config) * some}
        )


class Entry(Record):
    """A rectangle that a chain's rays meet in the columns from start up to, and without, stop.

    They meet it at t = distance / e, with e > 0 the slope's component on the rectangle's axis, negated if back.
    """

    def __init__(self, config: Configuration):
        columns = column_bits(config)
        super().__init__(
            {"index": index_bits(config), "axis": AXIS_BITS, "back": 1, "distance": eye_distance_bits(config)}
            | {"start": columns, "stop": columns}
        )


class Frame(Record):
    """State of a chain, kept while the chains behind its mirror are drawn: the chain, and the place of its sweep.

    chain: only with several reflections, as there is only one chain without a mirror; part_stop: the end of the part of
    the span that is being drawn; stop: the span's end; heir, inherited: the entry that is seen next, and whether there
    is one; count: number of the chain's entries.
    """

    def __init__(self, config: Configuration):
        entry, columns = len(Entry(config).word), column_bits(config)
        chain = len(Chain(config).word) * (config.most_reflections > 1)
        super().__init__(
            {"chain": chain, "winner": entry, "heir": entry, "inherited": 1}
            | {"part_stop": columns, "stop": columns, "count": count_bits(config)}
        )


class Paint(Record):
    """The colour of a surface that rays of a span see, and its share in the picture, in units of 4 ** -reflections.

    With patterns, kind, colour_2: as in a `Look`, with kind 0 for a share of 0.
    """

    def __init__(self, config: Configuration):
        some = int(config.patterns)
        super().__init__(
            {"share": weight_bits(config), "colour": RGB_BITS, "kind": KIND_BITS * some, "colour_2": RGB_BITS * some}
        )


class Grid(Record):
    """The pattern of a surface, as a chain's rays see it.

    kind, cell: as in a `Look`, with kind 0 for no pattern; axis, back, distance: of the rectangle's `Entry`; eye_u,
    eye_v: the mirrored eye on the two other axes; back_u, back_v: the slope's components there have changed their
    signs; stop: the column after the surface.
    """

    def __init__(self, config: Configuration):
        super().__init__(
            {"kind": KIND_BITS, "cell": CELL_BITS, "axis": AXIS_BITS, "back": 1, "distance": eye_distance_bits(config)}
            | dict.fromkeys(("eye_u", "eye_v"), Signed(eye_bits(config)))
            | {"back_u": 1, "back_v": 1, "stop": column_bits(config)}
        )


class Cells(Record):
    """The pattern's cells at the present column: their numbers along u and v, and the columns in which the next begin.

    rises_u, rises_v: the next cell has a greater number; next_u, next_v: the surface's end if there is none.
    """

    def __init__(self, config: Configuration):
        cells, columns = PLACE_BITS, column_bits(config)
        super().__init__(
            {"cell_u": cells, "cell_v": cells, "rises_u": 1, "rises_v": 1, "next_u": columns, "next_v": columns}
        )


class Shadows(Record):
    """The light on a surface: dark, it does not reach the present column; until: the column in which that changes, or
    might; count: the number of rectangles that shade it somewhere; stop: the column after the surface."""

    def __init__(self, config: Configuration):
        columns = column_bits(config)
        super().__init__({"dark": 1, "until": columns, "count": count_bits(config), "stop": columns})


class Query(Record):
    """A line f(c) = factor_1 X(c) - factor_2 Y(c) - strict for `line_eval`, asked at the columns left and right.

    X and Y are the components of the slope on axis_1 and axis_2, negated if back_1 and back_2. half_line, last,
    number: returned with the answer. half_line: it belongs to a rectangle's set-up; last: the rectangle has no more.
    With a light, from_light: X and Y are components of the slope from the light, and on axis 3 of e.
    """

    def __init__(self, config: Configuration):
        columns, factor = column_bits(config), Signed(line_factor_bits(config))
        super().__init__(
            {"from_light": int(config.light), "left": columns, "right": columns, "strict": 1}
            | {"axis_1": AXIS_BITS, "back_1": 1, "factor_1": factor}
            | {"axis_2": AXIS_BITS, "back_2": 1, "factor_2": factor}
            | {"half_line": 1, "last": 1, "number": NUMBER_BITS}
        )


class Answer(Group):
    """The values of a line at two columns, `LATENCY` cycles after its query, and the end of a division.

    Attributes:
        valid: a query's answer is here.
        half_line: as in the `Query`.
        last: as in the `Query`.
        number: as in the `Query`.
        left: f at the left column.
        right: f at the right column.
        growth: the change of f from column to column.
        divided: strobe; a division ends.
        columns: columns from the one in which its line has the given value to its change of sign; valid with divided.
    """

    def __init__(self, config: Configuration, **given: Any):
        self.valid, self.half_line, self.last = bit(), bit(), bit()
        self.number = unsigned(NUMBER_BITS)
        self.left, self.right = signed(line_bits(config)), signed(line_bits(config))
        self.growth = signed(divisor_bits(config))
        self.divided, self.columns = bit(), unsigned(column_bits(config))
        super().__init__(**given)


class Aim(Interface):
    """The slope from the light to the points of a surface, times e, and e itself, at both ends of a span.

    Attributes:
        left_x: component along x in the span's first column.
        left_y: component along y there.
        left_z: component along z there.
        left_e: e there.
        right_x: component along x in the span's last column.
        right_y: component along y there.
        right_z: component along z there.
        right_e: e there.
        growth_x: change of the component along x from column to column.
        growth_y: that of the component along y.
        growth_z: that of the component along z.
        growth_e: that of e.
    """

    def __init__(self, config: Configuration):
        bits, growth = operand_bits(config), operand_growth_bits(config)
        self.left_x, self.left_y, self.left_z, self.left_e = (signed(bits) for _ in range(4))
        self.right_x, self.right_y, self.right_z, self.right_e = (signed(bits) for _ in range(4))
        self.growth_x, self.growth_y, self.growth_z, self.growth_e = (signed(growth) for _ in range(4))


class Division(Record):
    """The line whose sign changes, for `first_change`: its value at a column, and its change per column."""

    def __init__(self, config: Configuration):
        super().__init__({"value": Signed(line_bits(config)), "growth": Signed(divisor_bits(config))})


class Asks(Group):
    """Requests to `line_eval` and `first_change`, for which several blocks take turns.

    Attributes:
        ask: strobe; evaluate the query of this cycle.
        query: the line; valid with ask.
        divide: strobe; find where a line's sign changes.
        division: that line; valid with divide.
    """

    def __init__(self, config: Configuration, *, asks: bool = True, divides: bool = True):
        """Make the requests of a block; without some of them, they are tied off."""
        self.ask, self.query = bit(), Query(config)
        self.divide, self.division = bit(), Division(config)
        given: dict[str, Any] = {} if asks else {"ask": tied(0, 1), "query": Query(config).tie({})}
        given |= {} if divides else {"divide": tied(0, 1), "division": Division(config).tie({})}
        super().__init__(**given)


class Run(Interface):
    """A run of columns of one colour; a run is taken in each cycle in which valid and ready are high.

    Attributes:
        valid: a run is offered; it stays until it is taken.
        ready: the run is taken in this cycle if it is valid.
        end: the column after the run's last one.
        colour: red, green and blue, 24 bits.
    """

    def __init__(self, config: Configuration):
        self.valid, self.ready = bit(), bit()
        self.end = unsigned(column_bits(config))
        self.colour = unsigned(RGB_BITS)
