# SPDX-License-Identifier: MIT
"""Convert to Verilog and keep the hierarchy, one module per file; MyHDL by itself would flatten the design.

Blocks are converted from the leaves up. MyHDL analyses and prints the processes of each, and this package does the
rest: ports, signals and instances. Blocks of one function share a module if their arguments are alike: see `_kind`.
"""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from myhdl import ConcatSignal

from raycaster.hdl.contents import Connection, Contents, Instance, Loading, Module, Port, Usage, check_keyword, refusal
from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.errors import UserError, faults_in_one_line
from raycaster.hdl.given import GivenVerilog, load_words
from raycaster.hdl.internals import Block, SignalType, SliceSignal, around, bits_of, drivers_of, operands_of
from raycaster.hdl.records import Field, block_arguments, block_ports, is_interface, signals_in
from raycaster.hdl.signals import Tied, Unconnected
from raycaster.hdl.verilog_style import module_text, number


def prefixed(name: str, prefix: str) -> str:
    """Put a prefix before a module's name, unless it has it already, as `ray_caster` and `ray_caster_module` may."""
    return name if f"{name}_".startswith(prefix) else f"{prefix}{name}"


def convert_hierarchy(
    top: Block,
    directory: Path,
    header: str,
    prefix: str = "",
    vocabulary: Mapping[str, Any] | None = None,
    vhdl: bool = True,
) -> list[Module]:
    """Write one Verilog file for each distinct block below and including `top`.

    Args:
        top: an elaborated block; it cannot be simulated afterwards.
        directory: directory for the files, made if there is none.
        header: comment lines for the head of each file; `{module}` is replaced by the module's name.
        prefix: prefix of the names of modules and files; instances keep their names.
        vocabulary: meanings of Python names in docstrings and comments; see `raycaster.hdl.port_comments.Comments`.
        vhdl: True to refuse keywords of VHDL as names of the top and its ports, for parents in that language.

    Returns:
        The modules, each after those that it instantiates; `top` is the last.

    Raises:
        UserError: a block cannot be a module: see `raycaster.hdl.contents.Contents`; or given Verilog lists an output
            that is not an argument of its block, lacks its module, or has the name of another block.
    """
    if not isinstance(top, Block):
        code = getattr(getattr(top, "funcobj", None), "__code__", None)
        place = f"{code.co_filename}:{code.co_firstlineno}: " if code else ""
        raise UserError(
            f"{place}expected a block, got {type(top).__name__}; write @block above the function that makes it"
        )
    directory.mkdir(parents=True, exist_ok=True)
    with elaboration(), faults_in_one_line():
        converter = _Converter(directory, header, prefix, vocabulary or {})
        outside = dict.fromkeys(map(id, converter.ports(top).values()), 0)
        converter.driven = {*map(id, converter.drivers(top)), *outside}
        converter.check_crossing(top, outside)
        module = converter.module_of(top)
        for name in (top.func.__name__, *(port.name for port in module.ports)) if vhdl else ():
            check_keyword(top, name, vhdl=True)
        return [*converter.modules.values()]


class _Converter:
    def __init__(self, directory: Path, header: str, prefix: str, vocabulary: Mapping[str, Any]):
        self._directory, self._header, self._prefix, self._vocabulary = directory, header, prefix, vocabulary
        self._kinds: dict[str, Any] = {}
        self.modules: dict[str, Module] = {}
        self._initial: dict[str, list[int]] = {}
        self._texts: dict[tuple[Any, str], Module] = {}
        self.driven: set[int] = set()
        self.read: set[int] = set()
        self.ports = functools.cache(block_ports)
        self.port_ids = functools.cache(lambda block: {*map(id, self.ports(block).values())})

    def drivers(self, block: Block) -> Iterator[Any]:
        """Yield the signals, and the lists of signals, that something in a block drives."""
        if given := getattr(block.func, "given_verilog", None):
            yield from (signal for name, signal in self.ports(block).items() if name in given.outputs)
        for sub in block.subs:
            driven = list(self.drivers(sub) if isinstance(sub, Block) else drivers_of(sub))
            yield from driven
            yield from (one for memory in driven if isinstance(memory, list) for one in memory)

    def check_crossing(self, top: Block, homes: dict[int, int]) -> None:
        """Refuse a signal, or a list, that two blocks use and to which no argument brings it; find what is read.

        Args:
            top: the design.
            homes: the signals from outside.
        """
        users = [*self._users(top)]
        crossing: set[int] = set()
        for block, _, value in users:
            for one in _parts(value, self.port_ids(block)):
                if homes.setdefault(id(one), id(block)) != id(block):
                    crossing.add(id(one))
        crossing &= self.driven
        for block, name, value in users:
            if name and any(id(one) in crossing for one in _parts(value, self.port_ids(block))):
                raise refusal(block, f"{name} is used by another block too; pass it as an argument", name)

    def _users(self, block: Block) -> Iterator[tuple[Block, str, Any]]:
        """Yield each block, those in it first, with each signal and list that it uses, and a name in its processes."""
        for sub in block.subs:
            if isinstance(sub, Block):
                given = getattr(sub.func, "given_verilog", None)
                if not given:
                    yield from self._users(sub)
                for name, signal in self.ports(sub).items():
                    yield block, "", signal
                    if given and name not in given.outputs:
                        self.read |= {*map(id, _parts(signal, ()))}
            else:
                for name, value in (sub.sigdict | sub.losdict).items():
                    yield block, name, value
                    if name in sub.inputs:
                        self.read |= {*map(id, _parts(value, ()))}
                for edge in getattr(sub, "senslist", ()):
                    yield block, "", getattr(edge, "sig", edge)
                yield block, "", getattr(sub, "reset", None)

    def module_of(self, block: Block) -> Module:
        """Return the block's module, after writing it unless a block of the same kind has one."""
        if given := getattr(block.func, "given_verilog", None):
            return self._copy(given, block)
        if block.verilog_code is not None:
            raise refusal(block, "verilog_code has no ports; write its text as a module, and use given_verilog")
        kind, ports = self._kind(block), self.ports(block)
        for known, module in self.modules.items():
            if self._kinds[known] == kind and self._initial[known] == _initial(module, ports):
                return module
        name = first = prefixed(block.func.__name__, self._prefix)
        number = 0
        while name in self._kinds:
            number += 1
            name = f"{first}_{number}"
        self._kinds[name] = kind  # the name is taken while the block's own parts are converted
        module = self._convert_block(block, name, ports)
        alike = self._texts.setdefault((block.func, _text(module, first)), module)
        if alike is not module:
            # What differs between the two blocks is in no line of their Verilog.
            module.path.unlink()
            del self._kinds[name]
            return alike
        self.modules[name] = module
        self._initial[name] = _initial(module, ports)
        return module

    def _copy(self, given: GivenVerilog, block: Block) -> Module:
        """Return the module of given Verilog: one file for all instances, each with its own parameters."""
        given_name, ports = block.func.__name__, self.ports(block)
        name = prefixed(given_name, self._prefix)
        if strangers := given.outputs - set(ports):
            raise refusal(
                block, f"{', '.join(sorted(strangers))} is listed as an output, but no argument; correct its name"
            )
        shapes = tuple(Port.of(port, signal, port in given.outputs) for port, signal in ports.items())
        parameters = tuple(
            (parameter, repr(value))
            for parameter, value in block_arguments(block).items()
            if not any(signals_in(parameter, value))
        )
        if name not in self._kinds:
            path = self._directory / f"{name}.v"
            text, found = re.subn(
                rf"^(\s*module\s+){given_name}\b", rf"\g<1>{name}", given.source().read_text(), flags=re.M
            )
            if not found:
                raise refusal(block, f"{given.source()} has no module {given_name}; name the block after the module")
            path.write_text(text)
            self._kinds[name], self.modules[name] = block.func, Module(name, path, shapes, {}, parameters)
        if self._kinds[name] is not block.func:
            raise refusal(block, f"{name} is the name of given Verilog, which stays, and of another block; rename that")
        return replace(self.modules[name], ports=shapes, parameters=parameters)

    def _convert_block(self, block: Block, name: str, ports: dict[str, SignalType]) -> Module:
        """Write a block's module after those of the blocks in it."""
        loading: Any = load_words
        children = [sub for sub in block.subs if isinstance(sub, Block) and sub.func is not loading.func]
        modules = {id(child): self.module_of(child) for child in children}
        instances: dict[str, str] = {}
        parts: list[Any] = []
        for sub in block.subs:
            if id(sub) not in modules:
                parts.append(Loading(*sub.args) if isinstance(sub, Block) else sub)
                continue
            kind = sub.func.__name__
            alike = [other for other in children if other.func.__name__ == kind]
            instance = kind if len(alike) == 1 else f"{kind}_{alike.index(sub)}"
            if instance in instances:
                raise refusal(block, f"two instances would be called {instance}; rename a block")
            instances[instance] = modules[id(sub)].name
            connections = _connections(self.ports(sub), modules[id(sub)], ports)
            parts.append(Instance(modules[id(sub)], f"{instance}_i", connections))
        contents = Contents(block, parts, Usage(self.driven, self.read))
        path = self._directory / f"{name}.v"
        path.write_text(module_text(contents, name, self._header.replace("{module}", name), self._vocabulary))
        return Module(name, path, contents.ports, instances)

    def _kind(self, block: Block) -> tuple[Any, ...]:
        """Return what determines a block's module.

        These are its function, its arguments, which ports are the same signal, and what its processes and the blocks in
        it begin with.

        A signal counts by its shape, a record by its layout, an interface by its class and all its attributes, anything
        else by its value.
        """
        numbers: dict[int, int] = {}
        ports = [id(signal) for signal in self.ports(block).values()]
        same = tuple(numbers.setdefault(port, number) for number, port in enumerate(ports))
        # Signals that nothing drives are a table, whose contents count, unless they are connected as numbers.
        tables = {id(one) for one in self.ports(block).values() if type(one) is SignalType} - self.driven
        return block.func, _description(block_arguments(block)), same, [*self._beginnings(block, {*ports} - tables)]

    def _beginnings(self, block: Block, ports: set[int]) -> Iterator[Any]:
        """Yield what processes in a block read from around them: numbers, and initial values except those of ports."""
        known = {id(signal): -1 - place for place, signal in enumerate(self.ports(block).values())}

        def beginning(value: Any) -> Any:
            if isinstance(value, SignalType):
                first = id(value) not in known
                number = known.setdefault(id(value), len(known))
                if id(value) in ports or not first:
                    return number, id(value) in ports or _Constant(value.val)
                cut = bits_of(value) if isinstance(value, SliceSignal) else ()
                parts = operands_of(value) if isinstance(value, ConcatSignal) else cut
                return number, type(value), _description(value), _Constant(value.val), [*map(beginning, parts)]
            if isinstance(value, list) and value and isinstance(value[0], SignalType):  # a memory may be large
                first = id(value) not in known
                number = known.setdefault(id(value), len(known))
                return number, type(value), len(value), [beginning(element) for element in value * first]
            if isinstance(value, (list, tuple)):
                return [beginning(element) for element in value]
            parts = []
            if inspect.isfunction(value):
                parts = list(around(value).values())
            elif type(value).__eq__ is object.__eq__:
                parts = list(getattr(value, "__dict__", {}).values())
            else:
                return _Constant(value)
            first = id(value) not in known
            number = known.setdefault(id(value), len(known))
            return number, type(value), [beginning(part) for part in parts * first]

        for sub in block.subs:
            if isinstance(sub, Block):
                values = block_arguments(sub).values()
                yield sub.func, [_Constant(one) for one in values if isinstance(one, (int, float, str))]
                yield [beginning(signal) for signal in self.ports(sub).values()]
                yield from self._beginnings(sub, ports)
            else:
                edges = [(type(edge), beginning(getattr(edge, "sig", edge))) for edge in getattr(sub, "senslist", ())]
                yield type(sub), sub.funcobj.__code__, beginning(sub.funcobj), edges
                yield [(name, beginning(value)) for name, value in (sub.sigdict | sub.losdict).items()]


def _parts(value: Any, ports: Collection[int]) -> Iterator[SignalType]:
    """Yield a signal or a list's signals, and what they are cut or joined from, except ports."""
    if isinstance(value, (list, tuple)):
        for one in value:
            yield from _parts(one, ports)
    elif isinstance(value, SignalType) and id(value) not in ports:
        yield value
        if isinstance(value, SliceSignal):
            yield from _parts(bits_of(value)[0], ports)
        elif isinstance(value, ConcatSignal):
            yield from _parts(operands_of(value), ports)


def _text(module: Module, name: str) -> str:
    """Return a module's text with another name."""
    return re.sub(rf"\b{module.name}\b", name, module.path.read_text())


def _initial(module: Module, ports: Mapping[str, SignalType]) -> list[int]:
    """Return the values that a module gives its outputs when it is reset."""
    return [int(ports[port.name].val) for port in module.ports if port.output]


def _connections(
    signals: Mapping[str, SignalType], module: Module, parent_ports: Mapping[str, SignalType]
) -> dict[str, Connection]:
    """Return what an instance's ports connect to in its parent, from the signals at its ports and the parent's."""
    passed_on = {id(signal) for signal in parent_ports.values()}
    connections: dict[str, Connection] = {}
    for port in module.ports:
        signal = signals[port.name]
        source = bits_of(signal)[0] if isinstance(signal, Field) else signal
        connections[port.name] = signal
        if passed_on & {id(signal), id(source)}:
            continue
        if isinstance(signal, Unconnected):
            connections[port.name] = None
        elif isinstance(source, Tied) and not port.output:
            connections[port.name] = number(signal)
    return connections


class _Constant:
    """An argument that is not a signal. Type, value and text must be equal, as True == 1 and -0.0 == 0.0 in Python."""

    __hash__: Any = None

    def __init__(self, value: Any):
        self.value = value

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Constant) or type(self.value) is not type(other.value):
            return False
        mine, its = self.value, other.value
        # An array's == returns an array, not a bool.
        return mine is its or ((mine == its) is True and repr(mine) == repr(its) and _inside(mine) == _inside(its))


def _inside(value: Any) -> list[tuple[str, _Constant]]:
    """Return an object's attributes, as its own == and repr may leave some out."""
    names = [*getattr(value, "__dict__", ()), *(name for kind in type(value).__mro__ for name in _slots(kind))]
    return [(name, _Constant(getattr(value, name))) for name in names if hasattr(value, name)]


def _slots(kind: type) -> Sequence[str]:
    slots = vars(kind).get("__slots__", ())
    return (slots,) if isinstance(slots, str) else tuple(slots)


def _description(value: Any, above: tuple[Any, ...] = ()) -> Any:
    """Return what `_kind` compares for an argument; `above` are the objects around it."""
    if isinstance(value, SignalType):
        reset = (getattr(value, "active", None), getattr(value, "isasync", None))
        return type(value.val), len(value), value.min, value.max, reset
    if isinstance(value, (list, tuple)):
        return tuple(_description(one, above) for one in value)
    if any(value is one for one in above):
        return len(above)
    if is_interface(value):
        places = {name: bits_of(field)[1:] for name, field in vars(value).items() if isinstance(field, Field)}
        return type(value), places, _description(vars(value), (*above, value))
    if isinstance(value, dict):
        return tuple((name, _description(element, above)) for name, element in value.items())
    return _Constant(value)
