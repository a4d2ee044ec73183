# SPDX-License-Identifier: MIT
"""Convert to Verilog and keep the hierarchy, one module per file; MyHDL by itself would flatten the design.

Blocks are converted from the leaves up. MyHDL analyses the processes of each, and this package does the rest: ports,
signals, instances and the Verilog. Blocks of one function share a module if their Verilog is the same.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from raycaster.hdl.contents import (
    Connection,
    Contents,
    Instance,
    Loading,
    Module,
    Port,
    Usage,
    check_keyword,
    refusal,
    sources,
)
from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.errors import UserError, faults_in_one_line
from raycaster.hdl.given import GivenVerilog, load_words
from raycaster.hdl.internals import Block, SignalType, bits_of, drivers_of
from raycaster.hdl.records import Field, block_arguments, block_ports, signals_in
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
        reason = f"expected a block, got {type(top).__name__}; write @block above the function that makes it"
        raise UserError(f"{place}{reason}")
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
        self._functions: dict[str, Any] = {}
        self.modules: dict[str, Module] = {}
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
            for one in self._inside(block, value):
                if homes.setdefault(id(one), id(block)) != id(block):
                    crossing.add(id(one))
        crossing &= self.driven
        for block, name, value in users:
            if name and any(id(one) in crossing for one in self._inside(block, value)):
                raise refusal(block, f"{name} is used by another block too; pass it as an argument", name)

    def _inside(self, block: Block, value: Any) -> Iterator[SignalType]:
        ports = self.port_ids(block)
        return (one for one in sources(value, ports) if id(one) not in ports)

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
                        self.read |= {*map(id, sources(signal, ()))}
            else:
                for name, value in (sub.sigdict | sub.losdict).items():
                    yield block, name, value
                    if name in sub.inputs:
                        self.read |= {*map(id, sources(value, ()))}
                for edge in getattr(sub, "senslist", ()):
                    yield block, "", getattr(edge, "sig", edge)
                yield block, "", getattr(sub, "reset", None)

    def module_of(self, block: Block) -> Module:
        """Return the block's module, after writing it unless a block of the same kind has one."""
        if given := getattr(block.func, "given_verilog", None):
            return self._copy(given, block)
        if block.verilog_code is not None:
            raise refusal(block, "verilog_code has no ports; write its text as a module, and use given_verilog")
        name = first = prefixed(block.func.__name__, self._prefix)
        number = 0
        while name in self._functions:
            number += 1
            name = f"{first}_{number}"
        self._functions[name] = block.func  # the name is taken while the block's own parts are converted
        contents, instances = self._contents(block)
        text = module_text(contents, name, self._header.replace("{module}", name), self._vocabulary)
        module = Module(name, self._directory / f"{name}.v", contents.ports, instances)
        known = self._texts.setdefault((block.func, re.sub(rf"\b{name}\b", first, text)), module)
        if known is not module:
            del self._functions[name]
            return known
        module.path.write_text(text)
        self.modules[name] = module
        return module

    def _copy(self, given: GivenVerilog, block: Block) -> Module:
        """Return the module of given Verilog: one file for all instances, each with its own parameters."""
        given_name, ports = block.func.__name__, self.ports(block)
        name = prefixed(given_name, self._prefix)
        if strangers := given.outputs - set(ports):
            names = ", ".join(sorted(strangers))
            raise refusal(block, f"{names} is listed as an output, but no argument; correct its name")
        shapes = tuple(Port.of(port, signal, port in given.outputs) for port, signal in ports.items())
        parameters = tuple(
            (parameter, repr(value))
            for parameter, value in block_arguments(block).items()
            if not any(signals_in(parameter, value))
        )
        if name not in self._functions:
            path = self._directory / f"{name}.v"
            text, found = re.subn(
                rf"^(\s*module\s+){given_name}\b", rf"\g<1>{name}", given.source().read_text(), flags=re.M
            )
            if not found:
                raise refusal(block, f"{given.source()} has no module {given_name}; name the block after the module")
            path.write_text(text)
            self._functions[name], self.modules[name] = block.func, Module(name, path, shapes, {}, parameters)
        if self._functions[name] is not block.func:
            raise refusal(block, f"{name} is the name of given Verilog, which stays, and of another block; rename that")
        return replace(self.modules[name], ports=shapes, parameters=parameters)

    def _contents(self, block: Block) -> tuple[Contents, dict[str, str]]:
        """Return a block's contents and the modules of its instances, after writing those modules."""
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
            connections = _connections(self.ports(sub), modules[id(sub)], self.ports(block))
            parts.append(Instance(modules[id(sub)], f"{instance}_i", connections))
        return Contents(block, parts, Usage(self.driven, self.read)), instances


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
