# SPDX-License-Identifier: MIT
"""A unit of the span engine: it draws a row as runs of columns of one colour."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, tied, unconnected, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.interfaces import Rects, Vector
from raycaster.rtl.common.widths import (
    RGB_BITS,
    column_bits,
    count_bits,
    index_bits,
    level_bits,
    signed_slope_bits,
    step_bits,
    weight_bits,
)
from raycaster.rtl.span.chain_stack import chain_stack
from raycaster.rtl.span.corner_finder import corner_finder
from raycaster.rtl.span.entry_table import entry_table
from raycaster.rtl.span.fold import fold
from raycaster.rtl.span.line_desk import line_desk
from raycaster.rtl.span.painter import painter
from raycaster.rtl.span.records import Aim, Answer, Asks, Chain, Entry, Frame, Paint, Run
from raycaster.rtl.span.run_joiner import run_joiner
from raycaster.rtl.span.set_up import set_up
from raycaster.rtl.span.span_control import span_control
from raycaster.rtl.span.surface_table import surface_table
from raycaster.rtl.span.surfaces import surfaces
from raycaster.rtl.span.sweep import sweep


@block
def span_unit(clk, reset, start, slope, rects, camera, picture, run, done, config: Configuration):
    """Draw a row as runs of columns of one colour, from left to right, to the last bit as the image contract has it.

    Along a row the slope of the rays is linear in the column, so all decisions are signs of lines, and the columns in
    which they change. The work depends on what is seen in the row, and hardly on the number of columns (Watkins 1970).

    Args:
        reset: synchronous, active high; ends the row.
        start: strobe; draws a row. Only after reset, and from the cycle of done on.
        slope: `Vector` of `signed_slope_bits` bits; the slope of column 0 of that row, read with start.
        rects: `Rects`; index and fetch are outputs. All others are constant from start to done.
        camera: `Camera`; constant from start to done. If it turns, only right of its basis is read.
        picture: `Picture`; reflections and background are read, constant from start to done.
        run: output `Run`; ready is an input. Neighbouring runs differ in colour, and the last one of the row ends at
            the number of columns.
        done: output strobe, in the cycle after that in which the last run was taken.
    """
    width, mirrors = column_bits(config), config.most_reflections > 0

    first_slope, step, answer = Vector(signed_slope_bits(config)), Vector(step_bits(config)), Answer(config)
    chain, winner, heir, swept_heir, entry, tested = Chain(config), *(Entry(config) for _ in range(5))
    set_up_asks, sweep_asks, corner_asks = Asks(config), Asks(config), Asks(config, asks=mirrors, divides=False)
    surface_asks = Asks(config, asks=config.varied, divides=config.patterns)
    column, stop, swept_stop = (unsigned(width) for _ in range(3))
    begin_set_up, begin_sweep, begin_paint, begin_emit, fetch = (bit() for _ in range(5))
    set_up_done, sweep_done, emitted, painted = (bit() for _ in range(4))
    gap, inherited, swept_inherited, append, read = (bit() for _ in range(5))
    level, place = unsigned(level_bits(config)), unsigned(index_bits(config))
    entry_count, count = unsigned(count_bits(config)), unsigned(count_bits(config))
    share = unsigned(weight_bits(config)) if mirrors else tied(1, weight_bits(config))
    colour = unsigned(RGB_BITS)
    seen, reached = unsigned(level_bits(config)), unsigned(width)
    seen_share, seen_colour = unsigned(weight_bits(config)), unsigned(RGB_BITS)
    aim, fan = Aim(config), Chain(config)
    begin_fan, read_shadow = (bit(), bit()) if config.light else (unconnected(1), unconnected(1))
    shading = bit() if config.light else tied(0, 1)
    read_entry, entry_place, shadow_place, shaded_level = read, place, place, level
    rays, start_set_up, table_level = chain, begin_set_up, level
    if config.light:
        read_entry, entry_place, shadow_place = bit(), unsigned(index_bits(config)), unsigned(index_bits(config))
        shaded_level, table_level = unsigned(level_bits(config)), unsigned(level_bits(config))
        rays, start_set_up = Chain(config), bit()
    walk, part = Rects(config, usable=rects.usable, rect=rects.rect), Run(config)

    if mirrors:
        folded, kept, frame = Chain(config), Frame(config), Frame(config)
        begin_corner, cornered, corner, corner_done, push = (bit() for _ in range(5))
        part_stop, passed_on = unsigned(width), unsigned(weight_bits(config))
        behind = (
            corner_finder(
                clk=clk, reset=reset, start=begin_corner, chain=chain, winner=winner, column=column, stop=stop,
                asks=corner_asks, answer=answer, needed=cornered, corner=corner, part_stop=part_stop, done=corner_done,
                config=config,
            ),
            fold(
                chain=chain, winner=winner, column=column, stop=part_stop, corner=corner, weight=passed_on,
                folded=folded, config=config,
            ),
            chain_stack(clk=clk, push=push, level=level, kept=kept, frame=frame, config=config),
        )  # fmt: skip
        now = kept.joined(
            chain=chain.word,
            winner=winner.word,
            heir=heir.word,
            inherited=inherited,
            part_stop=part_stop,
            stop=stop,
            count=count,
        )

        keep_frame = assign(kept.word, lambda: now)

    else:
        folded, frame = Chain(config).tie({}), Frame(config).tie({})
        cornered, corner_done = tied(0, 1), tied(0, 1)
        begin_corner, push, passed_on = unconnected(1), unconnected(1), unconnected(1)

    if config.varied:
        go_on, stepped = bit(), bit()
        next_column = unsigned(width)
        looks = surfaces(
            clk=clk, reset=reset, paint=begin_paint, level=level, share=share, colour=colour, gap=gap, rect=rects.rect,
            chain=chain, winner=winner, camera=camera, column=column, stop=stop, seen=seen, step=go_on, place=reached,
            asks=surface_asks, answer=answer, set_up_done=set_up_done, entry_count=entry_count, tested=tested, aim=aim,
            fan=fan, begin_set_up=begin_fan, shading=shading, shaded_level=shaded_level, read=read_shadow,
            read_place=shadow_place, painted=painted, seen_share=seen_share, seen_colour=seen_colour,
            next_column=next_column, stepped=stepped, config=config,
        )  # fmt: skip
    else:
        stepped, next_column, go_on = tied(0, 1), tied(0, width), unconnected(1)
        given, surface = Paint(config), Paint(config)
        plain = given.joined(share=share, colour=colour)
        looks = surface_table(
            clk=clk, paint=begin_paint, level=level, given=given, seen=seen, shown=surface, config=config
        )

        @always_comb
        def show_surface():
            given.word.next, painted.next = plain, begin_paint
            seen_share.next, seen_colour.next = surface.share, surface.colour

    # The shadows on a surface are found like the entries of a chain. It is far from both to the set-up.
    if config.light:

        @always(clk.posedge)
        def choose_rays():
            start_set_up.next = (begin_set_up or begin_fan) and not reset
            rays.word.next = chain.word
            if shading:
                rays.word.next = fan.word

        choose_table_level = assign(table_level, lambda: shaded_level if shading else level)
        choose_read = assign(read, lambda: read_entry or read_shadow)
        choose_place = assign(place, lambda: shadow_place if shading else entry_place)

    control = span_control(
        clk=clk, reset=reset, start=start, camera=camera, picture=picture, rect=rects.rect, set_up_done=set_up_done,
        entry_count=entry_count, sweep_done=sweep_done, swept_stop=swept_stop, swept_inherited=swept_inherited,
        swept_heir=swept_heir, cornered=cornered, corner_done=corner_done, folded=folded, frame=frame,
        painted=painted, emitted=emitted, begin_set_up=begin_set_up, begin_sweep=begin_sweep,
        begin_corner=begin_corner, begin_paint=begin_paint, begin_emit=begin_emit, push=push, fetch=fetch,
        level=level, chain=chain, winner=winner, gap=gap, column=column, stop=stop, heir=heir, inherited=inherited,
        count=count, share=share, colour=colour, passed_on=passed_on, config=config,
    )  # fmt: skip
    finder = set_up(
        clk=clk, reset=reset, start=start_set_up, chain=rays, from_light=shading, rects=walk,
        asks=set_up_asks, answer=answer, append=append, entry=entry, count=entry_count, done=set_up_done, config=config,
    )  # fmt: skip
    table = entry_table(
        clk=clk, level=table_level, shadows=shading, append=append, number=entry_count, entry=entry, read=read,
        place=place, stored=tested, config=config,
    )  # fmt: skip
    sweeper = sweep(
        clk=clk, reset=reset, start=begin_sweep, gap=gap, column=column, chain_stop=chain.stop, winner=winner,
        count=count, tested=tested, asks=sweep_asks, answer=answer, read=read_entry, place=entry_place, stop=swept_stop,
        inherited=swept_inherited, heir=swept_heir, done=sweep_done, config=config,
    )  # fmt: skip
    desk = line_desk(
        clk=clk, reset=reset, set_up_asks=set_up_asks, sweep_asks=sweep_asks, corner_asks=corner_asks,
        surface_asks=surface_asks, slope=first_slope, step=step, aim=aim, answer=answer, config=config,
    )  # fmt: skip
    mixer = painter(
        clk=clk, reset=reset, emit=begin_emit, level=level, stop=stop, picture=picture, seen_share=seen_share,
        seen_colour=seen_colour, next_column=next_column, stepped=stepped, seen=seen, step=go_on, place=reached,
        run=part, emitted=emitted, config=config,
    )  # fmt: skip
    joiner = run_joiner(clk=clk, reset=reset, part=part, run=run, done=done, config=config)

    @always(clk.posedge)
    def keep_slope():
        if start:
            first_slope.x.next, first_slope.y.next, first_slope.z.next = slope.x, slope.y, slope.z

    # The camera is far from most units.
    if config.turn:

        @always(clk.posedge)
        def keep_step():
            if start:
                step.x.next, step.y.next, step.z.next = camera.right_x, camera.right_y, camera.right_z

    # One of them works at a time.
    choose_fetch = assign(rects.fetch, lambda: walk.fetch or fetch)
    choose_index = assign(rects.index, lambda: winner.index if fetch else walk.index)

    return instances()
