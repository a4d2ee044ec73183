# SPDX-License-Identifier: MIT
"""Which rectangles a group's primary rays may hit, found while the group before it is traced."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.legacy import Facet, PipelinedRects, Prospects, Walk, WideRect
from raycaster.rtl.common.ties import tied, unconnected
from raycaster.rtl.common.widths import (
    RGB_BITS,
    WIDE_BITS,
    bit,
    exact_slope_bits,
    offset_bits,
    row_bits,
    signed,
    unsigned,
    wide_walk_bits,
)
from raycaster.rtl.cull.group_tester import group_tester
from raycaster.rtl.cull.rect_copy import rect_copy
from raycaster.rtl.engine import rect_setup as setup
from raycaster.rtl.engine.rect_setup import rect_setup

LATENCY = setup.LATENCY
"""Cycles from start_group to the first reset_ray_caster that finds an answer, beside one for each rectangle."""

MARGIN = {"seed": 1, "exact": 0}
"""By engine, how far outside a rectangle's bounds a primary ray may pass that hits it, in world units: a rounded
coordinate is off by less than one."""


def prospects_of(config: Configuration) -> Prospects:
    """For an engine's control: without config.culling everything is possible for ever."""
    prospects = Prospects(config)
    if not config.culling:
        prospects.possible = tied((1 << config.rectangles) - 1, prospects.possible)
        prospects.ahead, prospects.alive = tied(1, prospects.ahead), tied(1, prospects.alive)
    return prospects


@block
def group_culler(
    clk, reset_ray_caster, start_group, done, row, column_offset, camera, rects, possible, config: Configuration
):
    """From start_group on, find out for the group that follows in the frame's order, until reset_ray_caster comes.

    possible: a bit for each rectangle, from the second cycle of reset_ray_caster to the next one's; all ones where
    nothing was found out in time, as for a frame's first two groups: the scene may be another one, so the first is
    traced before anything is known of it. rects: listened to, as rect_copy does. start_group, done: of the group at
    (row, column_offset), which is another from the second cycle of reset_ray_caster on.
    """
    units, rectangles = config.units, config.rectangles
    slope_bits = exact_slope_bits(config) + 1
    centre_column = config.screen_geometry.centre_column
    horizon_row = config.screen_geometry.horizon_row
    last_group, last_rectangle = config.groups - 1, rectangles - 1
    everything = (1 << rectangles) - 1
    margin = MARGIN[config.engine]

    first, learned, start_sweep = bit(), bit(), bit()
    next_row = unsigned(row_bits(config))
    next_offset = unsigned(offset_bits(config))
    first_column = unsigned(config.screen_geometry.columns.bit_length())
    column_slope, row_slope = signed(slope_bits), signed(slope_bits)
    swept, finished, foreseen = bit(), bit(), bit()

    copy = PipelinedRects(config)
    copy.usable = rects.usable
    copy.rect = WideRect()
    copy.rect.colour = tied(0, unsigned(RGB_BITS))
    load, found = unsigned(rectangles), unsigned(rectangles)
    facet, growth, start = Facet(config), Walk(WIDE_BITS), Walk(wide_walk_bits(config))
    facet.usable, facet.colour = unconnected(facet.usable), unconnected(facet.colour)

    copies = rect_copy(clk, rects, copy, margin, config)
    sweep = rect_setup(
        clk, reset_ray_caster, start_sweep, copy, camera, column_slope, row_slope, load, facet, growth, start, config
    )
    tester = group_tester(clk, load, facet, growth, start, column_slope, row_slope, found, config)

    # The group in which a frame's rectangles are seen for the first time.
    @always_comb
    def look_first():
        first.next = (row == 0) and (column_offset == 0)

    # From the end of it on they are known.
    @always(clk.posedge)
    def learn():
        if first:
            learned.next = done

    # Then each group looks ahead.
    @always_comb
    def see_start():
        start_sweep.next = start_group and learned

    # To the next group, in the next row after the last.
    @always(clk.posedge)
    def choose_group():
        if start_group:
            if column_offset == last_group:
                next_row.next = row + 1
                next_offset.next = 0
            else:
                next_row.next = row
                next_offset.next = column_offset + 1

    # Its first column.
    @always_comb
    def scale_offset():
        first_column.next = next_offset * units

    # The ray there.
    @always(clk.posedge)
    def aim():
        column_slope.next = first_column - centre_column
        row_slope.next = horizon_row - next_row

    # The last rectangle's bit comes with the end of the sweep.
    @always(clk.posedge)
    def finish():
        swept.next = load[last_rectangle]
        if start_group:
            finished.next = False
        elif swept:
            finished.next = True

    # A row that was abandoned, or a frame, continues elsewhere.
    @always_comb
    def compare_places():
        foreseen.next = learned and finished and (next_row == row) and (next_offset == column_offset)

    # What is not known to be impossible is possible.
    @always(clk.posedge)
    def announce():
        if reset_ray_caster:
            possible.next = everything
            if foreseen:
                possible.next = found

    return (
        copies, sweep, tester, look_first, learn, see_start, choose_group, scale_offset, aim, finish, compare_places,
        announce,
    )  # fmt: skip
