# SPDX-License-Identifier: MIT
"""The joining of neighbouring runs of one colour."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import RGB_BITS, column_bits


@block
def run_joiner(clk, reset, part, run, done, config: Configuration):
    """Join neighbouring runs of one colour, and drop those without columns.

    The last run of a row ends at the number of columns.

    Args:
        reset: flag; synchronous reset, which forgets all runs.
        part: `Run`; ready is an output, which waits for a run of another colour to leave.
        run: output `Run`; ready is an input.
        done: output strobe; the last run of the row was taken in the cycle before.
    """
    columns, width = config.screen_geometry.columns, column_bits(config)

    held, last, same, empty, vacant, leaves, taken = (bit() for _ in range(7))
    held_end, colour = unsigned(width), unsigned(RGB_BITS)

    @always_comb
    def compare():
        same.next = part.colour == colour
        empty.next = part.end == held_end
        last.next = held and (held_end == columns)
        vacant.next = run.ready or not run.valid

    # A held run leaves once it cannot become longer.
    see_leaving = assign(leaves, lambda: held and vacant and (last or (part.valid and not (same or empty))))

    accept = assign(part.ready, lambda: (not last) and ((not held) or same or empty or vacant))
    see_taken = assign(taken, lambda: part.valid and part.ready and not empty)

    @always(clk.posedge)
    def hold():
        if reset:
            held.next = False
        elif taken:
            held.next = True
        elif leaves:
            held.next = False
        # A row begins at column 0.
        if reset:
            held_end.next = 0
        elif taken:
            held_end.next = part.end
        elif leaves:
            held_end.next = 0
        if taken:
            colour.next = part.colour

    @always(clk.posedge)
    def offer():
        if reset:
            run.valid.next = False
        elif leaves:
            run.valid.next = True
        elif run.ready:
            run.valid.next = False
        if leaves:
            run.end.next, run.colour.next = held_end, colour

    finish = register(clk, done, lambda: run.valid and run.ready and (run.end == columns) and not reset)

    return instances()
