# SPDX-License-Identifier: MIT
"""Leaf tests of `scene_player`: MyHDL and converted Verilog match the expected values on the same vectors."""

from collections import deque

import pytest
from conftest import SMALL_SCENE
from vectors import check, leaf_of, stepped

from raycaster.configuration import configure
from raycaster.program import scene_words
from raycaster.registers import address_bits, register_map
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.system.scene_player import BUTTONS, scene_player
from raycaster.scene import load_scene


@pytest.mark.parametrize("rectangles", [4, 12])
def test_scene_player(rectangles, tmp_path, random):
    """Every write is held until it is accepted; the buttons held at the interrupt move the camera."""
    config = configure(rectangles=rectangles, screen="tiny", units=1, allow_underrun=True)
    scene, count = load_scene(SMALL_SCENE, rectangles), len(BUTTONS)
    ports = {"buttons": count, "avm_m0": lambda: AvalonPort(address_bits(rectangles))}
    leaf = leaf_of(scene_player, tmp_path, config, **ports, scene=scene)
    stimulus = [{"reset": 1, "buttons": 0, "irq": 0, "avm_m0_waitrequest": 1}]
    buttons = 0
    for cycle in range(1, 12000):
        if random.random() < 0.002:
            buttons = int(random.choice([0, *(1 << index for index in range(count)), random.integers(64)]))
        stimulus.append({"reset": int(cycle in (40, 6000)), "buttons": buttons, "irq": int(random.random() < 0.5)})
        stimulus[-1]["avm_m0_waitrequest"] = int(random.random() < 0.3)
    registers, load = register_map(rectangles), scene_words(scene, config)
    pending, camera, enable = (registers[name] for name in ("irq_pending", "camera", "irq_enable"))
    position, frames = [], 0
    writes: deque[tuple[int, int]] = deque()

    def draw() -> None:
        """Write the camera's place and commit it, once the interrupt is cleared."""
        moved = camera.pack(**dict(zip("xyz", position, strict=True)))
        writes.extend([(pending.address, pending.implemented), (camera.address, moved), load[-1]])

    expected = []
    for cycle, inputs in enumerate(stimulus):
        wanted = {"avm_m0_write": bool(writes)}
        if writes:
            wanted |= {"avm_m0_address": writes[0][0], "avm_m0_writedata": writes[0][1], "avm_m0_byteenable": 0b1111}
        expected.append(wanted)
        if inputs["reset"]:
            writes = deque([*load, (enable.address, enable.implemented)])
            position = list(scene.camera.position)
            # The whole program runs once, with or without an interrupt.
            draw()
        elif writes:
            if not inputs["avm_m0_waitrequest"]:
                writes.popleft()
        elif inputs["irq"]:
            held = 0 if any(one["reset"] for one in stimulus[cycle - 2 : cycle]) else stimulus[cycle - 2]["buttons"]
            forward, back, left, right, up, down = (held >> index & 1 for index in range(count))
            pairs = ((forward, back), (right, left), (up, down))
            position = [stepped(value, *pair) for value, pair in zip(position, pairs, strict=True)]
            draw()
            frames += 1
    check(leaf, stimulus, expected, settled=1)
    assert frames > 50
