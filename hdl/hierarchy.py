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
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from myhdl import ConcatSignal, ToVerilogWarning

from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.errors import UserError, faults_in_one_line
from raycaster.hdl.given import GivenVerilog, load_words
from raycaster.hdl.internals import (
    Block,
    Constant,
    Process,
    ShadowSignal,
    SignalType,
    SliceSignal,
    UserVerilog,
    VerilogConvertor,
    verilog_printer,
)
from raycaster.hdl.lint import check_process
from raycaster.hdl.records import Field, block_arguments, block_ports, signals_in
from raycaster.hdl.signals import Tied, Unconnected
from raycaster.hdl.verilog_style import restyle


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
        return cls(name, len(signal) or 1, (signal.min or 0) < 0, output)


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


REMEDIES = {
    "Signal is not driven": "drive it, or use tied()",
    "Signal is driven but not read": "remove it, or use unconnected() for an instance's output",
}
"""Remedies for MyHDL's warnings, which are errors here."""

Connection = SignalType | str | None
"""A signal, a number in Verilog notation, or nothing."""


class _Text(UserVerilog):
    """Text that replaces a block in its parent; it is made when it is printed, as names are only known then."""

    def __init__(self, name: str, text: Callable[[], str], connections: Mapping[str, Connection] | None = None):
        super().__init__("", {}, name, None, None, None)
        self.name, self.connections, self._text = name, connections or {}, text

    def __str__(self) -> str:
        return self._text()


def _instance(module: Module, name: str, connections: Mapping[str, Connection]) -> _Text:
    def text() -> str:
        pins = ",\n".join(f"    .{port}({_printed(signal)})" for port, signal in connections.items())
        values = ",\n".join(f"    .{name}({value})" for name, value in module.parameters)
        kind = f"{module.name} #(\n{values}\n)" if values else module.name
        return f"\n{kind} {name} (\n{pins}\n);\n"

    return _Text(name, text, connections)


def _loading(memory: Any, file: str) -> _Text:
    return _Text(
        memory.name,
        lambda: f'\n// Initial contents of the memory.\ninitial $readmemh("{file}", {memory.name});\n',
    )


def _printed(connection: Any) -> str:
    """Return a signal's name in the parent, a number as it is, or nothing if there is no connection."""
    if connection is None:
        return ""
    return connection if isinstance(connection, str) else connection._name


class _RecordingConvertor(VerilogConvertor):
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
        for process in genlist:
            if not isinstance(process, UserVerilog):
                check_process(process)
        for signal in intf.argdict.values():
            if isinstance(signal, (SliceSignal, ConcatSignal)):
                signal._driven = None  # MyHDL would have its reader drive it
        arguments = inspect.signature(intf.func).parameters
        intf.argnames = [
            name
            for name in intf.argnames
            if (name in arguments and not isinstance(intf.argdict[name], (Tied, Unconnected)))
            or (not isinstance(intf.argdict[name], Field) and (intf.argdict[name]._driven or intf.argdict[name]._read))
        ]
        self.ports = tuple(
            Port.of(name, intf.argdict[name], bool(intf.argdict[name]._driven)) for name in intf.argnames
        )
        self._declare_fields(siglist, intf)
        siglist.sort(key=lambda signal: isinstance(signal, ConcatSignal))  # after their parts
        _check_names(intf, {id(intf.argdict[name]): name for name in intf.argnames}, memlist)
        _check_values(intf, siglist, memlist)
        self.constants = [s for s in siglist if isinstance(s, Tied) and s._used and s._name not in intf.argnames]
        siglist[:] = [s for s in siglist if not isinstance(s, Tied) or s._name in intf.argnames]

    def _declare_fields(self, siglist: list[SignalType], intf: Any) -> None:
        """Have MyHDL print a wire for each field, named record_field."""
        ports = {id(intf.argdict[name]): name for name in intf.argnames}
        cut = [intf.argdict[name] for name in intf.argnames if isinstance(intf.argdict[name], SliceSignal)]
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
    top: Block, directory: Path, header: str, prefix: str = "", vocabulary: Mapping[str, Any] | None = None
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
        UserError: a block cannot be a module: a signal has no driver or no reader; a process indexes a list of
            slices; a constant is below 0; two things in it would have one name in Verilog; an instance connects to a
            signal that no variable holds; given Verilog lists an output that is not an argument of its block, lacks
            its module, or has the name of another block.
    """
    with elaboration(), faults_in_one_line():
        return _Converter(directory, header, prefix, vocabulary or {}).modules_of(top)


class _Converter:
    def __init__(self, directory: Path, header: str, prefix: str, vocabulary: Mapping[str, Any]):
        self._directory, self._header, self._prefix, self._vocabulary = directory, header, prefix, vocabulary
        self._kinds: dict[str, Any] = {}
        self._modules: dict[str, Module] = {}

    def modules_of(self, top: Block) -> list[Module]:
        """Return the modules of a block and of all in it."""
        self._module_of(top)
        return [*self._modules.values()]

    def _module_of(self, block: Block) -> Module:
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

    def _copy(self, given: GivenVerilog, block: Block) -> Module:
        """Return the module of given Verilog: one file for all instances, each with its own parameters."""
        given_name, ports = block.func.__name__, block_ports(block)
        name = prefixed(given_name, self._prefix)
        if strangers := given.outputs - set(ports):
            raise _refusal(
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
                raise _refusal(block, f"{given.source()} has no module {given_name}; name the block after the module")
            path.write_text(text)
            self._kinds[name], self._modules[name] = block.func, Module(name, path, shapes, {}, parameters)
        if self._kinds[name] is not block.func:
            raise _refusal(
                block, f"{name} is the name of given Verilog, which stays, and of another block; rename that"
            )
        return replace(self._modules[name], ports=shapes, parameters=parameters)

    def _convert_block(self, block: Block, name: str, ports: dict[str, SignalType]) -> Module:
        children: list[Block] = []
        loading: Any = load_words
        for sub in block.subs:
            if isinstance(sub, Block) and sub.func is loading.func:
                _replace_by_loading(sub, block)
            elif isinstance(sub, Block):
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
                raise _refusal(block, f"two instances would be called {instance}; rename a block")
            instances[instance] = module.name
            _replace_by_instance(child, module, f"{instance}_i", ports)
        fields = _fields_read(block, children)
        _name_signals(block, children, ports, fields)
        written_ports = self._write(block, name, ports, set(fields))
        return Module(name, self._directory / f"{name}.v", written_ports, instances)

    def _write(self, block: Block, name: str, ports: dict[str, SignalType], fields: set[int]) -> tuple[Port, ...]:
        for signal in block.sigdict.values():
            if isinstance(signal, Tied):
                signal._used = False  # a child's conversion has used it; here it needs a name where a process reads it
        _mark_processes(block)
        for signal in [*block.sigdict.values(), *ports.values()]:
            signal._name = None  # a child's conversion may have left its own name for it
        for port, signal in ports.items():
            if isinstance(signal, SliceSignal):
                signal._name = port  # MyHDL names a slice after the vector that the parent cut it from
        convertor: Any = _RecordingConvertor(fields)
        printer: Any = verilog_printer
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
            reason, signal = str(warning).split(": ")
            raise _refusal(block, f"{signal}: {reason}; {REMEDIES.get(reason, 'remove it')}", signal) from None
        finally:
            printer.no_myhdl_header = printer.no_testbench = False
            printer.header, printer.name = "", None
        if not {port.name for port in convertor.ports} <= set(ports):
            raise _refusal(block, "MyHDL found other ports than the arguments")
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


def _kind(block: Block) -> tuple[Any, ...]:
    """Return what determines a block's module: its function, its arguments, and which ports are the same signal.

    A signal counts by its shape, a record by its layout, an interface by its class and all its attributes, anything
    else by its value.
    """
    numbers: dict[int, int] = {}
    same = tuple(numbers.setdefault(id(signal), number) for number, signal in enumerate(block_ports(block).values()))
    return block.func, _description(block_arguments(block)), same


def _description(value: Any) -> Any:
    """Return what `_kind` compares for an argument."""
    if isinstance(value, SignalType):  # MyHDL has no range for a single bit
        return len(value) or 1, value.min or 0, value.max or 1 << (len(value) or 1)
    if isinstance(value, (list, tuple)):
        return tuple(map(_description, value))
    if getattr(value, "is_interface", False):
        places = {name: field._right for name, field in vars(value).items() if isinstance(field, Field)}
        return type(value), places, _description(vars(value))
    if isinstance(value, dict):
        return tuple((name, _description(element)) for name, element in value.items())
    return _Constant(value)


def _check_names(block: Block, ports: Mapping[int, str], memories: list[Any]) -> None:
    """Refuse two signals, memories or instances with one name in Verilog: MyHDL would print one for the other."""
    owners: dict[str, int] = {memory.name: id(memory) for memory in memories if memory._used}
    owners |= {name: number for number, name in ports.items()}
    used: list[tuple[str, SignalType]] = []
    for sub in block.subs:
        if isinstance(sub, Process):
            used += sub.sigdict.items()
        elif isinstance(sub.verilog_code, _Text) and sub.verilog_code.connections:
            owners[sub.verilog_code.name] = id(sub)
            used += [(port, one) for port, one in sub.verilog_code.connections.items() if isinstance(one, SignalType)]
    for variable, signal in used:
        if isinstance(signal, SliceSignal) and not isinstance(signal, Field) and id(signal) not in ports:
            continue  # it is printed as bits of another signal
        name = ports.get(id(signal), signal._name)
        if name is None or owners.setdefault(name, id(signal)) != id(signal):
            raise _refusal(
                block, f"two things would be called {name or variable} in Verilog; rename one", name or variable
            )


def _check_values(block: Block, signals: list[SignalType], memories: list[Any]) -> None:
    """Refuse values that MyHDL would print wrongly: slices that processes index, and constants below 0."""
    for memory in memories:
        if memory._used and any(isinstance(one, ShadowSignal) for one in memory.mem):
            raise _refusal(
                block,
                f"a process indexes {memory.name}, whose slices would have no value in Verilog; "
                "index the signal that they are cut from",
                memory.name,
            )
    constants: list[Any] = [signal for signal in signals if isinstance(signal, Constant)]
    for signal in constants:
        if signal._read and int(signal.val) < 0:
            raise _refusal(
                block,
                f"{signal._name} is {int(signal.val)}, and a constant below 0 is not valid Verilog; use tied()",
                signal._name,
            )


def _refusal(block: Block, reason: str, name: str = "") -> UserError:
    """Return an error with the file and line at which a block assigns a name, or those of the block if it does not."""
    lines, first = inspect.getsourcelines(block.func)
    assigned = rf"\s*(?:\w+, *)*{re.escape(name)}\b.*=" if name else "(?!)"
    places = [number for rule in (assigned, r"\s*def ") for number, line in enumerate(lines) if re.match(rule, line)]
    return UserError(f"{inspect.getsourcefile(block.func)}:{first + places[0]}: {block.func.__name__}: {reason}")


def _fields_read(block: Block, children: list[Any]) -> dict[int, Field]:
    """Return the fields of records that a block's processes and instances read, by identity."""
    read = [sub.symdict[name] for sub in block.subs if isinstance(sub, Process) for name in sorted(sub.inputs)]
    read += [signal for child in children for signal in child.verilog_code.connections.values()]
    for signal in read:
        if isinstance(signal, ConcatSignal):
            read += signal._sigargs
        elif isinstance(signal, SliceSignal) and isinstance(signal._sig, Field):
            read.append(signal._sig)
    return {id(signal): signal for signal in read if isinstance(signal, Field)}


def _shape(signal: SignalType) -> str:
    """Return a declaration's sign and range."""
    width = len(signal) or 1
    return f"{'signed ' if (signal.min or 0) < 0 else ''}{f'[{width - 1}:0] ' if width > 1 else ''}"


def _number(signal: Any) -> str:
    """Return a constant in Verilog notation."""
    width, value = len(signal) or 1, int(signal.val)
    if (signal.min or 0) < 0:
        return f"{'-' if value < 0 else ''}{width}'sd{abs(value)}"
    return f"{width}'h{value:0{-(-width // 4)}x}" if width > 16 else f"{width}'d{value}"


def _replace_by_instance(child: Block, module: Module, name: str, parent_ports: dict[str, SignalType]) -> None:
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
    child.verilog_code = _instance(module, name, connections)
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


def _replace_by_loading(loading: Block, parent: Block) -> None:
    """Make the parent's conversion print the file from which its memory is loaded."""
    words, file = loading.args
    [memory] = [known for known in parent.memdict.values() if known.mem is words]
    loading.verilog_code = _loading(memory, file)
    loading.subs, loading.sigdict, loading.memdict = [], {}, {}


def _mark_processes(block: Block) -> None:
    """Repeat the marks that elaboration left on signals, and that the children's conversion removed.

    Registers to reset come in the order of a Python set, which changes from run to run; here they are sorted by name.
    """
    for sub in block.subs:
        if isinstance(sub, Process):
            names = {id(sub.symdict[name]): name for name in sub.outputs if name in sub.symdict}
            getattr(sub, "sigregs", []).sort(key=lambda signal, names=names: names.get(id(signal), ""))
            for signal in sub.sigdict.values():
                signal._markUsed()
            edges = getattr(sub, "senslist", ())
            reset = getattr(sub, "reset", None)
            for signal in [getattr(edge, "sig", edge) for edge in edges] + [reset]:
                if isinstance(signal, SignalType):
                    signal._markRead()


def _name_signals(
    block: Block, children: list[Any], ports: Mapping[str, SignalType], fields: Mapping[int, Field]
) -> None:
    """Give MyHDL a name for every signal that only instances use, and for records used only by their fields."""
    named = {id(signal) for signal in block.sigdict.values()}
    arrived = {id(signal) for signal in ports.values()}
    scope: dict[str, Any] = {}
    for sub in block.subs:
        scope |= {name: value for name, value in sub.callinfo.symdict.items() if not name.startswith("_")}
    candidates = {id(signal): port for port, signal in ports.items()}
    # A signal's own variable is a better name than its place in a list.
    for name, value in sorted(scope.items(), key=lambda item: not isinstance(item[1], SignalType)):
        for path, signal in signals_in(name, value):
            candidates.setdefault(id(signal), path)

    def give_name(connected: SignalType, where: str) -> None:
        signal = connected._sig if isinstance(connected, SliceSignal) and id(connected) not in arrived else connected
        if id(signal) in named:
            return
        if id(signal) not in candidates:
            raise _refusal(block, f"the signal that {where} has no name; assign it to a variable")
        block.sigdict[candidates[id(signal)]] = signal
        named.add(id(signal))

    for child in children:
        for port, connected in child.verilog_code.connections.items():
            if isinstance(connected, SignalType):
                give_name(connected, f"{child.func.__name__}.{port} connects to")
    for field in fields.values():
        give_name(field, f"a process reads {field.field} of")
