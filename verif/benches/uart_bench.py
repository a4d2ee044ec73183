# SPDX-License-Identifier: MIT
"""cocotb: a whole design on a serial line: every register, and rooms that come well, disturbed, in part or together.

Each picture must be that of a whole room: the one before, or one that was sent. What the next frame after a
disturbance asks for is answered.
"""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from random import Random

import cocotb
import numpy as np
from cocotb.handle import HierarchyObject
from cocotb.triggers import SimTimeoutError, Timer

from raycaster.golden.picture import count_wrong, describe_difference
from raycaster.program import scene_words
from raycaster.serial_frames import LEAD, access, framed, writes
from raycaster.sim.harness import Harness
from raycaster.sim.register_model import EVERY_LANE, SceneFollower
from raycaster.sim.uart import UartBus
from raycaster.verif.random_scenes import random_scene

ROOMS = 3
"""Rooms of each kind per seed."""

SILENCE = 400
"""Bits' time within which an answer to a write has come."""


class Hosts:
    """Hosts on the line, which send rooms, and the pictures that the design may show."""

    def __init__(self, harness: Harness, seed: int):
        assert isinstance(harness.bus, UartBus)
        self.harness, self.bus, self.line = harness, harness.bus, harness.bus.line
        self.random, self.counts = Random(seed), Counter()
        self.shown = harness.golden_live(None)

    def room(self) -> tuple[bytes, np.ndarray]:
        """Return a new room's frame and its picture, which differs from the one that is shown."""
        config = self.harness.configuration
        while True:
            scene = random_scene(self.random.randrange(1 << 16), config.rectangles, config.most_reflections)
            picture = self.harness.golden(scene, scene.reflections)
            if count_wrong(picture, self.shown) > picture[..., 0].size // 8:
                return bytes([LEAD]) + framed(writes(scene_words(scene, config))), picture

    async def wait(self, bits: float) -> None:
        """Wait for some bits' time."""
        await Timer(max(1, round(bits * self.line.bit_ns)), "ns")

    async def well(self) -> list[np.ndarray]:
        """Send a room at a rate that is up to 3 per cent wrong, at once after some noise."""
        data, picture = self.room()
        noise = bytes(self.random.randrange(256) for _ in range(self.random.randrange(4)))
        await self.line.send(noise, bits=self.random.randrange(1, 40))
        rate = self.random.choice((0.97, 1.03, self.random.uniform(0.97, 1.03)))
        await self.line.send(data, rate=rate)
        await self.wait(SILENCE)
        assert len(self.bus.heard()) == 1, f"no answer to a room at {rate:.3f} of the rate"
        self.shown = picture
        return []

    async def noisy(self) -> list[np.ndarray]:
        """Send a room while the line is inverted for short times."""
        data, picture = self.room()
        bits = 10 * len(data)
        for _ in range(self.random.choice((1, 1, 3, 10))):
            wait, length = self.random.uniform(12, bits), self.random.choice((0.1, 0.6, 1, 5)) * self.line.bit_ns
            cocotb.start_soon(self.line.disturb(round(wait * self.line.bit_ns), round(length)))
        await self.line.send(data)
        return [picture]

    async def flipped(self) -> list[np.ndarray]:
        """Send a room of which one bit arrives inverted."""
        data, _ = self.room()
        bit = 10 * self.random.randrange(2, len(data) - 1) + self.random.randrange(1, 9)
        cocotb.start_soon(self.line.disturb(round(bit * self.line.bit_ns), round(self.line.bit_ns)))
        await self.line.send(data)
        return []

    async def pulled(self) -> list[np.ndarray]:
        """Pull the cable in the middle of a room: the line is then idle, or low for some time."""
        data, _ = self.room()
        await self.line.send(data, bits=self.random.randrange(1, 10 * len(data) - 12))
        if self.random.random() < 0.5:
            self.line.drive(self, 0)
            await self.wait(self.random.uniform(1, 50))
            self.line.drive(self, 1)
        return []

    async def together(self) -> list[np.ndarray]:
        """Let two hosts send a room each, one of them a little later."""
        (data, picture), (other, other_picture) = self.room(), self.room()
        later = cocotb.start_soon(self._later(other, self.random.uniform(0, 11 * len(data))))
        await self.line.send(data, rate=self.random.uniform(0.97, 1.03))
        await later
        return [picture, other_picture]

    async def _later(self, data: bytes, bits: float) -> None:
        await self.wait(bits)
        await self.line.send(data, rate=self.random.uniform(0.97, 1.03), host="other")

    async def check(self, kind: str) -> None:
        """Let rooms come in one way; then a frame is answered, and the picture is that of a whole room."""
        harness = self.harness
        maybe = await getattr(self, kind)()
        registers = self.bus.registers
        # No pause: the answer to a room that was accepted may be cut.
        asked = access(registers["id"].address, read=1)
        try:
            assert await self.bus.request(asked) == [*asked, registers["id"].reset], f"{kind}: a wrong answer"
        except SimTimeoutError:
            raise AssertionError(f"{kind}: no answer to the next frame") from None
        await harness.wait_for_frame()
        seen = await harness.monitor.frame()
        fits = [picture for picture in (self.shown, *maybe) if not count_wrong(seen, picture)]
        if not fits:
            raise AssertionError(f"{kind}: {describe_difference(seen, self.shown)}, or another room")
        self.counts[f"{kind}: {'new' if fits[0] is not self.shown or kind == 'well' else 'old'}"] += 1
        self.counts["pixels"] += seen[..., 0].size
        self.shown = fits[0]


@cocotb.test()
async def rooms(bench: HierarchyObject) -> None:
    """For each of the job's seeds, rooms of each kind in any order; `uart.json` counts what became of them."""
    harness, counts = Harness(bench), Counter()
    kinds = ("well", "noisy", "flipped", "pulled", "together")
    for seed in harness.job.seeds:
        await harness.reset()
        hosts = Hosts(harness, seed)
        order = [kind for kind in kinds for _ in range(ROOMS)]
        hosts.random.shuffle(order)
        for number, kind in enumerate(("well", *order)):
            try:
                await hosts.check(kind)
            except AssertionError as error:
                raise AssertionError(f"seed {seed}, room {number}: {error}") from None
        counts += hosts.counts
    harness.monitor.check_pins()
    Path(harness.job.output, "uart.json").write_text(json.dumps(counts) + "\n")
    bench._log.info("%s", dict(counts))


@cocotb.test()
async def every_register(bench: HierarchyObject) -> None:
    """All words of a scene are written in one frame and read in another; so are the others that a host may write."""
    harness = Harness(bench)
    bus, random, written = harness.bus, Random(1), SceneFollower(harness.configuration)
    assert isinstance(bus, UartBus)
    await harness.reset()
    control = bus.registers["control"].address
    addresses = sorted(written.shadow.keys() - {control})
    for _ in range(2):
        pairs = [(address, random.getrandbits(32)) for address in addresses]
        await bus.write_words(writes([*pairs, (control, 0)]))
        for address, word in pairs:
            written.write(0, address, word, EVERY_LANE)
        asked = access(0, read=max(addresses) + 1)
        words = await bus.request(asked)
        assert words[0] == asked[0]
        for name, register in bus.registers.items():
            if register.address in written.shadow and register.address != control:
                assert words[1 + register.address] == written.shadow[register.address], name
        constants = {name: bus.registers[name].reset for name in ("id", "version")}
        assert constants == {name: words[1 + bus.registers[name].address] for name in constants}
    for name in ("irq_enable", "irq_pending", "status", "cycles"):
        before = await bus.read_word(bus.registers[name].address)
        await bus.write_word(bus.registers[name].address, 0xFFFFFFFF)
        assert await bus.read_word(bus.registers[name].address) & 0xFFFF in (before & 0xFFFF, 1, 0), name
    assert await bus.read("irq_enable") == {"start_screen": 1}
    for name in (name for name in bus.registers if name.startswith("frames.")):
        await bus.read(name)
