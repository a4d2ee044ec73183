# SPDX-License-Identifier: MIT
"""`scene_player`: every write is held until it is accepted; the buttons held at the interrupt move the camera."""

from collections import deque

from conftest import SMALL_SCENE
from vectors import by, named, stepped

from raycaster.design.decide import configure
from raycaster.program import scene_words
from raycaster.registers import address_bits, register_map
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.system.scene_player import BUTTONS, scene_player
from raycaster.scene import load_scene


@by(rectangles=[4, 12])
def test_scene_player(rectangles, leaf_of, random):
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
