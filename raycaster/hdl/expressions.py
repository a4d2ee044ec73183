# SPDX-License-Identifier: MIT
"""Expressions of a process in Verilog: the only place that knows what Verilog makes of one.

MyHDL computes with integers of any size. Verilog computes a whole expression with the bits of its widest operand or of
its target, and without signs if any operand has none. So each expression gets a context, a width and a sign: if it has
a signed operand, all others are cast. The range of each operand is known. A result that is compared, shifted to the
right, divided or used as an index is refused if the context does not hold it. Only the lowest bits of other results
count, and they are right for any widths, as in `total.next = a + b + c`.
"""

from __future__ import annotations

import ast
import operator
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from itertools import chain
from typing import Any, NamedTuple, NoReturn

from myhdl import concat, intbv

from raycaster.hdl import internals
from raycaster.hdl.errors import UserError
from raycaster.hdl.internals import EnumItemType, ShadowSignal, SignalType, SliceSignal, is_memory, table_of
from raycaster.hdl.source import joined

INTEGER_BITS = 32
"""Bits of a number, or of an integer variable, in Verilog."""

LARGEST_VARIABLE = 1 << 20
"""Assumed most runs of a process with an integer variable that it keeps and that grows in each run."""

MOST_SWEEPS, MOST_BITS = 100, 64
"""Sweeps over the assignments to integer variables, and bits of such a variable, after which more is assumed."""

SYMBOLS = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Mod: "%", ast.FloorDiv: "/", ast.LShift: "<<", ast.RShift: ">>>",
    ast.BitOr: "|", ast.BitAnd: "&", ast.BitXor: "^", ast.Invert: "~", ast.USub: "-", ast.UAdd: "+", ast.Eq: "==",
    ast.NotEq: "!=", ast.Gt: ">", ast.GtE: ">=", ast.Lt: "<", ast.LtE: "<=", ast.And: "&&", ast.Or: "||",
}  # fmt: skip

COMPUTED: Mapping[type, Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.BitOr: operator.or_,
    ast.BitAnd: operator.and_, ast.BitXor: operator.xor, ast.Mod: operator.mod, ast.FloorDiv: operator.floordiv,
    ast.LShift: lambda value, places: value << min(max(places, 0), 1 << 10),
    ast.RShift: lambda value, places: value >> max(places, 0), ast.Pow: lambda base, power: base ** min(power, 1 << 10),
    ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Invert: operator.invert, ast.Not: operator.not_,
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Gt: operator.gt, ast.GtE: operator.ge, ast.Lt: operator.lt,
    ast.LtE: operator.le,
}  # fmt: skip
"""Operators of numbers."""

OPPOSITES = {
    ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.Lt: ast.GtE, ast.GtE: ast.Lt,
}  # fmt: skip
MIRRORED = {ast.Gt: ast.Lt, ast.Lt: ast.Gt, ast.GtE: ast.LtE, ast.LtE: ast.GtE}

CARRYING = (ast.Add, ast.Sub, ast.Mult, ast.LShift, ast.BitAnd, ast.BitOr, ast.BitXor)
"""Operators whose lowest bits depend on the lowest bits of their operands only."""


class Range(NamedTuple):
    """Values of an expression in MyHDL."""

    low: int
    high: int

    def bits(self, signed: bool) -> int:
        """Return the bits that hold them."""
        return max((~self.low).bit_length() if self.low < 0 else 0, self.high.bit_length()) + signed


class Argument(NamedTuple):
    """An argument of a call: its values, and the bits that MyHDL's ~ inverts, as `Expressions.inverted` finds them."""

    values: Range
    inverted: int | None


class Context(NamedTuple):
    """The bits with which Verilog computes an expression, and True if with signs."""

    bits: int
    signed: bool


class Expressions:
    """The expressions of an analysed process, or of a function that it calls, as Verilog."""

    def __init__(
        self, tree: Any, function_name: Callable[[Any, list[Argument]], str], arguments: Mapping[str, Argument]
    ):
        """Find the ranges of variables.

        Args:
            tree: the process or function.
            function_name: returns the name in Verilog of a function, from its tree and its arguments.
            arguments: a function's arguments.
        """
        self._tree, self._function_name, self._state = tree, function_name, internals.state_of(tree)
        self._ranges = {name: argument.values for name, argument in arguments.items()}
        self._inverted = {name: argument.inverted for name, argument in arguments.items()}
        self._assumed: dict[str, int] = {}
        self._around: list[Any] = []
        self._find_ranges()

    def refuse(self, node: Any, reason: str) -> NoReturn:
        """Refuse a line."""
        raise UserError(f"{self._tree.sourcefile}:{self._tree.lineoffset + node.lineno}: {reason}")

    def text(self, node: ast.expr, bits: int | None = None) -> str:
        """Return an expression. Only its lowest `bits` count; in a condition, for instance, all do (None)."""
        constant = self.constant(node)
        if type(constant) is int and bits and abs(constant) >= 1 << 30:
            return f"{'-' * (constant < 0)}{bits}'h{abs(constant):x}"
        text = self._root(node, bits)
        return text[1:-1] if _is_one_group(text) else text

    def assigned(self, target: ast.expr, value: ast.expr) -> tuple[str, str]:
        """Return the two sides of an assignment."""
        outer = target.value if isinstance(target, ast.Attribute) else target
        if isinstance(target, ast.Name) and (same := self._itself(value)):
            self.refuse(value, f"{target.id} would be {same} itself in Python; write {target.id}[:] = {same}")
        within = isinstance(outer, ast.Subscript) and isinstance(outer.slice, ast.Slice) and outer.slice.lower
        if within and self.range(value).low < 0:
            self.refuse(value, "MyHDL changes higher bits too if the value is below 0; write % and a power of two")
        bits, _ = self._type(outer)
        inner: Any = target
        while isinstance(inner, (ast.Subscript, ast.Attribute)):
            at = inner.value
            copy = isinstance(at, ast.Subscript) and not self.is_word(at)
            if copy and (isinstance(inner, ast.Attribute) or isinstance(inner.slice, ast.Slice)):
                name = ast.unparse(at).partition("[")[0].removesuffix(".next")
                if isinstance(at, ast.Subscript) and isinstance(self._object(at.value), (list, tuple, dict)):
                    self.refuse(target, f"{name} is not a list of signals of one width; a process drives signals, and "
                                "words of such lists")  # fmt: skip
                self.refuse(target, f"MyHDL assigns to a copy of these bits; write {name}.next[...]")
            inner = at
        target = outer
        if isinstance(target, ast.Name) and target.id in self._tree.vardict:
            self.check_integer(value, self._value(target), target.id)
        modulo = self._power(value.right) if isinstance(value, ast.BinOp) and isinstance(value.op, ast.Mod) else None
        folded = self.constant(value) is not None
        if modulo == bits and not folded and isinstance(value, ast.BinOp) and isinstance(value.right, ast.BinOp):
            value = value.left  # an assignment wraps around by itself
        return self._place(target), self.text(value, bits)

    def _itself(self, node: ast.expr) -> str:
        """Return the text of a variable, or of a signal's value, if an expression may be this object and no copy."""
        match node:
            case ast.Name() if isinstance(self._object(node), intbv):
                return node.id
            case ast.Attribute(attr="val") if isinstance(self._object(node), intbv):
                return ast.unparse(node)
            case ast.IfExp():
                return self._itself(node.body) or self._itself(node.orelse)
            case ast.Call() if _tree(node) is not None:
                inner, results = self._results(node)
                return ast.unparse(node) if any(map(inner._itself, results)) else ""
        return ""

    @contextmanager
    def assuming(self, values: Mapping[str, int]) -> Iterator[None]:
        """Make a context in which loops' variables are constants."""
        before = self._assumed
        self._assumed = {**before, **values}
        try:
            yield
        finally:
            self._assumed = before

    def check_integer(self, value: ast.expr, known: Any, name: str) -> None:
        """Refuse a value that a Verilog integer, or a bit, does not hold, for a variable or result of this type."""
        around = self.range(value)
        bits = around.bits(True)
        if _is_integer(known) and bits > INTEGER_BITS:
            self.refuse(value, f"{name} is an integer of {INTEGER_BITS} bits in Verilog, and has {bits} here; use an "
                        "intbv(0, min=..., max=...)")  # fmt: skip
        if isinstance(known, bool) and _around(around, Range(0, 1)) != Range(0, 1):
            self.refuse(value, f"{name} is one bit in Verilog, and may be {around.low} to {around.high} here; write "
                        "not for a bit")  # fmt: skip
        # MyHDL gives the result of ~ the type of its operand.
        inverse = isinstance(value, ast.UnaryOp) and isinstance(value.op, ast.Invert) and isinstance(known, intbv)
        if inverse and _around(around, held := _all_of(*_shape(known))) != held:
            self.refuse(value, f"{name} holds {held.low} to {held.high} in Verilog, and may be {around.low} to "
                        f"{around.high} here; use an intbv(0, min=..., max=...)")  # fmt: skip

    def initial(self, value: Any) -> str:
        """Return an initial value."""
        if isinstance(value, EnumItemType):
            return internals.text_of(value)
        number, bits = int(value), max(len(value), 1) if isinstance(value, intbv) else 1
        return str(number) if abs(number) < 1 << 30 else f"{'-' * (number < 0)}{bits}'h{abs(number):x}"

    def case(self, subject: ast.expr, value: Any) -> str:
        """Return a value that a case compares with its subject."""
        if isinstance(value, EnumItemType):
            return internals.text_of(value)
        if not isinstance(value, int):
            self.refuse(subject, "Verilog's case has numbers and states only; write if and elif")
        low, high = self.range(subject)
        if not low <= value <= high:
            self.refuse(subject, f"{ast.unparse(subject)} is never {value}; leave out this case")
        bits, signed = self._type(subject)
        return str(int(value)) if signed or value < 0 else f"{bits if value >= 1 << 30 else ''}'h{value:x}"

    def part(self, target: Any) -> tuple[int, int] | None:
        """Return the first of the bits that an assignment sets, and the one after them; None if they vary."""
        at = target.value if isinstance(target, ast.Attribute) else target
        bits, _ = self._type(at.value if isinstance(at, ast.Subscript) else at)
        if not isinstance(at, ast.Subscript):
            return 0, bits
        if isinstance(at.slice, ast.Slice):
            low = self.constant(at.slice.upper) if at.slice.upper else 0
            return None if low is None else (low, low + self._width(at, bits))
        index = self.constant(at.slice)
        return None if index is None else (index, index + 1)

    def is_word(self, node: ast.expr) -> bool:
        """Return True for a word of a memory."""
        return isinstance(node, ast.Subscript) and bool(is_memory(self._object(node.value)))

    def constant(self, node: ast.expr | None) -> Any:
        """Return a number, or True or False; None for an expression that is not constant."""
        match node:
            case ast.Constant(value=int(value)):
                return value
            case ast.Name(id=name) if name in self._assumed:
                return self._assumed[name]
            case ast.Name() | ast.Attribute():
                known = self._object(node)
                variable = isinstance(node, ast.Name) and (node.id in self._tree.vardict or node.id in self._ranges)
                return known if isinstance(known, int) and not variable else None
            case ast.BoolOp() | ast.Compare() | ast.UnaryOp(op=ast.Not()) if not self._assumed:
                return None  # conditions are printed as they are written
            case ast.BoolOp(op=op, values=values):
                return joined(op, map(self.constant, values))
            case ast.BinOp(left=one, op=op, right=other) | ast.Compare(left=one, ops=[op], comparators=[other]):
                return self._computed(op, one, other)
            case ast.UnaryOp(op=op, operand=operand):
                return self._computed(op, operand)
            case ast.Call(args=[argument]) if _called(node) is len:
                return len(self._object(argument))
            case ast.Call(args=[ast.Constant(value=str(value))]) if _called(node) is ord:
                return ord(value[0])
            case ast.Call(args=[argument]) if _called(node) is int:
                return self.constant(argument)
            case ast.Subscript() if (table := table_of(self._object(node.value))) is not None:
                index = self.constant(node.slice) if isinstance(node.slice, ast.expr) else None
                return None if index is None or not -len(table) <= index < len(table) else table[index]
        return None

    def _computed(self, op: Any, *operands: ast.expr) -> Any:
        values = [*map(self.constant, operands)]
        if type(op) not in COMPUTED or None in values or (isinstance(op, (ast.Mod, ast.FloorDiv)) and not values[1]):
            return None
        return COMPUTED[type(op)](*map(int, values))

    def range(self, node: ast.expr) -> Range:
        """Return the values that an expression may have."""
        if (constant := self.constant(node)) is not None:
            return Range(int(constant), int(constant))
        match node:
            case ast.BinOp():
                return self._range_of_operator(node)
            case ast.UnaryOp(op=ast.Invert(), operand=operand) if bits := self._own_bits(operand):
                return Range(0, (1 << bits) - 1)
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() | ast.Invert() as op):
                return _around([COMPUTED[type(op)](end) for end in self.range(node.operand)])
            case ast.Call() if _tree(node):
                return self._returned(node)
            case ast.Name(id=name) if name in self._ranges:
                return self._ranges[name]
            case ast.Subscript(slice=ast.Slice(lower=None, upper=bits)) if bits is not None:
                places = max(self.range(bits).low, 0)
                low, high = self.range(node.value)
                return Range(low >> places if low < 0 else 0, high >> places)
            case ast.Subscript() if (table := table_of(self._object(node.value))) is not None:
                return _around(table)
        if parts := self._parts(node):
            return _around(*map(self.range, parts))
        known = self._value(node)
        if (
            isinstance(known, intbv)
            and len(known)
            and (isinstance(node, (ast.Name, ast.Attribute)) or self.is_word(node))
        ):
            return Range(known.min or 0, (known.max or 1 << len(known)) - 1)
        return _all_of(*self._type(node))

    def _range_of_operator(self, node: ast.BinOp) -> Range:
        one, other = self.range(node.left), self.range(node.right)
        if isinstance(node.op, ast.Mod):
            return Range(min(other.low + 1, 0), max(other.high - 1, 0))
        if isinstance(node.op, ast.BitAnd) and max(one.low, other.low) >= 0:
            return Range(0, min(part.high for part in (one, other) if part.low >= 0))
        if isinstance(node.op, (ast.BitAnd, ast.BitOr, ast.BitXor)):
            around = _around(one, other)
            bits = around.bits(False)
            return Range(-(1 << bits) if around.low < 0 else 0, (1 << bits) - 1)
        if isinstance(node.op, ast.FloorDiv) and other.low <= 0:
            return _around(one, [-one.high, -one.low])
        compute = COMPUTED.get(type(node.op))
        return _around([compute(a, b) for a in one for b in other]) if compute else _around(one, other)

    def _find_ranges(self) -> None:
        """Find the ranges of loops' variables, and those of integer variables from what is assigned to them.

        A sweep does all assignments, so that ranges grow at least as much in a sweep as in one assignment of a run.
        """
        values: dict[str, list[ast.expr]] = {}
        runs = self._find_assignments(self._tree, 1, (), values)
        state = values.keys() & self._state.keys()
        for name in values:
            self._ranges.setdefault(name, Range(0, 0))
        growth: dict[str, Range] = {}
        for sweep in range(1, MOST_SWEEPS):
            before, grew = {name: self._ranges[name] for name in values}, growth
            for name, known in values.items():
                self._ranges[name] = _around(before[name], *map(self.range, known))
            now = {name: self._ranges[name] for name in values}
            if (
                now == before
                or (sweep == runs and not state)
                or any(one.bits(True) > MOST_BITS for one in now.values())
            ):
                return
            growth = {name: Range(now[name].low - before[name].low, now[name].high - before[name].high) for name in now}
        for name, (low, high) in growth.items():
            times = (LARGEST_VARIABLE if state else runs) if growth == grew else 1 << MOST_BITS
            before = self._ranges[name]
            self._ranges[name] = Range(before.low + low * times, before.high + high * times)

    def _find_assignments(self, node: Any, times: int, loops: Sequence[str], values: dict[str, list[ast.expr]]) -> int:
        """Collect the values of integer variables in a statement; return how many assignments a run does.

        Args:
            node: the statement.
            times: how often a run gets to it.
            loops: variables of the loops around it.
            values: values by variable, to add to.
        """
        runs = 0
        if isinstance(node, ast.For):
            with self.assuming(dict.fromkeys(loops, 0)):
                if None in map(self.constant, self.loop(node)[:2]):
                    self.refuse(node, "synthesis needs constant bounds of a loop; write a number, and if in the loop")
            numbers, name = self.numbers(node), ast.unparse(node.target)
            if name in loops:
                self.refuse(node, f"{name} is the variable of the loop around it; take another name")
            found = _around(numbers or [0])
            self._ranges[name] = _around(found, self._ranges.get(name, found))
            times, loops = times * len(numbers), (*loops, name)
        elif isinstance(node, (ast.Assign, ast.AugAssign)):
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            value = node.value
            if isinstance(node, ast.AugAssign):
                value = ast.copy_location(ast.BinOp(node.target, node.op, node.value), node)
            if isinstance(target, ast.Name) and _is_integer(self._tree.vardict.get(target.id)):
                if target.id in loops:
                    self.refuse(node, f"{target.id} is the variable of a loop; assign to another one")
                values.setdefault(target.id, []).append(value)
                runs = times
        if isinstance(node, (ast.If, ast.IfExp, ast.Assert)):
            self._check_condition(node.test)
        elif isinstance(node, ast.BoolOp) or (isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)):
            for value in node.values if isinstance(node, ast.BoolOp) else [node.operand]:
                self._check_condition(value)
        parts = ast.iter_child_nodes(node)
        return runs + sum(self._find_assignments(part, times, loops, values) for part in parts)

    def _check_condition(self, node: ast.expr) -> None:
        if isinstance(self._value(node), EnumItemType):
            self.refuse(node, f"{ast.unparse(node)} is a state, which Python always takes as true; compare it with ==")

    @contextmanager
    def within(self, node: Any) -> Iterator[None]:
        """Make a context in which a loop's variable has its values there; elsewhere, it has those of all loops."""
        numbers = self.numbers(node)
        with self._narrowed({node.target.id: _around(numbers)} if numbers else {}, node):
            yield

    @contextmanager
    def where(self, test: ast.expr, truth: bool, statement: ast.stmt | None = None) -> Iterator[None]:
        """Make a context in which a condition is true, or false; it limits names that a statement does not change."""
        changed = {*_changed(statement)} if statement else ()
        limits = {name: limits for name, limits in self._limits(test, truth) if name not in changed}
        with self._narrowed(limits, (test, truth)):
            yield

    @contextmanager
    def _narrowed(self, ranges: Mapping[str, Range], around: Any) -> Iterator[None]:
        before = self._ranges, self._around
        self._ranges, self._around = {**self._ranges, **ranges}, [*self._around, around]
        try:
            yield
        finally:
            self._ranges, self._around = before

    def _limits(self, test: ast.expr, truth: bool) -> Iterator[tuple[str, Range]]:
        """Yield names and their ranges where a condition is true, or false."""
        match test:
            case ast.UnaryOp(op=ast.Not()):
                yield from self._limits(test.operand, not truth)
            case ast.BoolOp() if isinstance(test.op, ast.And) == truth:
                with ExitStack() as before:
                    for value in test.values:
                        found = dict(self._limits(value, truth))
                        before.enter_context(self._narrowed(found, (value, truth)))
                        yield from found.items()
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                kind = type(op) if truth else OPPOSITES.get(type(op))
                for one, relation, other in ((left, kind, right), (right, MIRRORED.get(kind, kind), left)):
                    name = one.id if isinstance(one, ast.Name) else ""
                    if not name or not isinstance(self._value(one), (int, intbv)) or self.constant(one) is not None:
                        continue
                    (low, high), (first, last) = self.range(one), self.range(other)
                    if relation in (ast.Gt, ast.GtE, ast.Eq):
                        low = max(low, first + (relation is ast.Gt))
                    if relation in (ast.Lt, ast.LtE, ast.Eq):
                        high = min(high, last - (relation is ast.Lt))
                    if relation is ast.NotEq and first == last:
                        low, high = low + (low == first), high - (high == first)
                    if low <= high:
                        yield name, Range(low, high)

    def is_full(self, subject: ast.expr, patterns: Sequence[ast.expr]) -> bool:
        """Return True if these values are all that an expression may have."""
        if isinstance(known := self._value(subject), EnumItemType):
            return len({internals.text_of(_known(one)) for one in patterns}) == len(internals.states_of(known))
        low, high = self.range(subject)
        return len({self.constant(one) for one in patterns} - {None}) > high - low

    def loop(self, node: Any) -> tuple[ast.expr, ast.expr, int]:
        """Return the bounds of a loop: the first value, the end, which is not reached, and the step."""
        given, step = node.iter.args, 1
        if len(given) == 3:
            step = self.constant(given[2])
            if not step:
                self.refuse(node, "synthesis needs a constant step of a loop; write a number")
        start, stop = given[:2] if len(given) > 1 else (ast.copy_location(ast.Constant(0), node), given[0])
        if _called(node.iter) is range:
            return start, stop, step
        first, end = (start, stop) if len(given) > 1 else (stop, start)
        one = ast.Constant(1)
        first, end = (ast.copy_location(ast.BinOp(bound, ast.Sub(), one), node) for bound in (first, end))
        return first, end, -step

    def _values(self, node: ast.expr, around: Sequence[Any]) -> Iterator[Any]:
        """Yield the value of an expression in each run of loops and under conditions; None where it is not constant."""
        if not around:
            yield self.constant(node)
        elif isinstance(around[0], ast.For):
            for number in self.numbers(around[0]):
                with self.assuming({ast.unparse(around[0].target): number}):
                    yield from self._values(node, around[1:])
        elif (decided := self.constant(around[0][0])) is None or bool(decided) == around[0][1]:
            yield from self._values(node, around[1:])

    def numbers(self, node: Any) -> range:
        """Return the values of a loop's variable, or if its bounds vary, a range that contains them."""
        start, stop, step = self.loop(node)
        one, other = self.range(start), self.range(stop)
        first, end = (one.low, other.high) if step > 0 else (one.high, other.low)
        return range(first, end, step if one.low == one.high else step // abs(step))

    def _returned(self, node: ast.Call) -> Range:
        """Return the range of a function's result."""
        known = _tree(node).returnObj
        inner, results = self._results(node)
        if not results or not isinstance(known, int):
            return _all_of(*_shape(known))
        return _around(*map(inner.range, results))

    def _results(self, node: ast.Call) -> tuple[Expressions, list[ast.expr]]:
        """Return the expressions of a function, with the ranges of this call's arguments, and those that it returns."""
        tree = _tree(node)
        inner = Expressions(tree, self._function_name, dict(zip(tree.argnames, self.arguments(node), strict=True)))
        return inner, [one.value for one in ast.walk(tree) if isinstance(one, ast.Return) and one.value is not None]

    def arguments(self, node: ast.Call) -> list[Argument]:
        """Return a call's arguments."""
        return [Argument(self.range(argument), self.inverted(argument)) for argument in node.args]

    def _object(self, node: Any) -> Any:
        """Return what MyHDL knows of an expression: its signal, its memory, or a value of its type."""
        if isinstance(node, ast.Name) and node.id in self._tree.vardict:
            return self._tree.vardict[node.id]
        return _known(node)

    def _value(self, node: Any) -> Any:
        """Return a value of an expression's type."""
        known = self._object(node)
        return known.val if isinstance(known, SignalType) else known

    def _type(self, node: ast.expr) -> tuple[int, bool]:
        """Return the bits of an operand, and True if Verilog takes it as two's complement."""
        match node:
            case ast.Subscript(slice=ast.Slice(lower=lower, upper=upper)):
                bits, signed = self._type(node.value)
                whole = lower is None and (upper is None or signed)
                return (bits, signed) if whole else (self._width(node, bits), False)
            case ast.Subscript() if (table := table_of(self._object(node.value))) is not None:
                around = _around(table)
                return max(around.bits(around.low < 0), 1), around.low < 0
            case ast.Call() if _called(node) == intbv.signed and isinstance(node.func, ast.Attribute):
                return self._type(node.func.value)[0], True
            case ast.Call() if _called(node) is concat:
                return sum(self._operand_of_concat(argument)[0] for argument in node.args), False
        return _shape(self._object(node))

    def _operand_of_concat(self, node: ast.expr) -> tuple[int, str]:
        """Return the bits and the text of an operand of concat."""
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            return len(node.value), f"{len(node.value)}'b{node.value}"
        constant = self.constant(node)
        if isinstance(constant, bool):
            return 1, f"1'b{int(constant)}"
        if constant is not None or (isinstance(node, (ast.BinOp, ast.BoolOp, ast.IfExp)) and not self._is_bool(node)):
            self.refuse(node, "concat needs operands of a known width; assign it to a signal")
        return self._type(node)[0], self._root(node, None)

    def _is_bool(self, node: ast.expr) -> bool:
        """Return True for an expression that is True or False in Python."""
        return isinstance(self._value(node), bool)

    def _own_bits(self, node: ast.expr) -> int:
        """Return how many bits MyHDL's ~ inverts, 0 for a negative number; refuse it if Verilog inverts others."""
        bits = self.inverted(node)
        if bits is None or bits not in (0, self._type(node)[0]):
            self.refuse(node, f"~ inverts the bits that {ast.unparse(node)} has in Python, which is not known here; "
                        "assign it to a signal first")  # fmt: skip
        return bits

    def inverted(self, node: ast.expr) -> int | None:
        """Return the bits that a value has in Python, 0 if it is a number without a width; None if that varies."""
        match node:
            case ast.IfExp():
                return _only([self.inverted(node.body), self.inverted(node.orelse)])
            case ast.Name(id=name) if name in self._inverted:
                return self._inverted[name]
            case ast.Name(id=name) if values := self._bound(name):
                self._inverted[name] = None  # while it depends on itself
                self._inverted[name] = _only([*map(self.inverted, values)])
                return self._inverted[name]
            case ast.Call() if _tree(node):
                inner, results = self._results(node)
                return _only([*map(inner.inverted, results)])
            case ast.Name() | ast.Attribute() | ast.Subscript() | ast.Call() if isinstance(self._value(node), intbv):
                bits, signed = self._type(node)
                return 0 if signed else bits
        return 0

    def _bound(self, name: str) -> list[ast.expr]:
        """Return the values that are assigned to a variable."""
        return [
            part.value for part in ast.walk(self._tree)
            if isinstance(part, ast.Assign) and isinstance(part.targets[0], ast.Name) and part.targets[0].id == name
        ]  # fmt: skip

    def _parts(self, node: ast.expr) -> list[ast.expr]:
        """Return the operands that share the context of an expression; none if it is an operand itself."""
        match node:
            case ast.BinOp(op=ast.LShift() | ast.RShift()):
                return [node.left]
            case ast.BinOp():
                return [node.left, node.right]
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() | ast.Invert()):
                return [node.operand]
            case ast.IfExp():
                return [node.body, node.orelse]
            case ast.Call(args=[value, *_]) if _called(node) in (int, intbv) or _is_modbv(_called(node)):
                return [value]
        return []

    def _leaves(self, node: ast.expr) -> list[ast.expr]:
        """Return all operands that share a context."""
        parts = self._parts(node) if self.constant(node) is None else []
        return [leaf for part in parts for leaf in self._leaves(part)] if parts else [node]

    def _context(self, nodes: list[ast.expr], bits: int | None) -> Context:
        """Return the context of an expression, or of the two sides of a comparison."""
        leaves = [leaf for node in nodes for leaf in self._leaves(node)]
        constants = [(leaf, self.constant(leaf)) for leaf in leaves]
        signed = any(self._type(leaf)[1] for leaf, constant in constants if constant is None)
        signed = signed or any(self._is_negative(node, bits) for node in nodes)
        widths = [
            self._type(leaf)[0] + (signed and not self._type(leaf)[1]) if constant is None
            else max(INTEGER_BITS, Range(constant, constant).bits(signed)) if not isinstance(constant, bool)
            else 1 + signed
            for leaf, constant in constants
        ]  # fmt: skip
        for part in (part for node in nodes for part in ast.walk(node)):
            if isinstance(part, ast.BinOp) and (times := self._times(part)):
                widths.append(Range(0, self.range(part.left).high + times * self.range(part.right).low).bits(True))
        return Context(max([bits or 0, *widths]), signed)

    def _is_negative(self, node: ast.expr, needed: int | None) -> bool:
        """Return True if a part of an expression that is computed in full may be below 0."""
        if needed is None and self.range(node).low < 0:
            return True
        if self.constant(node) is not None:
            return False
        if isinstance(node, ast.BinOp) and not isinstance(node.op, CARRYING):
            needed = self._power(node.right) if isinstance(node.op, ast.Mod) else None
        return any(self._is_negative(part, needed) for part in self._parts(node))

    def _power(self, node: ast.expr) -> int | None:
        """Return the exponent of a constant power of two."""
        value = self.constant(node)
        return value.bit_length() - 1 if value and value > 0 and value & value - 1 == 0 else None

    def _root(self, node: ast.expr, bits: int | None) -> str:
        """Return an expression with a context of its own; `bits` is the number of its lowest bits that count."""
        return self._emit(node, self._context([node], bits), bits)

    def _emit(self, node: ast.expr, context: Context, needed: int | None) -> str:
        """Return an expression in a context."""
        constant = self.constant(node)
        if constant is not None:
            return self._number(node, constant, context)
        match node:
            case ast.BinOp(op=ast.LShift() | ast.RShift() as op):
                if self.range(node.right).low < 0:
                    self.refuse(node, "the number of places may be below 0; give it a range without a sign")
                left = self._emit(node.left, context, needed if isinstance(op, ast.LShift) else None)
                text = f"({left} {SYMBOLS[type(op)]} {self._root(node.right, None)})"
            case ast.BinOp(op=ast.Mod() | ast.FloorDiv()):
                text = self._divided(node, context, needed)
            case ast.BinOp() if type(node.op) not in SYMBOLS:
                self.refuse(node, f"{ast.unparse(node)}: Verilog has no such operator here; write it out")
            case ast.BinOp():
                left, right = (self._emit(side, context, needed) for side in (node.left, node.right))
                text = f"({left} {SYMBOLS[type(node.op)]} {right})"
            case ast.UnaryOp(op=ast.Invert()):
                own = self._own_bits(node.operand)
                if own and own < (context.bits if needed is None else needed):
                    text = f"{{~{_primary(self._root(node.operand, own))}}}"
                    return f"$signed({{1'b0, {text}}})" if context.signed else text
                text = f"(~{_primary(self._emit(node.operand, context, needed))})"
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() as op):
                text = f"({SYMBOLS[type(op)]}{_primary(self._emit(node.operand, context, needed))})"
            case ast.IfExp():
                parts = []
                for truth, part in ((True, node.body), (False, node.orelse)):
                    with self.where(node.test, truth):
                        parts.append(self._emit(part, context, needed))
                text = f"({self._root(node.test, None)} ? {' : '.join(parts)})"
            case ast.Call(args=[value, *_]) if _called(node) in (int, intbv) or _is_modbv(_called(node)):
                return self._emit(value, context, needed)
            case _:
                text = self._operand(node)
                return f"$signed({{1'b0, {text}}})" if context.signed and not self._type(node)[1] else text
        self._fits(node, context, needed)
        return text

    def _fits(self, node: ast.expr, context: Context, needed: int | None) -> None:
        """Refuse a result that loses bits that the context needs."""
        own = self.range(node)
        bits = own.bits(context.signed)
        if needed is None and bits > context.bits:
            kind = f"signed({bits})" if own.low < 0 else f"a signal of {own.bits(False)} bits"
            self.refuse(node, f"the result has {bits if own.low < 0 else own.bits(False)} bits, and loses some; "
                        f"assign it to {kind}")  # fmt: skip

    def _divided(self, node: ast.BinOp, context: Context, needed: int | None) -> str:
        """Return a quotient or a remainder."""
        power = self._power(node.right) if isinstance(node.op, ast.Mod) else None
        dividend, divisor = self.range(node.left), self.range(node.right)
        if power is not None and (dividend.low < 0 or dividend.bits(context.signed) > context.bits):
            left = self._emit(node.left, context, power)
            return f"({left} & {self._number(node, (1 << power) - 1, context)})"
        if times := self._times(node):
            left, right = (self._emit(side, context, None) for side in (node.left, node.right))
            distance = (
                f"{context.bits}'sh{times * divisor.low:x}" if context.bits > INTEGER_BITS else times * divisor.low
            )
            text = f"(({left} + {distance}) {SYMBOLS[type(node.op)]} {right})"
            return text if isinstance(node.op, ast.Mod) else f"({text} - {self._number(node, times, context)})"
        if power is None and min(dividend.low, divisor.low) < 0:
            self.refuse(
                node, "a side may be below 0, where Verilog rounds up and Python down; shift to the right, or take bits"
            )
        left = self._emit(node.left, context, power)
        right = f"(1 << {power})" if 16 < (power or 0) < 31 else self._emit(node.right, context, None)
        return f"({left} {SYMBOLS[type(node.op)]} {right})"

    def _times(self, node: ast.AST) -> int:
        """Return by how many divisors a dividend is moved to be 0 or more, as Verilog rounds up below 0; mostly 0."""
        if not isinstance(node, ast.BinOp) or not isinstance(node.op, (ast.Mod, ast.FloorDiv)):
            return 0
        dividend, divisor = self.range(node.left), self.range(node.right)
        power = isinstance(node.op, ast.Mod) and self._power(node.right) is not None
        return -(min(dividend.low, 0) // divisor.low) if not power and divisor.low == divisor.high > 0 else 0

    def _number(self, node: ast.expr, value: Any, context: Context) -> str:
        """Return a constant; a name of True or False is a bit."""
        if isinstance(value, bool):
            return f"$signed({{1'b0, 1'b{int(value)}}})" if context.signed else f"1'b{int(value)}"
        text = str(abs(value))
        if abs(value) >= 1 << 30:
            bits = max(INTEGER_BITS, Range(value, value).bits(context.signed))
            text = f"{bits}'{'s' * context.signed}h{abs(value):x}"
        return f"(-{text})" if value < 0 else text

    def _operand(self, node: ast.expr) -> str:
        """Return an operand: a name, bits, a comparison, a call."""
        if any(isinstance(part, ast.Attribute) and part.attr == "next" for part in _chain(node)):
            self.refuse(node, "a signal's next value cannot be read in Verilog; keep it in a variable")
        match node:
            case ast.Name() | ast.Attribute(attr="val" | "next") | ast.Subscript():
                return self._place(node)
            case ast.Attribute() if isinstance(self._object(node), EnumItemType):
                return internals.text_of(self._object(node))
            case ast.Constant(value=str(text)):
                return f'"{text}"' if set(text) - {"0", "1"} else f"{len(text)}'b{text}"
            case ast.Constant(value=None):
                self.refuse(node, "tristate signals are not supported; use an input, an output and an enable")
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                if isinstance(op, (ast.Is, ast.IsNot)) or any(ast.unparse(side) == "None" for side in (left, right)):
                    self.refuse(node, f"Verilog has no {ast.unparse(node)}; decide it outside of the process")
                if any(isinstance(side, ast.Constant) and isinstance(side.value, str) for side in (left, right)):
                    self.refuse(node, "a signal never equals a text; write a number, such as 0b0101")
                if type(op) not in SYMBOLS:
                    self.refuse(node, f"Verilog has no {_words(op)}; write == or != for each value")
                context = self._context([left, right], None)
                sides = [self._emit(side, context, None) for side in (left, right)]
                if sides[1][:2] == "(-" and re.fullmatch(r"\(-[\w']+\)", sides[1]):
                    sides[1] = sides[1][1:-1]
                return f"({sides[0]} {SYMBOLS[type(op)]} {sides[1]})"
            case ast.BoolOp():
                texts = []
                with ExitStack() as before:
                    for value in node.values:
                        texts.append(self._root(value, None))
                        before.enter_context(self.where(value, isinstance(node.op, ast.And)))
                return f"({f' {SYMBOLS[type(node.op)]} '.join(texts)})"
            case ast.UnaryOp(op=ast.Not()):
                text = self._root(node.operand, None)
                return f"!{text}" if re.fullmatch(r"\w+", text) else f"(!{_primary(text)})"
            case ast.Call():
                return self._call(node)
        self.refuse(node, f"Verilog has no {ast.unparse(node)}; write it otherwise")

    def _call(self, node: ast.Call) -> str:
        function = _called(node)
        if function == intbv.signed and isinstance(node.func, ast.Attribute):
            inner = node.func.value
            return self._operand(inner) if self._type(inner)[1] else f"$signed({self._operand(inner)})"
        if function is concat:
            return f"{{{', '.join(self._operand_of_concat(argument)[1] for argument in node.args)}}}"
        if function is bool:
            context = self._context([node.args[0]], None)
            return f"({self._emit(node.args[0], context, None)} != 0)"
        if tree := _tree(node):
            if lists := [one for one in node.args if isinstance(self._object(one), (list, tuple))]:
                self.refuse(node, f"{ast.unparse(lists[0])} is a list, which no function of Verilog takes; write its "
                            "words as arguments")  # fmt: skip
            name = self._function_name(tree, self.arguments(node))
            texts = []
            for argument, formal in zip(node.args, tree.argnames, strict=True):
                bits, signed = _shape(tree.symdict[formal])
                around, held = self.range(argument), _all_of(bits, signed)
                texts.append(self.text(argument, bits))
                if _around(around, held) != held:
                    self.refuse(node, f"{formal} holds {held.low} to {held.high} in Verilog, and may be {around.low} "
                                f"to {around.high} here; assign the argument to a signal first")  # fmt: skip
            return f"{name}({', '.join(texts)})"
        name = getattr(function, "__name__", ast.unparse(node.func))
        self.refuse(node, f"Verilog has no {name}; write if and else" if name in ("max", "min", "abs") else
                    f"Verilog has no {name}; write it out, or call it outside the process")  # fmt: skip

    def _width(self, node: ast.Subscript, whole: int) -> int:
        """Return the bits of a slice, whose bounds may depend on loops' variables."""
        assert isinstance(node.slice, ast.Slice)
        lower, upper = node.slice.lower, node.slice.upper
        found = Counter({"": 0 if lower else whole})
        for bound, times in ((lower, 1), (upper, -1)):
            if bound:
                self._add_terms(bound, times, found)
        bits = found.pop("")
        if any(found.values()):
            self.refuse(node, "the number of these bits must be constant; shift the signal, and take its lowest bits")
        if upper and self.range(upper).low < 0:
            self.refuse(node, "the lowest bit may be below 0; correct the bounds")
        if bits < 1:
            self.refuse(node, "these bounds enclose no bits; the first is above the highest bit, the second the lowest")
        return bits

    def _add_terms(self, node: ast.expr, times: int, found: Counter[str]) -> None:
        """Add the terms of a sum, each with how often it is added; a number belongs to the empty text."""
        constant = self.constant(node)
        match node:
            case _ if constant is not None:
                found[""] += times * int(constant)
            case ast.BinOp(op=ast.Add() | ast.Sub() as op):
                self._add_terms(node.left, times, found)
                self._add_terms(node.right, times if isinstance(op, ast.Add) else -times, found)
            case ast.BinOp(op=ast.Mult()) if (factor := self.constant(node.right)) is not None:
                self._add_terms(node.left, times * factor, found)
            case ast.BinOp(op=ast.Mult()) if (factor := self.constant(node.left)) is not None:
                self._add_terms(node.right, times * factor, found)
            case _:
                found[ast.unparse(node)] += times

    def _place(self, node: ast.expr) -> str:
        """Return the text of a name, or of bits of a signal or words of a memory."""
        match node:
            case ast.Attribute(value=inner, attr="next" | "val"):
                return self._place(inner)
            case ast.Name(id=name):
                return self._name(node, name)
            case ast.Subscript(slice=ast.Slice(lower=None, upper=None)):
                return self._place(node.value)
            case ast.Subscript(slice=ast.Slice(lower=lower, upper=upper)):
                return self._bits(node, lower, upper)
            case ast.Subscript(value=value, slice=index):
                known = self._object(value)
                if isinstance(known, tuple):
                    self.refuse(node, f"{ast.unparse(value)} is a tuple, and Verilog has tables of numbers only; "
                                "use a list of signals, or if and elif")  # fmt: skip
                around = self.range(index)
                if around.low < 0 and (found := {*self._values(index, self._around)}) and None not in found:
                    around = Range(max(around.low, min(found)), min(around.high, max(found)))
                if around.low < 0:
                    self.refuse(node, "the index may be below 0; give it a range without a sign")
                if (table := table_of(known)) is not None:
                    if isinstance(node.ctx, ast.Store):
                        self.refuse(node, "the numbers of a table do not change in Verilog; use a list of signals")
                    place, (bits, signed) = self._root(index, None), self._type(node)
                    values = [f"{bits}'{'s' * signed}h{value % (1 << bits):x}" for value in table]
                    choices = [f"{place} == {number} ? {value} : " for number, value in enumerate(values[:-1])]
                    return f"({''.join(choices)}{values[-1]})"
                if is_memory(known):
                    return f"{self._place(value)}[{self.text(index)}]"
                bits, _ = self._type(value)
                if isinstance(known, SignalType) and isinstance(known.val, bool):
                    self.refuse(node, f"{ast.unparse(value)} is a bit; write it without an index")
                constant = self.constant(index)
                text = self._selected(value, index)
                # Beyond the highest bit MyHDL reads zeros, or the sign, and refuses to write.
                if around.high < bits or (constant is None and isinstance(node.ctx, ast.Store)):
                    return text
                if constant is not None:
                    self.refuse(node, f"bit {constant} is beyond the highest bit, {bits - 1}; correct the index")
                if self._type(value)[1]:
                    self.refuse(node, f"the index may be {around.high}, and the highest bit is {bits - 1}; give it a "
                                f"range, such as intbv(0, min=0, max={bits})")  # fmt: skip
                return f"({self._root(index, None)} < {bits} && {text})"
        return self._operand(node)

    def _selected(self, value: ast.expr, low: ast.expr | None, width: int = 0) -> str:
        """Return bits of a value, from the lowest on; a single bit if there is no width."""
        text, offset = self._base(value)
        first = self.constant(low) if low else 0
        if low and first is None:
            place = f"{self._root(low, None)} + {offset}" if offset else self.text(low)
            return f"{text}[{place}{f' +: {width}' * bool(width)}]"
        first += offset
        return f"{text}[{first + width - 1}:{first}]" if width else f"{text}[{first}]"

    def _bits(self, node: ast.Subscript, lower: ast.expr | None, upper: ast.expr | None) -> str:
        if isinstance(node.value, ast.Call) and (_called(node.value) is intbv or _is_modbv(_called(node.value))):
            value, low = self.constant(node.value.args[0]), self.constant(upper) if upper else 0
            if value is not None and lower is not None and low is not None:
                bits = self._width(node, 0)
                return f"{bits}'h{(value >> low) % (1 << bits):x}"
        bits, signed = self._type(node.value)
        if lower is None and signed:
            assert upper is not None
            return f"({self._place(node.value)} >>> {self.text(upper)})"
        low: Any = self.constant(upper) if upper else 0
        width = self._width(node, bits)
        if upper and low is None and (last := self.range(upper).high + width - 1) >= bits:
            self.refuse(node, f"bit {last} may be among these, and the highest bit is {bits - 1}; correct the "
                        "bounds, or shift the signal and take its lowest bits")  # fmt: skip
        if low is not None and low + width > bits:
            self.refuse(node, f"bits {low + width - 1} to {low} are not all within 0 to {bits - 1}; correct the bounds")
        return self._selected(node.value, upper, width)

    def _base(self, node: ast.expr) -> tuple[str, int]:
        """Return the text of what bits are taken from, and the place of its lowest bit there."""
        match node:
            case ast.Subscript(slice=ast.Slice(lower=None, upper=None)):
                return self._base(node.value)
            case ast.Subscript(slice=ast.Slice(lower=lower, upper=upper)) if lower or not self._type(node.value)[1]:
                low = self.constant(upper) if upper else 0
                if low is not None and not isinstance(node.value, ast.Call):
                    text, offset = self._base(node.value)
                    return text, offset + low
            case ast.Subscript() if is_memory(self._object(node.value)):
                return self._place(node), 0
            case ast.Attribute(value=inner, attr="next" | "val"):
                return self._base(inner)
            case ast.Name():
                known = self._object(node)
                text = self._place(node)
                if re.fullmatch(r"[\w.]+(\[\d+\])?", text) and not re.search(r"\[\d+\]$", text):
                    return text, 0
                if isinstance(known, SliceSignal):
                    found = re.fullmatch(r"(.*)\[(?:\d+:)?(\d+)\]", text)
                    if found:
                        return found[1], int(found[2])
                if not isinstance(known, ShadowSignal):
                    return text, 0
        if any(isinstance(self._object(part), (tuple, list)) for part in _chain(node)):
            self.refuse(node, f"Verilog has no tables of tables; put the numbers of {ast.unparse(node)} into one tuple")
        self.refuse(node, "Verilog has no bits of an expression; assign it to a signal, and take its bits")

    def _name(self, node: ast.expr, name: str) -> str:
        tree = self._tree
        known = tree.symdict.get(name)
        if name in tree.argnames or (name in tree.vardict and (name not in tree.nonlocaldict or name in self._state)):
            return name
        if isinstance(known, SignalType) and internals.has_name(known):
            return str(known)
        if memory := is_memory(known):
            return memory
        if isinstance(known, EnumItemType):
            return internals.text_of(known)
        if type(known) is intbv:
            self.refuse(node, f"{name} is an intbv of no process, so Verilog has no value for it; use tied()")
        kind = type(known).__name__
        self.refuse(node, f"{name}, of type {kind}, has no value in Verilog; use an int, a signal or a list of signals")


def _known(node: Any) -> Any:
    return getattr(node, "obj", None)


def _chain(node: Any) -> Iterator[ast.expr]:
    """Yield an expression, what it is an attribute or a part of, and so on."""
    yield node
    while isinstance(node, (ast.Attribute, ast.Subscript)):
        node = node.value
        yield node


def _only(values: Sequence[int | None]) -> int | None:
    """Return the value that all have, None if they differ, and 0 for no values."""
    different = {*values} or {0}
    return different.pop() if len(different) == 1 else None


def _changed(statement: ast.stmt) -> Iterator[str]:
    """Yield the names of variables that a statement may change."""
    for node in ast.walk(statement):
        if isinstance(node, (ast.Name, ast.Subscript)) and isinstance(node.ctx, ast.Store):
            yield from (part.id for part in _chain(node) if isinstance(part, ast.Name))
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            yield from (part.id for part in node.value.args if isinstance(part, ast.Name))


def _called(node: ast.expr) -> Any:
    """Return the function that a call calls."""
    return _known(node.func) if isinstance(node, ast.Call) else None


def _tree(node: ast.AST) -> Any:
    """Return a function that a call calls, as MyHDL has analysed it; None if Verilog has it."""
    return getattr(node, "tree", None)


def _is_modbv(function: Any) -> bool:
    return isinstance(function, type) and issubclass(function, intbv)


def _is_integer(known: Any) -> bool:
    return isinstance(known, int) and not isinstance(known, bool)


def _around(*ranges: Iterable[int]) -> Range:
    """Return the range of all numbers in some ranges, tables or lists."""
    numbers = [*chain(*ranges)]
    return Range(min(numbers), max(numbers))


def _shape(known: Any) -> tuple[int, bool]:
    """Return the bits and the sign of a signal, or of a value of a variable's type."""
    known = known.val if isinstance(known, SignalType) else known
    if isinstance(known, intbv):
        return len(known) or INTEGER_BITS, (known.min or 0) < 0
    if isinstance(known, EnumItemType):
        return len(next(iter(internals.states_of(known).values()))), False
    return (INTEGER_BITS, True) if _is_integer(known) else (1, False)


def _all_of(bits: int, signed: bool) -> Range:
    """Return the values of a type."""
    return Range(-(1 << bits - 1), (1 << bits - 1) - 1) if signed else Range(0, (1 << bits) - 1)


def _primary(text: str) -> str:
    """Return an operand of a sign: Verilog has no two in a row."""
    return f"({text})" if text.startswith("!") else text


def _words(op: ast.AST) -> str:
    return {ast.In: "in", ast.NotIn: "not in"}.get(type(op), "such comparison")


def _is_one_group(text: str) -> bool:
    """Return True if the last parenthesis closes the first."""
    depth = 0
    for index, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if depth == 0:
            return index == len(text) - 1 and text[0] == "("
    return False
