# SPDX-License-Identifier: MIT
"""Leaf tests of `scene_player`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

from collections import deque

import pytest
from conftest import SMALL_SCENE
from vectors import ports, stepped

from raycaster.configuration import configure
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.program import scene_words
from raycaster.registers import address_bits, register_map
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.system.scene_player import BUTTONS, scene_player
from raycaster.scene import load_scene


@pytest.mark.parametrize("rectangles", [4, 12])
def test_scene_player(rectangles, tmp_path, random):
    """Every write is held until it is accepted; the buttons held at the interrupt move the camera."""
    config = configure(rectangles=rectangles, screen="tiny", units=1, allow_underrun=True)
    scene = load_scene(SMALL_SCENE, rectangles)
    leaf = Leaf(scene_player, lambda: ports(
        "clk reset irq", buttons=unsigned(len(BUTTONS)), avm_m0=AvalonPort(address_bits(rectangles)), config=config,
        scene=scene
    ), tmp_path)  # fmt: skip
    stimulus = [{"reset": 1, "buttons": 0, "irq": 0, "avm_m0_waitrequest": 1}]
    buttons = 0
    for cycle in range(1, 12000):
        if random.random() < 0.002:
            buttons = int(random.choice([0, *(1 << index for index in range(len(BUTTONS))), random.integers(64)]))
        stimulus.append(
            {
                "reset": int(cycle in (40, 6000)),
                "buttons": buttons,
                "irq": int(random.random() < 0.5),
                "avm_m0_waitrequest": int(random.random() < 0.3),
            }
        )
    outputs = leaf.run_both(stimulus, settled=1)

    registers = register_map(rectangles)
    load = scene_words(scene, config)
    commit = load[-1]
    expected: deque[tuple[int, int]] = deque()
    position: list[int] = []
    frames = 0
    for cycle, (inputs, output) in enumerate(zip(stimulus, outputs, strict=True)):
        if cycle:
            assert output["avm_m0_write"] == int(bool(expected)), cycle
            if expected:
                write = output["avm_m0_address"], output["avm_m0_writedata"]
                assert (write, output["avm_m0_byteenable"]) == (expected[0], 0b1111), cycle
        if inputs["reset"]:
            enable = registers["irq_enable"]
            expected = deque([*load, (enable.address, enable.implemented)])
            position = list(scene.camera.position)
            # The whole program runs once, with or without an interrupt.
            expected += _frame(registers, position, commit)
        elif expected:
            if not inputs["avm_m0_waitrequest"]:
                expected.popleft()
        elif inputs["irq"]:
            held = 0 if any(one["reset"] for one in stimulus[cycle - 2 : cycle]) else stimulus[cycle - 2]["buttons"]
            forward, back, left, right, up, down = (held >> index & 1 for index in range(len(BUTTONS)))
            pairs = ((forward, back), (right, left), (up, down))
            position = [stepped(value, *pair) for value, pair in zip(position, pairs, strict=True)]
            expected += _frame(registers, position, commit)
            frames += 1
    assert frames > 50


def _frame(registers, position, commit) -> list[tuple[int, int]]:
    pending, camera = registers["irq_pending"], registers["camera"]
    moved = camera.pack(**dict(zip("xyz", position, strict=True)))
    return [(pending.address, pending.implemented), (camera.address, moved), commit]
