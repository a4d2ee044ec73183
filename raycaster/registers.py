# SPDX-License-Identifier: MIT
"""The register map, read from `registers.rdl`: addresses, fields, and words packed from them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from systemrdl.compiler import RDLCompiler
from systemrdl.node import AddrmapNode, FieldNode, RegNode

SOURCE = Path(__file__).with_name("registers.rdl")


@dataclass(frozen=True)
class RegisterField:
    """A field: bits `lsb + width - 1` to `lsb` of a word."""

    lsb: int
    width: int
    reset: int

    @property
    def mask(self) -> int:
        """Mask of the field's bits."""
        return ((1 << self.width) - 1) << self.lsb


@dataclass(frozen=True)
class Register:
    """A 32-bit word of the map; `address` counts words, as the bus does."""

    name: str
    address: int
    fields: dict[str, RegisterField]

    @property
    def implemented(self) -> int:
        """Mask of the bits that belong to a field."""
        return sum(field.mask for field in self.fields.values())

    @property
    def reset(self) -> int:
        """Value after reset, with 0 for fields that have no reset value."""
        return sum(field.reset << field.lsb for field in self.fields.values())

    def pack(self, **values: int) -> int:
        """Return the word with these fields set and the others 0.

        Raises:
            KeyError: there is no such field.
            ValueError: a value does not fit its field.
        """
        word = 0
        for name, value in values.items():
            field = self.fields[name]
            if not 0 <= value < 1 << field.width:
                raise ValueError(f"{self.name}.{name} has {field.width} bits; {value} does not fit")
            word |= value << field.lsb
        return word

    def unpack(self, word: int) -> dict[str, int]:
        """Return every field's value in a word."""
        return {name: (word & field.mask) >> field.lsb for name, field in self.fields.items()}


@lru_cache
def compile_registers(rectangles: int, lists: bool = False) -> AddrmapNode:
    """Compile the map of a design with this many entries in its rectangle table; callers share the tree.

    With lists, the design draws frames into lists, and has registers for them.
    """
    compiler = RDLCompiler()
    defines = {"RECTANGLES": str(rectangles)} if rectangles else {"NO_TABLE": ""}
    compiler.compile_file(str(SOURCE), defines=defines | ({"LISTS": ""} if lists else {}))
    return compiler.elaborate("ray_caster").top


@lru_cache
def register_map(rectangles: int, lists: bool = False) -> dict[str, Register]:
    """Return every register by its path: `"control"`, `"camera"`, `"rectangle[3].corner_0"`, ..."""
    registers = {}
    for node in compile_registers(rectangles, lists).descendants(unroll=True):
        if isinstance(node, RegNode):
            path = node.get_path().removeprefix("ray_caster.")
            registers[path] = Register(path, node.absolute_address // 4, dict(map(_field, node.fields())))
    return registers


def _field(node: FieldNode) -> tuple[str, RegisterField]:
    reset = node.get_property("reset")
    return node.inst_name, RegisterField(node.low, node.width, reset if isinstance(reset, int) else 0)


def address_bits(rectangles: int, lists: bool = False) -> int:
    """Return the width of the bus's word address."""
    last = max(register.address for register in register_map(rectangles, lists).values())
    return last.bit_length()
