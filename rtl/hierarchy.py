# SPDX-License-Identifier: MIT
"""Verilog with its hierarchy kept: one module a file, where MyHDL by itself would flatten the design.

This is the only file that touches MyHDL's internals, which is why its version is pinned; the contract that it relies
on is tested. Blocks are converted from the leaves up. Each converts as a top level of its own, and in its
parent's conversion it is replaced by text that instantiates the module. Equal blocks share one module.
"""

from __future__ import annotations

import inspect
import shutil
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from myhdl import ConcatSignal, Constant, ToVerilogWarning, block, intbv
from myhdl._block import _Block
from myhdl._enum import EnumItemType
from myhdl._extractHierarchy import _MemInfo, _UserVerilogCode
from myhdl._instance import _Instantiator
from myhdl._ShadowSignal import _SliceSignal
from myhdl._Signal import _Signal
from myhdl._simulator import _signals
from myhdl.conversion._toVerilog import _ToVerilogConvertor, toVerilog

from raycaster.rtl.verilog_style import restyle


class HierarchyError(Exception):
    """A block that cannot be made a module of its own; the text says which and why."""


@dataclass(frozen=True)
class Port:
    """A module's port, as its parent and other generators need to know it."""

    name: str
    width: int
    signed: bool
    output: bool


@dataclass(frozen=True)
class Module:
    """A module. `instances` are the modules it instantiates directly, by instance name.

    `parameters` are given to its instances in Verilog; a converted one has none, as its values are built in.
    """

    name: str
    path: Path
    ports: tuple[Port, ...]
    instances: dict[str, str]
    parameters: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class _GivenVerilog:
    """What `given_verilog` says of a block."""

    source: Callable[[], Path]
    outputs: frozenset[str]


class _Instance(_UserVerilogCode):
    """The text that stands for a block in its parent; names are only known when it is printed."""

    def __init__(self, module: Module, name: str, connections: dict[str, _Signal | str | None]):
        super().__init__("", {}, module.name, None, None, None)
        self._module, self._name, self._connections = module, name, connections

    def __str__(self) -> str:
        pins = ",\n".join(f"    .{port}({_printed(signal)})" for port, signal in self._connections.items())
        values = ",\n".join(f"    .{name}({value})" for name, value in self._module.parameters)
        kind = f"{self._module.name} #(\n{values}\n)" if values else self._module.name
        return f"\n{kind} {self._name} (\n{pins}\n);\n"


class _Loading(_UserVerilogCode):
    """The text that stands for `load_words`; as with instances, the memory's name is known when it is printed."""

    def __init__(self, memory: _MemInfo, file: str):
        super().__init__("", {}, memory.name, None, None, None)
        self._memory, self._file = memory, file

    def __str__(self) -> str:
        return f'\n// What the memory holds from the start.\ninitial $readmemh("{self._file}", {self._memory.name});\n'


def _printed(connection: _Signal | str | None) -> str:
    """A signal by its name in the parent, a number as it is, and nothing for what is not connected."""
    if connection is None:
        return ""
    return connection if isinstance(connection, str) else connection._name


class _RecordingConvertor(_ToVerilogConvertor):
    """MyHDL's convertor, which drops the signals of an interface that a block does not use, and remembers the ports."""

    __slots__ = ("ports",)

    def _convert_filter(self, h, intf, siglist, memlist, genlist):
        for signal in intf.argdict.values():
            if isinstance(signal, _SliceSignal):
                signal._driven = None  # MyHDL would have a slice's reader drive it
        arguments = inspect.signature(intf.func).parameters
        intf.argnames = [
            name
            for name in intf.argnames
            if name in arguments or intf.argdict[name]._driven or intf.argdict[name]._read
        ]
        self.ports = tuple(
            Port(
                name, len(intf.argdict[name]) or 1, (intf.argdict[name].min or 0) < 0, bool(intf.argdict[name]._driven)
            )
            for name in intf.argnames
        )


@dataclass(frozen=True)
class Part:
    """A block or a process inside a design, with the signals that it drives, and those that it reads of others.

    What only clocks and resets it does not count. A signal stands for itself by its identity; `Inside.names` has what
    it is called.
    """

    name: str
    is_block: bool
    within: tuple[str, ...]
    """The blocks that it stands in, below the one that was asked for, outermost first."""

    reads: frozenset[int]
    drives: frozenset[int]


@dataclass(frozen=True)
class Inside:
    """What a block is made of. `names` has the variable that gives access to a signal, and the signal's whole name."""

    parts: tuple[Part, ...]
    names: dict[int, tuple[str, str]]
    ports: frozenset[int]


@contextmanager
def elaboration() -> Iterator[None]:
    """Elaborate quickly, and have MyHDL forget the signals afterwards; what is to be simulated must be within too.

    MyHDL asks for the stack at each instance and process, of which it only wants a few frames and their functions'
    names. Python's own answer opens files, and goes through all modules for each frame that has no file: 64 units take
    twice as long with it, and six times as long under pytest. And MyHDL keeps every signal ever made, and resets them
    all after each simulation, so that each takes longer than the one before.
    """
    with_source, known = inspect.stack, len(_signals)
    inspect.stack = _callers
    try:
        yield
    finally:
        inspect.stack = with_source
        del _signals[known:]


def _callers() -> list[inspect.FrameInfo]:
    """What `inspect.stack` returns, but for the source."""
    found, frame = [], inspect.currentframe()
    while frame := frame.f_back:
        code = frame.f_code
        found.append(inspect.FrameInfo(frame, code.co_filename, frame.f_lineno, code.co_name, None, None))
    return found


def convert_hierarchy(top: _Block, directory: Path, header: str) -> list[Module]:
    """Write one Verilog file for each distinct block below and including `top`.

    Args:
        top: an elaborated block; it cannot be simulated any more afterwards.
        directory: where the files go; it exists.
        header: comment lines for the head of each file; `{module}` stands for the module's name.

    Returns:
        The modules, each after those that it instantiates; `top` is the last.

    Raises:
        HierarchyError: two blocks of one name differ in parameters or ports, or a signal has no name in its parent.
    """
    return _Converter(directory, header).convert(top)


class _Converter:
    def __init__(self, directory: Path, header: str):
        self._directory, self._header = directory, header
        self._modules: dict[str, tuple[Any, Module]] = {}

    def convert(self, top: _Block) -> list[Module]:
        self._module_of(top)
        return [module for _, module in self._modules.values()]

    def _module_of(self, block: _Block) -> Module:
        name = block.func.__name__
        ports, parameters = _arguments(block)
        shapes = tuple((port, len(signal) or 1, (signal.min or 0) < 0) for port, signal in ports.items())
        signature = parameters, shapes
        if name in self._modules:
            known, module = self._modules[name]
            if known != signature:
                raise HierarchyError(f"{name} stands in the design with different parameters or port widths")
            return module
        given = getattr(block.func, "given_verilog", None)
        module = self._copy(given, name, ports, parameters) if given else self._convert_block(block, name, ports)
        self._modules[name] = signature, module
        return module

    def _copy(self, given: _GivenVerilog, name: str, ports: dict[str, _Signal], parameters: Any) -> Module:
        if strangers := given.outputs - set(ports):
            raise HierarchyError(f"{name}: {', '.join(sorted(strangers))} is said to be an output, and is no argument")
        path = self._directory / f"{name}.v"
        shutil.copyfile(given.source(), path)
        shapes = tuple(
            Port(port, len(signal) or 1, (signal.min or 0) < 0, port in given.outputs) for port, signal in ports.items()
        )
        return Module(name, path, shapes, {}, parameters)

    def _convert_block(self, block: _Block, name: str, ports: dict[str, _Signal]) -> Module:
        children = []
        for sub in block.subs:
            if isinstance(sub, _Block) and sub.func is load_words.func:
                _replace_by_loading(sub, block)
            elif isinstance(sub, _Block):
                children.append(sub)
        modules = [self._module_of(child) for child in children]
        for signal in ports.values():
            signal._read = False  # another block may have read it, or a slice of it; this one has not been looked at
        instances = {}
        for child, module in zip(children, modules, strict=True):
            count = sum(other.func is child.func for other in children)
            ordinal = sum(used == module.name for used in instances.values())
            instance = module.name if count == 1 else f"{module.name}_{ordinal}"
            instances[instance] = module.name
            _replace_by_instance(child, module, f"{instance}_i", ports)
        _name_connections(block, children, ports)
        written_ports = self._write(block, name, ports)
        return Module(name, self._directory / f"{name}.v", written_ports, instances)

    def _write(self, block: _Block, name: str, ports: dict[str, _Signal]) -> tuple[Port, ...]:
        _mark_processes(block)
        for signal in [*block.sigdict.values(), *ports.values()]:
            signal._name = None  # a child's conversion may have left its own name for it
        for port, signal in ports.items():
            if isinstance(signal, _SliceSignal):
                signal._name = port  # MyHDL names a slice after the vector that the parent cut it from
        convertor = _RecordingConvertor()
        convertor.name = toVerilog.name = name
        convertor.directory = str(self._directory)
        # The functions that print the module read these from MyHDL's global convertor, not from the one that runs.
        toVerilog.no_myhdl_header = toVerilog.no_testbench = True
        toVerilog.header = self._header.format(module=name).replace("$", "$$")
        toVerilog.initial_values = False
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", category=ToVerilogWarning)
                convertor(block)
        except ToVerilogWarning as warning:
            raise HierarchyError(f"{name}: {warning}") from None
        finally:
            toVerilog.no_myhdl_header = toVerilog.no_testbench = False
            toVerilog.header, toVerilog.name = "", None
        if not {port.name for port in convertor.ports} <= set(ports):
            raise HierarchyError(f"{name}: MyHDL found other ports than its arguments")
        path = self._directory / f"{name}.v"
        path.write_text(restyle(path.read_text(), block, [port.name for port in convertor.ports]))
        return convertor.ports


def find_block(top: _Block, name: str) -> _Block:
    """The first block of this name in an elaborated design.

    Raises:
        KeyError: there is none.
    """
    waiting = [top]
    for candidate in waiting:
        if candidate.func.__name__ == name:
            return candidate
        waiting += [sub for sub in candidate.subs if isinstance(sub, _Block)]
    raise KeyError(name)


def look_inside(top: _Block, opened: Collection[str]) -> Inside:
    """What an elaborated block is made of; blocks whose names are in `opened` give way to their own parts."""
    ports, _ = _arguments(top)
    names: dict[int, tuple[str, str]] = {}
    parts: list[Part] = []

    def visit(block: _Block, within: tuple[str, ...]) -> None:
        arguments = inspect.signature(block.func).bind(*block.args, **block.kwargs).arguments
        scope = dict(arguments)
        for sub in block.subs:
            scope |= {name: value for name, value in sub.callinfo.symdict.items() if not name.startswith("_")}
        for name, value in scope.items():
            for path, signal in _signals_in(name, value):
                names.setdefault(id(signal), (name, path))
        for sub in block.subs:
            if isinstance(sub, _Block) and sub.func.__name__ in opened:
                visit(sub, (*within, sub.func.__name__))
            elif isinstance(sub, _Block):
                around = {id(signal) for signal in _arguments(sub)[0].values()}
                reads, drives = (_whole(signals, around) for signals in _traffic(sub))
                parts.append(Part(sub.func.__name__, True, within, reads - drives, drives))
            else:
                reads, drives = (_whole(signals) for signals in _traffic_of_process(sub))
                parts.append(Part(sub.func.__name__, False, within, reads - drives, drives))

    visit(top, ())
    return Inside(tuple(parts), names, frozenset(id(signal) for signal in ports.values()))


Signals = dict[int, _Signal]


def _traffic(block: _Block) -> tuple[Signals, Signals]:
    """All signals that are read, and driven, in a block and below."""
    given = getattr(block.func, "given_verilog", None)
    reads: Signals = {}
    drives: Signals = {}
    if given:
        for name, signal in _arguments(block)[0].items():
            (drives if name in given.outputs else reads)[id(signal)] = signal
    for sub in block.subs:
        more_reads, more_drives = _traffic(sub) if isinstance(sub, _Block) else _traffic_of_process(sub)
        reads |= more_reads
        drives |= more_drives
    return reads, drives


def _traffic_of_process(process: _Instantiator) -> tuple[Signals, Signals]:
    """The signals that a process reads, and drives; the edges and the reset that it waits for are not among them."""

    def find(names: Collection[str]) -> Signals:
        return {id(signal): signal for name in names for _, signal in _signals_in(name, process.symdict[name])}

    return find(process.inputs), find(process.outputs)


def _whole(signals: Signals, around: Collection[int] | None = None) -> frozenset[int]:
    """The signals themselves where some of these are slices of them, or put together of them."""
    found: set[int] = set()
    waiting = [signal for number, signal in signals.items() if around is None or number in around]
    while waiting:
        signal = waiting.pop()
        if isinstance(signal, _SliceSignal):
            waiting.append(signal._sig)
        elif isinstance(signal, ConcatSignal):
            waiting += signal._sigargs
        else:
            found.add(id(signal))
    return frozenset(found)


def state_names(top: _Block) -> dict[tuple[str, str], dict[int, str]]:
    """The enumerated signals of an elaborated design.

    Returns:
        By module and signal, the name of each value as the Verilog encodes it.
    """
    found = {}
    for name, signal in top.sigdict.items():
        if isinstance(signal.val, EnumItemType):
            states = signal.val._type
            found[top.func.__name__, name] = {int(getattr(states, item)._val, 2): item for item in states._names}
    for sub in top.subs:
        if isinstance(sub, _Block):
            found |= state_names(sub)
    return found


def port_signals(arguments: Mapping[str, Any]) -> dict[str, _Signal]:
    """The signals among a block's arguments by Verilog port name: `name`, or `interface_attribute`."""
    return {path: signal for name, value in arguments.items() for path, signal in _signals_in(name, value)}


def _arguments(block: _Block) -> tuple[dict[str, _Signal], Any]:
    """A block's port signals by Verilog name, and its other arguments."""
    bound = inspect.signature(block.func).bind(*block.args, **block.kwargs)
    bound.apply_defaults()
    ports = port_signals(bound.arguments)
    parameters = ((name, repr(value)) for name, value in bound.arguments.items() if not any(_signals_in(name, value)))
    return ports, tuple(parameters)


def _signals_in(name: str, value: Any) -> Iterator[tuple[str, _Signal]]:
    """Every signal that a name gives access to: itself, an interface's attributes, a list's elements."""
    if isinstance(value, _Signal):
        yield name, value
    elif isinstance(value, (list, tuple)):
        for index, element in enumerate(value):
            yield from _signals_in(f"{name}_{index}", element)
    elif getattr(value, "is_interface", False):
        for attribute, element in vars(value).items():
            yield from _signals_in(f"{name}_{attribute}", element)


def _replace_by_instance(child: _Block, module: Module, name: str, parent_ports: dict[str, _Signal]) -> None:
    """Make the parent's conversion print an instance where the child's processes would stand."""
    signals, _ = _arguments(child)
    passed_on = {id(signal) for signal in parent_ports.values()}
    connections = {port.name: signals[port.name] for port in module.ports}
    for port, signal in connections.items():
        if isinstance(signal, _Unconnected) and id(signal) not in passed_on:
            connections[port] = None
        if isinstance(signal, _Held) and id(signal) not in passed_on:
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


def _replace_by_loading(loading: _Block, parent: _Block) -> None:
    """Make the parent's conversion print where its memory's words come from."""
    words, file = loading.args
    [memory] = [known for known in parent.memdict.values() if known.mem is words]
    loading.verilog_code = _Loading(memory, file)
    loading.subs, loading.sigdict, loading.memdict = [], {}, {}


def _mark_processes(block: _Block) -> None:
    """Repeat the marks that elaboration left on signals, and that converting the children wiped off.

    Registers to reset come in the order of a Python set, which changes from run to run; here they get that of names.
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


def _name_connections(block: _Block, children: list[_Block], ports: Mapping[str, _Signal]) -> None:
    """Give MyHDL a name for every signal that only instances use: it knows those of processes by itself."""
    named = {id(signal) for signal in block.sigdict.values()}
    arrived = {id(signal) for signal in ports.values()}
    scope: dict[str, Any] = {}
    for sub in block.subs:
        scope |= {name: value for name, value in sub.callinfo.symdict.items() if not name.startswith("_")}
    candidates = {}
    for name, value in scope.items():
        for path, signal in _signals_in(name, value):
            candidates.setdefault(id(signal), path)
    for child in children:
        for port, connected in child.verilog_code._connections.items():
            cut_here = isinstance(connected, _SliceSignal) and id(connected) not in arrived
            signal = connected._sig if cut_here else connected
            if signal is None or isinstance(signal, str) or id(signal) in named:
                continue
            if id(signal) not in candidates:
                raise HierarchyError(
                    f"{block.func.__name__}: what {child.func.__name__}.{port} connects to has no name"
                )
            block.sigdict[candidates[id(signal)]] = signal
            named.add(id(signal))


class _Unconnected(_Signal):
    """What `unconnected` makes; it prints as an empty connection."""


def unconnected(width: int) -> _Signal:
    """A signal for an instance's output that nobody reads; of one bit it is a bool, as such outputs are."""
    return _Unconnected(intbv(0)[width:] if width > 1 else False)


def unconnected_like(signal: _Signal) -> _Signal:
    """The same in the shape of another signal."""
    if signal.min is None:
        return unconnected(1)
    return _Unconnected(intbv(0, min=signal.min, max=signal.max))


class _Held(_Signal):
    """What `held` makes; it prints as a number."""


def held(value: int, like: _Signal) -> _Signal:
    """A signal in the shape of another for instances' inputs that never change, however many levels down.

    Unlike with a constant, processes may look at nothing else.
    """
    if like.min is None:
        return _Held(bool(value))
    return _Held(intbv(value, min=like.min, max=like.max))


def is_held(signal: _Signal) -> bool:
    """Whether `held` made it."""
    return isinstance(signal, _Held)


def _number(signal: _Signal) -> str:
    """What never changes, as Verilog writes it."""
    width, value = len(signal) or 1, int(signal.val)
    kind = "sd" if (signal.min or 0) < 0 else "d"
    return f"{'-' if value < 0 else ''}{width}'{kind}{abs(value)}"


def constant(value: int, width: int) -> Constant:
    """A signal for an instance's input that never changes; of one bit it is a bool, as such inputs are."""
    return Constant(intbv(value)[width:] if width > 1 else bool(value))


def signed_constant(value: int, width: int) -> Constant:
    """The same in two's complement."""
    return Constant(intbv(value, min=-(1 << (width - 1)), max=1 << (width - 1)))


def given_verilog(source: Callable[[], Path], outputs: Collection[str]) -> Callable[[Any], Any]:
    """Mark a block as one whose Verilog is given; it has no processes, so MyHDL cannot simulate it.

    Its arguments without a signal are the module's parameters, of the same names. Ports of the module that are no
    arguments stay unconnected.

    Args:
        source: finds the file, which is copied as it is; called when it is needed.
        outputs: which of the block's arguments the module drives.
    """

    def mark(decorated: Any) -> Any:
        decorated.func.given_verilog = _GivenVerilog(source, frozenset(outputs))
        return decorated

    return mark


@block
def load_words(memory, file: str):
    """Verilog's $readmemh: a memory, a list of signals, holds a file's words from the start, as its block must, too.

    The file is looked for where the simulation or synthesis runs, and not when the block is converted.
    """
    return ()
