# SPDX-License-Identifier: MIT
"""Contents of a module: its ports, signals and memories with their names and drivers, its instances and processes."""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from myhdl import ConcatSignal
from pygments.lexers import SystemVerilogLexer
from pygments.token import Keyword, Operator

from raycaster.hdl import internals
from raycaster.hdl.errors import UserError
from raycaster.hdl.internals import (
    Block,
    Constant,
    EnumItemType,
    Process,
    ShadowSignal,
    SignalType,
    SliceSignal,
    bits_of,
)
from raycaster.hdl.records import Field, block_arguments, signals_in
from raycaster.hdl.signals import Tied, Unconnected, Unset
from raycaster.hdl.source import prepare

Connection = SignalType | str | None
"""A signal, a number in Verilog notation, or nothing."""


@dataclass(frozen=True)
class Port:
    """A module's port, for its parent and for other generators."""

    name: str
    width: int
    signed: bool
    output: bool

    @classmethod
    def of(cls, name: str, signal: SignalType, output: bool) -> Port:
        """Describe a signal as a port."""
        return cls(name, len(signal), is_signed(signal), output)


@dataclass(frozen=True)
class Module:
    """A Verilog module. `instances` are the modules that it instantiates directly, by instance name.

    `parameters` are those that an instance sets in Verilog; a converted module has none, as its values are built in.
    """

    name: str
    path: Path
    ports: tuple[Port, ...]
    instances: dict[str, str]
    parameters: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Instance:
    """An instance of a module, with what its ports connect to."""

    module: Module
    name: str
    connections: Mapping[str, Connection]


@dataclass(frozen=True)
class Usage:
    """Identities of what something in the whole design drives, or comes from outside; and of what something reads."""

    driven: Collection[int]
    read: Collection[int]


@dataclass(frozen=True)
class Loading:
    """Initial contents of a memory, a list of signals, from a file of hexadecimal words."""

    memory: list[Any]
    file: str


class Contents:
    """A block's signals, by identity, and its parts in order.

    Attributes:
        block: the block.
        parts: instances, loadings of memories, and processes as MyHDL has analysed them.
        ports: ports in order.
        arriving: signals among the block's arguments, by port name.
        names: name of each signal, by identity.
        signals: signals to declare, in order, except ports.
        fields: fields of records that are read, which are wires.
        memories: lists of signals that processes index, by name.
        passed: lists that are ports, a port for each signal, by name; True if the block drives them.
        variables: variables that a process keeps from one run to the next, by name, with their initial values.
        states: name in Verilog of each state of an enumeration, by its name and code.
        labels: names of processes that have variables of their own, by identity.
        driven: `reg` or `wire` for each signal and memory that is driven, by identity.
        starting: signals and memories that begin with their initial values, by identity: registers.
        read: signals that are read, and what they are cut or joined from.
    """

    def __init__(self, block: Block, parts: list[Any], design: Usage):
        """Analyse a block.

        Args:
            block: the block.
            parts: as the attribute, with processes as MyHDL has made them.
            design: what is driven and read in all of the design.

        Raises:
            UserError: a signal has no driver, two drivers or no reader; it has no variable or no width; its name is a
                keyword or already taken; a process indexes a list of slices, or Verilog would compute something else.
        """
        self.block = block
        check_keyword(block, block.func.__name__)
        arriving = [pair for argument in block_arguments(block).items() for pair in signals_in(*argument)]
        self.arriving = dict(arriving)
        for name, signal in arriving:
            if self.arriving[name] is not signal:
                self._refuse(f"two things would be called {name} in Verilog; rename one", name)
        self._port_ids = {id(signal) for signal in self.arriving.values()}
        self._touched: dict[int, SignalType] = {}
        self._design = design
        self._writers: dict[int, list[tuple[Any, str]]] = {}
        self._places: dict[int, str] = {}
        self._owners: dict[str, int] = {}
        self.passed: dict[str, bool] = {}
        self.variables: dict[str, tuple[Any, int]] = {}
        self.states: dict[tuple[str, str], str] = {}
        self.driven: dict[int, str] = {}
        self.starting: set[int] = set()
        self.read: set[int] = set()
        processes = [part for part in parts if isinstance(part, Process)]
        lists = [one for process in processes for one in process.losdict.values()]
        lists += [part.memory for part in parts if isinstance(part, Loading)]
        self.memories: dict[str, list[Any]] = {}
        for name, known in block.memdict.items():
            if any(known.mem is one for one in lists) and all(known.mem is not one for one in self.memories.values()):
                self.memories[name] = known.mem
        trees = iter(internals.analysed(processes, prepare))
        self.parts = [next(trees) if isinstance(part, Process) else part for part in parts]
        for part, tree in zip(parts, self.parts, strict=True):
            if isinstance(part, Process):
                tree.function = part.funcobj
        for part in sorted(self.parts, key=lambda part: not isinstance(part, Instance)):
            self._connect(part)
        self._find_lists()
        self._find_ports()
        self._name_signals()
        self._check()

    def text(self, connection: Any) -> str:
        """Return what is printed for a signal: its name, the bits that it is cut from, or what it is joined from."""
        if connection is None or (isinstance(connection, str) and not set(connection) <= {"0", "1"}):
            return connection or ""
        if name := self.names.get(id(connection)):
            return name
        if isinstance(connection, SliceSignal):
            return self.bits(connection)
        if isinstance(connection, ConcatSignal):
            return f"{{{', '.join(map(self.text, internals.operands_of(connection)))}}}"
        if isinstance(connection, str):
            return f"{len(connection)}'b{connection}"
        width = 1 if isinstance(connection, bool) else len(connection)
        return f"{width}'b{int(getattr(connection, 'val', connection)) % (1 << width):0{width}b}"

    def bits(self, part: SliceSignal) -> str:
        """Return a slice as bits of a signal that has a name."""
        word, high, low = bits_of(part)
        while id(word) not in self.names and isinstance(word, SliceSignal):
            word, _, offset = bits_of(word)
            high, low = high + offset, low + offset
        return f"{self.text(word)}[{high}]" if part.min is None else f"{self.text(word)}[{high}:{low}]"

    def _connect(self, part: Any) -> None:
        """Mark the signals that a part drives and reads."""
        if isinstance(part, Instance):
            for port in part.module.ports:
                connected = part.connections[port.name]
                if isinstance(connected, SignalType):
                    self._places.setdefault(id(connected), f"{part.name}.{port.name}")
                    self._drive(connected, "wire", port.name) if port.output else self._read(connected)
        elif not isinstance(part, Loading):
            kind = "wire" if internals.assigned(part) else "reg"
            for name in part.outputs:
                self._drive(part.sigdict[name], kind, name)
            for name in part.outmems:
                self.driven[id(part.symdict[name])] = kind
                self._writers.setdefault(id(part.symdict[name]), []).append((part, name))
            if internals.keeps(part):
                begun = [part.symdict[name] for name in (*part.outputs, *part.outmems)]
                self.starting |= {id(one) for one in begun if not isinstance(one, Unset)}
            known = all(isinstance(part.sigdict[name], (Tied, Constant)) for name in part.inputs)
            if internals.is_combinational(part) and kind == "reg" and known and not part.hasLos:
                reason = "reads constants only, and Verilog would never run it; compute their values outside of it"
                self._refuse(f"{part.name} {reason}", part.name)
            if not internals.keeps(part):
                for name in (name for name, one in part.symdict.items() if isinstance(one, Unset)):
                    self._refuse(f"{part.name} reads {name}, whose words are unknown at power-up; use a clock", name)
            edges = [getattr(edge, "sig", edge) for edge in getattr(part, "senslist", ())]
            edged = [id(edge.sig) for edge in getattr(part, "senslist", ()) if not isinstance(edge, SignalType)]
            if len({*edged}) < len(edged):
                reason = "waits for both edges of a signal, and no register does; write a process for each edge"
                self._refuse(f"{part.name} {reason}", part.name)
            for signal in [*(part.sigdict[name] for name in sorted(part.inputs)), *edges, getattr(part, "reset", None)]:
                if isinstance(signal, SignalType):
                    self._read(signal)

    def _find_lists(self) -> None:
        """Make ports of lists among the arguments; refuse a list that has two drivers."""
        for name, memory in self.memories.items():
            inside = [one for one in memory if id(one) not in self._port_ids]
            moving = any(id(one) in self._design.driven for one in [memory, *memory])
            writers = self._writers.get(id(memory), [])
            words = [word for part, own in writers for word in {*internals.written_words(part, own)}]
            alone = {place: self.driven[id(one)] for place, one in enumerate(memory) if id(one) in self.driven}
            kinds = {("wire" if internals.assigned(part) else "reg", internals.keeps(part)) for part, _ in writers}
            kinds |= {(kind, False if kind == "wire" else None) for kind in alone.values()}
            resets = any(getattr(part, "reset", None) is not None for part, _ in writers)
            words += alone
            apart = None not in words and len({*words}) == len(words)
            if len(writers) + bool(alone) > 1 and (not apart or len(kinds) > 1 or resets):
                reason = "different kinds of drivers" if apart else "two drivers"
                self._refuse(f"{name} has {reason}; drive all of it in one process, or write signals instead", name)
            if len(kinds) > 1:
                self._refuse(f"{name} has different kinds of drivers; drive its signals alike", name)
            idle = [place for place in range(len(memory)) if place not in words] if inside and None not in words else []
            if idle and ("wire", False) in kinds:
                self._refuse(f"{name}[{idle[0]}]: Signal is not driven; drive it as the others", name)
            self.starting |= {id(memory[place]) for place in idle if kinds}
            if moving and not inside:
                self.passed[name] = bool(writers) or any(self.driven.get(id(one)) == "reg" for one in memory)
                for one in memory:
                    if writers:
                        self.driven[id(one)] = "wire"
                        self._touched[id(one)] = one
                    elif id(one) not in self.driven:
                        self._read(one)

    def _drive(self, signal: SignalType, kind: str, name: str) -> None:
        if isinstance(signal, internals.TRISTATE):
            self._refuse("tristate signals are not supported; use an input, an output and an enable", name)
        name = next((own for own, one in self.block.sigdict.items() if one is signal), name)
        if isinstance(signal, (ShadowSignal, Tied)) and id(signal) not in self._port_ids:
            self._refuse(f"{name} is a slice or a constant, and has a driver; connect a new signal", name)
        if id(signal) in self.driven:
            self._refuse(f"{name} has two drivers; connect one of them to a new signal", name)
        self.driven[id(signal)] = kind
        self._touched[id(signal)] = signal

    def _read(self, signal: SignalType) -> None:
        for one in sources(signal, self._port_ids):
            self.read.add(id(one))
            self._touched[id(one)] = one

    def _find_ports(self) -> None:
        """Find the ports: signals among the arguments, and those of interfaces that the module uses."""
        arguments = block_arguments(self.block)
        self.ports: tuple[Port, ...] = ()
        self.names: dict[int, str] = {}
        for name, signal in sorted(self.arriving.items(), key=lambda item: item[0] not in arguments):
            needed = name in arguments and not isinstance(signal, (Tied, Unconnected))
            if needed or id(signal) in self._touched:
                self.ports += (Port.of(name, signal, id(signal) in self.driven),)
                self._take(name, -len(self.ports))  # one signal may be at two ports
                self.names[id(signal)] = name

    def _name_signals(self) -> None:
        """Find the name of each signal: its variable, its place in a list or an interface, or a field of its record."""
        known: dict[int, str] = {}
        for name, signal in self.block.sigdict.items():
            if not name.startswith("_"):
                known.setdefault(id(signal), name)
        first = {number: place for place, number in enumerate(dict.fromkeys([*known, *self._touched]))}
        scope: dict[str, Any] = {}
        for sub in self.block.subs:
            scope |= {name: value for name, value in sub.callinfo.symdict.items() if not name.startswith("_")}
        # A signal's own variable is a better name than its place in a list.
        for name, value in sorted(scope.items(), key=lambda item: not isinstance(item[1], SignalType)):
            for path, signal in signals_in(name, value):
                known.setdefault(id(signal), path)
        for name, memory in self.memories.items():
            self._take(name, id(memory))
            internals.set_name(memory, name)
            for index, element in enumerate(memory):
                own = f"{name}[{index}]"
                if name not in self.passed and (other := self.names.setdefault(id(element), own)) != own:
                    self._refuse(f"a process indexes {name}, but {own} is also {other}", name)
        touched = sorted(self._touched.values(), key=lambda signal: first[id(signal)])
        unnamed = [signal for signal in touched if id(signal) not in self.names]
        inline = (ConcatSignal, Tied, Constant)  # printed where they are used, if no variable holds them
        self.signals = [one for one in unnamed if not isinstance(one, SliceSignal)]
        self.signals = [one for one in self.signals if id(one) in known or not isinstance(one, inline)]
        self.signals.sort(key=lambda signal: isinstance(signal, ConcatSignal))  # after their parts
        for signal in self.signals:
            place = self._places.get(id(signal), "a process or a joined signal")
            self.names[id(signal)] = known.get(id(signal)) or self._refuse(
                f"the signal at {place} has no name; assign it to a variable", ""
            )
            self._take(known[id(signal)], id(signal))
        self.fields = [signal for signal in unnamed if isinstance(signal, Field)]
        self.fields.sort(key=lambda field: _place(field, first))
        for field in self.fields:
            word = bits_of(field)[0]
            record = self.names.get(id(word)) or known[id(word)]
            self.names[id(field)] = f"{record.removesuffix('_word')}_{field.field}"
            self._take(self.names[id(field)], id(field))
        words = [one for memory in self.memories.values() for one in memory]
        for signal in [*touched, *words]:
            internals.set_name(signal, self.text(signal))
        for name in self.passed:
            for index, one in enumerate(self.memories[name]):
                internals.set_name(one, f"{name}[{index}]")
        for part in self.parts:
            if isinstance(part, Instance):
                self._take(part.name, id(part))
            elif not isinstance(part, Loading):
                texts = dict.fromkeys(map(self.text, part.sigdict.values()), 0)
                for name in part.vardict:
                    self._take(name, 1, texts)
                for name, value in internals.state_of(part).items():
                    self._take(name, id(part))
                    self.variables[name] = part.vardict[name], value
        signals = [*self.signals, *self.arriving.values(), *words]
        variables = [one for part in self.parts for one in getattr(part, "vardict", {}).values()]
        values = [*(signal.val for signal in signals), *variables]
        self.enumerations = [value for value in values if isinstance(value, EnumItemType)]
        for state in (state for value in self.enumerations for state in internals.states_of(value).items()):
            self.states[state] = self.states.get(state) or self.free(state[0])
        self.labels = {id(part): self.free(part.name) for part in self.parts if internals.locals_of(part)}

    def free(self, name: str) -> str:
        """Take a name that nothing else has: this one, if possible."""
        first, number = re.sub(r"[^\x00-\x7f]", "_", name), 0
        name = first
        while name in self._owners or _is_keyword(name):
            number += 1
            name = f"{first}_{number}"
        self._owners[name] = 0
        return name

    def _take(self, name: str, owner: int, owners: dict[str, int] | None = None) -> None:
        """Refuse a keyword, and a name that something else has; `owners` are those of a process."""
        if (self._owners if owners is None else owners).setdefault(name, owner) != owner:
            self._refuse(f"two things would be called {name} in Verilog; rename one", name)
        check_keyword(self.block, name)

    def _check(self) -> None:
        """Refuse signals without a driver, reader or width, and lists that have no value in Verilog."""
        for port in self.ports:
            self._check_width(port.name, self.arriving[port.name])
        for signal in self.signals:
            name = self.names[id(signal)]
            self._check_width(name, signal)
            if id(signal) not in self.driven and not isinstance(signal, (Tied, Constant, ConcatSignal)):
                if id(signal) in self._design.driven:
                    self._refuse(f"{name} is driven by another block; pass it as an argument", name)
                self._refuse(f"{name}: Signal is not driven; drive it, or use tied()", name)
            if id(signal) not in self.read and id(signal) not in self._design.read:
                remedy = "remove it, or use unconnected() for an instance's output"
                self._refuse(f"{name}: Signal is driven but not read; {remedy}", name)
        for name, memory in self.memories.items():
            if any(isinstance(one, ShadowSignal) for one in memory):
                remedy = "whose slices would have no value in Verilog; index the signal that they are cut from"
                self._refuse(f"a process indexes {name}, {remedy}", name)
            if len({(len(one), is_signed(one)) for one in memory}) > 1:
                self._refuse(f"a process indexes {name}, whose signals differ in width or sign", name)

    def _check_width(self, name: str, signal: SignalType) -> None:
        if not len(signal):
            self._refuse(f"{name} has no width; write intbv(0)[8:] or intbv(0, min=-8, max=8)", name)

    def _refuse(self, reason: str, name: str) -> NoReturn:
        raise refusal(self.block, reason, name)


def _place(field: Field, first: Mapping[int, int]) -> tuple[bool, int, int]:
    """Return what a module's fields are sorted by: the place of the word, then the place in it."""
    word = bits_of(field)[0]
    place = next(number for number, other in enumerate(internals.slices_of(word)) if other is field)
    return isinstance(word, SliceSignal), first[id(word)], place


def sources(value: Any, ports: Collection[int]) -> Iterator[SignalType]:
    """Yield a signal or a list's signals, and what they are cut or joined from; ports come from outside."""
    if isinstance(value, (list, tuple)):
        for one in value:
            yield from sources(one, ports)
    elif isinstance(value, SignalType):
        yield value
        if isinstance(value, (SliceSignal, ConcatSignal)) and id(value) not in ports:
            parts = internals.operands_of(value) if isinstance(value, ConcatSignal) else bits_of(value)[0]
            yield from sources(parts, ports)


def is_signed(signal: SignalType) -> bool:
    """Return True if Verilog takes a signal as two's complement."""
    return (signal.min or 0) < 0


def check_keyword(block: Block, name: str, vhdl: bool = False) -> None:
    """Refuse a name that is a keyword of Verilog or SystemVerilog, or of VHDL.

    Raises:
        UserError: the name is a keyword.
    """
    if name.lower() in internals.vhdl_keywords if vhdl else _is_keyword(name):
        raise refusal(block, f"{name} is a keyword of {'VHDL' if vhdl else 'Verilog'}; rename it", name)
    if not name.isascii():
        raise refusal(block, f"{name} has letters that Verilog does not know; rename it", name)


@functools.cache
def _is_keyword(name: str) -> bool:
    kind, _ = next(SystemVerilogLexer().get_tokens(name))
    return kind in Keyword or kind in Operator or name in ("class", "extends")  # which Pygments takes with a name only


def refusal(block: Block, reason: str, name: str = "") -> UserError:
    """Return an error with the file and line at which a block assigns a name, or those of the block if it does not."""
    lines, first = inspect.getsourcelines(block.func)
    assigned = rf"\s*(?:\w+, *)*{re.escape(name)}\b.*=" if name else "(?!)"
    places = [number for rule in (assigned, r"\s*def ") for number, line in enumerate(lines) if re.match(rule, line)]
    return UserError(f"{inspect.getsourcefile(block.func)}:{first + places[0]}: {block.func.__name__}: {reason}")
