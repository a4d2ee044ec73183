# SPDX-License-Identifier: MIT
"""An encoder for one channel of a DVI link: a byte or two control bits become a symbol of ten bits."""

from myhdl import always_comb, always_seq, block, concat, instances

from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.hdl.verbs import assign, plus
from raycaster.rtl.dvi.ones_count import ones_count

SYMBOL_BITS = 10
DISPARITY_BITS = 5
"""Width of half the excess of ones over zeros sent so far, which stays within -4..4, and of its sum with one symbol."""

CONTROL_SYMBOLS = (0b1101010100, 0b0010101011, 0b0101010100, 0b1010101011)
"""The symbols by control bits, c1 above c0."""


@block
def tmds_encoder(clk, enable, data, control, visible, symbol):
    """Encode a channel in TMDS (DVI 1.0, section 3.2): few transitions, as many ones as zeros in the long run.

    Blanking resets the balance of ones and zeros.

    Args:
        enable: strobe, once per pixel; takes the inputs.
        data: unsigned, 8 bits; encoded in the picture. Read with enable.
        control: unsigned, 2 bits, c1 above c0; encoded in blanking. Read with enable.
        visible: flag; high in the picture, low in blanking. Read with enable.
        symbol: unsigned output, 10 bits, bit 0 first; changes one strobe after its inputs were taken, so a reader
            samples it two strobes after them.
    """
    controls = CONTROL_SYMBOLS
    ones, word_ones = unsigned(4), unsigned(4)
    chain_xnor, word_visible, invert = bit(), bit(), bit()
    chained_2, chained_4, chained = (unsigned(8) for _ in range(3))
    word = unsigned(9)
    low_bits = word(8, 0)
    word_control = unsigned(2)
    excess, sent_excess, flags = signed(4), signed(4), signed(2)
    disparity = signed(DISPARITY_BITS)
    sent, add_bits = plus(disparity, sent_excess, Signed(DISPARITY_BITS))
    next_disparity, add_flags = plus(sent, flags, Signed(DISPARITY_BITS))

    data_count = ones_count(data, ones)
    word_count = ones_count(low_bits, word_ones)

    # XNOR if XOR would leave more transitions.
    choose_chain = assign(chain_xnor, lambda: ones > 4 or (ones == 4 and not data[0]))

    # Each bit becomes the XOR of all bits up to it, in three steps.
    chain_two = assign(chained_2, lambda: data ^ concat(data[7:], False))

    chain_four = assign(chained_4, lambda: chained_2 ^ concat(chained_2[6:], False, False))
    chain_eight = assign(chained, lambda: chained_4 ^ concat(chained_4[4:], False, False, False, False))

    # A chain of XNORs differs from a chain of XORs in every second bit.
    @always_seq(clk.posedge, reset=None)
    def keep_word():
        if enable:
            word.next[8:] = chained
            if chain_xnor:
                word.next[8:] = chained ^ 0xAA
            word.next[8] = not chain_xnor
            word_visible.next = visible
            word_control.next = control

    # Half the excess of ones over zeros in the word.
    weigh_word = assign(excess, lambda: word_ones - 4)

    # The complement is sent if it reduces the disparity; if the disparity or the word is balanced, it cannot.
    @always_comb
    def decide():
        if disparity == 0 or excess == 0:
            invert.next = not word[8]
        else:
            invert.next = (excess > 0) == (disparity > 0)

    # The excess added by the eight bits, and by the two flags above them.
    @always_comb
    def weigh_symbol():
        sent_excess.next = excess
        flags.next = 0
        if invert:
            sent_excess.next = -excess
        if word[8] and invert:
            flags.next = 1
        elif not word[8] and not invert:
            flags.next = -1

    @always_seq(clk.posedge, reset=None)
    def send():
        if enable:
            if word_visible:
                symbol.next[8:] = word[8:]
                if invert:
                    symbol.next[8:] = word[8:] ^ 0xFF
                symbol.next[8] = word[8]
                symbol.next[9] = invert
                disparity.next = next_disparity
            else:
                disparity.next = 0
                symbol.next = controls[int(word_control)]

    return instances()
