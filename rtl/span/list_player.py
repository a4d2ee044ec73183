# SPDX-License-Identifier: MIT
"""The monitor's side of the lists."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.hdl.signals import bit, bits_for, tied, unconnected, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.span.list_memory import list_memory
from raycaster.rtl.span.pair_player import pair_player
from raycaster.rtl.span.pixel_player import pixel_player
from raycaster.rtl.span.read_ahead import read_ahead
from raycaster.rtl.span.row_place import row_place
from raycaster.rtl.span.run_memory import BANK_PLACES, read_latency


@block
def list_player(
    clk, reset, scan, upper, view_run, write, write_place, written, shown, pixels: int, entries: int,
    bank: int = BANK_PLACES,
):  # fmt: skip
    """Keep both lists, and play the one in view.

    With two pixels per clock, even and odd entries of a list have memories of their own, since two runs of one pixel
    each may be needed in every clock. Each memory is read ahead, so that no comparison with an entry decides about an
    address.

    A line must begin at least eight cycles and the latency of a `list_memory` before its first pixel.

    Args:
        scan: `Scan`, a cycle ahead of the pixels: with one clock per pixel, lead=1 of the `video_generator`.
        upper: flag; the upper list is drawn, and the lower one is in view. Changes only in the cycle after
            scan.start_screen.
        view_run: flag; there is a frame in the list in view. Changes like upper.
        write: strobe; written belongs to the list that is drawn.
        write_place: unsigned, `entry_bits` bits; number of the entry.
        written: `ListEntry`.
        shown: unsigned output; the pixels of a clock, each as in `ListEntry`, the left one in the lowest bits.
        pixels: pixels per clock, 1 or 2.
        entries: entries of a list, an even number.
        bank: places of a bank of a memory.
    """
    places = entries // pixels
    place_bits = bits_for(places)

    place = unsigned(len(write_place))
    restart, playing = bit(), bit()
    taken = unsigned(2)
    firsts, reads = ([unsigned(place_bits) for _ in range(pixels)] for _ in range(2))
    writes, takes = ([bit() for _ in range(pixels)] for _ in range(2))
    bank_place = unsigned(place_bits)
    fetched, heads = ([written.twin() for _ in range(pixels)] for _ in range(2))

    follower = row_place(
        clk, reset, scan=scan, view_run=view_run, taken=taken, restart=restart, place=place,
        playing=playing,
    )  # fmt: skip
    memories = [
        list_memory(
            clk, upper=upper, write=writes[i], write_place=bank_place, written=written, read_place=reads[i],
            shown=fetched[i], places=places, bank=bank,
        )
        for i in range(pixels)
    ]  # fmt: skip
    readers = [
        read_ahead(
            clk, restart=restart, first=firsts[i], more=tied(1, 1), shown=fetched[i], take=takes[i],
            fetch=unconnected(1), read_place=reads[i], offered=unconnected(1), head=heads[i], places=places,
            latency=read_latency(places, bank),
        )
        for i in range(pixels)
    ]  # fmt: skip

    if pixels == 1:
        (bank_write,), (bank_first,), (bank_take,) = writes, firsts, takes
        player = pixel_player(
            clk, playing=playing, visible_line=scan.visible_line, next_column=scan.next_column, head=heads[0],
            take=bank_take, pixel=shown,
        )  # fmt: skip

        @always_comb
        def find_places():
            bank_write.next = write
            bank_place.next = write_place[place_bits:]
            bank_first.next = place[place_bits:]

        count = assign(taken, lambda: 1 if bank_take else 0)

    else:
        write_even, write_odd = writes
        first_even, first_odd = firsts
        take_even, take_odd = takes
        odd = bit()
        bits, last = place_bits + 1, entries - 1
        left, right = (unsigned(len(written.pixel)) for _ in range(2))
        player = pair_player(
            clk, playing=playing, visible_line=scan.visible_line, next_column=scan.next_column, odd=odd,
            head_0=heads[0], head_1=heads[1], take_0=take_even, take_1=take_odd, left=left, right=right,
        )  # fmt: skip

        # Whether the present entry is an odd one, which place tells a cycle later.
        @always(clk.posedge)
        def follow():
            if restart:
                odd.next = place[0]
            elif take_even != take_odd:
                odd.next = not odd

        @always_comb
        def find_places():
            write_even.next = write and not write_place[0]
            write_odd.next = write and write_place[0]
            bank_place.next = write_place[bits:1]

        @always_comb
        def find_firsts():
            first_odd.next = first_even.next = place[bits:1]
            if place == last:
                first_even.next = 0
            elif place[0]:
                first_even.next = (place[bits:1] + 1) % (1 << place_bits)

        join = assign(shown, lambda: concat(right, left))

        @always_comb
        def count():
            taken.next = 0
            if take_even and take_odd:
                taken.next = 2
            elif take_even or take_odd:
                taken.next = 1

    return instances()
