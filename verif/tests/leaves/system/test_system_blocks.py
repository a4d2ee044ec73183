# SPDX-License-Identifier: MIT
"""Leaf tests of the parts of systems: resets, buttons, and the player of a scene."""

from collections import deque
from itertools import product

from conftest import SMALL_SCENE
from vectors import STEP, by, named, stepped

from raycaster.configuration import COORDINATE_BITS, WORLD_SIZE
from raycaster.design.decide import configure
from raycaster.hdl.signals import bit
from raycaster.memory_map import BUTTON_NAMES, INTERRUPT_BIT
from raycaster.program import scene_words
from raycaster.registers import address_bits, register_map
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.system.button_port import button_port
from raycaster.rtl.system.camera_axis import camera_axis
from raycaster.rtl.system.reset_release import reset_release
from raycaster.rtl.system.scene_player import BUTTONS, scene_player
from raycaster.scene import load_scene

HOLD_CYCLES = 16
"""Cycles for which reset continues after its cause is over."""


def test_reset_release(leaf_of, random):
    """Interruptions of a reset just before and just after its end."""
    ready = [0] * 4
    for _ in range(30):
        length = int(random.choice([1, 2, HOLD_CYCLES - 1, HOLD_CYCLES, HOLD_CYCLES + 1, 2 * HOLD_CYCLES]))
        ready += [1] * length + [0] * int(random.integers(1, 4))
    leaf = leaf_of(reset_release, reset=bit)
    for cycle, value in enumerate(ready):
        # ready takes two cycles to arrive, and one to be counted.
        window = ready[max(0, cycle - HOLD_CYCLES - 2) : max(0, cycle - 2)]
        leaf.case({"ready": value}, {"reset": not (all(window) and len(window) == HOLD_CYCLES)})
    leaf.check(settled=4)


def test_power_up_resets(leaf_of):
    """Without a low ready, reset lasts as long as it does after one, because the registers begin at 0."""
    leaf = leaf_of(reset_release, reset=bit)
    for cycle in range(3 * HOLD_CYCLES):
        leaf.case({"ready": 1}, {"reset": cycle < HOLD_CYCLES + 2})
    leaf.check()


def test_button_port(leaf_of, random):
    """The buttons two cycles late, and the interrupt at once."""
    leaf = leaf_of(button_port, buttons=len(BUTTON_NAMES), word=WORD_BITS)
    for cycle in range(300):
        reset, buttons = int(cycle == 0 or random.random() < 0.05), random.integers(1 << len(BUTTON_NAMES))
        leaf.case({"reset": reset, "buttons": int(buttons), "irq": int(random.integers(2))})
        if cycle > 1:
            before, last, now = leaf.stimulus[-3:]
            held = 0 if before["reset"] or last["reset"] else before["buttons"]
            leaf.expect({"word": held | now["irq"] << INTERRUPT_BIT})
    leaf.check(settled=1)


def test_camera_axis(leaf_of, random):
    """Steps near both walls, and across the whole world and back."""
    leaf = leaf_of(camera_axis, start=COORDINATE_BITS, position=COORDINATE_BITS)
    cases = []
    walls = [*range(2 * STEP), *range(WORLD_SIZE - 2 * STEP, WORLD_SIZE)]
    for start, up in product(walls, (0, 1)):
        cases += [(1, start, 1, 1, 0), (0, start, 1, up, 1 - up)]
        cases += [(0, start, *(int(random.random() < likely) for likely in (0.8, 0.5, 0.5))) for _ in range(40)]
    for more in (1, 0):
        cases += [(0, 0, 1, more, 1 - more)] * (WORLD_SIZE // STEP + 3)
    position = 0
    for case in cases:
        leaf.case(dict(zip(("reset", "start", "move", "more", "less"), case, strict=True)), {"position": position})
        reset, start, move, more, less = case
        if reset:
            position = start
        elif move:
            position = stepped(position, more, less)
    leaf.check(settled=1)


@by(rectangles=[4, 12])
def test_scene_player(rectangles, leaf_of, random):
    """Every write is held until it is accepted; the buttons held at the interrupt move the camera."""
    config = configure(rectangles=rectangles, screen="tiny", units=1, allow_underrun=True)
    scene, count = load_scene(SMALL_SCENE, rectangles), len(BUTTONS)
    ports = {"buttons": count, "avm_m0": lambda: AvalonPort(address_bits(rectangles))}
    leaf = leaf_of(scene_player, config, **ports, scene=scene)
    leaf.case({"reset": 1, "buttons": 0, "irq": 0, "avm_m0_waitrequest": 1})
    buttons = 0
    for cycle in range(1, 12000):
        if random.random() < 0.002:
            buttons = int(random.choice([0, *(1 << index for index in range(count)), random.integers(64)]))
        inputs = {"reset": int(cycle in (40, 6000)), "buttons": buttons, "irq": int(random.random() < 0.5)}
        leaf.case(inputs | {"avm_m0_waitrequest": int(random.random() < 0.3)})
    registers, load = register_map(rectangles), scene_words(scene, config)
    pending, camera, enable = (registers[name] for name in ("irq_pending", "camera", "irq_enable"))
    position, frames = [], 0
    writes: deque[tuple[int, int]] = deque()

    def draw() -> None:
        """Write the camera's place and commit it, once the interrupt is cleared."""
        moved = camera.pack(**dict(zip("xyz", position, strict=True)))
        writes.extend([(pending.address, pending.implemented), (camera.address, moved), load[-1]])

    for cycle, inputs in enumerate(leaf.stimulus):
        leaf.expected[cycle]["avm_m0_write"] = bool(writes)
        if writes:
            write = {"address": writes[0][0], "writedata": writes[0][1], "byteenable": 0b1111}
            leaf.expected[cycle] |= named("avm_m0", write)
        if inputs["reset"]:
            writes = deque([*load, (enable.address, enable.implemented)])
            position = list(scene.camera.position)
            # The whole program runs once, with or without an interrupt.
            draw()
        elif writes:
            if not inputs["avm_m0_waitrequest"]:
                writes.popleft()
        elif inputs["irq"]:
            before, last = leaf.stimulus[cycle - 2 : cycle]
            held = 0 if before["reset"] or last["reset"] else before["buttons"]
            forward, back, left, right, up, down = (held >> index & 1 for index in range(count))
            pairs = ((forward, back), (right, left), (up, down))
            position = [stepped(value, *pair) for value, pair in zip(position, pairs, strict=True)]
            draw()
            frames += 1
    leaf.check(settled=1)
    assert frames > 50
