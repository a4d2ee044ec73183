# SPDX-License-Identifier: MIT
"""Access the design's registers through cocotb-bus's Avalon-MM master."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cocotb.handle import HierarchyObject
from cocotb.triggers import NextTimeStep, ReadOnly, RisingEdge, Timer
from cocotb_bus.drivers.avalon import AvalonMaster

from raycaster.configuration import Configuration
from raycaster.sim.register_bus import RegisterBus

MAX_WAIT = 4
"""Maximum number of clocks that waitrequest may last."""


class AvalonBus(RegisterBus):
    """Register access over Avalon-MM, on a bench whose signals are named `avs_s0_*`."""

    def __init__(self, bench: HierarchyObject, configuration: Configuration):
        super().__init__(configuration)
        self._clock: Any = bench.clk
        self._master = AvalonMaster(bench, "avs_s0", bench.clk)
        self._signals: Any = self._master.bus

    async def write_word(self, address: int, word: int, byteenable: int = 0b1111) -> None:
        """Write the enabled bytes of a word; `address` counts words."""
        if byteenable == 0b1111:
            await self._master.write(address, word)
            return
        # cocotb-bus always enables all bytes.
        signals = self._signals
        await RisingEdge(self._clock)
        signals.address.value = address
        signals.writedata.value = word
        signals.byteenable.value = byteenable
        signals.write.value = 1
        await self._accepted()
        signals.write.value = 0

    async def read_word(self, address: int) -> int:
        """Read a word; `address` counts words."""
        word = await self._master.read(address)
        await NextTimeStep()  # the master returns in the read-only phase
        return int(word)

    async def read_pipelined(self, addresses: Sequence[int]) -> list[int]:
        """Read words, issuing each address as soon as the previous one is accepted, without waiting for the data.

        Raises:
            AssertionError: there are too few or too many answers, or waitrequest lasted more than `MAX_WAIT` clocks.
        """
        signals = self._signals
        answers: list[int] = []
        await RisingEdge(self._clock)
        signals.byteenable.value = 0b1111
        signals.read.value = 1
        for address in addresses:
            signals.address.value = address
            await self._accepted(answers)
        signals.read.value = 0
        for _ in range(16):
            await self._sample(answers)
            await RisingEdge(self._clock)
        assert len(answers) == len(addresses), f"{len(addresses)} reads got {len(answers)} answers"
        return answers

    async def _accepted(self, answers: list[int] | None = None) -> None:
        """Return just after the clock edge at which the current request is accepted."""
        for _ in range(MAX_WAIT + 1):
            waiting = await self._sample(answers)
            await RisingEdge(self._clock)
            if not waiting:
                return
        raise AssertionError(f"waitrequest lasted more than {MAX_WAIT} clocks")

    async def _sample(self, answers: list[int] | None) -> bool:
        """Return the settled waitrequest before the next clock edge; collect any answer on the bus."""
        await Timer(1, "ns")  # past the edge at which the inputs were driven
        await ReadOnly()
        if answers is not None and int(self._signals.readdatavalid.value):
            answers.append(int(self._signals.readdata.value))
        return bool(int(self._signals.waitrequest.value))
