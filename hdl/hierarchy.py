# SPDX-License-Identifier: MIT
"""Convert to Verilog and keep the hierarchy, one module per file; MyHDL by itself would flatten the design.

Blocks are converted from the leaves up. Each is converted as a top level, and in its parent's conversion it is replaced
by text that instantiates the module. Blocks of one function share a module if their arguments are alike: see `_kind`.

This package imports MyHDL's internals, so its version is pinned, and tests check the internals that it relies on.
"""

from __future__ import annotations

import inspect
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from myhdl import ConcatSignal, ToVerilogWarning
from myhdl._block import _Block
from myhdl._extractHierarchy import _MemInfo, _UserVerilogCode
from myhdl._instance import _Instantiator
from myhdl._ShadowSignal import _ShadowSignal, _SliceSignal
from myhdl._Signal import Constant, _Signal
from myhdl.conversion._toVerilog import _ToVerilogConvertor, toVerilog

from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.errors import UserError
from raycaster.hdl.given import GivenVerilog, load_words
from raycaster.hdl.inside import block_arguments, block_ports, signals_in
from raycaster.hdl.records import Field
from raycaster.hdl.signals import Tied, Unconnected
from raycaster.hdl.verilog_style import restyle


class HierarchyError(UserError):
    """A block that cannot be made a module; the text says which block and why."""


@dataclass(frozen=True)
class Port:
    """A module's port, for its parent and for other generators."""

    name: str
    width: int
    signed: bool
    output: bool


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


Connection = _Signal | str | None
"""A signal, a number in Verilog notation, or nothing."""


class _Instance(_UserVerilogCode):
    """Text that replaces a block in its parent; names are only known when it is printed."""

    def __init__(self, module: Module, name: str, connections: dict[str, Connection]):
        super().__init__("", {}, module.name, None, None, None)
        self._module, self.name, self.connections = module, name, connections

    def __str__(self) -> str:
        pins = ",\n".join(f"    .{port}({_printed(signal)})" for port, signal in self.connections.items())
        values = ",\n".join(f"    .{name}({value})" for name, value in self._module.parameters)
        kind = f"{self._module.name} #(\n{values}\n)" if values else self._module.name
        return f"\n{kind} {self.name} (\n{pins}\n);\n"


class _Loading(_UserVerilogCode):
    """Text that replaces `load_words`; as with instances, the memory's name is only known when it is printed."""

    def __init__(self, memory: _MemInfo, file: str):
        super().__init__("", {}, memory.name, None, None, None)
        self._memory, self._file = memory, file

    def __str__(self) -> str:
        return f'\n// Initial contents of the memory.\ninitial $readmemh("{self._file}", {self._memory.name});\n'


def _printed(connection: Any) -> str:
    """Return a signal's name in the parent, a number as it is, or nothing if there is no connection."""
    if connection is None:
        return ""
    return connection if isinstance(connection, str) else connection._name


class _RecordingConvertor(_ToVerilogConvertor):
    """MyHDL's convertor, except that an interface's signals are ports only of modules that use them.

    Likewise for ports that are tied or left open, so a design without a feature does not have its ports. Fields of
    records that are read become wires, and ties that are read become localparams.
    """

    __slots__ = ("constants", "fields", "ports")

    def __init__(self, fields: set[int]):
        """Convert a block that reads these fields, given by identity."""
        super().__init__()
        self.fields = fields

    def _convert_filter(self, h, intf, siglist, memlist, genlist):
        for signal in intf.argdict.values():
            if isinstance(signal, (_SliceSignal, ConcatSignal)):
                signal._driven = None  # MyHDL would have its reader drive it
        arguments = inspect.signature(intf.func).parameters
        intf.argnames = [
            name
            for name in intf.argnames
            if (name in arguments and not isinstance(intf.argdict[name], (Tied, Unconnected)))
            or (not isinstance(intf.argdict[name], Field) and (intf.argdict[name]._driven or intf.argdict[name]._read))
        ]
        self.ports = tuple(
            Port(
                name, len(intf.argdict[name]) or 1, (intf.argdict[name].min or 0) < 0, bool(intf.argdict[name]._driven)
            )
            for name in intf.argnames
        )
        self._declare_fields(siglist, intf)
        siglist.sort(key=lambda signal: isinstance(signal, ConcatSignal))  # after their parts
        _check_names(intf, {id(intf.argdict[name]): name for name in intf.argnames}, memlist)
        _check_values(intf, siglist, memlist)
        self.constants = [s for s in siglist if isinstance(s, Tied) and s._used and s._name not in intf.argnames]
        siglist[:] = [s for s in siglist if not isinstance(s, Tied) or s._name in intf.argnames]

    def _declare_fields(self, siglist: list[_Signal], intf: Any) -> None:
        """Have MyHDL print a wire for each field, named record_field."""
        ports = {id(intf.argdict[name]): name for name in intf.argnames}
        cut = [intf.argdict[name] for name in intf.argnames if isinstance(intf.argdict[name], _SliceSignal)]
        for word in [*siglist, *cut]:
            record = ports.get(id(word), word._name).removesuffix("_word")
            for field in word._slicesigs:
                if not isinstance(field, Field) or id(field) not in self.fields or id(field) in ports:
                    continue
                field._name = f"{record}_{field.field}"
                field._driven, field._read, field._used = "wire", True, True
                siglist.append(field)


def prefixed(name: str, prefix: str) -> str:
    """Put a prefix before a module's name, unless it has it already, as `ray_caster` and `ray_caster_module` may."""
    return name if f"{name}_".startswith(prefix) else f"{prefix}{name}"


def convert_hierarchy(
    top: _Block, directory: Path, header: str, prefix: str = "", vocabulary: Mapping[str, Any] | None = None
) -> list[Module]:
    """Write one Verilog file for each distinct block below and including `top`.

    Args:
        top: an elaborated block; it cannot be simulated afterwards.
        directory: directory for the files, which exists.
        header: comment lines for the head of each file; `{module}` is replaced by the module's name.
        prefix: prefix of the names of modules and files; instances keep their names.
        vocabulary: meanings of Python names in docstrings and comments; see `raycaster.hdl.port_comments.in_verilog`.

    Returns:
        The modules, each after those that it instantiates; `top` is the last.

    Raises:
        HierarchyError: a block cannot be a module: a signal has no driver or no reader; a process indexes a list of
            slices; a constant is below 0; two things in it would have one name in Verilog; an instance connects to a
            signal that no variable holds; given Verilog lists an output that is not an argument of its block, lacks
            its module, or has the name of another block.
    """
    with elaboration():
        return _Converter(directory, header, prefix, vocabulary or {}).convert(top)


class _Converter:
    def __init__(self, directory: Path, header: str, prefix: str, vocabulary: Mapping[str, Any]):
        self._directory, self._header, self._prefix, self._vocabulary = directory, header, prefix, vocabulary
        self._kinds: dict[str, Any] = {}
        self._modules: dict[str, Module] = {}

    def convert(self, top: _Block) -> list[Module]:
        self._module_of(top)
        return [*self._modules.values()]

    def _module_of(self, block: _Block) -> Module:
        """Return the block's module, after writing it unless a block of the same kind has one."""
        if given := getattr(block.func, "given_verilog", None):
            return self._copy(given, block)
        kind = _kind(block)
        for known, module in self._modules.items():
            if self._kinds[known] == kind:
                return module
        name = first = prefixed(block.func.__name__, self._prefix)
        number = 0
        while name in self._kinds:
            number += 1
            name = f"{first}_{number}"
        self._kinds[name] = kind  # the name is taken while the block's own parts are converted
        self._modules[name] = self._convert_block(block, name, block_ports(block))
        return self._modules[name]

    def _copy(self, given: GivenVerilog, block: _Block) -> Module:
        """Return the module of given Verilog: one file for all instances, each with its own parameters."""
        given_name, ports = block.func.__name__, block_ports(block)
        name = prefixed(given_name, self._prefix)
        if strangers := given.outputs - set(ports):
            raise HierarchyError(f"{name}: {', '.join(sorted(strangers))} is listed as an output, but no argument")
        shapes = tuple(
            Port(port, len(signal) or 1, (signal.min or 0) < 0, port in given.outputs) for port, signal in ports.items()
        )
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
                raise HierarchyError(f"{given_name}: {given.source()} has no module of this name")
            path.write_text(text)
            self._kinds[name], self._modules[name] = block.func, Module(name, path, shapes, {}, parameters)
        if self._kinds[name] is not block.func:
            raise HierarchyError(f"{name} is the name of given Verilog, which stays, and of another block; rename that")
        return replace(self._modules[name], ports=shapes, parameters=parameters)

    def _convert_block(self, block: _Block, name: str, ports: dict[str, _Signal]) -> Module:
        children: list[_Block] = []
        loading: Any = load_words
        for sub in block.subs:
            if isinstance(sub, _Block) and sub.func is loading.func:
                _replace_by_loading(sub, block)
            elif isinstance(sub, _Block):
                children.append(sub)
        modules = [self._module_of(child) for child in children]
        for signal in ports.values():
            signal._read = False  # set if another block reads it, or a slice of it
        instances = {}
        for child, module in zip(children, modules, strict=True):
            kind = child.func.__name__
            alike = [other for other in children if other.func.__name__ == kind]
            instance = kind if len(alike) == 1 else f"{kind}_{alike.index(child)}"
            if instance in instances:
                raise HierarchyError(f"{name}: two instances would be called {instance}; rename a block")
            instances[instance] = module.name
            _replace_by_instance(child, module, f"{instance}_i", ports)
        fields = _fields_read(block, children)
        _name_signals(block, children, ports, fields)
        written_ports = self._write(block, name, ports, set(fields))
        return Module(name, self._directory / f"{name}.v", written_ports, instances)

    def _write(self, block: _Block, name: str, ports: dict[str, _Signal], fields: set[int]) -> tuple[Port, ...]:
        for signal in block.sigdict.values():
            if isinstance(signal, Tied):
                signal._used = False  # a child's conversion has used it; here it needs a name where a process reads it
        _mark_processes(block)
        for signal in [*block.sigdict.values(), *ports.values()]:
            signal._name = None  # a child's conversion may have left its own name for it
        for port, signal in ports.items():
            if isinstance(signal, _SliceSignal):
                signal._name = port  # MyHDL names a slice after the vector that the parent cut it from
        convertor: Any = _RecordingConvertor(fields)
        printer: Any = toVerilog
        convertor.name = printer.name = name
        convertor.directory = str(self._directory)
        # The functions that print the module read these from MyHDL's global convertor, not from the one that runs.
        printer.no_myhdl_header = printer.no_testbench = True
        printer.header = self._header.format(module=name).replace("$", "$$")
        printer.initial_values = False
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", category=ToVerilogWarning)
                convertor(block)
        except ToVerilogWarning as warning:
            raise HierarchyError(f"{name}: {warning}") from None
        finally:
            printer.no_myhdl_header = printer.no_testbench = False
            printer.header, printer.name = "", None
        if not {port.name for port in convertor.ports} <= set(ports):
            raise HierarchyError(f"{name}: MyHDL found other ports than its arguments")
        path = self._directory / f"{name}.v"
        declared = "".join(f"localparam {_shape(one)}{one._name} = {_number(one)};\n" for one in convertor.constants)
        text = path.read_text().replace("endmodule\n", f"{declared}endmodule\n")
        for constant in convertor.constants:
            constant._clear()
        path.write_text(restyle(text, block, [port.name for port in convertor.ports], self._vocabulary))
        return convertor.ports


class _Constant:
    """An argument that is not a signal. Type, value and text must be equal, as True == 1 and -0.0 == 0.0 in Python."""

    __hash__: Any = None

    def __init__(self, value: Any):
        self._value = value

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Constant) or type(self._value) is not type(other._value):
            return False
        mine, its = self._value, other._value
        # An array's == returns an array, not a bool.
        return mine is its or ((mine == its) is True and repr(mine) == repr(its))


def _kind(block: _Block) -> tuple[Any, ...]:
    """Return what determines a block's module: its function, its arguments, and which ports are the same signal.

    A signal counts by its shape, a record by its layout, an interface by its class and all its attributes, anything
    else by its value.
    """
    numbers: dict[int, int] = {}
    same = tuple(numbers.setdefault(id(signal), number) for number, signal in enumerate(block_ports(block).values()))
    return block.func, _description(block_arguments(block)), same


def _description(value: Any) -> Any:
    """Return what `_kind` compares for an argument."""
    if isinstance(value, _Signal):
        return _description_of_signal(value)
    if isinstance(value, (list, tuple)):
        return tuple(map(_description, value))
    if getattr(value, "is_interface", False):
        places = {name: field._right for name, field in vars(value).items() if isinstance(field, Field)}
        return type(value), places, _description(vars(value))
    if isinstance(value, dict):
        return tuple((name, _description(element)) for name, element in value.items())
    return _Constant(value)


def _description_of_signal(signal: _Signal) -> tuple[int, ...]:
    """Return a signal's width and range; MyHDL has no range for a single bit."""
    return len(signal) or 1, signal.min or 0, signal.max or 1 << (len(signal) or 1)


def _check_names(block: _Block, ports: Mapping[int, str], memories: list[Any]) -> None:
    """Refuse two signals, memories or instances with one name in Verilog: MyHDL would print one for the other."""
    owners: dict[str, int] = {memory.name: id(memory) for memory in memories if memory._used}
    owners |= {name: number for number, name in ports.items()}
    used: list[tuple[str, _Signal]] = []
    for sub in block.subs:
        if isinstance(sub, _Instantiator):
            used += sub.sigdict.items()
        elif isinstance(sub.verilog_code, _Instance):
            owners[sub.verilog_code.name] = id(sub)
            used += [(port, one) for port, one in sub.verilog_code.connections.items() if isinstance(one, _Signal)]
    for variable, signal in used:
        if isinstance(signal, _SliceSignal) and not isinstance(signal, Field) and id(signal) not in ports:
            continue  # it is printed as bits of another signal
        name = ports.get(id(signal), signal._name)
        if name is None or owners.setdefault(name, id(signal)) != id(signal):
            raise HierarchyError(f"{block.name}: two things would be called {name or variable} in Verilog; rename one")


def _check_values(block: _Block, signals: list[_Signal], memories: list[Any]) -> None:
    """Refuse values that MyHDL would print wrongly: slices that processes index, and constants below 0."""
    for memory in memories:
        if memory._used and any(isinstance(one, _ShadowSignal) for one in memory.mem):
            raise HierarchyError(
                f"{_place(block, memory.name)}: a process indexes {memory.name}, whose slices would have no value "
                "in Verilog; index the signal that they are cut from"
            )
    constants: list[Any] = [signal for signal in signals if isinstance(signal, Constant)]
    for signal in constants:
        if signal._read and int(signal.val) < 0:
            raise HierarchyError(
                f"{_place(block, signal._name)}: {signal._name} is {int(signal.val)}, and a constant below 0 is not "
                "valid Verilog; use tied()"
            )


def _place(block: _Block, name: str) -> str:
    """Return the file and line at which a block assigns a name, or those of the block if it does not."""
    lines, first = inspect.getsourcelines(block.func)
    given = (number for number, line in enumerate(lines) if re.match(rf"\s*(?:\w+, *)*{re.escape(name)}\b.*=", line))
    return f"{inspect.getsourcefile(block.func)}:{first + next(given, 0)}"


def _fields_read(block: _Block, children: list[Any]) -> dict[int, Field]:
    """Return the fields of records that a block's processes and instances read, by identity."""
    read = [sub.symdict[name] for sub in block.subs if isinstance(sub, _Instantiator) for name in sorted(sub.inputs)]
    read += [signal for child in children for signal in child.verilog_code.connections.values()]
    for signal in read:
        if isinstance(signal, ConcatSignal):
            read += signal._sigargs
        elif isinstance(signal, _SliceSignal) and isinstance(signal._sig, Field):
            read.append(signal._sig)
    return {id(signal): signal for signal in read if isinstance(signal, Field)}


def _shape(signal: _Signal) -> str:
    """Return a declaration's sign and range."""
    width = len(signal) or 1
    return f"{'signed ' if (signal.min or 0) < 0 else ''}{f'[{width - 1}:0] ' if width > 1 else ''}"


def _number(signal: Any) -> str:
    """Return a constant in Verilog notation."""
    width, value = len(signal) or 1, int(signal.val)
    if (signal.min or 0) < 0:
        return f"{'-' if value < 0 else ''}{width}'sd{abs(value)}"
    return f"{width}'h{value:0{-(-width // 4)}x}" if width > 16 else f"{width}'d{value}"


def _replace_by_instance(child: _Block, module: Module, name: str, parent_ports: dict[str, _Signal]) -> None:
    """Make the parent's conversion print an instance instead of the child's processes."""
    signals = block_ports(child)
    # Set by `rests_on`.
    if (clock := getattr(child, "verilog_clk", None)) is not None:
        signals["clk"] = clock
    passed_on = {id(signal) for signal in parent_ports.values()}
    connections: dict[str, Connection] = {port.name: signals[port.name] for port in module.ports}
    for port, signal in connections.items():
        if isinstance(signal, Unconnected) and id(signal) not in passed_on:
            connections[port] = None
        tied = isinstance(signal._sig if isinstance(signal, Field) else signal, Tied)
        if tied and not passed_on & {id(signal), id(getattr(signal, "_sig", None))}:
            connections[port] = _number(signal)
    child.verilog_code = _Instance(module, name, connections)
    child.subs, child.sigdict, child.memdict = [], {}, {}
    directions = {port.name: port.output for port in module.ports}
    for port, signal in connections.items():
        if signal is None or isinstance(signal, str):
            continue
        signal._markUsed()
        if directions[port]:
            signal._driven = "wire"
        else:
            signal._markRead()
            if isinstance(signal, ConcatSignal):
                signal._driven = "wire"  # driven by its parts, which the child's conversion has forgotten


def _replace_by_loading(loading: _Block, parent: _Block) -> None:
    """Make the parent's conversion print the file from which its memory is loaded."""
    words, file = loading.args
    [memory] = [known for known in parent.memdict.values() if known.mem is words]
    loading.verilog_code = _Loading(memory, file)
    loading.subs, loading.sigdict, loading.memdict = [], {}, {}


def _mark_processes(block: _Block) -> None:
    """Repeat the marks that elaboration left on signals, and that the children's conversion removed.

    Registers to reset come in the order of a Python set, which changes from run to run; here they are sorted by name.
    """
    for sub in block.subs:
        if isinstance(sub, _Instantiator):
            names = {id(sub.symdict[name]): name for name in sub.outputs if name in sub.symdict}
            getattr(sub, "sigregs", []).sort(key=lambda signal, names=names: names.get(id(signal), ""))
            for signal in sub.sigdict.values():
                signal._markUsed()
            edges = getattr(sub, "senslist", ())
            reset = getattr(sub, "reset", None)
            for signal in [getattr(edge, "sig", edge) for edge in edges] + [reset]:
                if isinstance(signal, _Signal):
                    signal._markRead()


def _name_signals(
    block: _Block, children: list[Any], ports: Mapping[str, _Signal], fields: Mapping[int, Field]
) -> None:
    """Give MyHDL a name for every signal that only instances use, and for records used only by their fields."""
    named = {id(signal) for signal in block.sigdict.values()}
    arrived = {id(signal) for signal in ports.values()}
    scope: dict[str, Any] = {}
    for sub in block.subs:
        scope |= {name: value for name, value in sub.callinfo.symdict.items() if not name.startswith("_")}
    candidates = {id(signal): port for port, signal in ports.items()}
    # A signal's own variable is a better name than its place in a list.
    for name, value in sorted(scope.items(), key=lambda item: not isinstance(item[1], _Signal)):
        for path, signal in signals_in(name, value):
            candidates.setdefault(id(signal), path)

    def give_name(connected: _Signal, where: str) -> None:
        signal = connected._sig if isinstance(connected, _SliceSignal) and id(connected) not in arrived else connected
        if id(signal) in named:
            return
        if id(signal) not in candidates:
            raise HierarchyError(f"{block.func.__name__}: the signal that {where} has no name")
        block.sigdict[candidates[id(signal)]] = signal
        named.add(id(signal))

    for child in children:
        for port, connected in child.verilog_code.connections.items():
            if isinstance(connected, _Signal):
                give_name(connected, f"{child.func.__name__}.{port} connects to")
    for field in fields.values():
        give_name(field, f"a process reads {field.field} of")
