# SPDX-License-Identifier: MIT
"""Access the design's registers through cocotb-bus's Avalon-MM master."""

from __future__ import annotations

from typing import Any

from cocotb.handle import HierarchyObject
from cocotb.triggers import NextTimeStep, ReadOnly, RisingEdge, Timer
from cocotb_bus.drivers.avalon import AvalonMaster

from raycaster.configuration import Configuration
from raycaster.sim.register_bus import RegisterBus


class AvalonBus(RegisterBus):
    """Register access over Avalon-MM, on a bench whose signals are named `avs_s0_*`."""

    def __init__(self, bench: HierarchyObject, configuration: Configuration):
        super().__init__(configuration)
        self._clock: Any = bench.clk
        self._master = AvalonMaster(bench, "avs_s0", bench.clk)

    async def write_word(self, address: int, word: int, byteenable: int = 0b1111) -> None:
        """Write the enabled bytes of a word; `address` counts words."""
        if byteenable == 0b1111:
            await self._master.write(address, word)
            return
        # cocotb-bus always enables all bytes.
        signals: Any = self._master.bus
        await RisingEdge(self._clock)
        for name, value in {"address": address, "writedata": word, "byteenable": byteenable, "write": 1}.items():
            getattr(signals, name).value = value
        waiting = True
        while waiting:
            await Timer(1, "ns")  # past the edge at which the inputs were driven
            await ReadOnly()
            waiting = bool(int(signals.waitrequest.value))
            await RisingEdge(self._clock)
        signals.write.value = 0

    async def read_word(self, address: int) -> int:
        """Read a word; `address` counts words."""
        word = await self._master.read(address)
        await NextTimeStep()  # the master returns in the read-only phase
        return int(word)
