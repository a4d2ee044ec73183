# SPDX-License-Identifier: MIT
"""One rectangle of the scene."""

from myhdl import always, always_comb, block

from raycaster.registers import register_map
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import WORD_BITS, bit
from raycaster.rtl.scene.scene_word import scene_word

REGISTERS = register_map(1)
POINT = REGISTERS["rectangle[0].corner_0"]
SURFACE = REGISTERS["rectangle[0].surface"]
X, Y, Z = (POINT.fields[axis] for axis in "xyz")
ENABLE_BIT = SURFACE.fields["enable"].lsb


@block
def rect_slot(
    clk,
    reset,
    bus,
    number,
    corner_0,
    corner_1,
    surface,
    live_corner_0,
    live_corner_1,
    live_surface,
    usable,
    bad,
):
    """Two corners, a colour and an enable bit, each a scene_word; corner_0, corner_1, surface: the shadow's words.

    number: constant, the slot's address in units of four words. usable: the live rectangle is enabled and has a plane,
    a cycle late. bad: the shadow's is enabled and has none.
    """
    address_width = len(bus.address)
    x_low, x_high = X.lsb, X.lsb + X.width
    y_low, y_high = Y.lsb, Y.lsb + Y.width
    z_low, z_high = Z.lsb, Z.lsb + Z.width
    enable_bit = ENABLE_BIT

    point_bits = tied(POINT.implemented, WORD_BITS)
    surface_bits = tied(SURFACE.implemented, WORD_BITS)
    select_corner_0, select_corner_1, select_surface = bit(), bit(), bit()
    flat, live_flat = bit(), bit()

    word_0 = scene_word(clk, reset, bus, select_corner_0, point_bits, corner_0, live_corner_0)
    word_1 = scene_word(clk, reset, bus, select_corner_1, point_bits, corner_1, live_corner_1)
    word_2 = scene_word(clk, reset, bus, select_surface, surface_bits, surface, live_surface)

    # Which word of this slot a write is for.
    @always_comb
    def decode():
        select_corner_0.next = (bus.address[address_width:2] == number) and (bus.address[2:] == 0)
        select_corner_1.next = (bus.address[address_width:2] == number) and (bus.address[2:] == 1)
        select_surface.next = (bus.address[address_width:2] == number) and (bus.address[2:] == 2)

    # A rectangle's corners share a coordinate.
    @always_comb
    def find_plane():
        flat.next = (
            (corner_0[x_high:x_low] == corner_1[x_high:x_low])
            or (corner_0[y_high:y_low] == corner_1[y_high:y_low])
            or (corner_0[z_high:z_low] == corner_1[z_high:z_low])
        )
        live_flat.next = (
            (live_corner_0[x_high:x_low] == live_corner_1[x_high:x_low])
            or (live_corner_0[y_high:y_low] == live_corner_1[y_high:y_low])
            or (live_corner_0[z_high:z_low] == live_corner_1[z_high:z_low])
        )

    # What is enabled without a plane is reported when it is committed.
    @always_comb
    def judge():
        bad.next = surface[enable_bit] and not flat

    # And it is never traced; the renderer starts later than this register knows.
    @always(clk.posedge)
    def qualify():
        usable.next = live_surface[enable_bit] and live_flat

    return word_0, word_1, word_2, decode, find_plane, judge, qualify
