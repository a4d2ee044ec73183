# SPDX-License-Identifier: MIT
"""Records: fields side by side in one word, so a copy is one assignment, and a memory of records is one of words.

Interfaces: groups of ports, of which each is a signal of its own.
"""

import inspect
from collections.abc import Iterator, Mapping
from copy import copy
from typing import TYPE_CHECKING, Any, Self

from myhdl import ConcatSignal

from raycaster.hdl.internals import Block, Process, SignalType, SignedSlice, SliceSignal, slices_of
from raycaster.hdl.signals import Signed, Tied, initial, tied, unsigned


class Interface:
    """A group of signals; generated Verilog names them group_signal."""

    is_interface = True


class Field(SignedSlice):
    """A record's field: read-only bits of its word. In Verilog it is a wire in the module that reads it."""

    def __init__(self, word: SignalType, name: str, low: int, width: int):
        """Create the field from bits of a word; a `Signed` width means two's complement."""
        self.field = name
        if isinstance(width, Signed):
            super().__init__(word, initial(int(word.val[low + width : low].signed()), width), low + width, low)
        else:
            SliceSignal.__init__(self, word, *((low,) if width == 1 else (low + width, low)))
        slices_of(word).append(self)


class Joined(ConcatSignal):
    """A record's word, joined from its fields' values; see `Record.joined`. In Verilog a comment names each field."""

    def __init__(self, parts: Mapping[str, SignalType | bool]):
        super().__init__(*parts.values())
        self.parts = dict(parts)


class Record:
    """A word with an attribute for each of its fields, the first in the highest bits.

    For a port `rect`, the word becomes the Verilog port `rect_word`, and a field that is read becomes a wire such as
    `rect_axis`. A record is driven by assigning the result of `joined` to `word`.

    A field that a design lacks has no bits: it reads as 0, and its drivers are left out. A part is a further name for
    some bits of the word, such as several fields together.
    """

    is_interface = True

    def __init__(
        self,
        fields: Mapping[str, int],
        parts: Mapping[str, tuple[int, int]] | None = None,
        word: SignalType | None = None,
    ):
        """Lay out fields.

        Args:
            fields: widths in bits by name, `Signed` for two's complement, 0 for a field that the design lacks.
            parts: lowest bit in the word and width in bits by name, 0 bits for a part that the design lacks.
            word: an existing signal for all fields together; a new one by default.
        """
        self.layout = {name: bits for name, bits in fields.items() if bits}
        self._fields, self._parts = dict(fields), dict(parts or {})
        self._connect(unsigned(sum(fields.values())) if word is None else word)

    def _connect(self, word: SignalType) -> Self:
        """Cut all fields and parts from a word."""
        self.word = word
        low = sum(self._fields.values())
        places = {name: ((low := low - bits), bits) for name, bits in self._fields.items()} | self._parts
        for name, (place, bits) in places.items():
            setattr(self, name, Field(word, name, place, bits) if bits else tied(0, 1))
        return self

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Field: ...

    def twin(self) -> Self:
        """Return a new record with the same layout."""
        return copy(self)._connect(unsigned(len(self.word)))

    def has(self, name: str) -> bool:
        """Return True if a field has bits; otherwise the logic that computes it is left out."""
        return name in self.layout

    def joined(self, **parts: SignalType | bool) -> Joined:
        """Return the fields side by side, to assign to a record's word.

        Args:
            parts: a signal or a bit for each field.

        Raises:
            ValueError: a field is missing, unknown, or of another width.
        """
        lacking = self._fields.keys() - self.layout
        if strange := (set(self.layout) ^ set(parts)) - lacking:
            raise ValueError(f"{type(self).__name__}: {', '.join(sorted(strange))}: missing, or no field")
        for name, bits in self.layout.items():
            given = parts[name]
            if (width := 1 if isinstance(given, bool) else len(given) or 1) != bits:
                raise ValueError(f"{type(self).__name__}: {name} has {bits} bits, not {width}")
        return Joined({name: parts[name] for name in self.layout})

    def pack(self, values: Mapping[str, int]) -> int:
        """Return the word with these field values, 0 for fields not named; each value is truncated to its width."""
        word = 0
        for name, bits in self.layout.items():
            word = word << bits | int(values.get(name, 0)) % (1 << bits)
        return word

    def slice(self, name: str) -> tuple[int, int]:
        """Return the highest and the lowest bit of a field."""
        names = list(self.layout)
        low = sum(self.layout[after] for after in names[names.index(name) + 1 :])
        return low + self.layout[name] - 1, low

    def cut(self, words: SignalType, index: int) -> Self:
        """Make the record one of several packed side by side in words, the first in the lowest bits, and return it."""
        width = len(self.word)
        return self._connect(words((index + 1) * width, index * width))

    def tie(self, values: Mapping[str, int]) -> Self:
        """Tie the record to these constant values, and return it."""
        return self._connect(Tied(initial(self.pack(values), self.word)))


def port_signals(arguments: Mapping[str, Any]) -> dict[str, SignalType]:
    """Return the signals among a block's arguments by Verilog port name: `name`, or `interface_attribute`."""
    return {path: signal for name, value in arguments.items() for path, signal in signals_in(name, value)}


def block_arguments(block: Block) -> dict[str, Any]:
    """Return a block's arguments by name, including defaults."""
    bound = inspect.signature(block.func).bind(*block.args, **block.kwargs)
    bound.apply_defaults()
    return dict(bound.arguments)


def block_ports(block: Block) -> dict[str, SignalType]:
    """Return a block's port signals by Verilog name."""
    return port_signals(block_arguments(block))


def signals_in(name: str, value: Any, above: tuple[Any, ...] = ()) -> Iterator[tuple[str, SignalType]]:
    """Yield a variable's signals: itself, a record's word, an interface's attributes, or a list's elements.

    An object that refers to one of those above it, in which it is, is not entered again.
    """
    if isinstance(value, SignalType):
        yield name, value
    elif isinstance(value, Record):
        yield f"{name}_word", value.word
    elif isinstance(value, (list, tuple)):
        for index, element in enumerate(value):
            yield from signals_in(f"{name}_{index}", element, above)
    elif all(value is not one for one in above) and is_interface(value):
        for attribute, element in vars(value).items():
            yield from signals_in(f"{name}_{attribute}", element, (*above, value))


def is_interface(value: Any, depth: int = 6) -> bool:
    """Return True for an `Interface`, and for any other object with signals or lists of them, as MyHDL does."""
    if getattr(value, "is_interface", False):
        return True
    if isinstance(value, (type, Block, Process)) or inspect.isroutine(value) or inspect.ismodule(value) or not depth:
        return False
    values = getattr(value, "__dict__", {}).values()
    parts = [one[0] if isinstance(one, list) and one else one for one in values]
    return any(isinstance(one, SignalType) or is_interface(one, depth - 1) for one in parts)
