# SPDX-License-Identifier: MIT
"""The registers about frames that are drawn into lists."""

from myhdl import Signal, always_comb, always_seq, block, instances, intbv

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign
from raycaster.registers import register_map
from raycaster.rtl.common.widths import WORD_BITS


@block
def frame_registers(clk, reset, bus, events, rect_readback, readback, rectangles: int):
    """Keep what became of frames, for software: the registers `frames` of the map.

    Args:
        bus: `SceneBus`; write, address, data and mask are read.
        events: `FrameEvents`; input.
        rect_readback: unsigned, 32 bits; the rectangle memory's word at bus.address.
        readback: unsigned output, 32 bits; the word at bus.address, at other registers' addresses that of the memory.
        rectangles: entries of the rectangle table, 0 if there is none.
    """
    registers = register_map(rectangles, lists=True)
    counts, status = registers["frames.counts"], registers["frames.status"]
    again_low = counts.fields["again"].lsb
    count_bits = counts.fields["drawn"].width
    late_bit, full_bit = (status.fields[name].lsb for name in ("late", "list_full"))
    most = (1 << count_bits) - 1
    none = registers["frames.left"].reset
    cycles_address, left_address, counts_address, status_address = (
        bus.address_of(registers[f"frames.{name}"]) for name in ("cycles", "left", "counts", "status")
    )

    cycles, least = unsigned(WORD_BITS), Signal(intbv(none)[WORD_BITS:])
    drawn, again = unsigned(count_bits), unsigned(count_bits)
    late, list_full, clears = bit(), bit(), bit()
    ones, word = unsigned(WORD_BITS), unsigned(WORD_BITS)

    decode = assign(
        (ones, clears), lambda: (bus.data & bus.mask, bus.write and bus.address == left_address and bus.mask != 0)
    )

    @always_seq(clk.posedge, reset=reset)
    def measure():
        if events.drawn:
            cycles.next = events.time
        if events.late:
            least.next = 0
        elif events.shown and (clears or events.time < least):
            least.next = events.time
        elif clears:
            least.next = none

    @always_seq(clk.posedge, reset=reset)
    def count():
        if events.drawn:
            drawn.next = (drawn + 1) % (most + 1)
        if events.again:
            again.next = (again + 1) % (most + 1)

    # What is set and cleared in the same cycle, is set; the least time, likewise.
    @always_seq(clk.posedge, reset=reset)
    def remember():
        if bus.write and bus.address == status_address:
            if ones[late_bit]:
                late.next = False
            if ones[full_bit]:
                list_full.next = False
        if events.late:
            late.next = True
        if events.list_full:
            list_full.next = True

    @always_comb
    def choose():
        word.next = rect_readback
        if bus.address == cycles_address:
            word.next = cycles
        elif bus.address == left_address:
            word.next = least
        elif bus.address == counts_address:
            word.next[count_bits:] = drawn
            word.next[again_low + count_bits : again_low] = again
        elif bus.address == status_address:
            word.next = 0
            word.next[late_bit] = late
            word.next[full_bit] = list_full

    read = assign(readback, lambda: word)

    return instances()
