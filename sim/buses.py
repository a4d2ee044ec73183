# SPDX-License-Identifier: MIT
"""The design's registers over the buses that it may have instead of Avalon-MM, by others' drivers of these."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from typing import Any

from cocotb.handle import HierarchyObject
from cocotbext.axi import (
    ApbBus,
    ApbMaster,
    AxiLiteARBus,
    AxiLiteAWBus,
    AxiLiteBBus,
    AxiLiteRBus,
    AxiLiteWBus,
    AxiResp,
)
from cocotbext.axi.axil_channels import (
    AxiLiteARSource,
    AxiLiteARTransaction,
    AxiLiteAWSource,
    AxiLiteAWTransaction,
    AxiLiteBSink,
    AxiLiteRSink,
    AxiLiteWSource,
    AxiLiteWTransaction,
)
from cocotbext.wishbone.driver import WBOp, WishboneMaster

from raycaster.configuration import Configuration
from raycaster.sim.avalon import AvalonBus
from raycaster.sim.register_bus import RegisterBus

WORD_BYTES = 4

for driver in ("s_axi", "s_apb", "wb"):
    logging.getLogger(f"cocotb.bench.{driver}").setLevel(logging.WARNING)  # they tell of each access


class Axi4LiteBus(RegisterBus):
    """On a bench whose signals are named `s_axi_*`, by cocotbext-axi's channels; each of them may be paused."""

    def __init__(self, bench: HierarchyObject, configuration: Configuration):
        super().__init__(configuration)

        def channel(kind: type, bus: type) -> Any:
            return kind(bus.from_prefix(bench, "s_axi"), bench.bus_clk, bench.reset)

        self.write_address = channel(AxiLiteAWSource, AxiLiteAWBus)
        self.write_data = channel(AxiLiteWSource, AxiLiteWBus)
        self.response = channel(AxiLiteBSink, AxiLiteBBus)
        self.read_address = channel(AxiLiteARSource, AxiLiteARBus)
        self.read_data = channel(AxiLiteRSink, AxiLiteRBus)

    async def write_word(self, address: int, word: int, byteenable: int = 0b1111) -> None:
        """As declared; the response must say that all is well."""
        await self.write_address.send(AxiLiteAWTransaction(awaddr=WORD_BYTES * address))
        await self.write_data.send(AxiLiteWTransaction(wdata=word, wstrb=byteenable))
        response = await self.response.recv()
        assert response.bresp == AxiResp.OKAY, f"a write to {address} got the response {response.bresp}"

    async def read_word(self, address: int) -> int:
        """As declared; the response must say that all is well."""
        await self.read_address.send(AxiLiteARTransaction(araddr=WORD_BYTES * address))
        answer = await self.read_data.recv()
        assert answer.rresp == AxiResp.OKAY, f"a read of {address} got the response {answer.rresp}"
        return int(answer.rdata)

    def pause(self, *generators: Iterator[bool]) -> None:
        """Hold back the five channels, AW, W, B, AR and R, in the clocks in which these say so."""
        channels = (self.write_address, self.write_data, self.response, self.read_address, self.read_data)
        for one, generator in zip(channels, generators, strict=True):
            one.set_pause_generator(generator)


class WishboneBus(RegisterBus):
    """On a bench whose signals are named `wb_*`, by cocotbext-wishbone's master."""

    def __init__(self, bench: HierarchyObject, configuration: Configuration):
        super().__init__(configuration)
        signals = {name: name for name in ("cyc", "stb", "we", "adr", "ack")} | {"datwr": "dat_w", "datrd": "dat_r"}
        self._master = WishboneMaster(bench, "wb", bench.bus_clk, timeout=64, signals_dict=signals)
        self.idle: Iterator[int] | None = None
        """Clocks between the bus cycle's begin and each strobe; none where it is None."""

    async def write_word(self, address: int, word: int, byteenable: int = 0b1111) -> None:
        """As declared."""
        await self._access(WBOp(adr=address, dat=word, sel=byteenable, acktimeout=64))

    async def read_word(self, address: int) -> int:
        """As declared."""
        return await self._access(WBOp(adr=address, acktimeout=64))

    async def _access(self, operation: WBOp) -> int:
        operation.idle = next(self.idle) if self.idle else 0
        [result] = await self._master.send_cycle([operation])
        assert result.ack == 1, f"an access to {operation.adr} was not acknowledged"
        return int(result.datrd) if operation.dat is None else 0


class ApbRegisterBus(RegisterBus):
    """On a bench whose signals are named `s_apb_*`, by cocotbext-axi's APB master, which may be paused."""

    def __init__(self, bench: HierarchyObject, configuration: Configuration):
        super().__init__(configuration)
        self._master: Any = ApbMaster(ApbBus.from_prefix(bench, "s_apb"), bench.bus_clk, bench.reset)

    async def write_word(self, address: int, word: int, byteenable: int = 0b1111) -> None:
        """As declared; the master's writes are of neighbouring bytes, so that others are two of them."""
        data = word.to_bytes(WORD_BYTES, "little")
        lane = 0
        while lane < WORD_BYTES:
            length = 0
            while lane + length < WORD_BYTES and byteenable >> lane + length & 1:
                length += 1
            if length:
                done = await self._master.write(WORD_BYTES * address + lane, data[lane : lane + length])
                assert done.resp == AxiResp.OKAY, f"a write to {address} failed"
            lane += length + 1

    async def read_word(self, address: int) -> int:
        """As declared."""
        done = await self._master.read(WORD_BYTES * address, WORD_BYTES)
        assert done.resp == AxiResp.OKAY, f"a read of {address} failed"
        return int.from_bytes(done.data, "little")

    def pause(self, generator: Iterator[bool]) -> None:
        """Begin no access in the clocks in which this says so."""
        self._master.set_pause_generator(generator)


BUSES: dict[str, Callable[[HierarchyObject, Configuration], RegisterBus]] = {
    "avalon": AvalonBus,
    "axi4lite": Axi4LiteBus,
    "wishbone": WishboneBus,
    "apb": ApbRegisterBus,
}
"""By what `Configuration.bus` may be."""
