# SPDX-License-Identifier: MIT
"""The camera's position."""

from myhdl import always_comb, block

from raycaster.registers import register_map
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import WORD_BITS, bit, unsigned
from raycaster.rtl.scene.scene_word import scene_word

CAMERA = register_map(1)["camera"]
X, Y, Z = (CAMERA.fields[axis] for axis in "xyz")


@block
def camera_mem(clk, reset, bus, read_word, camera):
    """A scene_word, taken apart: camera is the live position, read_word the shadow."""
    camera_address = tied(CAMERA.address, len(bus.address))
    x_low, x_high = X.lsb, X.lsb + X.width
    y_low, y_high = Y.lsb, Y.lsb + Y.width
    z_low, z_high = Z.lsb, Z.lsb + Z.width

    implemented = tied(CAMERA.implemented, WORD_BITS)
    selected = bit()
    live = unsigned(WORD_BITS)
    word = scene_word(clk, reset, bus, selected, implemented, read_word, live)

    # Whether a write is for the camera.
    @always_comb
    def decode():
        selected.next = bus.address == camera_address

    # The word's three coordinates.
    @always_comb
    def take_apart():
        camera.x.next = live[x_high:x_low]
        camera.y.next = live[y_high:y_low]
        camera.z.next = live[z_high:z_low]

    return word, decode, take_apart
