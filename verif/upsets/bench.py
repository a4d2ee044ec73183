# SPDX-License-Identifier: MIT
"""cocotb: a design is disturbed while it draws, once a case, and must come back.

A case is one of three: a bit of a register or memory flips; reset comes for some clocks; or a host does as it likes on
the bus for some clocks. All that is chosen at random follows from the case's number.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from random import Random

import cocotb
import numpy as np
from cocotb.handle import ArrayObject, HierarchyObject, LogicArrayObject, LogicObject, PackedObject
from cocotb.simtime import get_sim_time
from cocotb.triggers import ClockCycles, FallingEdge, SimTimeoutError, with_timeout

from raycaster.golden.picture import count_wrong
from raycaster.scene import Scene
from raycaster.sim.harness import Harness
from raycaster.sim.monitor import CLOCK_NS, VideoError
from raycaster.verif.random_scenes import random_scene

Register = LogicObject | LogicArrayObject | PackedObject | ArrayObject
"""A register, or a memory."""

KINDS = (*8 * ("upset",), "reset", "bus")
"""One of ten cases each for reset and for the bus."""

FRAMES = 3
"""That a design gets to be right in: the disturbed one, the next, and one more where a sync came early or late."""

MOST_CLOCKS = 40
"""That reset or a wild host takes."""

PATIENCE = 1000
"""Clocks that an access of the bus may take; the slowest needs some ten."""


@cocotb.test()
async def disturb(bench: HierarchyObject) -> None:
    """Disturb the design once a case; write a line of JSON for each, and fail where it did not come back."""
    harness = Harness(bench)
    registers = list(
        find_registers(harness.bench.dut, {name: set(found) for name, found in harness.job.registers.items()})
    )
    assert registers, "there is nothing to flip"
    lost = []
    with (Path(harness.job.output) / "results.jsonl").open("w") as results:
        for number in harness.job.seeds:
            result = {"case": number} | await _case(harness, registers, number)
            if result["outcome"] == "hangs":
                lost.append(number)
            results.write(json.dumps(result) + "\n")
            results.flush()
    assert not lost, f"did not come back in cases {lost}"


def find_registers(scope: HierarchyObject, names: Mapping[str, set[str]]) -> Iterator[Register]:
    """The registers and memories within an instance, by the names that each module has."""
    for child in scope:
        if isinstance(child, HierarchyObject):
            yield from find_registers(child, names)
        elif isinstance(child, Register) and child._name in names.get(scope._def_name or "", ()):
            yield child


def bits_of(register: Register) -> int:
    """The number of bits of a register, or of all words of a memory."""
    if isinstance(register, ArrayObject):
        return len(register) * len(register[register.range.left])
    return len(register)


async def _case(harness: Harness, registers: list[Register], number: int) -> dict[str, object]:
    """What was done, what became of it, and the frames from then on that were not right."""
    random = Random(number)
    configuration, screen = harness.configuration, harness.screen
    scene, other = (
        random_scene(seed, configuration.rectangles, configuration.reflections, configuration.looks)
        for seed in (number, number + 1)
    )
    await harness.reset()
    await _program(harness, scene)
    assert await _look(harness, harness.golden(scene, scene.reflections)) == "right", "wrong before anything happened"

    await ClockCycles(harness.bench.clk, random.randrange(1, screen.vertical.total * screen.line_cycles))
    await FallingEdge(harness.bench.clk)
    kind = random.choice(KINDS)
    told = await {"upset": _flip, "reset": _reset, "bus": _misuse}[kind](harness, registers, random)
    at = get_sim_time("ns") // CLOCK_NS
    result = {"kind": kind, "clock": at} | told

    seen = []
    if kind == "upset":
        seen = await _look_until_right(harness, scene)
    # Then, or where software has to load its scene again, the next commit mends what is left.
    mended = "unseen" if seen == ["right", "right"] else "StartScreen" if seen[-1:] == ["right"] else "commit"
    came_back = await _answers(harness) and await _shows(harness, other)
    wrong = [each for each in seen if each != "right"]
    return result | {"outcome": mended if came_back else "hangs", "wrong": len(wrong), "lost_sync": "sync" in wrong}


async def _look_until_right(harness: Harness, scene: Scene) -> list[str]:
    """Look at the disturbed frame, and on until one is right after it."""
    picture, seen = harness.golden(scene, scene.reflections), []
    while len(seen) < FRAMES and not (len(seen) > 1 and seen[-1] == "right"):
        seen.append(await _look(harness, picture))
    return seen


async def _look(harness: Harness, picture: np.ndarray) -> str:
    """How the next frame is: right, wrong, or sync where that was not as it should be."""
    try:
        frame = await harness.monitor.frame()
    except VideoError:
        harness.monitor.forget()
        return "sync"
    return "wrong" if count_wrong(frame, picture) else "right"


async def _program(harness: Harness, scene: Scene) -> None:
    await harness.bus.load_scene(scene)
    await harness.bus.commit(reflections=scene.reflections)


async def _answers(harness: Harness) -> bool:
    """Whether the bus still says what the design is."""
    expected = harness.bus.registers["id"].reset
    word = harness.bus.read_word(harness.bus.registers["id"].address)
    try:
        return await with_timeout(word, PATIENCE * CLOCK_NS, "ns") == expected
    except SimTimeoutError:
        return False


async def _shows(harness: Harness, scene: Scene) -> bool:
    """Whether a scene is shown, in one of the next frames."""
    try:
        # A word takes less than a tenth of that.
        writes = PATIENCE * CLOCK_NS * (4 * harness.configuration.rectangles + 8)
        await with_timeout(_program(harness, scene), writes, "ns")
    except SimTimeoutError:
        return False
    picture = harness.golden(scene, scene.reflections)
    return any([await _look(harness, picture) == "right" for _ in range(FRAMES)])


async def _flip(harness: Harness, registers: list[Register], random: Random) -> dict[str, object]:
    """Flip a bit; each one of all registers and memories is as likely as any other."""
    [register] = random.choices(registers, [bits_of(register) for register in registers])
    if isinstance(register, ArrayObject):
        register = register[random.choice(list(register.range))]
    bit = random.randrange(len(register))
    register.value = int(register.value) ^ (1 << bit)
    await FallingEdge(harness.bench.clk)
    return {"where": f"{register._path.removeprefix('bench.dut.')}[{bit}]"}


async def _reset(harness: Harness, registers: list[Register], random: Random) -> dict[str, object]:
    """Reset for some clocks, at any time."""
    clocks = random.randint(1, MOST_CLOCKS)
    harness.bench.reset.value = 1
    await ClockCycles(harness.bench.clk, clocks)
    await FallingEdge(harness.bench.clk)
    harness.bench.reset.value = 0
    await FallingEdge(harness.bench.clk)
    harness.monitor.forget()
    return {"where": f"{clocks} clocks"}


async def _misuse(harness: Harness, registers: list[Register], random: Random) -> dict[str, object]:
    """Anything on the bus: both at once, let go or changed while it waits, addresses where nothing is."""
    bench, clocks = harness.bench, random.randint(1, MOST_CLOCKS)
    pins = [getattr(bench, f"avs_s0_{name}") for name in ("address", "byteenable", "read", "write", "writedata")]
    for _ in range(clocks):
        for pin in pins:
            pin.value = random.getrandbits(len(pin))
        await FallingEdge(bench.clk)
    bench.avs_s0_read.value = bench.avs_s0_write.value = 0
    for _ in range(MOST_CLOCKS):  # until what was asked for is answered
        await FallingEdge(bench.clk)
    return {"where": f"{clocks} clocks"}
