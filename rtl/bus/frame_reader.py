# SPDX-License-Identifier: MIT
"""The reader of frames from a serial line."""

from myhdl import always_comb, always_seq, block, concat, instances

from raycaster.hdl.signals import Unset, bit, bits_for, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.bus.frame_check import CHECK_BITS, RESIDUE, frame_check
from raycaster.rtl.bus.uart_transmitter import DATA_BITS
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.serial_frames import ESCAPE, ESCAPED, FLAG


@block
def frame_reader(clk, reset, received, data, good, words, place, shown, places: int):
    """Collect the words of frames, and report a frame when it has ended and its check is right.

    A frame stands between flags. It has whole words, lowest byte first, of which the last one is the check. Anything
    else between two flags is dropped: bytes with another check, or too many of them. So a flag ends whatever came
    before it, and the next frame is read.

    Args:
        received: strobe, at least `CHECK_CYCLES` cycles after the one before.
        data: unsigned, 8 bits; the byte on the line, read with received.
        good: output strobe, in the cycle after a frame's last flag.
        words: unsigned; output, number of the frame's words without the check. Valid with good and until the next good.
        place: unsigned, below places.
        shown: unsigned, 32 bits; output, the frame's word at place one cycle later. A word is kept until the word at
            the same place has arrived again, in the next frame. Don't care in the cycle after it.
        places: most words of a frame, the check included.
    """
    memory = Unset(places, WORD_BITS)
    most, ended_well = places, RESIDUE
    count = unsigned(bits_for(places + 1) + 2)
    at, lane = count(len(count), 2), count(2, 0)
    earlier = unsigned(WORD_BITS - DATA_BITS)
    plain, word = unsigned(DATA_BITS), unsigned(WORD_BITS)
    state = unsigned(CHECK_BITS)
    escaped, bad, is_flag, is_escape, is_data, store, sound, fresh = (bit() for _ in range(8))

    check = frame_check(clk, clear=fresh, add=is_data, data=plain, state=state)

    @always_comb
    def sort():
        is_flag.next = is_escape.next = is_data.next = False
        if data == FLAG:
            is_flag.next = received
        elif data == ESCAPE:
            is_escape.next = received
        else:
            is_data.next = received
        plain.next = data
        if escaped:
            plain.next = data ^ ESCAPED

    # What comes after a reset is the rest of a frame.
    begin = assign(fresh, lambda: is_flag or reset)
    gather = assign(word, lambda: concat(plain, earlier))
    see_word = assign(store, lambda: is_data and lane == 3 and at != most)
    see_sound = assign(sound, lambda: state == ended_well and lane == 0 and at != 0 and not escaped and not bad)

    @always_seq(clk.posedge, reset=reset)
    def follow():
        good.next = False
        if is_flag:
            good.next = sound
            if sound:
                words.next = at - 1
            count.next = 0
            escaped.next = bad.next = False
        elif is_escape:
            escaped.next = True
        elif is_data:
            escaped.next = False
            earlier.next = word[:DATA_BITS]
            if at == most:
                bad.next = True
            else:
                count.next = count + 1

    keep = register(clk, memory[at], lambda: word, store)
    fetch = register(clk, shown, lambda: memory[place])

    return instances()
