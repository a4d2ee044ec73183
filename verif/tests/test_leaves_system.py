# SPDX-License-Identifier: MIT
"""What stands for a processor on a board: MyHDL's simulator, the converted Verilog and a model on one stimulus."""

from __future__ import annotations

from collections import deque
from itertools import product

import numpy as np
import pytest
from conftest import SMALL_SCENE

from raycaster.configuration import COORDINATE_BITS, WORLD_SIZE, configure
from raycaster.program import scene_words
from raycaster.registers import address_bits, register_map
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.synchroniser import synchroniser
from raycaster.rtl.common.widths import bit, unsigned
from raycaster.rtl.system.camera_axis import camera_axis
from raycaster.rtl.system.reset_release import reset_release
from raycaster.rtl.system.scene_player import BUTTONS, scene_player
from raycaster.scene import load_scene
from raycaster.verif.leaf import Leaf, reset_signal
from raycaster.verif.seeds import repeat, seed

STEP = 3
"""World units that a button moves the camera by in a frame."""

HOLD_CYCLES = 16
"""Cycles that reset lasts once its cause is over."""


def stepped(position: int, more: int, less: int) -> int:
    """Where a step leads; one out of the world is not made."""
    target = position + STEP * (more - less)
    return target if 0 <= target < WORLD_SIZE else position


def test_camera_axis(tmp_path):
    leaf = Leaf(
        camera_axis,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "move": bit(),
            "more": bit(),
            "less": bit(),
            "start": unsigned(COORDINATE_BITS),
            "position": unsigned(COORDINATE_BITS),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = []
    walls = [*range(2 * STEP), *range(WORLD_SIZE - 2 * STEP, WORLD_SIZE)]
    for start, up in product(walls, (0, 1)):
        stimulus.append({"reset": 1, "start": start, "move": 1, "more": 1, "less": 0})
        stimulus.append({"reset": 0, "start": start, "move": 1, "more": up, "less": 1 - up})
        for _ in range(40):
            move, more, less = (int(random.random() < likely) for likely in (0.8, 0.5, 0.5))
            stimulus.append({"reset": 0, "start": start, "move": move, "more": more, "less": less})
    # Across the whole world and back, and against both walls.
    for more in (1, 0):
        stimulus += [{"reset": 0, "start": 0, "move": 1, "more": more, "less": 1 - more}] * (WORLD_SIZE // STEP + 3)
    position = 0
    for cycle, (inputs, output) in enumerate(zip(stimulus, leaf.run_both(stimulus, settled=1), strict=True)):
        if cycle:
            assert output == {"position": position}, (cycle, repeat())
        if inputs["reset"]:
            position = inputs["start"]
        elif inputs["move"]:
            position = stepped(position, inputs["more"], inputs["less"])


@pytest.mark.parametrize("resettable", [False, True])
@pytest.mark.parametrize("width", [1, 5])
def test_synchroniser(width, resettable, tmp_path):
    leaf = Leaf(
        synchroniser,
        lambda: {
            "clk": bit(),
            "reset": reset_signal() if resettable else None,
            "value": unsigned(width) if width > 1 else bit(),
            "held": unsigned(width) if width > 1 else bit(),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = [{"value": int(random.integers(1 << width))} for _ in range(200)]
    if resettable:
        stimulus = [cycle | {"reset": int(random.random() < 0.1)} for cycle in stimulus]
    for cycle, output in enumerate(leaf.run_both(stimulus, settled=2)):
        if cycle > 1:
            before, last = stimulus[cycle - 2 : cycle]
            expected = 0 if before.get("reset") or last.get("reset") else before["value"]
            assert output == {"held": expected}, (cycle, repeat())


def test_reset_release(tmp_path):
    leaf = Leaf(reset_release, lambda: {"clk": bit(), "ready": bit(), "reset": reset_signal()}, tmp_path)
    random = np.random.default_rng(seed())
    ready = [0] * 4
    for _ in range(30):
        length = int(random.choice([1, 2, HOLD_CYCLES - 1, HOLD_CYCLES, HOLD_CYCLES + 1, 2 * HOLD_CYCLES]))
        ready += [1] * length + [0] * int(random.integers(1, 4))
    outputs = leaf.run_both([{"ready": value} for value in ready], settled=4)
    for cycle in range(4, len(ready)):
        # Two cycles to arrive, and one to be counted.
        window = ready[max(0, cycle - HOLD_CYCLES - 2) : cycle - 2]
        expected = int(not (all(window) and len(window) == HOLD_CYCLES))
        assert outputs[cycle] == {"reset": expected}, (cycle, repeat())


@pytest.mark.parametrize("rectangles", [4, 12])
def test_scene_player(rectangles, tmp_path):
    """Every write is held until it is taken; the camera goes where buttons that were held at the interrupt say."""
    config = configure(rectangles=rectangles, screen="tiny", units=1, allow_underrun=True)
    scene = load_scene(SMALL_SCENE, rectangles)
    leaf = Leaf(
        scene_player,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "buttons": unsigned(len(BUTTONS)),
            "irq": bit(),
            "avm_m0": AvalonPort(address_bits(rectangles)),
            "config": config,
            "scene": scene,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
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
            assert output["avm_m0_write"] == int(bool(expected)), (cycle, repeat())
            if expected:
                write = output["avm_m0_address"], output["avm_m0_writedata"]
                assert (write, output["avm_m0_byteenable"]) == (expected[0], 0b1111), (cycle, repeat())
        if inputs["reset"]:
            enable = registers["irq_enable"]
            expected = deque([*load, (enable.address, enable.implemented)])
            position = list(scene.camera.position)
            # What the program holds is all done once, whether or not an interrupt came.
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
