# SPDX-License-Identifier: MIT
"""The design's registers by name, over cocotb-bus's Avalon-MM master."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cocotb.handle import HierarchyObject
from cocotb.triggers import NextTimeStep, ReadOnly, RisingEdge, Timer
from cocotb_bus.drivers.avalon import AvalonMaster

from raycaster.configuration import Configuration
from raycaster.program import basis_fields, rectangle_fields, scene_fields
from raycaster.registers import Register, register_map
from raycaster.scene import Basis, Rectangle, Scene

MAX_WAIT = 4
"""Clocks that waitrequest may last."""


class AvalonBus:
    """Reads and writes registers of a design on a bench whose signals are named `avs_s0_*`.

    Every access returns in a phase in which the next may start at once.
    """

    def __init__(self, bench: HierarchyObject, configuration: Configuration):
        self.registers: dict[str, Register] = register_map(configuration.table)
        self._configuration = configuration
        self._clock = bench.clk
        self._master = AvalonMaster(bench, "avs_s0", bench.clk)
        self._signals = self._master.bus

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

    async def write(self, name: str, **fields: int) -> None:
        """Write a register: the named fields, and 0 to the others."""
        register = self.registers[name]
        await self.write_word(register.address, register.pack(**fields))

    async def read(self, name: str) -> dict[str, int]:
        """A register's fields."""
        register = self.registers[name]
        return register.unpack(await self.read_word(register.address))

    async def read_pipelined(self, addresses: Sequence[int]) -> list[int]:
        """Read words with a new address as soon as the last was accepted, not waiting for the data.

        Raises:
            AssertionError: an answer is missing or too many came, or waitrequest lasted more than `MAX_WAIT` clocks.
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
        assert len(answers) == len(addresses), f"{len(addresses)} reads were answered {len(answers)} times"
        return answers

    async def _accepted(self, answers: list[int] | None = None) -> None:
        """Return just after the clock edge at which the present request was taken."""
        for _ in range(MAX_WAIT + 1):
            waiting = await self._sample(answers)
            await RisingEdge(self._clock)
            if not waiting:
                return
        raise AssertionError(f"waitrequest lasted more than {MAX_WAIT} clocks")

    async def _sample(self, answers: list[int] | None) -> bool:
        """The settled waitrequest before the next clock edge; collects an answer that is on the bus."""
        await Timer(1, "ns")  # past the edge at which the inputs were driven
        await ReadOnly()
        if answers is not None and int(self._signals.readdatavalid.value):
            answers.append(int(self._signals.readdata.value))
        return bool(int(self._signals.waitrequest.value))

    async def write_camera(self, position: Sequence[int], basis: Basis | None = None) -> None:
        """Write the camera's x, y, z to the shadow, and forward, right and up where they are given."""
        await self.write("camera", **dict(zip("xyz", position, strict=True)))
        if basis:
            await self._write_all(basis_fields(basis))

    async def write_rectangle(self, index: int, rectangle: Rectangle) -> None:
        """Write an enabled rectangle to the shadow."""
        await self._write_all(rectangle_fields(index, rectangle, self._configuration))

    async def load_scene(self, scene: Scene) -> None:
        """Write background, camera and rectangles to the shadow, and disable the entries that the scene leaves."""
        await self._write_all(scene_fields(scene, self._configuration))

    async def _write_all(self, writes: Iterable[tuple[str, dict[str, int]]]) -> None:
        for name, fields in writes:
            await self.write(name, **fields)

    async def commit(self, *, run: int = 1, reflections: int) -> None:
        """Have the shadow shown from the next StartScreen on, with this many reflections."""
        await self.write("control", run=run, commit=1, reflections=reflections)
