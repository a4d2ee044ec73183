# SPDX-License-Identifier: MIT
"""The light on the surfaces that rays see on their way."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.hdl.signals import bit, tied, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.by_axis import along_a, by_axis
from raycaster.rtl.common.widths import column_bits, count_bits, level_bits
from raycaster.rtl.span.records import Shadows
from raycaster.rtl.span.shadow_finder import shadow_finder
from raycaster.rtl.span.shadow_scan import shadow_scan


@block
def surface_light(
    clk, reset, paint, level, unseen, rect, chain, winner, camera, column, stop, seen, step, place, asks, answer,
    set_up_done, entry_count, tested, aim, fan, begin_set_up, busy, looked, read, read_place, painted, dark,
    next_column, stepped, config: Configuration,
):  # fmt: skip
    """Hold for the surface of each level, the number of mirrors before it, whether the present column is in the dark.

    The present column of all levels is the first one of the surface that was painted last, and moves on with each step.
    A surface that the light is not strictly in front of is dark, and without shadows.

    Args:
        reset: flag; synchronous reset to idle.
        paint: strobe, while idle; a surface is seen at this level.
        level: unsigned, `level_bits` bits; constant from paint to painted, like chain, winner, camera, column, stop.
        unseen: flag; it needs no light. Read with paint.
        rect: `Rect` of the surface; position is read in the cycle before paint, as are chain and winner.
        chain: `Chain` whose rays see it.
        winner: `Entry` of the surface.
        camera: `Camera`; only the light is read.
        column: unsigned, `column_bits` bits; the surface's first column.
        stop: unsigned, `column_bits` bits; the column after its last.
        seen: unsigned, `level_bits` bits; the level that is read, while nothing is painted.
        step: flag, while nothing is painted; the level that is read goes on to the column place. High up to stepped.
        place: unsigned, `column_bits` bits; the present column from now on, not after next_column of any level that is
            in use. Constant while step is high.
        asks: output `Asks`; only ask and query are driven.
        answer: `Answer`.
        set_up_done: strobe; all shadows of the fan are in their table.
        entry_count: unsigned, `count_bits` bits; their number, read with set_up_done.
        tested: `Entry`; the shadow that was read last.
        aim: output `Aim`; valid while lines from the light are evaluated.
        fan: output `Chain` of the rays from the light.
        begin_set_up: output strobe; `set_up` must find the shadows.
        busy: output flag; the table of shadows is in use.
        looked: unsigned output, `level_bits` bits; its level.
        read: output strobe; the table must read the shadow at read_place.
        read_place: unsigned output, `index_bits` bits; valid with read.
        painted: output strobe; the surface can be read from the next cycle on.
        dark: output flag; the light does not reach the present column, at the level that is read. Combinational.
        next_column: unsigned output, `column_bits` bits; the column in which that changes, or might. Combinational.
        stepped: output strobe; the level that is read has gone on.
        config: the design, with a light.
    """
    width, levels = column_bits(config), 1 << level_bits(config)

    painting, needs, front, in_front, lit, unlit = (bit() for _ in range(6))
    found, scanned, now_dark = bit(), bit(), bit()
    back_a, find, scan = bit(), bit(), bit()
    light_a = unsigned(COORDINATE_BITS)
    here, next_dark = unsigned(width), unsigned(width)
    memory = [unsigned(len(Shadows(config).word)) for _ in range(levels)]
    fresh, shadows, with_count, follow, shown = (Shadows(config) for _ in range(5))
    no_shadows = tied(0, count_bits(config))

    choices = (
        by_axis(winner.axis, *along_a(camera.light_x, camera.light_y, camera.light_z), light_a, width=COORDINATE_BITS),
        by_axis(winner.axis, *along_a(chain.back_x, chain.back_y, chain.back_z), back_a, width=1),
    )

    # The eye is in front of the surface, on the side of the smaller coordinates unless the ray runs towards them.
    see_front = assign(front, lambda: light_a > rect.position if winner.back != back_a else light_a < rect.position)
    keep_front = register(clk, in_front, lambda: front)

    @always_comb
    def see_light():
        lit.next = paint and camera.light_on and in_front and not unseen
        unlit.next = camera.light_on and not (in_front or unseen)

    begun = fresh.joined(dark=unlit, until=stop, count=no_shadows, stop=stop)
    counted = with_count.joined(dark=shadows.dark, until=shadows.until, count=entry_count, stop=shadows.stop)
    gone = follow.joined(dark=now_dark, until=next_dark, count=shadows.count, stop=shadows.stop)

    @always(clk.posedge)
    def keep():
        if paint:
            memory[level].next = begun
        elif found:
            memory[looked].next = counted
        elif scanned:
            memory[looked].next = gone

    choose_looked = assign(looked, lambda: level if painting else seen)
    choose_here = assign(here, lambda: column if painting else place)
    look_up = assign(shadows.word, lambda: memory[looked])
    show = assign(shown.word, lambda: memory[seen])

    see_need = assign(needs, lambda: step and (not busy) and (shown.until == place))

    @always_comb
    def see_end():
        painted.next = (paint and not lit) or (painting and scanned)
        stepped.next = step and not (busy or needs)

    @always(clk.posedge)
    def advance():
        if reset:
            find.next = scan.next = busy.next = painting.next = False
        else:
            find.next = lit
            scan.next = found or needs
            busy.next = lit or needs or (busy and not scanned)
            painting.next = lit or (painting and not scanned)

    finder = shadow_finder(
        clk=clk, reset=reset, start=find, chain=chain, winner=winner, camera=camera, column=column, stop=stop,
        asks=asks, answer=answer, set_up_done=set_up_done, aim=aim, fan=fan, begin_set_up=begin_set_up, done=found,
        config=config,
    )  # fmt: skip
    scanner = shadow_scan(
        clk=clk, reset=reset, start=scan, column=here, stop=shadows.stop, count=shadows.count, tested=tested,
        read=read, place=read_place, dark=now_dark, next_dark=next_dark, done=scanned, config=config,
    )  # fmt: skip

    show_light = assign((dark, next_column), lambda: (shown.dark, shown.until))

    return instances()
