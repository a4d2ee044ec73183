# SPDX-License-Identifier: MIT
"""The colours of runs, mixed from those that a ray sees on its way."""

from myhdl import Signal, always, always_comb, block, enum, instances

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.hdl.signals import bit, unsigned
from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import RGB_BITS, level_bits, weight_bits
from raycaster.rtl.span.records import Paint

PaintState = enum("IDLE", "SUM", "OFFER")


@block
def painter(clk, reset, paint, level, share, colour, emit, stop, picture, run, painted, emitted, config: Configuration):
    """Hold the colour and weight of each level, the number of mirrors before it, and offer runs of the mixed colour.

    Args:
        clk: the clock.
        reset: flag; synchronous reset to idle.
        paint: strobe, only while idle; from now on a ray sees this colour at this level.
        level: unsigned, `level_bits` bits; read with paint and emit, constant from emit to emitted.
        share: unsigned, `weight_bits` bits; the colour's weight in the picture, read with paint.
        colour: unsigned, 24 bits; read with paint.
        emit: strobe; offer the run that ends at stop, in which the levels from 0 to this one are seen.
        stop: unsigned, `column_bits` bits; constant from emit to emitted.
        picture: `Picture`; only reflections is read, constant from emit to emitted.
        run: output `Run`; ready is an input.
        painted: output strobe; the level has been painted.
        emitted: output strobe; the run has been taken.
        config: the design.
    """
    reflections, share_width = config.reflections, weight_bits(config)
    sum_bits = CHANNEL_BITS + share_width - 1  # all shares add up to 1 << (share_width - 1)

    state = Signal(PaintState.IDLE)
    memory = [unsigned(share_width + RGB_BITS) for _ in range(1 << level_bits(config))]
    shown_there, seen = Paint(config), Paint(config)
    seen_colour, mixed = Colour(), Colour()
    summed = unsigned(level_bits(config))
    last = bit()
    red_part, green_part, blue_part = (unsigned(share_width + CHANNEL_BITS) for _ in range(3))
    red, green, blue = (unsigned(sum_bits) for _ in range(3))
    red_shown, green_shown, blue_shown = (unsigned(CHANNEL_BITS) for _ in range(3))

    words = shown_there.joined(share=share, colour=colour)

    @always(clk.posedge)
    def store():
        if paint:
            memory[level].next = words

    @always_comb
    def look_up():
        seen.word.next = memory[summed]

    @always_comb
    def see_colour():
        seen_colour.word.next = seen.colour

    @always_comb
    def weigh():
        red_part.next = seen.share * seen_colour.red
        green_part.next = seen.share * seen_colour.green
        blue_part.next = seen.share * seen_colour.blue

    @always_comb
    def see_end():
        last.next = summed == level
        emitted.next = (state == PaintState.OFFER) and run.ready
        run.valid.next = state == PaintState.OFFER

    @always_comb
    def see_paint():
        painted.next = paint

    @always(clk.posedge)
    def step():
        if reset:
            state.next = PaintState.IDLE
        elif emit:
            state.next = PaintState.SUM
        elif (state == PaintState.SUM) and last:
            state.next = PaintState.OFFER
        elif emitted:
            state.next = PaintState.IDLE

    @always(clk.posedge)
    def add():
        if emit:
            summed.next = 0
            red.next = 0
            green.next = 0
            blue.next = 0
        elif state == PaintState.SUM:
            summed.next = (summed + 1) % (1 << len(summed))
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

    @always_comb
    def mix():
        mixed.word.next = shown

    @always_comb
    def offer():
        run.end.next = stop
        run.colour.next = mixed.word

    return instances()
