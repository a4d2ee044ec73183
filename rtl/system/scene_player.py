# SPDX-License-Identifier: MIT
"""The Avalon-MM host of a system without a processor: it loads one scene, and moves the camera with buttons."""

from myhdl import always_comb, always_seq, block, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.hdl.signals import bit, bits_for, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.program import scene_words
from raycaster.registers import register_map
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.synchroniser import synchroniser
from raycaster.rtl.common.widths import LANES, WORD_BITS
from raycaster.rtl.system.camera_axis import camera_axis
from raycaster.scene import Scene

BUTTONS = ("forward", "back", "left", "right", "up", "down")
"""Effects of the bits of `buttons`, from bit 0 on: x rises and falls, y falls and rises, z rises and falls."""


def player_program(scene: Scene, config: Configuration) -> tuple[list[tuple[int, int]], int]:
    """Return word addresses and words in the order of writing, and the index at which the part for each frame starts.

    That part clears the interrupt, moves the camera (its word here is only a placeholder) and commits.
    """
    registers = register_map(*config.map)
    enable, pending = registers["irq_enable"], registers["irq_pending"]
    load = scene_words(scene, config)
    frame = [(pending.address, pending.pack(start_screen=1)), (registers["camera"].address, 0), load[-1]]
    return [*load, (enable.address, enable.pack(start_screen=1)), *frame], len(load) + 1


@block
def scene_player(clk, reset, buttons, irq, avm_m0: AvalonPort, config: Configuration, scene: Scene):
    """Load a scene after reset, then a camera at each StartScreen interrupt, as an Avalon-MM host that only writes.

    A camera written at one StartScreen is shown from the next on.

    Args:
        buttons: unsigned, 6 bits, active high; from bit 0 on: forward, back, left, right, up, down, as in BUTTONS. They
            may change at any time, and count if they are held at StartScreen.
        irq: level; the StartScreen interrupt.
        avm_m0: `AvalonPort`, this block as the host: drives address, write, writedata and byteenable, reads
            waitrequest.
        scene: the scene.
    """
    program, first_of_frame = player_program(scene, config)
    addresses, words = (tuple(column) for column in zip(*program, strict=True))
    last = len(program) - 1
    every_lane = (1 << LANES) - 1
    camera = register_map(*config.map)["camera"]
    camera_entry = first_of_frame + 1
    x_low, y_low, z_low = (camera.fields[axis].lsb for axis in "xyz")
    x_high, y_high, z_high = (camera.fields[axis].lsb + camera.fields[axis].width for axis in "xyz")

    entry = unsigned(bits_for(len(program)))
    waiting, move = bit(), bit()
    held = unsigned(len(BUTTONS))
    forward, back, left, right, up, down = (held(index) for index in range(len(BUTTONS)))
    x, y, z = (unsigned(COORDINATE_BITS) for _ in "xyz")
    word = unsigned(WORD_BITS)
    start_x, start_y, start_z = (tied(value, COORDINATE_BITS) for value in scene.camera.position)

    synchronised = synchroniser(clk, reset, value=buttons, held=held)
    axis_x = camera_axis(clk, reset, move, more=forward, less=back, start=start_x, position=x)
    axis_y = camera_axis(clk, reset, move, more=right, less=left, start=start_y, position=y)
    axis_z = camera_axis(clk, reset, move, more=up, less=down, start=start_z, position=z)

    # The camera moves when the part of the program for each frame starts.
    start_frame = assign(move, lambda: waiting and irq)

    # Write after write, each until it is accepted; then wait for the next StartScreen.
    @always_seq(clk.posedge, reset=reset)
    def sequence():
        if waiting:
            if irq:
                waiting.next = False
                entry.next = first_of_frame
        elif not avm_m0.waitrequest:
            if entry == last:
                waiting.next = True
            else:
                entry.next = entry + 1

    look_up = assign((avm_m0.address, word), lambda: (addresses[int(entry)], words[int(entry)]))

    # The camera's word is the only one that is not constant.
    @always_comb
    def present():
        avm_m0.write.next = not waiting
        avm_m0.byteenable.next = every_lane
        avm_m0.writedata.next = word
        if entry == camera_entry:
            avm_m0.writedata.next = 0
            avm_m0.writedata.next[x_high:x_low] = x
            avm_m0.writedata.next[y_high:y_low] = y
            avm_m0.writedata.next[z_high:z_low] = z

    return instances()
