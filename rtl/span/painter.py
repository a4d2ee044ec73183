# SPDX-License-Identifier: MIT
"""The colours of runs, mixed from those that a ray sees on its way."""

from myhdl import Signal, always, always_comb, block, enum, instances

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.hdl.signals import bit, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import weight_bits

PaintState = enum("IDLE", "SUM", "OFFER", "STEP")


@block
def painter(
    clk, reset, emit, level, stop, picture, seen_share, seen_colour, next_column, stepped, seen, step, place, run,
    emitted, config: Configuration,
):  # fmt: skip
    """Offer the runs of a span, in the mixed colours of what a ray sees at each level, the number of mirrors before it.

    A run ends at the span's end or, before it, where the colour of any level changes, or might.

    Args:
        reset: flag; synchronous reset to idle.
        emit: strobe, while idle; offer the runs from the present column of `surfaces` up to stop.
        level: unsigned, `level_bits` bits; the levels from 0 to this one are seen. Constant from emit to emitted.
        stop: unsigned, `column_bits` bits; the column after the span. Constant from emit to emitted.
        picture: `Picture`; only reflections is read, constant from emit to emitted.
        seen_share: unsigned, `weight_bits` bits; the share of the level that is read.
        seen_colour: unsigned, 24 bits; its colour at the present column.
        next_column: unsigned, `column_bits` bits; the column in which that changes, or might; read with patterns
            or a light.
        stepped: strobe; the level has gone on; read with patterns or a light.
        seen: unsigned output, `level_bits` bits; the level to read, or to go on.
        step: output flag, driven with patterns or a light; the level must go on to place. High up to stepped.
        place: unsigned output, `column_bits` bits; the column after the run.
        run: output `Run`; ready is an input. A register, since the runs before it are compared with it.
        emitted: output strobe; the span's last run is in that register in the next cycle.
    """
    reflections, share_width = config.most_reflections, weight_bits(config)
    sum_bits = CHANNEL_BITS + share_width - 1  # all shares add up to 1 << (share_width - 1)

    state = Signal(PaintState.IDLE)
    colour, mixed = Colour(), Colour()
    last, offers = bit(), bit()
    # Without patterns and a light, a span is one run.
    whole, again = (bit(), bit()) if config.varied else (tied(1, 1), tied(0, 1))
    sums = bit()
    share = unsigned(share_width) if config.varied else seen_share
    red_part, green_part, blue_part = (unsigned(share_width + CHANNEL_BITS) for _ in range(3))
    red, green, blue = (unsigned(sum_bits) for _ in range(3))
    red_shown, green_shown, blue_shown = (unsigned(CHANNEL_BITS) for _ in range(3))

    @always_comb
    def weigh():
        red_part.next = share * colour.red
        green_part.next = share * colour.green
        blue_part.next = share * colour.blue

    @always_comb
    def see_end():
        last.next = seen == level
        offers.next = (state == PaintState.OFFER) and not (sums or run.valid)

    # With patterns or a light, it takes most of a cycle to find a colour.
    if config.varied:
        next_end = unsigned(len(place))

        @always(clk.posedge)
        def keep_seen():
            sums.next = (state == PaintState.SUM) and not reset
            share.next, colour.word.next, next_end.next = seen_share, seen_colour, next_column

        @always_comb
        def see_whole():
            whole.next = place == stop
            step.next = state == PaintState.STEP
            again.next = (state == PaintState.STEP) and stepped and last

        @always(clk.posedge)
        def find_place():
            if (state == PaintState.SUM) and not sums:
                place.next = stop
            elif sums and (next_end < place):
                place.next = next_end

    else:
        see_colour = assign(colour.word, lambda: seen_colour)
        see_sums = assign(sums, lambda: state == PaintState.SUM)
        show_place = assign(place, lambda: stop)

    see_emitted = assign(emitted, lambda: offers and whole)

    @always(clk.posedge)
    def advance():
        if reset:
            state.next = PaintState.IDLE
        elif emit or again:
            state.next = PaintState.SUM
        elif (state == PaintState.SUM) and last:
            state.next = PaintState.OFFER
        elif offers:
            state.next = PaintState.STEP
            if whole:
                state.next = PaintState.IDLE

    @always(clk.posedge)
    def add():
        if reset:
            seen.next = 0
        elif (state == PaintState.SUM) or ((state == PaintState.STEP) and stepped):
            seen.next = (seen + 1) % (1 << len(seen))
            if last:
                seen.next = 0
        if reset or offers:
            red.next = green.next = blue.next = 0
        elif sums:
            red.next = (red + red_part) % (1 << sum_bits)
            green.next = (green + green_part) % (1 << sum_bits)
            blue.next = (blue + blue_part) % (1 << sum_bits)

    # All channels are divided by 4 for each reflection of the scene.
    @always_comb
    def scale():
        red_shown.next = red[CHANNEL_BITS:]
        green_shown.next = green[CHANNEL_BITS:]
        blue_shown.next = blue[CHANNEL_BITS:]
        for i in range(1, reflections + 1):
            if picture.reflections == i:
                red_shown.next = red[2 * i + CHANNEL_BITS : 2 * i]
                green_shown.next = green[2 * i + CHANNEL_BITS : 2 * i]
                blue_shown.next = blue[2 * i + CHANNEL_BITS : 2 * i]

    shown = mixed.joined(red=red_shown, green=green_shown, blue=blue_shown)
    mix = assign(mixed.word, lambda: shown)

    @always(clk.posedge)
    def offer():
        if reset:
            run.valid.next = False
        elif offers:
            run.valid.next = True
        elif run.ready:
            run.valid.next = False
        if offers:
            run.end.next, run.colour.next = place, mixed.word

    return instances()
