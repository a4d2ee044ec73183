# SPDX-License-Identifier: MIT
"""The surfaces that rays see on their way, with their patterns and the light on them."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, tied, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import KIND_BITS, RGB_BITS, column_bits
from raycaster.rtl.engine.pattern_colour import pattern_colour
from raycaster.rtl.engine.shade_colour import shade_colour
from raycaster.rtl.span.records import Asks, Paint
from raycaster.rtl.span.surface_cells import surface_cells
from raycaster.rtl.span.surface_light import surface_light
from raycaster.rtl.span.surface_table import surface_table


@block
def surfaces(
    clk, reset, paint, level, share, colour, gap, rect, chain, winner, camera, column, stop, seen, step, place, asks,
    answer, set_up_done, entry_count, tested, aim, fan, begin_set_up, shading, shaded_level, read, read_place, painted,
    seen_share, seen_colour, next_column, stepped, config: Configuration,
):  # fmt: skip
    """Hold the surface of each level, the number of mirrors before it: its share and its colour at the present column.

    The present column of all levels is the first one of the surface that was painted last, and moves on with each step.
    Painting and steps take a cycle each if there is neither a pattern nor a light; first come cells, then shadows.

    Args:
        reset: flag; synchronous reset to idle.
        paint: strobe, while idle; from now on a ray sees this surface at this level. share, gap, rect, chain and winner
            are valid in the cycle before it, too.
        level: unsigned, `level_bits` bits; constant from paint to painted, like all inputs up to stop; rect only up to
            begin_set_up.
        share: unsigned, `weight_bits` bits; the surface's share in the picture.
        colour: unsigned, 24 bits; its plain colour.
        gap: flag; it is the background.
        rect: `Rect` of the winner.
        chain: `Chain` whose rays see it.
        winner: `Entry` that is seen, without gap.
        camera: `Camera`; only the light is read.
        column: unsigned, `column_bits` bits; the surface's first column.
        stop: unsigned, `column_bits` bits; the column after its last.
        seen: unsigned, `level_bits` bits; the level that is read, while nothing is painted.
        step: flag, while nothing is painted; the level that is read goes on to the column place. High up to stepped.
        place: unsigned, `column_bits` bits; the present column from now on, not after next_column of any level that is
            in use. Constant while step is high.
        asks: output `Asks`; divide and division are driven with `config.patterns`.
        answer: `Answer`.
        set_up_done: strobe; all shadows of the fan are in their table. Read with `config.light`, like the two below.
        entry_count: unsigned, `count_bits` bits; their number, read with set_up_done.
        tested: `Entry`; the shadow that was read last.
        aim: output `Aim`; valid while lines from the light are evaluated. Driven with `config.light`, like the six
            below.
        fan: output `Chain` of the rays from the light.
        begin_set_up: output strobe; `set_up` must find the shadows.
        shading: output flag; the table of shadows is in use.
        shaded_level: unsigned output, `level_bits` bits; its level.
        read: output strobe; the table must read the shadow at read_place.
        read_place: unsigned output, `index_bits` bits; valid with read.
        painted: output strobe; the surface can be read from the next cycle on.
        seen_share: unsigned output, `weight_bits` bits; the share of the level that is read. Combinational.
        seen_colour: unsigned output, 24 bits; its colour at the present column. Combinational.
        next_column: unsigned output, `column_bits` bits; the column in which that changes, or might. Combinational.
        stepped: output strobe; that level has gone on.
        config: the design, with patterns or a light.
    """
    width, patterns, light = column_bits(config), config.patterns, config.light

    new, surface, bright = Paint(config), Paint(config), Colour()
    kind = unsigned(KIND_BITS) if patterns else tied(0, KIND_BITS)
    unseen = bit()
    pattern = unsigned(RGB_BITS) if patterns else surface.colour
    cells_painted, cells_stepped = (bit(), bit()) if patterns else (paint, step)
    next_cells = unsigned(width)
    cells_asks, light_asks = Asks(config, asks=patterns, divides=patterns), Asks(config, asks=light, divides=False)

    table = surface_table(clk=clk, paint=paint, level=level, given=new, seen=seen, shown=surface, config=config)

    see_need = register(clk, unseen, lambda: gap or (share == 0))

    given = new.joined(share=share, colour=colour, kind=kind, colour_2=rect.colour_2)
    join = assign(new.word, lambda: given)

    if patterns:
        odd_u, odd_v = bit(), bit()

        see_kind = assign(kind, lambda: 0 if unseen else rect.kind)

        cells = surface_cells(
            clk=clk, reset=reset, paint=paint, level=level, kind=kind, rect=rect, chain=chain, winner=winner,
            column=column, stop=stop, seen=seen, step=step, place=place, asks=cells_asks, answer=answer,
            painted=cells_painted, odd_u=odd_u, odd_v=odd_v, next_column=next_cells, stepped=cells_stepped,
            config=config,
        )  # fmt: skip
        painter = pattern_colour(look=surface, odd_u=odd_u, odd_v=odd_v, colour=pattern)

    if light:
        dark, next_light = bit(), unsigned(width)
        lighting = surface_light(
            clk=clk, reset=reset, paint=cells_painted, level=level, unseen=unseen, rect=rect, chain=chain,
            winner=winner, camera=camera, column=column, stop=stop, seen=seen, step=cells_stepped, place=place,
            asks=light_asks, answer=answer, set_up_done=set_up_done, entry_count=entry_count, tested=tested, aim=aim,
            fan=fan, begin_set_up=begin_set_up, busy=shading, looked=shaded_level, read=read, read_place=read_place,
            painted=painted, dark=dark, next_column=next_light, stepped=stepped, config=config,
        )  # fmt: skip

        see_bright = assign(bright.word, lambda: pattern)

        dimmer = shade_colour(colour=bright, dark=dark, shade=camera.light_shade, shaded=seen_colour)

    else:
        show_colour = assign((seen_colour, painted, stepped), lambda: (pattern, cells_painted, cells_stepped))

    if patterns and light:
        see_next = assign(next_column, lambda: next_light if next_light < next_cells else next_cells)

    elif patterns:
        see_next = assign(next_column, lambda: next_cells)

    else:
        see_next = assign(next_column, lambda: next_light)

    show = assign(seen_share, lambda: surface.share)
    request_ask = assign(asks.ask, lambda: cells_asks.ask or light_asks.ask)
    request_asks = assign(asks.query.word, lambda: light_asks.query.word if light_asks.ask else cells_asks.query.word)

    if patterns:

        @always_comb
        def request_division():
            asks.divide.next = cells_asks.divide
            asks.division.word.next = cells_asks.division.word

    return instances()
