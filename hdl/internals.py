# SPDX-License-Identifier: MIT
"""Parts of MyHDL that it does not publish: its classes under our names, and a function for each private attribute.

No other file of the package touches them. They may change with any version of MyHDL, so its version is pinned.
"""

import importlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import StringIO
from typing import Any

from myhdl import ConcatSignal
from myhdl._block import _Block as Block
from myhdl._enum import EnumItemType
from myhdl._extractHierarchy import _getMemInfo
from myhdl._instance import _Instantiator as Process
from myhdl._ShadowSignal import _ShadowSignal as ShadowSignal
from myhdl._ShadowSignal import _SliceSignal as SliceSignal
from myhdl._Signal import Constant, _PosedgeWaiterList
from myhdl._Signal import _Signal as SignalType
from myhdl._simulator import _signals as all_signals
from myhdl.conversion import _toVerilog as to_verilog
from myhdl.conversion._analyze import _analyzeGens
from myhdl.conversion._misc import _genUniqueSuffix, _kind
from myhdl.conversion._VHDLNameValidation import _vhdl_keywords as vhdl_keywords

SOURCE_READERS = tuple((importlib.import_module(f"myhdl.{name}"), "_dedent") for name in ("_util", "_Waiter"))
"""Modules and names of the function that MyHDL calls to read a process's source."""

__all__ = [
    "SOURCE_READERS", "Block", "Constant", "DerivedClock", "EnumItemType", "Process", "ShadowSignal", "SignalType",
    "SignedSlice", "SliceSignal", "all_signals", "analysed", "assigned", "bits_of", "keeps", "operands_of",
    "printed", "set_name", "slices_of", "states_by_name", "states_of", "vhdl_keywords",
]  # fmt: skip


class SignedSlice(SliceSignal):
    """Bits of a word that may be a two's complement number; MyHDL's own slices are unsigned."""

    def __init__(self, word: SignalType, initial: Any, left: int, right: int):
        """Create it from bits left-1 to right of a word; `initial` is their value and has its range."""
        super().__init__(word, left, right)
        SignalType.__init__(self, initial)

    def _genfuncSlice(self):
        set_next: Any = SignalType.next.fset
        word, high, low = bits_of(self)
        sign = 1 << high - low if self.min < 0 else 0
        while True:
            bits = int(word.val) >> low & (2 << high - low) - 1
            set_next(self, (bits ^ sign) - sign)
            yield word


class DerivedClock(SignalType):
    """A clock that given Verilog derives from another one, whose rising edges it has in MyHDL's simulation."""

    class _Edges(_PosedgeWaiterList):
        def __init__(self, clock: SignalType, source: SignalType):
            super().__init__(clock)
            self._source = source

        def append(self, waiter: Any) -> None:
            self._source.posedge.append(waiter)

    def __init__(self, source: SignalType):
        """Create it from its source, which has the same edges or more."""
        super().__init__(bool(0))
        self._posedgeWaiters = self._Edges(self, source)


def bits_of(part: SliceSignal) -> tuple[SignalType, int, int]:
    """Return the signal from which a slice is cut, and the slice's highest and lowest bit there."""
    if part._right is None:
        return part._sig, part._left, part._left
    return part._sig, part._left - 1, part._right


def slices_of(word: SignalType) -> list[Any]:
    """Return the list of a signal's slices, which resets them with the signal."""
    return word._slicesigs


def operands_of(joined: ConcatSignal) -> tuple[Any, ...]:
    """Return what a signal is joined from, the highest bits first: signals, numbers, texts of bits."""
    return joined._args


def states_of(value: Any) -> dict[str, str]:
    """Return the binary code of each state of an enumeration, by name, from one of its items."""
    return dict(value._type._codedict)


def set_name(signal: Any, name: str | None) -> None:
    """Set the text that MyHDL prints for a signal or for a list of signals; None: it prints the value."""
    if isinstance(signal, list):
        _getMemInfo(signal).name = name
    else:
        signal._name = name


def analysed(processes: Iterable[Process]) -> list[Any]:
    """Return the syntax trees of processes, to which MyHDL has added the object of each name.

    Attributes of a tree: `sigdict` and `symdict`, signals and all values by name; `inputs` and `outputs`, names of
    signals; `outmems`, names of lists that are assigned; `vardict`, variables; `sourcefile` and `lineoffset`.
    """
    processes = list(processes)
    for process in processes:
        for signal in process.sigdict.values():
            signal._driven = None  # MyHDL refuses a second driver, but the first may be in a module converted before
        # Registers to reset come in the order of a Python set, which changes from run to run.
        names = {id(process.symdict[name]): name for name in process.outputs if name in process.symdict}
        getattr(process, "sigregs", []).sort(key=lambda signal, names=names: names.get(id(signal), ""))
    _genUniqueSuffix.reset()
    return _analyzeGens(processes, {id(process): process.name for process in processes})


def assigned(tree: Any) -> bool:
    """Return True if an analysed process becomes continuous assignments."""
    return tree.kind == _kind.SIMPLE_ALWAYS_COMB


def keeps(tree: Any) -> bool:
    """Return True if what an analysed process drives are registers: it waits for an edge, or runs only once."""
    return any(not isinstance(edge, SignalType) for edge in getattr(tree, "senslist", ())) or tree.kind == _kind.INITIAL


def printed(tree: Any, sensitivity: Callable[[Sequence[str]], str]) -> tuple[str, str]:
    """Return the Verilog of an analysed process, and that of the functions that it calls.

    Args:
        tree: the process, whose signals have their names.
        sensitivity: returns the Verilog for what a process waits for, from the signals and edges.
    """
    kinds = {
        _kind.ALWAYS: to_verilog._ConvertAlwaysVisitor,
        _kind.INITIAL: to_verilog._ConvertInitialVisitor,
        _kind.SIMPLE_ALWAYS_COMB: to_verilog._ConvertSimpleAlwaysCombVisitor,
        _kind.ALWAYS_DECO: to_verilog._ConvertAlwaysDecoVisitor,
        _kind.ALWAYS_SEQ: to_verilog._ConvertAlwaysSeqVisitor,
        _kind.ALWAYS_COMB: to_verilog._ConvertAlwaysCombVisitor,
    }

    class Visitor(kinds[tree.kind]):
        def writeSensitivityList(self, senslist):
            self.write(sensitivity([edge._toVerilog() for edge in senslist]))

        def writeAlwaysHeader(self):
            self.write("always ")
            self.writeSensitivityList(self.tree.senslist)
            # A block that declares nothing needs no name, which would cost Icarus a thread at each evaluation.
            self.write(f" begin: {self.tree.name}" if self.tree.vardict else " begin")
            self.indent()

    to_verilog._annotateTypes([tree])
    text, functions = StringIO(), StringIO()
    Visitor(tree, text, functions).visit(tree)
    return text.getvalue(), functions.getvalue()


@contextmanager
def states_by_name(values: Iterable[Any]) -> Iterator[None]:
    """Make a context in which MyHDL prints the names of states instead of their codes, for these items' types."""
    before: Mapping[Any, Any] = {type(value): type(value)._toVerilog for value in values}
    for kind in before:
        kind._toVerilog = lambda item, dontcare=0: item._name
    try:
        yield
    finally:
        for kind, function in before.items():
            kind._toVerilog = function
