# SPDX-License-Identifier: MIT
"""The camera's position, and where it looks."""

from myhdl import Signal, always_comb, block, instances, intbv

from raycaster.configuration import Configuration
from raycaster.registers import register_map
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import WORD_BITS, bit
from raycaster.rtl.scene.scene_word import scene_word

REGISTERS = register_map(1)


@block
def camera_mem(clk, reset, bus, readback, camera, config: Configuration):
    """Hold the camera: a scene_word for the position and, where the camera turns, one for each vector of its basis.

    Args:
        clk: the clock.
        reset: synchronous, active high.
        bus: `SceneBus`; input.
        readback: unsigned, 32 bits; output, combinational: the shadow's word at bus.address, don't care at other
            addresses.
        camera: `Camera`; output, the live one.
        config: the design.
    """
    vectors = ("forward", "right", "up") if config.turn else ()
    registers = [REGISTERS[name] for name in ("camera", *vectors)]
    selects = [bit() for _ in registers]
    shadows, lives = ([Signal(intbv(register.reset)[WORD_BITS:]) for register in registers] for _ in range(2))
    whole = camera.joined(
        **{
            vector + axis: live(register.fields[axis].lsb + register.fields[axis].width, register.fields[axis].lsb)
            for vector, register, live in zip(("", *(f"{one}_" for one in vectors)), registers, lives, strict=True)
            for axis in "xyz"
        }
    )

    words = [
        scene_word(
            clk, reset, bus, select, implemented=tied(register.implemented, WORD_BITS), shadow=shadow, live=live,
            first=register.reset,
        )
        for register, select, shadow, live in zip(registers, selects, shadows, lives, strict=True)
    ]  # fmt: skip
    select_position, position_word = selects[0], shadows[0]
    camera_address = tied(registers[0].address, len(bus.address))

    @always_comb
    def decode():
        select_position.next = bus.address == camera_address

    if config.turn:
        select_forward, select_right, select_up = selects[1:]
        forward_word, right_word, up_word = shadows[1:]
        forward_address, right_address, up_address = (
            tied(register.address, len(bus.address)) for register in registers[1:]
        )

        @always_comb
        def decode_basis():
            select_forward.next = bus.address == forward_address
            select_right.next = bus.address == right_address
            select_up.next = bus.address == up_address

        @always_comb
        def read():
            readback.next = position_word
            if select_forward:
                readback.next = forward_word
            elif select_right:
                readback.next = right_word
            elif select_up:
                readback.next = up_word

    else:

        @always_comb
        def read():
            readback.next = position_word

    @always_comb
    def join():
        camera.word.next = whole

    return instances()
