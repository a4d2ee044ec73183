# SPDX-License-Identifier: MIT
"""Parts of MyHDL that it does not publish: its classes under our names, and a function for each private attribute.

No other file of the package touches them. They may change with any version of MyHDL, so its version is pinned.
"""

import ast
import copy
import functools
import importlib
import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import CellType, CodeType, FunctionType
from typing import Any

from myhdl import ConcatSignal, concat, intbv
from myhdl._always import _Always
from myhdl._always_comb import _AlwaysComb
from myhdl._block import _Block as Block
from myhdl._enum import EnumItemType, EnumType
from myhdl._extractHierarchy import _getMemInfo, _isMem
from myhdl._instance import _getCallInfo as calling_block
from myhdl._instance import _Instantiator as Process
from myhdl._ShadowSignal import _ShadowSignal as ShadowSignal
from myhdl._ShadowSignal import _SliceSignal as SliceSignal
from myhdl._ShadowSignal import _TristateDriver, _TristateSignal
from myhdl._Signal import Constant, _PosedgeWaiterList
from myhdl._Signal import _Signal as SignalType
from myhdl._simulator import _signals as all_signals
from myhdl.conversion import _analyze
from myhdl.conversion._misc import _genUniqueSuffix, _kind
from myhdl.conversion._toVerilog import _ConvertVisitor
from myhdl.conversion._VHDLNameValidation import _vhdl_keywords as vhdl_keywords

SOURCE_READERS = tuple((importlib.import_module(f"myhdl.{name}"), "_dedent") for name in ("_util", "_Waiter"))
"""Modules and names of the function that MyHDL calls to read a process's source."""


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


class _Written(Process):
    """A process of one assignment that is written as a call with a lambda.

    The lambda has the value. The argument before it is driven, if the argument after it is high or there is none. Both
    may be tuples.
    """

    def _made(self, value: FunctionType, block: Any) -> FunctionType:
        """Return the process's function; the block is what `calling_block` returns."""
        self._tree, code = _written(value.__code__.co_filename, value.__code__)
        cells = dict(zip(value.__code__.co_freevars, value.__closure__ or (), strict=True))
        closure = tuple(cells.get(name) or CellType(block.symdict[name]) for name in code.co_freevars)
        return FunctionType(code, value.__globals__, code.co_name, None, closure)

    @property
    def ast(self) -> Any:
        """A syntax tree of its own for MyHDL, which changes it."""
        return copy.deepcopy(self._tree)


class Assignment(_Written, _AlwaysComb):
    """A combinational process of one assignment."""

    def __init__(self, value: FunctionType, block: Any):
        """Create it from a call's lambda, and from the block that calls."""
        super().__init__(self._made(value, block), block)


class Register(_Written, _Always):
    """A process of one assignment at the rising edges of a clock."""

    def __init__(self, clk: SignalType, value: FunctionType, block: Any):
        """Create it from the clock, a call's lambda, and the block that calls."""
        clk._read = clk._used = True
        clocks = {name: clk for name, known in block.symdict.items() if known is clk}
        super().__init__(self._made(value, block), (clk.posedge,), block, clocks)


@functools.cache
def _written(file: str, value: CodeType) -> tuple[Any, CodeType]:  # equal code may be in two files
    """Return the syntax tree and the code of the process to which a lambda gives its value."""
    calls = _calls("".join(inspect.findsource(value)[0])).get(value.co_firstlineno, [])
    if len(calls) != 1:
        raise SyntaxError("expected one lambda in a line", (file, value.co_firstlineno, 0, ""))
    [(name, call)] = calls
    place = next(index for index, one in enumerate(call.args) if isinstance(one, ast.Lambda))
    target, function, *conditions = call.args[place - 1 :]
    targets, values = ([*getattr(one, "elts", [one])] for one in (target, function.body))
    if len({*map(ast.unparse, targets)}) != len(values):
        raise SyntaxError("expected different signals, and a value for each", (file, value.co_firstlineno, 0, ""))
    pairs: Any = zip(targets, values, strict=True)
    body: Any = [ast.Assign([ast.Attribute(one, "next", ast.Store())], new) for one, new in pairs]
    if conditions:
        body = [ast.If(conditions[0], body, [])]
    around = [node.id for one in (target, *conditions) for node in ast.walk(one) if isinstance(node, ast.Name)]
    arguments = [ast.arg(name) for name in sorted({*value.co_freevars, *around})]
    none: Any = ast.arguments([], [], None, [], [], None, [])
    process = ast.FunctionDef(name or around[0], none, body, [])
    block = ast.FunctionDef("block", ast.arguments([], arguments, None, [], [], None, []), [process], [])
    tree: Any = ast.Module([process], [])
    for node in (process, block):
        ast.fix_missing_locations(ast.copy_location(node, call))
    tree.sourcefile, tree.lineoffset = file, 0
    code = compile(ast.Module([block], []), file, "exec")
    for _ in range(2):
        code = next(one for one in code.co_consts if isinstance(one, CodeType))
    return tree, code


@functools.cache
def _calls(source: str) -> dict[int, list[tuple[str, Any]]]:
    """Return all calls with a lambda, each with the variable that it is assigned to, by the line of the lambda."""
    found: dict[int, list[tuple[str, Any]]] = {}
    nodes: list[Any] = [*ast.walk(ast.parse(source))]
    names = {node.value: getattr(node.targets[0], "id", "") for node in nodes if isinstance(node, ast.Assign)}
    for node in nodes:
        for function in node.args if isinstance(node, ast.Call) else ():
            if isinstance(function, ast.Lambda):
                found.setdefault(function.lineno, []).append((names.get(node, ""), node))
    return found


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


def has_name(signal: Any) -> bool:
    """Return True if MyHDL prints a name for a signal, not its value."""
    return signal._name is not None


def analysed(processes: Iterable[Process], prepare: Callable[[Any], None]) -> list[Any]:
    """Return the syntax trees of processes, to which MyHDL has added the object of each name.

    Attributes of a tree: `sigdict` and `symdict`, signals and all values by name; `inputs` and `outputs`, names of
    signals; `outmems`, names of lists that are assigned; `vardict`, variables; `sourcefile` and `lineoffset`.

    Args:
        processes: the processes.
        prepare: changes the tree of each process, and of each function that it calls, before MyHDL analyses it.
    """
    processes = list(processes)
    for process in processes:
        around(process.funcobj)
        for signal in process.sigdict.values():
            signal._driven = None  # MyHDL refuses a second driver, but the first may be in a module converted before
        # Registers to reset come in the order of a Python set, which changes from run to run.
        names = {id(process.symdict[name]): name for name in process.outputs if name in process.symdict}
        getattr(process, "sigregs", []).sort(key=lambda signal, names=names: names.get(id(signal), ""))
    _genUniqueSuffix.reset()
    with _prepared(prepare):
        trees = _analyze._analyzeGens(processes, {id(process): process.name for process in processes})
    for tree, process in zip(trees, processes, strict=True):
        _add_inputs(tree)
        for name in process.outputs if getattr(tree, "reset", None) is not None else ():
            signal = process.symdict[name]  # a reset sets it, even if nothing else ever does
            tree.symdict[name] = signal
            if isinstance(signal, SignalType):
                tree.sigdict[name] = signal
                tree.outputs.add(name)
            elif isinstance(signal, list):
                tree.outmems.add(name)
    return trees


def around(function: Any) -> dict[str, Any]:
    """Return what a function reads around it, by name; None for a name that was never bound, as MyHDL reads all."""
    for cell in function.__closure__ or ():
        try:
            cell.cell_contents  # noqa: B018 - an empty cell raises
        except ValueError:
            cell.cell_contents = None
    return dict(inspect.getclosurevars(function).nonlocals)


@contextmanager
def _prepared(prepare: Callable[[Any], None]) -> Iterator[None]:
    """Make a context in which MyHDL analyses prepared trees, and knows the types of more expressions."""
    visitor, first = _analyze._AnalyzeVisitor, _analyze._FirstPassVisitor
    before, value_of, count_of = dict(vars(visitor)), visitor.getVal, _analyze._getNritems

    class FirstPass(first):
        def visit_Module(self, node: Any) -> None:
            prepare(node)
            self.generic_visit(node)

    def is_bit(*nodes: Any) -> bool:
        return all(_analyze.hasType(getattr(node, "obj", None), bool) for node in nodes)

    def visit_BinOp(self: Any, node: Any) -> None:
        before["visit_BinOp"](self, node)
        if isinstance(node.op, (ast.BitAnd, ast.BitOr, ast.BitXor)) and is_bit(node.left, node.right):
            node.obj = False

    def visit_IfExp(self: Any, node: Any) -> None:
        self.generic_visit(node)
        one = getattr(node.body, "obj", None)
        node.obj = False if is_bit(node.body, node.orelse) else one if isinstance(one, EnumItemType) else -1

    def getVal(self: Any, node: Any) -> Any:
        try:
            return value_of(self, node)
        except Exception:
            if isinstance(node, ast.Call) and getattr(node.func, "obj", None) is concat:
                return None  # the index of a bit depends on a loop, or an operand has no width
            raise

    def count(known: Any) -> int:
        value = known.val if isinstance(known, SignalType) else known
        return 2 if isinstance(value, bool) else 1 << 32 if isinstance(value, int) else count_of(known)

    methods = {"visit_BinOp": visit_BinOp, "visit_IfExp": visit_IfExp, "getVal": getVal}
    _analyze._FirstPassVisitor, _analyze._getNritems = FirstPass, count
    for name, method in methods.items():
        setattr(visitor, name, method)
    try:
        yield
    finally:
        _analyze._FirstPassVisitor, _analyze._getNritems = first, count_of
        for name in methods:
            setattr(visitor, name, before[name]) if name in before else delattr(visitor, name)


def _add_inputs(tree: Any) -> None:
    """Add to what a process or a function reads what MyHDL leaves out: behind `len`, in calls, and in functions."""
    nodes: list[Any] = [node for line in tree.body[0].body for node in ast.walk(line)]
    driven = {id(root_of(node.targets[0])) for node in nodes if isinstance(node, ast.Assign)}
    tree.inputs |= {node.id for node in nodes if isinstance(node, ast.Name) and id(node) not in driven} & {
        *tree.sigdict
    }
    for call in (node for node in nodes if hasattr(node, "tree")):
        _add_inputs(call.tree)
        for name in signals_read_around(call.tree):
            tree.inputs.add(name)
            for known in (tree.sigdict, tree.symdict):
                known.setdefault(name, call.tree.symdict[name])


def assigned(tree: Any) -> bool:
    """Return True if an analysed process becomes continuous assignments."""
    return tree.kind == _kind.SIMPLE_ALWAYS_COMB


def keeps(tree: Any) -> bool:
    """Return True if what an analysed process drives are registers or latches, or if it runs only once."""
    edges = any(not isinstance(edge, SignalType) for edge in getattr(tree, "senslist", ()))
    latches = tree.kind == _kind.ALWAYS_DECO and {*tree.outputs} > always_assigned(tree.body[0].body)
    return edges or latches or runs_once(tree)


def is_combinational(tree: Any) -> bool:
    """Return True if an analysed process is @always_comb."""
    return tree.kind in (_kind.ALWAYS_COMB, _kind.SIMPLE_ALWAYS_COMB)


def runs_once(tree: Any) -> bool:
    """Return True if an analysed process is an @instance that ends."""
    return tree.kind == _kind.INITIAL


def is_endless(tree: Any) -> bool:
    """Return True if an analysed process is an @instance around one endless loop."""
    return tree.kind == _kind.ALWAYS


def is_task(tree: Any) -> bool:
    """Return True if an analysed function has no result."""
    return tree.kind == _kind.TASK


TRISTATE = (_TristateSignal, _TristateDriver)


def adopted(process: Process) -> Process:
    """Return a process that a function made, as one of the block that calls the function; MyHDL would refuse it."""
    process.modctxt = True
    return process


def drivers_of(process: Process) -> Iterator[Any]:
    """Yield the signals and lists of signals that a process drives."""
    for name in process.outputs:
        yield process.symdict.get(name)


def signals_read_around(function: Any) -> list[str]:
    """Return the names of signals that an analysed function reads and that are no arguments of it."""
    around = sorted({*function.inputs} - {*function.argnames})
    return [name for name in around if isinstance(function.symdict.get(name), SignalType)]


def written_words(tree: Any, name: str) -> list[int | None]:
    """Return the index of each word of a list that an analysed process drives, None if it is no constant."""
    found: list[int | None] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and node.attr == "next" and isinstance(node.value, ast.Subscript):
            at, index = node.value.value, node.value.slice
            if isinstance(at, ast.Name) and at.id == name:
                known = index.value if isinstance(index, ast.Constant) else None
                if isinstance(index, ast.Name) and index.id not in tree.vardict:
                    known = tree.symdict.get(index.id)
                found.append(known if isinstance(known, int) else None)
    return found


def text_of(state: Any) -> str:
    """Return a state of an enumeration in Verilog."""
    return state._toVerilog()


def is_memory(known: Any) -> str | None:
    """Return the name of a list of signals that a process indexes, None for anything else."""
    return _getMemInfo(known).name if isinstance(known, list) and _isMem(known) else None


def table_of(known: Any) -> tuple[int, ...] | None:
    """Return the numbers of a tuple that a process indexes, None for anything else."""
    return known.rom or None if isinstance(known, _analyze._Rom) else None


def state_of(tree: Any) -> dict[str, int]:
    """Return the initial value of each variable that an analysed process keeps from one run to the next."""
    changed = {node.value.id for node in ast.walk(tree) if isinstance(node, ast.Subscript)
               and isinstance(node.ctx, ast.Store) and isinstance(node.value, ast.Name)}  # fmt: skip
    kept = {name: int(value) for name, value in tree.nonlocaldict.items() if name in changed}
    if is_endless(tree):
        for statement in tree.body[0].body[:-1]:
            if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
                kept[statement.targets[0].id] = int(_ConvertVisitor(tree, None).getVal(statement.value))
    return kept


def locals_of(tree: Any) -> dict[str, Any]:
    """Return the variables of an analysed process that it does not keep, by name."""
    variables = getattr(tree, "vardict", {})
    state = state_of(tree) if variables else {}
    return {name: value for name, value in variables.items() if name not in state}


def resets_of(tree: Any) -> list[tuple[str, Any]]:
    """Return what an analysed process sets when it is reset: names in Verilog, and initial values."""
    signals = [(str(signal), signal._init) for signal in tree.sigregs]
    return signals + [(name, intbv(value)) for name, _, value in tree.varregs]


def declaration(kind: str, known: Any) -> str:
    """Return the declaration of a variable up to its name, from a value of its type."""
    if isinstance(known, int):
        return f"{kind} " if isinstance(known, bool) else "integer "
    signed = "signed " * ((getattr(known, "_min", None) or 0) < 0)
    return f"{kind} {signed}[{known._nrbits - 1}:0] "


def root_of(target: Any) -> ast.Name:
    """Return the name of what is assigned."""
    while not isinstance(target, ast.Name):
        target = target.value
    return target


def always_assigned(body: Sequence[Any]) -> set[str]:
    """Return the names that statements assign in any case; bits alone do not count."""
    found: set[str] = set()
    node: Any
    for node in body:
        if isinstance(node, ast.Assign) and not isinstance(node.targets[0], ast.Subscript):
            found.add(root_of(node.targets[0]).id)
        elif isinstance(node, ast.For):
            found |= always_assigned(node.body)
        elif isinstance(node, ast.If) and (branches := branches_of(node)):
            found |= set.intersection(*map(always_assigned, branches))
        elif isinstance(node, ast.Match) and ast.unparse(node.cases[-1].pattern) == "_":
            found |= set.intersection(*(always_assigned(case.body) for case in node.cases))
    return found


def branches_of(node: Any, complete: bool = True) -> list[Any]:
    """Return the bodies of an `if`; if they must be complete, none if there is a case without a body."""
    if node.ignore:  # if __debug__
        return []
    branches = [branch for _, branch in node.tests]
    if not complete or node.else_:
        return [*branches, node.else_]
    return branches if node.isFullCase else []


@contextmanager
def states_by_name(values: Iterable[Any], names: Mapping[tuple[str, str], str]) -> Iterator[None]:
    """Make a context in which MyHDL prints names of states instead of their codes, for these items' types.

    Args:
        values: an item of each type.
        names: the name to print for each state's name and code.
    """
    before: Mapping[Any, Any] = {type(value): type(value)._toVerilog for value in values}
    for kind in before:
        kind._toVerilog = lambda item, dontcare=0: names[item._name, item._val]
    try:
        yield
    finally:
        for kind, function in before.items():
            kind._toVerilog = function
