# SPDX-License-Identifier: MIT
"""An encoder for one channel of a DVI link: a byte or two control bits become a symbol of ten bits."""

from myhdl import always, block, concat, instances

from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.hdl.verbs import assign, minus, plus, register

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
    chained_2, chained_4, chained, turned, sent_bits = (unsigned(8) for _ in range(5))
    word, word_control, encoded = unsigned(9), unsigned(2), unsigned(SYMBOL_BITS)
    sent_excess, flags, disparity = signed(4), signed(2), signed(DISPARITY_BITS)
    excess, weigh_word = minus(word_ones, 4, Signed(4))
    sent, add_bits = plus(disparity, sent_excess, Signed(DISPARITY_BITS))
    next_disparity, add_flags = plus(sent, flags, Signed(DISPARITY_BITS))

    # XNOR if XOR would leave more transitions.
    count_ones = assign(ones, lambda: data[0] + data[1] + data[2] + data[3] + data[4] + data[5] + data[6] + data[7])
    choose_chain = assign(chain_xnor, lambda: ones > 4 or (ones == 4 and not data[0]))

    # Each bit becomes the XOR of all bits up to it, in three steps.
    chain_two = assign(chained_2, lambda: data ^ concat(data[7:], False))
    chain_four = assign(chained_4, lambda: chained_2 ^ concat(chained_2[6:], False, False))
    chain_eight = assign(chained, lambda: chained_4 ^ concat(chained_4[4:], False, False, False, False))

    # A chain of XNORs differs from a chain of XORs in every second bit.
    turn = assign(turned, lambda: chained ^ 0xAA if chain_xnor else chained)

    keep_word = register(clk, word, lambda: concat(not chain_xnor, turned), enable)
    keep_kind = register(clk, (word_visible, word_control), lambda: (visible, control), enable)

    count = assign(word_ones, lambda: word[0] + word[1] + word[2] + word[3] + word[4] + word[5] + word[6] + word[7])

    # The complement is sent if it reduces the disparity; if the disparity or the word is balanced, it cannot.
    decide = assign(invert, lambda: not word[8] if disparity == 0 or excess == 0 else (excess > 0) == (disparity > 0))

    # The halved excess that the eight bits add, and the two flags above them.
    weigh_bits = assign(sent_excess, lambda: -excess if invert else excess)
    weigh_flags = assign(flags, lambda: word[8] + invert - 1)

    complement = assign(sent_bits, lambda: word[8:] ^ 0xFF if invert else word[8:])
    join = assign(encoded, lambda: concat(invert, word[8], sent_bits))

    @always(clk.posedge)
    def send():
        if enable:
            symbol.next = controls[int(word_control)]
            disparity.next = 0
            if word_visible:
                symbol.next, disparity.next = encoded, next_disparity

    return instances()
