# SPDX-License-Identifier: MIT
"""Access the design's registers by name, over any bus."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from random import Random
from typing import ClassVar

from raycaster.configuration import Configuration
from raycaster.program import scene_fields
from raycaster.registers import Register, address_bits, register_map
from raycaster.scene import Scene


class RegisterBus(ABC):
    """Reads and writes registers of a design; when an access returns, the next may start at once."""

    def __init__(self, configuration: Configuration):
        self.registers: dict[str, Register] = register_map(*configuration.map)
        self.address_bits = address_bits(*configuration.map)
        self._configuration = configuration

    @abstractmethod
    async def write_word(self, address: int, word: int, byteenable: int = 0b1111) -> None:
        """Write the enabled bytes of a word; `address` counts words."""

    @abstractmethod
    async def read_word(self, address: int) -> int:
        """Read a word; `address` counts words."""

    async def write(self, name: str, **fields: int) -> None:
        """Write a register: the named fields, and 0 to the others."""
        register = self.registers[name]
        await self.write_word(register.address, register.pack(**fields))

    async def read(self, name: str) -> dict[str, int]:
        """Read a register's fields."""
        register = self.registers[name]
        return register.unpack(await self.read_word(register.address))

    async def load_scene(self, scene: Scene) -> None:
        """Write background, camera and rectangles to the shadow, and disable the unused entries."""
        for name, fields in scene_fields(scene, self._configuration):
            await self.write(name, **fields)

    async def commit(self, *, run: int = 1, reflections: int) -> None:
        """Commit the shadow, to be shown from the next StartScreen on with this many reflections."""
        await self.write("control", run=run, commit=1, reflections=reflections)


class BridgedBus(RegisterBus):
    """A bus with a bridge to Avalon-MM.

    Attributes:
        begins: signals that are high, or low if marked with `!`, in the first cycle of a write and of a read.
        ends: likewise, signals of the last cycle.
    """

    begins: ClassVar[Mapping[str, tuple[str, ...]]]
    ends: ClassVar[Mapping[str, tuple[str, ...]]]

    @abstractmethod
    def press_back(self, random: Random) -> None:
        """Make accesses wait at random, with a separate chance for each channel."""
