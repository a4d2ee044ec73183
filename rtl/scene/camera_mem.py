# SPDX-License-Identifier: MIT
"""The memory of the camera's position and basis, and of the light."""

from myhdl import Signal, always_comb, block, instances, intbv

from raycaster.hdl.signals import bit, tied
from raycaster.hdl.verbs import assign
from raycaster.registers import register_map
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.scene.scene_word import scene_word

REGISTERS = register_map(1)


@block
def camera_mem(clk, reset, bus, readback, camera):
    """Hold the camera: a scene_word for the position, for each vector of its basis if it turns, and for the light.

    Args:
        bus: `SceneBus`; input.
        readback: unsigned, 32 bits; output, combinational: the shadow's word at bus.address, don't care at other
            addresses.
        camera: `Camera` of the live scene; output.
    """
    turns, lit = camera.has("forward_x"), camera.has("light_x")
    names = ("camera", *("forward", "right", "up") * turns, *("light",) * lit)
    registers = [REGISTERS[name] for name in names]
    selects = [bit() for _ in registers]
    shadows, lives = ([Signal(intbv(register.reset)[WORD_BITS:]) for register in registers] for _ in range(2))
    whole = camera.joined(
        **{
            (field if name == "camera" else f"{name}_{field}"): live(bits.lsb + bits.width, bits.lsb)
            for name, register, live in zip(names, registers, lives, strict=True)
            for field, bits in register.fields.items()
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
    camera_address = bus.address_of(registers[0])

    decode = assign(select_position, lambda: bus.address == camera_address)

    if lit:
        select_light, light_word = selects[-1], shadows[-1]
        light_address = bus.address_of(registers[-1])

        decode_light = assign(select_light, lambda: bus.address == light_address)

    else:
        select_light, light_word = tied(0, 1), tied(0, WORD_BITS)

    if turns:
        select_forward, select_right, select_up = selects[1:4]
        forward_word, right_word, up_word = shadows[1:4]
        forward_address, right_address, up_address = map(bus.address_of, registers[1:4])

        decode_basis = assign(
            (select_forward, select_right, select_up),
            lambda: (bus.address == forward_address, bus.address == right_address, bus.address == up_address),
        )

        @always_comb
        def read():
            readback.next = position_word
            if select_forward:
                readback.next = forward_word
            elif select_right:
                readback.next = right_word
            elif select_up:
                readback.next = up_word
            elif select_light:
                readback.next = light_word

    else:
        read = assign(readback, lambda: light_word if select_light else position_word)

    join = assign(camera.word, lambda: whole)

    return instances()
