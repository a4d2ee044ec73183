# SPDX-License-Identifier: MIT
"""From the VGA output to the symbols of a DVI link."""

from myhdl import Signal, always, always_comb, block

from raycaster.configuration import CHANNEL_BITS
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import bit, unsigned
from raycaster.rtl.dvi.tmds_encoder import SYMBOL_BITS, tmds_encoder


class DviPorts:
    """Signals for every port of dvi_encoder; `all()` are its arguments, by name."""

    def __init__(self):
        self.clk, self.ready, self.pixel_end = bit(), bit(), bit()
        self.vga_r, self.vga_g, self.vga_b = (unsigned(CHANNEL_BITS) for _ in range(3))
        self.vga_hs, self.vga_vs, self.vga_blank_n = (bit() for _ in range(3))
        self.blue, self.green, self.red = (unsigned(SYMBOL_BITS) for _ in range(3))
        self.pixel = bit()

    def all(self) -> dict[str, Signal]:
        """The ports by name, as keyword arguments."""
        return vars(self)


@block
def dvi_encoder(clk, ready, pixel_end, vga_r, vga_g, vga_b, vga_hs, vga_vs, vga_blank_n, blue, green, red, pixel):
    """Channel 0 carries blue and the syncs, 1 green, 2 red, as DVI 1.0 has it, section 2.2.3.

    vga_*: as ray_caster_module has them, 8 bits a colour, one or two cycles of clk a pixel; pixel_end: high in the last
    of them; blue, green, red: symbols, each stable for a pixel, from the second end of a pixel after their own on;
    pixel: changes with them, and is low while ready is, which may change at any time.
    """
    syncs = unsigned(2)
    none = tied(0, 2)
    marked = bit()

    blue_channel = tmds_encoder(clk, pixel_end, vga_b, syncs, vga_blank_n, blue)
    green_channel = tmds_encoder(clk, pixel_end, vga_g, none, vga_blank_n, green)
    red_channel = tmds_encoder(clk, pixel_end, vga_r, none, vga_blank_n, red)

    # Control bits of channel 0.
    @always_comb
    def place_syncs():
        syncs.next[0] = vga_hs
        syncs.next[1] = vga_vs

    # Symbols change at the end of a pixel, and the mark with them.
    @always(clk.posedge)
    def mark():
        if not ready:
            marked.next = False
        elif pixel_end:
            marked.next = not marked

    # The port cannot be read back.
    @always_comb
    def show_mark():
        pixel.next = marked

    return blue_channel, green_channel, red_channel, place_syncs, mark, show_mark
