# SPDX-License-Identifier: MIT
"""Access the design's registers over the buses that can replace Avalon-MM, mostly through third-party drivers."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from random import Random
from typing import Any, ClassVar

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

from raycaster.buses import BUSES, OWN
from raycaster.configuration import Configuration
from raycaster.sim.avalon import AvalonBus
from raycaster.sim.register_bus import BridgedBus, RegisterBus
from raycaster.sim.uart import UartBus

WORD_BYTES = 4

for known in BUSES.values():
    logging.getLogger(f"cocotb.bench.{known.port}").setLevel(logging.WARNING)  # they log each access


def _odds(random: Random, chance: float) -> Iterator[bool]:
    """Yield True with this chance, anew in each clock."""
    while True:
        yield random.random() < chance


class Axi4LiteBus(BridgedBus):
    """Register access over AXI4-Lite, on a bench whose signals are named `s_axi_*`.

    Each of cocotbext-axi's channels may be paused.
    """

    begins: ClassVar = {"write": ("s_axi_awvalid", "s_axi_wvalid"), "read": ("s_axi_arvalid",)}
    ends: ClassVar = {"write": ("s_axi_bvalid", "s_axi_bready"), "read": ("s_axi_rvalid", "s_axi_rready")}

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
        """Write the enabled bytes of a word; the response must be OKAY."""
        await self.write_address.send(AxiLiteAWTransaction(awaddr=WORD_BYTES * address))
        await self.write_data.send(AxiLiteWTransaction(wdata=word, wstrb=byteenable))
        response = await self.response.recv()
        assert response.bresp == AxiResp.OKAY, f"a write to {address} got the response {response.bresp}"

    async def read_word(self, address: int) -> int:
        """Read a word; the response must be OKAY."""
        await self.read_address.send(AxiLiteARTransaction(araddr=WORD_BYTES * address))
        answer = await self.read_data.recv()
        assert answer.rresp == AxiResp.OKAY, f"a read of {address} got the response {answer.rresp}"
        return int(answer.rdata)

    def press_back(self, random: Random) -> None:
        """Pause channels at random."""
        for one in (self.write_address, self.write_data, self.response, self.read_address, self.read_data):
            one.set_pause_generator(_odds(random, random.choice((0.0, 0.3, 0.8))))


class WishboneBus(BridgedBus):
    """Register access over Wishbone by cocotbext-wishbone's master, on a bench whose signals are named `wb_*`."""

    begins: ClassVar = {"write": ("wb_cyc", "wb_stb", "wb_we"), "read": ("wb_cyc", "wb_stb", "!wb_we")}
    ends: ClassVar = dict.fromkeys(("write", "read"), ("wb_ack",))

    def __init__(self, bench: HierarchyObject, configuration: Configuration):
        super().__init__(configuration)
        signals = {name: name for name in ("cyc", "stb", "we", "adr", "ack")} | {"datwr": "dat_w", "datrd": "dat_r"}
        self._master = WishboneMaster(bench, "wb", bench.bus_clk, timeout=64, signals_dict=signals)
        self._idle: Iterator[int] | None = None

    async def write_word(self, address: int, word: int, byteenable: int = 0b1111) -> None:
        """Write the enabled bytes of a word."""
        await self._access(WBOp(adr=address, dat=word, sel=byteenable, acktimeout=64))

    async def read_word(self, address: int) -> int:
        """Read a word."""
        return await self._access(WBOp(adr=address, acktimeout=64))

    async def _access(self, operation: WBOp) -> int:
        operation.idle = next(self._idle) if self._idle else 0
        [result] = await self._master.send_cycle([operation])
        assert result.ack == 1, f"an access to {operation.adr} was not acknowledged"
        return int(result.datrd) if operation.dat is None else 0

    def press_back(self, random: Random) -> None:
        """Insert idle clocks between the start of the bus cycle and each strobe."""
        most = random.choice((0, 3))
        self._idle = iter(lambda: random.randint(0, most), None)


class ApbRegisterBus(BridgedBus):
    """Register access over APB by cocotbext-axi's master, which may pause, on a bench with signals named `s_apb_*`."""

    begins: ClassVar = {"write": ("s_apb_psel", "s_apb_pwrite"), "read": ("s_apb_psel", "!s_apb_pwrite")}
    ends: ClassVar = dict.fromkeys(("write", "read"), ("s_apb_penable", "s_apb_pready"))

    def __init__(self, bench: HierarchyObject, configuration: Configuration):
        super().__init__(configuration)
        self._master: Any = ApbMaster(ApbBus.from_prefix(bench, "s_apb"), bench.bus_clk, bench.reset)

    async def write_word(self, address: int, word: int, byteenable: int = 0b1111) -> None:
        """Write the enabled bytes of a word; the master writes adjacent bytes, so bytes with a gap take two writes."""
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
        """Read a word."""
        done = await self._master.read(WORD_BYTES * address, WORD_BYTES)
        assert done.resp == AxiResp.OKAY, f"a read of {address} failed"
        return int.from_bytes(done.data, "little")

    def press_back(self, random: Random) -> None:
        """Start no access in some clocks."""
        self._master.set_pause_generator(_odds(random, random.choice((0.0, 0.5))))


DRIVERS: dict[str, Callable[[HierarchyObject, Configuration], RegisterBus]] = {
    OWN: AvalonBus,
    "axi4lite": Axi4LiteBus,
    "wishbone": WishboneBus,
    "apb": ApbRegisterBus,
    "uart": UartBus,
}
"""Drivers by value of `Configuration.bus`."""
