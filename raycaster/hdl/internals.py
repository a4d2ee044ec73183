# SPDX-License-Identifier: MIT
"""Parts of MyHDL that it does not publish: its classes under our names, and a function for each private attribute.

No other file of the package touches them. They may change with any version of MyHDL, so its version is pinned.
"""

import ast
import copy
import functools
import importlib
import inspect
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, nullcontext
from io import StringIO
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

    The lambda has the value. The argument before it is driven, if the argument after it is high or there is none.
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
    driven: Any = ast.Attribute(target, "next", ast.Store())
    statement: Any = ast.Assign([driven], function.body)
    if conditions:
        statement = ast.If(conditions[0], [statement], [])
    around = [node.id for one in (target, *conditions) for node in ast.walk(one) if isinstance(node, ast.Name)]
    arguments = [ast.arg(name) for name in sorted({*value.co_freevars, *around})]
    none: Any = ast.arguments([], [], None, [], [], None, [])
    process = ast.FunctionDef(name or around[0], none, [statement], [])
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
    driven = {id(_root(node.targets[0])) for node in nodes if isinstance(node, ast.Assign)}
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
    return edges or latches or tree.kind == _kind.INITIAL


def is_combinational(tree: Any) -> bool:
    """Return True if an analysed process is @always_comb with more than assignments."""
    return tree.kind == _kind.ALWAYS_COMB


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
    if tree.kind == _kind.ALWAYS:
        for statement in tree.body[0].body[:-1]:
            if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
                kept[statement.targets[0].id] = int(_ConvertVisitor(tree, None).getVal(statement.value))
    return kept


def locals_of(tree: Any) -> dict[str, Any]:
    """Return the variables of an analysed process that it does not keep, by name."""
    return {name: value for name, value in getattr(tree, "vardict", {}).items() if name not in state_of(tree)}


def resets_of(tree: Any) -> list[tuple[str, Any]]:
    """Return what an analysed process sets when it is reset: names in Verilog, and initial values."""
    signals = [(str(signal), signal._init) for signal in tree.sigregs]
    return signals + [(name, intbv(value)) for name, _, value in tree.varregs]


class Statements(_ConvertVisitor):
    """A printer of an analysed process, or of a function that it calls. Another class prints its expressions."""

    def __init__(self, tree: Any, expressions: Any):
        super().__init__(tree, StringIO())
        self._expressions = expressions
        self._loops: list[Any] = []
        self._names = {*tree.symdict, *tree.vardict}
        for loop in (node for node in ast.walk(tree) if isinstance(node, ast.For)):
            tree.vardict |= {flag: False for _, flag in self._flags(loop)}
        if tree.kind == _kind.ALWAYS_COMB:
            self.okSigAss = False

    def printed(self, label: str, sensitivity: Callable[[Sequence[str]], str]) -> str:
        """Return a process; `sensitivity` returns the Verilog for what it waits for, from the signals and edges."""
        tree, [node] = self.tree, self.tree.body
        self.writeDoc(node)
        if tree.kind in (_kind.ALWAYS_COMB, _kind.SIMPLE_ALWAYS_COMB):
            self._refuse_latches(node)
        elif tree.kind != _kind.INITIAL:
            self._refuse_missing(node)
        if assigned(tree):
            self.visit_stmt(node.body)
            return self.buf.getvalue()
        waits = tree.kind != _kind.INITIAL
        self.write("always " + sensitivity([edge._toVerilog() for edge in tree.senslist]) if waits else "initial")
        # A block that declares nothing needs no name, which would cost Icarus a thread at each evaluation.
        self.write(f" begin: {label}" if label else " begin")
        self.indent()
        self._declare(locals_of(tree))
        if tree.kind in (_kind.ALWAYS_COMB, _kind.SIMPLE_ALWAYS_COMB):
            for name in self._sometimes_counted(node.body):
                self._lines(f"{name} = 0;")
        reset = getattr(tree, "reset", None)
        if reset is not None:
            self._lines(f"if ({reset} == {int(reset.active)}) begin")
            self.indent()
            for name, value in resets_of(tree):
                arrow = "=" if name in tree.vardict else "<="
                self._lines(f"{name} {arrow} {self._expressions.initial(value)};")
            self.dedent()
            self._lines("end", "else begin")
            self.indent()
        self.visit_stmt(node.body[-1].body[1:] if tree.kind == _kind.ALWAYS else node.body)
        if reset is not None:
            self.dedent()
            self._lines("end")
        self.dedent()
        self._lines("end")
        return self.buf.getvalue()

    def printed_function(self, name: str) -> str:
        """Return a function, or a task, which has no result."""
        tree, [node] = self.tree, self.tree.body
        for part in ast.walk(node):
            if isinstance(part, ast.Attribute) and part.attr == "next":
                self._expressions.refuse(part, "a function cannot drive signals in Verilog; let it return a value")
        if not tree.argnames and tree.kind != _kind.TASK:
            self._expressions.refuse(node, "a function in Verilog needs an argument; give it one, or write its value")
        if node.name in (*tree.argnames, *tree.vardict):
            self._expressions.refuse(node, f"{node.name} is the function and a variable of it; rename one")
        self.returnLabel = name
        _end_in_returns(node.body, self._expressions)
        word = "task" if tree.kind == _kind.TASK else "function"
        result = "" if word == "task" else declaration("", tree.returnObj).rstrip() + " "
        self.write(f"{word} {result.lstrip()}{name};")
        self.indent()
        for argument in tree.argnames:
            if tree.symdict.get(argument) is None:
                self._expressions.refuse(node, f"{argument} has no known type; assign its value to a signal first")
            way = "inout" if argument in tree.outputs else "input"
            self._lines(f"{way} {declaration('', tree.symdict[argument])}{argument};".replace("  ", " "))
        self._declare(tree.vardict)
        self.dedent()
        self._lines("begin")
        self.indent()
        self.visit_stmt(node.body)
        self.dedent()
        self._lines("end", f"end{word}", "")
        return self.buf.getvalue()

    def _refuse_missing(self, process: Any) -> None:
        """Refuse a process that waits for values but not for all that it reads, as synthesis does."""
        waits = [id(edge) for edge in self.tree.senslist if isinstance(edge, SignalType)]
        missing = [name for name in sorted(self.tree.inputs) if waits and id(self.tree.symdict[name]) not in waits]
        if missing or 0 < len(waits) < len(self.tree.senslist):
            self._expressions.refuse(process, f"it does not wait for {missing[0] if missing else 'edges only'}, as "
                                     "synthesis does; write @always_comb, or wait for all that it reads")  # fmt: skip

    def _sometimes_counted(self, body: Sequence[Any]) -> Iterator[str]:
        """Yield the variables of loops that only run in some cases, which would be latches for Yosys."""
        for node in body:
            if isinstance(node, ast.For):
                yield from self._sometimes_counted(node.body)
                continue
            loops: list[Any] = [each for each in ast.walk(node) if isinstance(each, ast.For)]
            for loop in loops:
                yield from dict.fromkeys((loop.target.id, *(flag for _, flag in self._flags(loop))))

    def _refuse_latches(self, process: Any) -> None:
        """Refuse a signal that keeps its value in some cases, or in some bits."""
        for name in state_of(self.tree):
            first = next(node for node in process.body if name in _names(node))
            if not (
                isinstance(first, ast.Assign)
                and ast.unparse(first.targets[0]) == f"{name}[:]"
                and name not in _names(first.value)
            ):
                self._expressions.refuse(first, f"{name} keeps its value from run to run, which makes a latch; assign "
                                         f"{name}[:] first, or use a signal and a clock")  # fmt: skip
        always, _ = self._always(process.body)
        for node in (node for node in ast.walk(process) if isinstance(node, ast.Assign) and _is_next(node.targets[0])):
            name = _root(node.targets[0]).id
            width = len(self.tree.symdict[name])
            words = written_words(self.tree, name)
            own = (1 << width) - 1 if None in words or not words else sum(1 << (word or 0) for word in {*words})
            missing = own & ~always.get(name, 0)
            if missing:
                part = "bit" if isinstance(self.tree.symdict[name], SignalType) else "word"
                which = f"{part} {missing.bit_length() - 1} of {name}" if missing + 1 < 1 << width else name
                self._expressions.refuse(node, f"{which} keeps its value in some cases, which makes a latch; assign "
                                         "all bits in all cases, or write @always to mean a latch")  # fmt: skip

    def _always(self, body: Sequence[Any]) -> tuple[dict[str, int], bool]:
        """Return a mask of the bits, or of a list's words, that statements assign in any case, by name.

        Also returns True if a break or a continue may skip what follows.
        """
        found: dict[str, int] = {}
        node: Any
        for node in body:
            every: list[tuple[dict[str, int], bool]] = []
            if isinstance(node, ast.Assign) and _is_next(node.targets[0]):
                target, name = node.targets[0], _root(node.targets[0]).id
                in_word = isinstance(target, ast.Subscript) and isinstance(self.tree.symdict[name], list)
                bits = None if in_word else self._expressions.part(target)
                every = [({name: 0 if bits is None else (1 << bits[1]) - (1 << bits[0])}, False)]
            elif isinstance(node, ast.For):
                every = [({}, False)]
                for value in self._expressions.numbers(node):
                    with self._expressions.assuming({ast.unparse(node.target): value}):
                        one, skips = self._always(node.body)
                    every[0][0].update({name: mask | every[0][0].get(name, 0) for name, mask in one.items()})
                    if skips and any(isinstance(part, ast.Break) for part in ast.walk(node)):
                        break
            elif isinstance(node, ast.If) and not getattr(node, "ignore", False):
                every = [self._always(branch) for branch in self._reached(node)]
            elif isinstance(node, ast.Match):
                every = [self._always(case.body) for case in node.cases]
                every += [({}, False)] * (not self._is_full(node))
            elif isinstance(node, (ast.Break, ast.Continue)):
                return found, True
            names = set.intersection(*({*masks} for masks, _ in every)) if every else set()
            for name in names:
                found[name] = functools.reduce(operator.and_, (masks[name] for masks, _ in every)) | found.get(name, 0)
            if any(skips for _, skips in every):
                return found, True
        return found, False

    def _reached(self, node: Any) -> Iterator[Any]:
        """Yield the branches of an `if` that may run."""
        for test, branch in node.tests:
            decided = self._expressions.constant(test)
            if decided is None or decided:
                yield branch
            if decided:
                return
        if node.else_ or not node.isFullCase:
            yield node.else_

    def _lines(self, *lines: str) -> None:
        for line in lines:
            self.writeline()
            self.write(line)

    def _declare(self, variables: Mapping[str, Any]) -> None:
        for name, known in variables.items():
            self._lines(f"{declaration('reg', known)}{name};")

    def _expression(self, node: Any) -> None:
        self.write(self._expressions.text(node))

    visit_BinOp = visit_BoolOp = visit_UnaryOp = visit_Compare = visit_IfExp = visit_Subscript = _expression
    visit_Name = visit_Attribute = _expression

    def visit_Call(self, node: Any) -> None:
        self.visit_Print(node) if node.func.obj is print else self._expression(node)

    def visit_Constant(self, node: Any) -> None:
        self.write(_quoted(node.value) if isinstance(node.value, str) else self._expressions.text(node))

    def visit_Expr(self, node: Any) -> None:
        value = node.value
        is_task = hasattr(value, "tree") and not value.tree.hasReturn
        is_print = isinstance(value, ast.Call) and getattr(value.func, "obj", None) is print
        if isinstance(value, (ast.Constant, ast.Yield)) or is_task or is_print:
            super().visit_Expr(node)
        else:
            self._expressions.refuse(
                node, f"{ast.unparse(value)} changes nothing; assign it to something, or remove it"
            )

    def visit_Print(self, node: Any) -> None:
        node.format = [_quoted(part)[1:-1] if isinstance(part, str) else part for part in node.format]
        super().visit_Print(node)

    def visit_Assign(self, node: Any) -> None:
        target, value = node.targets[0], node.value
        waits = _is_next(target) and self.okSigAss and not assigned(self.tree)
        arrow = "<=" if waits else "="
        index = value.slice if isinstance(value, ast.Subscript) else None
        table = table_of(getattr(value.value, "obj", None)) if isinstance(index, ast.expr) else None
        if table and self._expressions.constant(value) is None:
            if self._expressions.range(index).low < 0:
                self._expressions.refuse(node, "the index may be below 0; give it a range without a sign")
            self.write(f"case ({self._expressions.text(index)})")
            self.indent()
            for place, number in enumerate(table):
                left, right = self._expressions.assigned(target, ast.copy_location(ast.Constant(number), node))
                self._lines(f"{place if place < len(table) - 1 else 'default'}: {left} {arrow} {right};")
            self.dedent()
            self._lines("endcase")
            return
        left, right = self._expressions.assigned(target, value)
        self.write(f"{'assign ' * (assigned(self.tree) and _is_next(target))}{left} {arrow} {right};")

    def visit_AugAssign(self, node: Any) -> None:
        value = ast.copy_location(ast.BinOp(node.target, node.op, node.value), node)
        left, right = self._expressions.assigned(node.target, value)
        self.write(f"{left} = {right};")

    def visit_Assert(self, node: Any) -> None:
        self.write(f"if (!({self._expressions.text(node.test)})) begin")
        self.indent()
        self._lines('$display("*** AssertionError ***");')
        self.dedent()
        self._lines("end")

    def visit_For(self, node: Any) -> None:
        name, (start, stop, step) = node.target.id, self._expressions.loop(node)
        going, change = ("<", "+") if step > 0 else (">=", "-")
        if step < 0:
            stop = ast.copy_location(ast.BinOp(stop, ast.Add(), ast.Constant(1)), node)
        flags = dict(self._flags(node))
        if ast.Break in flags:
            self.write(f"{flags[ast.Break]} = 1;")
            self.writeline()
        ends = [self._expressions.text(end) for end in (start, stop)]
        self.write(f"for ({name}={ends[0]}; {name}{going}{ends[1]}; {name}={name}{change}{abs(step)}) begin")
        self.indent()
        self._loops.append(node)
        if ast.Continue in flags:
            self._lines(f"{flags[ast.Continue]} = 1;")
        with self._expressions.within(node):
            self._guarded(node.body, [flag for kind, flag in flags.items() if kind is ast.Break])
        self._loops.pop()
        self.dedent()
        self._lines("end")

    def visit_stmt(self, body: Any) -> None:
        for place, node in enumerate(body):
            self.writeline()
            self.visit(node)
            flags = [flag for loop in self._loops[-1:] for _, flag in self._flags(loop, node)]
            if flags and body[place + 1 :]:
                self._guarded(body[place + 1 :], flags)
                return

    def _guarded(self, body: Any, flags: Sequence[str]) -> None:
        """Print statements that are skipped after a break or a continue."""
        if flags:
            self._lines(f"if ({' && '.join(flags)}) begin")
            self.indent()
        self.visit_stmt(body)
        if flags:
            self.dedent()
            self._lines("end")

    def _flags(self, loop: Any, within: Any = None) -> list[tuple[type, str]]:
        """Return the flags of a loop's breaks and continues, for those within a statement."""
        kinds = {ast.Break: "goes_on", ast.Continue: "is_on"}
        found = {type(node) for node in _own_nodes(within or loop, within is None)}
        names = {kind: f"{loop.target.id}_{text}" for kind, text in kinds.items() if kind in found}
        return [(kind, name + "_" * (name in self._names)) for kind, name in names.items()]

    def mapToIf(self, node: Any, *_: Any) -> None:
        with ExitStack() as before:
            for place, (test, body) in enumerate(node.tests):
                head = f"if ({self._expressions.text(test)}) begin"
                self._lines(f"else {head}") if place else self.write(head)
                with self._expressions.where(test, True, node):
                    self._block(body)
                before.enter_context(self._expressions.where(test, False, node))
            if node.else_:
                self._lines("else begin")
                self._block(node.else_)

    def _block(self, body: Any) -> None:
        """Print statements up to their end."""
        self.indent()
        self.visit_stmt(body)
        self.dedent()
        self._lines("end")

    def mapToCase(self, node: Any, *_: Any) -> None:
        where = self._expressions.where
        cases = [(self._expressions.case(node.caseVar, test.case[1]), body, where(test, False, node))
                 for test, body in node.tests]  # fmt: skip
        if node.else_:
            cases.append(("default", node.else_, nullcontext()))
        elif node.isFullCase and self.tree.kind == _kind.ALWAYS_COMB:
            cases[-1] = "default", *cases[-1][1:]  # a code that no state has would keep values
        self._cases(node.caseVar, cases)

    def visit_Match(self, node: Any) -> None:
        cases = [(self._pattern(node, case), case.body, nullcontext()) for case in node.cases]
        if self._is_full(node):
            cases[-1] = "default", *cases[-1][1:]  # a code that no state has would keep values
        self._cases(node.subject, cases)

    def _is_full(self, node: Any) -> bool:
        """Return True if a match has a case for each value."""
        values = [one.value for case in node.cases for one in ast.walk(case.pattern) if isinstance(one, ast.MatchValue)]
        return ast.unparse(node.cases[-1].pattern) == "_" or self._expressions.is_full(node.subject, values)

    def _pattern(self, node: Any, case: Any) -> str:
        patterns: list[Any] = case.pattern.patterns if isinstance(case.pattern, ast.MatchOr) else [case.pattern]
        texts = []
        for pattern in patterns:
            if ast.unparse(pattern) == "_" and not case.guard:
                return "default"
            if not isinstance(pattern, ast.MatchValue) or case.guard:
                self._expressions.refuse(pattern, "Verilog's case has numbers and states only; write if and elif")
            known = getattr(pattern.value, "obj", None)
            value = known if isinstance(known, EnumItemType) else self._expressions.constant(pattern.value)
            texts.append(self._expressions.case(node.subject, value))
        return ", ".join(texts)

    def _cases(self, subject: Any, cases: Sequence[tuple[str, Any, Any]]) -> None:
        """Print cases: each one's value, its body, and the context of those that follow it."""
        self.write(f"case ({self._expressions.text(subject)})")
        self.indent()
        with ExitStack() as before:
            for text, body, passed in cases:
                self._lines(f"{text}: begin")
                self._block(body)
                before.enter_context(passed)
        self.dedent()
        self._lines("endcase")

    def visit_Return(self, node: Any) -> None:
        if hasattr(self.tree, "hasReturn"):
            bits = getattr(self.tree.returnObj, "_nrbits", 1 if isinstance(self.tree.returnObj, bool) else 32)
            if node.value is not None:
                self._expressions.check_integer(node.value, self.tree.returnObj, "the result")
                self.write(f"{self.returnLabel} = {self._expressions.text(node.value, bits)};")
            return
        self._expressions.refuse(node, "synthesis refuses return in a process; write if and else around what it skips")

    def visit_Break(self, node: Any) -> None:
        loop = self._loops[-1] if self._loops else self.visit_While(node)
        self.write(f"{dict(self._flags(loop))[type(node)]} = 0;")

    visit_Continue = visit_Break

    def visit_Raise(self, node: Any) -> None:
        self.write(f"$display({_quoted(f'*** {ast.unparse(node)} ***')});")

    def visit_While(self, node: Any) -> None:
        self._expressions.refuse(node, "synthesis has no such loop; write for with a range of numbers, or one "
                                 "`while True:` around all of an @instance, with one yield at its head")  # fmt: skip

    visit_Yield = visit_While

    def generic_visit(self, node: Any) -> None:
        self._expressions.refuse(node, f"Verilog has no {ast.unparse(node).splitlines()[0]}; write it otherwise")


def declaration(kind: str, known: Any) -> str:
    """Return the declaration of a variable up to its name, from a value of its type."""
    if isinstance(known, int):
        return f"{kind} " if isinstance(known, bool) else "integer "
    signed = "signed " * ((getattr(known, "_min", None) or 0) < 0)
    return f"{kind} {signed}[{known._nrbits - 1}:0] "


def _own_nodes(node: Any, inside: bool = False) -> Iterator[ast.AST]:
    """Yield a statement and its parts, except those of loops in it."""
    yield node
    if inside or not isinstance(node, ast.For):
        for child in ast.iter_child_nodes(node):
            yield from _own_nodes(child)


def _names(node: ast.AST) -> set[str]:
    """Return the names in a statement or an expression."""
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}


def _root(target: Any) -> ast.Name:
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
            found.add(_root(node.targets[0]).id)
        elif isinstance(node, ast.For):
            found |= always_assigned(node.body)
        elif isinstance(node, ast.If) and (branches := _branches(node)):
            found |= set.intersection(*map(always_assigned, branches))
        elif isinstance(node, ast.Match) and ast.unparse(node.cases[-1].pattern) == "_":
            found |= set.intersection(*(always_assigned(case.body) for case in node.cases))
    return found


def _is_next(target: Any) -> bool:
    """Return True for a signal's next value, or bits of it."""
    while isinstance(target, ast.Subscript):
        target = target.value
    return isinstance(target, ast.Attribute)


def _quoted(text: str) -> str:
    """Return a text in Verilog's quotation marks."""
    known = {"\\": "\\\\", '"': '\\"', "%": "%%", "\n": "\\n", "\t": "\\t"}
    octal = {chr(code): f"\\{code:03o}" for code in (*range(32), 127)}
    return f'"{"".join((octal | known).get(character, character) for character in text)}"'


def _branches(node: Any, complete: bool = True) -> list[Any]:
    """Return the bodies of an `if`; if they must be complete, none if there is a case without a body."""
    if node.ignore:  # if __debug__
        return []
    branches = [branch for _, branch in node.tests]
    if not complete or node.else_:
        return [*branches, node.else_]
    return branches if node.isFullCase else []


def _end_in_returns(body: list[Any], expressions: Any) -> None:
    """Move what follows an `if` with a return into its other branches, so that nothing is skipped."""
    statement: Any
    for place, statement in enumerate(body):
        if isinstance(statement, ast.Return):
            del body[place + 1 :]
        elif isinstance(statement, ast.If) and any(isinstance(part, ast.Return) for part in ast.walk(statement)):
            rest = body[place + 1 :]
            del body[place + 1 :]
            for branch in _branches(statement, False):
                branch.extend(rest)
                _end_in_returns(branch, expressions)
        elif any(isinstance(part, ast.Return) for part in ast.walk(statement)):
            expressions.refuse(statement, "Verilog has no return within a loop; assign the result, and return it last")


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
