# SPDX-License-Identifier: MIT
"""Access the design's registers over a serial line, whose levels are driven and sampled by time, not by clock edges."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Any, ClassVar

import cocotb
from cocotb.handle import HierarchyObject
from cocotb.queue import Queue
from cocotb.simtime import get_sim_time
from cocotb.triggers import FallingEdge, Timer, with_timeout

from raycaster.configuration import Configuration
from raycaster.program import scene_fields
from raycaster.scene import Scene
from raycaster.serial_frames import LEAD, FrameDecoder, access, framed, last_access, writes
from raycaster.sim.monitor import CLOCK_NS
from raycaster.sim.register_bus import BridgedBus

PATIENCE = 400
"""Bytes' time for which a host waits for the first byte of an answer."""


class Line:
    """The line to the design, which is low if any host drives it low.

    Args:
        signal: the design's input.
        bit_ns: nominal time of a bit.
    """

    def __init__(self, signal: Any, bit_ns: float):
        self._signal, self.bit_ns = signal, bit_ns
        self._low: set[object] = set()
        self._noise = 0
        signal.value = 1

    def drive(self, host: object, level: int) -> None:
        """Let a host drive a level."""
        (self._low.discard if level else self._low.add)(host)
        self._signal.value = int(not self._low) ^ self._noise

    async def disturb(self, wait_ns: int, length_ns: int) -> None:
        """After a time, invert the line for another time."""
        for noise, time in ((1, wait_ns), (0, length_ns)):
            await Timer(max(1, time), "ns")
            self._noise = noise
            self.drive(self, 1)

    async def send(self, data: bytes, *, rate: float = 1.0, bits: int | None = None, host: object = None) -> None:
        """Send bytes: at a multiple of the nominal rate, only the first bits if there is a number of them."""
        levels = [level for byte in data for level in (0, *(byte >> at & 1 for at in range(8)), 1)][:bits]
        began, bit_ns = get_sim_time("ns"), self.bit_ns / rate
        for number, level in enumerate([*levels, 1]):
            if number in (0, len(levels)) or level != levels[number - 1]:
                wait = round(began + number * bit_ns - get_sim_time("ns"))
                if wait > 0:
                    await Timer(wait, "ns")
                self.drive(host, level)


class UartBus(BridgedBus):
    """Register access over a serial line, on a bench whose signals are named `uart_*`.

    Attributes:
        line: the line to the design.
        rate: multiple of the nominal rate, in both directions.
        answers: words of the frames from the design.
    """

    begins: ClassVar = {}
    ends: ClassVar = {}

    def __init__(self, bench: HierarchyObject, configuration: Configuration):
        super().__init__(configuration)
        signals: Any = bench
        self.line = Line(signals.uart_rx, CLOCK_NS * configuration.screen_geometry.clock_hz / configuration.baud)
        self.rate = 1.0
        self.answers: Queue[list[int]] = Queue()
        self._tx, self._pauses = signals.uart_tx, None
        cocotb.start_soon(self._listen())

    async def _listen(self) -> None:
        decoder = FrameDecoder()
        while True:
            await FallingEdge(self._tx)
            bit_ns, began, byte = self.line.bit_ns / self.rate, get_sim_time("ns"), 0
            for place in range(9):
                await Timer(round(began + (place + 1.5) * bit_ns - get_sim_time("ns")), "ns")
                byte |= int(self._tx.value) << place
            assert byte >> 8, "a byte from the design has no stop bit"
            for words in decoder.feed(bytes([byte & 0xFF])):
                self.answers.put_nowait(words)

    def heard(self) -> list[list[int]]:
        """Return the answers that have come and were not read."""
        return [self.answers.get_nowait() for _ in range(self.answers.qsize())]

    async def request(self, words: Sequence[int]) -> list[int]:
        """Send a frame and return the words of its answer; answers to others and to earlier frames are dropped."""
        self.heard()
        if self._pauses:
            await Timer(round(self._pauses.random() * 20 * self.line.bit_ns), "ns")
        await self.line.send(bytes([LEAD]) + framed(words), rate=self.rate)
        answer: list[int] = []
        while answer[:1] != [last_access(words)]:
            answer = await with_timeout(self.answers.get(), round(PATIENCE * 10 * self.line.bit_ns), "ns")
        return answer

    async def write_words(self, words: Sequence[int]) -> None:
        """Send accesses that only write."""
        answer = await self.request(words)
        assert len(answer) == 1, f"a write got the answer {answer}"

    async def write_word(self, address: int, word: int, byteenable: int = 0b1111) -> None:
        """Write the enabled bytes of a word; the others are read, and written as they were."""
        mask = sum(0xFF << 8 * lane for lane in range(4) if byteenable >> lane & 1)
        if mask != 0xFFFFFFFF:
            word = (word & mask) | (await self.read_word(address) & ~mask)
        await self.write_words(access(address, [word]))

    async def read_word(self, address: int) -> int:
        """Read a word."""
        asked = access(address, read=1)
        [_, word] = await self.request(asked)
        return word

    async def load_scene(self, scene: Scene) -> None:
        """Write a scene to the shadow, all in one frame."""
        fields = scene_fields(scene, self._configuration)
        pairs = [(self.registers[name].address, self.registers[name].pack(**values)) for name, values in fields]
        await self.write_words(writes(pairs))

    def press_back(self, random: Random) -> None:
        """Let the host be up to 3 per cent fast or slow, and pause between frames."""
        self.rate, self._pauses = 1 + random.uniform(-0.03, 0.03), random
