# SPDX-License-Identifier: MIT
"""cocotb: a design is disturbed while it draws, once per case, and must recover.

There are three kinds of case: a bit of a register or memory flips; reset is asserted for some clocks; or a host drives
the bus at random for some clocks. All random choices follow from the number of the case.
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
"""A register or a memory."""

KINDS = (*8 * ("upset",), "reset", "bus")
"""Kinds of case: one in ten is a reset, and one in ten is on the bus."""

FRAMES = 3
"""Frames in which a design may recover: the disturbed one, the next, and one more if a sync came early or late."""

MOST_CLOCKS = 40
"""Longest reset or random drive of the bus, in clocks."""

PATIENCE = 1000
"""Clocks that a bus access may take; the slowest needs about ten."""


@cocotb.test()
async def disturb(bench: HierarchyObject) -> None:
    """Disturb the design once per case; write a line of JSON for each, and fail if it did not recover."""
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
    assert not lost, f"did not recover in cases {lost}"


def find_registers(scope: HierarchyObject, names: Mapping[str, set[str]]) -> Iterator[Register]:
    """Yield the registers and memories within an instance, whose names are given by module."""
    for child in scope:
        if isinstance(child, HierarchyObject):
            yield from find_registers(child, names)
        elif isinstance(child, Register) and child._name in names.get(scope._def_name or "", ()):
            yield child


def bits_of(register: Register) -> int:
    """Return the number of bits of a register, or of all words of a memory."""
    if isinstance(register, ArrayObject):
        return len(register) * len(register[register.range.left])
    return len(register)


async def _case(harness: Harness, registers: list[Register], number: int) -> dict[str, object]:
    """Run a case; return the disturbance, its outcome, and the number of wrong frames after it."""
    random = Random(number)
    configuration, screen = harness.configuration, harness.screen
    scene, other = (
        random_scene(seed, configuration.rectangles, configuration.reflections, configuration.looks)
        for seed in (number, number + 1)
    )
    await harness.reset()
    await harness.load(scene, scene.reflections)
    assert await _look(harness, harness.golden(scene, scene.reflections)) == "right", "wrong before anything happened"

    await ClockCycles(harness.bench.clk, random.randrange(1, screen.vertical.total * screen.line_cycles))
    await FallingEdge(harness.bench.clk)
    kind = random.choice(KINDS)
    disturbance = await {"upset": _flip, "reset": _reset, "bus": _misuse}[kind](harness, registers, random)
    at = get_sim_time("ns") // CLOCK_NS
    result = {"kind": kind, "clock": at} | disturbance

    seen = []
    if kind == "upset":
        seen = await _look_until_right(harness, scene)
    # Next, or at once after a reset or misuse, software loads another scene; its commit repairs the rest.
    mended = "unseen" if seen == ["right", "right"] else "StartScreen" if seen[-1:] == ["right"] else "commit"
    came_back = await _comes_back(harness, other)
    wrong = [each for each in seen if each != "right"]
    return result | {"outcome": mended if came_back else "hangs", "wrong": len(wrong), "lost_sync": "sync" in wrong}


async def _look_until_right(harness: Harness, scene: Scene) -> list[str]:
    """Check the disturbed frame, and then further frames until one is right."""
    picture, seen = harness.golden(scene, scene.reflections), []
    while len(seen) < FRAMES and not (len(seen) > 1 and seen[-1] == "right"):
        seen.append(await _look(harness, picture))
    return seen


async def _look(harness: Harness, picture: np.ndarray) -> str:
    """Return the state of the next frame: right, wrong, or sync if its sync was wrong."""
    try:
        frame = await harness.monitor.frame()
    except VideoError:
        harness.monitor.forget()
        return "sync"
    return "wrong" if count_wrong(frame, picture) else "right"


async def _comes_back(harness: Harness, scene: Scene) -> bool:
    """True if the identification can still be read on the bus, and a scene is shown in one of the next frames."""
    bus, picture = harness.bus, harness.golden(scene, scene.reflections)
    # A word of a scene takes less than a tenth of `PATIENCE`.
    words = 4 * harness.configuration.rectangles + 8
    try:
        word = await with_timeout(bus.read_word(bus.registers["id"].address), PATIENCE * CLOCK_NS, "ns")
        if word != bus.registers["id"].reset:
            return False
        await with_timeout(harness.load(scene, scene.reflections), words * PATIENCE * CLOCK_NS, "ns")
    except SimTimeoutError:
        return False
    return any([await _look(harness, picture) == "right" for _ in range(FRAMES)])


async def _flip(harness: Harness, registers: list[Register], random: Random) -> dict[str, object]:
    """Flip a bit; all bits of all registers and memories are equally likely."""
    [register] = random.choices(registers, [bits_of(register) for register in registers])
    if isinstance(register, ArrayObject):
        register = register[random.choice(list(register.range))]
    bit = random.randrange(len(register))
    register.value = int(register.value) ^ (1 << bit)
    await FallingEdge(harness.bench.clk)
    return {"where": f"{register._path.removeprefix('bench.dut.')}[{bit}]"}


async def _reset(harness: Harness, registers: list[Register], random: Random) -> dict[str, object]:
    """Assert reset for some clocks."""
    clocks = random.randint(1, MOST_CLOCKS)
    harness.bench.reset.value = 1
    await ClockCycles(harness.bench.clk, clocks)
    await FallingEdge(harness.bench.clk)
    harness.bench.reset.value = 0
    await FallingEdge(harness.bench.clk)
    harness.monitor.forget()
    return {"where": f"{clocks} clocks"}


async def _misuse(harness: Harness, registers: list[Register], random: Random) -> dict[str, object]:
    """Misuse the bus: read and write at once, requests dropped or changed while they wait, unmapped addresses."""
    bench, clocks = harness.bench, random.randint(1, MOST_CLOCKS)
    pins = [getattr(bench, f"avs_s0_{name}") for name in ("address", "byteenable", "read", "write", "writedata")]
    for _ in range(clocks):
        for pin in pins:
            pin.value = random.getrandbits(len(pin))
        await FallingEdge(bench.clk)
    bench.avs_s0_read.value = bench.avs_s0_write.value = 0
    for _ in range(MOST_CLOCKS):  # until all requests are answered
        await FallingEdge(bench.clk)
    return {"where": f"{clocks} clocks"}
