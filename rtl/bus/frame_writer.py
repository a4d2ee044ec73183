# SPDX-License-Identifier: MIT
"""The writer of frames to a serial line."""

from myhdl import Signal, always_comb, always_seq, block, enum, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.bus.frame_check import CHECK_BITS, frame_check
from raycaster.rtl.bus.uart_transmitter import DATA_BITS
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.serial_frames import ESCAPE, ESCAPED, FLAG

WriterState = enum("IDLE", "OPEN", "WORDS", "CHECK", "CLOSE")


@block
def frame_writer(clk, reset, start, valid, word, last, ready, sending, data, accepted):
    """Send words as a frame: a flag, the words, their check, and a flag; `frame_reader` describes it.

    Args:
        start: strobe; a frame begins. A frame that was being sent ends there, without its check.
        valid: flag; word waits to be accepted.
        word: unsigned, 32 bits; held, like last, until accepted.
        last: flag; the word is the frame's last.
        ready: output flag; word is accepted at the end of this cycle.
        sending: output flag; data waits to be accepted.
        data: unsigned, 8 bits; output. Don't care unless sending and accepted are high.
        accepted: flag; data is accepted at the end of this cycle if sending is high, too. At least `CHECK_CYCLES`
            cycles are between two bytes.
    """
    state = Signal(WriterState.IDLE)
    lane = unsigned(2)
    source, check = unsigned(WORD_BITS), unsigned(CHECK_BITS)
    plain = unsigned(DATA_BITS)
    escaped, special, in_words, in_check, is_flag, advance, add = (bit() for _ in range(7))

    checker = frame_check(clk, clear=start, add=add, data=plain, state=check)

    see_state = assign((in_words, in_check), lambda: (state == WriterState.WORDS, state == WriterState.CHECK))
    see_sending = assign(sending, lambda: valid if state == WriterState.WORDS else state != WriterState.IDLE)
    choose_word = assign(source, lambda: word if in_words else check ^ 0xFFFF_FFFF)

    @always_comb
    def choose_byte():
        plain.next = source[8:0]
        if lane == 1:
            plain.next = source[16:8]
        elif lane == 2:
            plain.next = source[24:16]
        elif lane == 3:
            plain.next = source[32:24]

    judge_is_flag = assign(is_flag, lambda: not in_words and not in_check)
    judge_special = assign(special, lambda: plain in (FLAG, ESCAPE))

    @always_comb
    def drive():
        data.next = plain
        if is_flag:
            data.next = FLAG
        elif special and not escaped:
            data.next = ESCAPE
        elif escaped:
            data.next = plain ^ ESCAPED

    proceed = assign(advance, lambda: sending and accepted and not start and (is_flag or escaped or not special))
    count_words = assign((add, ready), lambda: (advance and in_words, advance and in_words and lane == 3))

    @always_seq(clk.posedge, reset=reset)
    def step():
        if start:
            state.next = WriterState.OPEN
            lane.next = 0
            escaped.next = False
        elif advance:
            escaped.next = False
            if is_flag:
                state.next = WriterState.IDLE
                if state == WriterState.OPEN:
                    state.next = WriterState.WORDS
            elif lane != 3:
                lane.next = lane + 1
            else:
                lane.next = 0
                if in_check:
                    state.next = WriterState.CLOSE
                elif last:
                    state.next = WriterState.CHECK
        elif sending and accepted:
            escaped.next = True

    return instances()
