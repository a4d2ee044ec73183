# SPDX-License-Identifier: MIT
"""The camera's position."""

from myhdl import always_comb, block, concat, instances

from raycaster.registers import register_map
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import WORD_BITS, bit, unsigned
from raycaster.rtl.scene.scene_word import scene_word

CAMERA = register_map(1)["camera"]


@block
def camera_mem(clk, reset, bus, readback, camera):
    """A scene_word, taken apart: camera is the live position, readback the shadow's word, 32 bits."""
    address, implemented = tied(CAMERA.address, len(bus.address)), tied(CAMERA.implemented, WORD_BITS)
    selected = bit()
    live = unsigned(WORD_BITS)
    x, y, z = (live(field.lsb + field.width, field.lsb) for field in map(CAMERA.fields.get, "xyz"))

    word = scene_word(clk, reset, bus, selected, implemented=implemented, shadow=readback, live=live)

    @always_comb
    def decode():
        selected.next = bus.address == address

    @always_comb
    def take_apart():
        camera.word.next = concat(x, y, z)

    return instances()
