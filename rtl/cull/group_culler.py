# SPDX-License-Identifier: MIT
"""Prediction of the rectangles that a group's primary rays may hit, while the previous group is traced."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import Signed, bit, signed, tied, unsigned
from raycaster.hdl.verbs import assign, register, times
from raycaster.rtl.common.interfaces import Place, Rects, Vector
from raycaster.rtl.common.widths import WIDE_BITS, signed_slope_bits, wide_walk_bits
from raycaster.rtl.cull.group_tester import group_tester
from raycaster.rtl.cull.rect_copy import WideRect, rect_copy
from raycaster.rtl.cull.rect_setup import Facet, Walk, rect_setup


@block
def group_culler(clk, reset_ray_caster, start_group, done, place, camera, rects, may_hit, config: Configuration):
    """Predict the rectangles that the next group's primary rays may hit, from start_group to reset_ray_caster.

    After start_group, all rectangles are tested against the next group of the frame. may_hit is loaded only while
    reset_ray_caster is high, so it is constant while a group is traced. It takes the prediction if that is for the
    group at place and all rectangles were tested, and otherwise all ones, which is correct for any group.

    A prediction is correct only for the same scene, whose rectangles are all in rect_copy at done of a frame's first
    group: the first two groups of a frame have no prediction. Neither has a group that does not follow the previous one
    in the frame, or before which reset_ray_caster ends at most `SETUP_LATENCY` + `config.rectangles` cycles after the
    previous group's start_group.

    Args:
        reset_ray_caster: flag; synchronous reset between two groups, of at least two cycles.
        start_group: strobe; the group at place starts.
        done: flag; the group at place has been traced.
        place: `Place` of the group; changes at the end of the first cycle of reset_ray_caster.
        camera: `Camera`; only its position is read.
        rects: `Rects` of the engine; all inputs here, as in rect_copy.
        may_hit: unsigned output, `config.rectangles` bits, one per rectangle; 0 if no primary ray of the group at place
            hits it.
    """
    units, rectangles = config.units, config.rectangles
    slope_bits = signed_slope_bits(config)
    centre_column, horizon_row = config.screen_geometry.centre_column, config.screen_geometry.horizon_row
    last_group, last_rectangle = config.groups - 1, rectangles - 1
    everything = (1 << rectangles) - 1

    first_group, rects_known, start_sweep = bit(), bit(), bit()
    next_place = Place(config)
    first_column, scale_offset = times(next_place.column_offset, units, config.screen_geometry.columns.bit_length())
    column_slope, row_slope = signed(slope_bits), signed(slope_bits)
    slope = Vector(
        slope_bits, x=tied(config.screen_geometry.view_distance, Signed(slope_bits)), y=column_slope, z=row_slope
    )
    swept, all_tested, predicted = bit(), bit(), bit()

    copy = Rects(config, usable=rects.usable, rect=WideRect())
    load, found = unsigned(rectangles), unsigned(rectangles)
    facet, growth, start = Facet(config), Walk(WIDE_BITS), Walk(wide_walk_bits(config))

    copies = rect_copy(clk, rects=rects, copy=copy, margin=config.facts.margin, config=config)
    sweep = rect_setup(
        clk, reset_ray_caster, start_line=start_sweep, rects=copy, camera=camera, slope=slope, load=load,
        facet=facet, growth=growth, start=start, config=config,
    )  # fmt: skip
    tester = group_tester(
        clk, load=load, facet=facet, growth=growth, start=start, column_slope=column_slope, row_slope=row_slope,
        may_hit=found, config=config,
    )  # fmt: skip

    compare_with_first = assign(first_group, lambda: (place.row == 0) and (place.column_offset == 0))

    # A new scene goes live only before a frame's first group.
    know_rects = register(clk, rects_known, lambda: done, first_group)

    start_prediction = assign(start_sweep, lambda: start_group and rects_known)

    @always(clk.posedge)
    def choose_group():
        if start_group:
            if place.column_offset == last_group:
                next_place.row.next = place.row + 1
                next_place.column_offset.next = 0
            else:
                next_place.row.next = place.row
                next_place.column_offset.next = place.column_offset + 1

    aim = register(clk, (column_slope, row_slope), lambda: (first_column - centre_column, horizon_row - next_place.row))

    # group_tester has two stages: the last rectangle's bit is valid when all_tested is high.
    @always(clk.posedge)
    def finish():
        swept.next = load[last_rectangle]
        if start_group:
            all_tested.next = False
        elif swept:
            all_tested.next = True

    # After an abandoned row or frame, the next group is not the predicted one.
    @always_comb
    def compare_places():
        predicted.next = (
            rects_known
            and all_tested
            and (next_place.row == place.row)
            and (next_place.column_offset == place.column_offset)
        )

    # At first predicted is unknown, which a conditional expression would pass on.
    @always(clk.posedge)
    def announce():
        if reset_ray_caster:
            may_hit.next = everything
            if predicted:
                may_hit.next = found

    return instances()
