# SPDX-License-Identifier: MIT
"""Check of each process that is converted: Verilog must compute what MyHDL computes.

MyHDL computes with integers of any size. Verilog computes an expression with the bits of its widest operand or of its
target, so where a result is compared, shifted to the right, divided or used as an index, it may have lost a carry or a
sign. No other tool warns of it. The check knows the range of every signal, and refuses a result that may not fit.
Operators whose lowest bits do not depend on a carry may be nested: `total.next = a + b + c` is right for any widths.
"""

from __future__ import annotations

import ast
import operator
from typing import Any, NamedTuple

from myhdl import concat, intbv

from raycaster.hdl.errors import UserError
from raycaster.hdl.internals import SignalType

INTEGER_BITS = 32
"""Bits of a number, or of an integer variable, in Verilog."""

LARGEST_VARIABLE = 1 << 20
"""Assumed end of the range of an integer variable, such as a loop's."""

EXACT = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.LShift: lambda value, places: value << min(max(places, 0), 1 << 10),
}
"""Operators whose range follows from the ends of their operands' ranges."""

CARRYING = (*EXACT, ast.BitAnd, ast.BitOr, ast.BitXor)
"""Operators whose lowest bits depend on the lowest bits of their operands only."""


class _Range(NamedTuple):
    """Values of an expression in MyHDL, and its bits in Verilog if nothing around it is wider."""

    low: int
    high: int
    bits: int
    signed: bool
    """True if Verilog takes it as two's complement."""


def check_process(tree: Any, *, is_function: bool = False) -> None:
    """Check a process that MyHDL has analysed, and the functions that it calls.

    Raises:
        UserError: Verilog would compute something else, or has no such function; the text begins with file and line.
    """
    _Check(tree, is_function).visit(tree)


class _Check(ast.NodeVisitor):
    def __init__(self, tree: Any, is_function: bool):
        self._tree, self._is_function = tree, is_function

    def _refuse(self, node: Any, reason: str) -> None:
        raise UserError(f"{self._tree.sourcefile}:{self._tree.lineoffset + node.lineno}: {reason}")

    def visit(self, node: ast.AST) -> None:
        """Check a statement; its expressions stand alone, as conditions do."""
        if isinstance(node, ast.expr):
            self._alone(node)
        else:
            super().visit(node)

    def visit_FunctionDef(self, node: ast.FunctionDef | ast.For) -> None:
        """Check the body only; the range of a loop is constant."""
        for statement in node.body:
            self.visit(statement)

    visit_For = visit_FunctionDef

    def visit_Expr(self, node: ast.Expr) -> None:
        """Check a task's arguments; what a process waits for, and a text, compute nothing."""
        if isinstance(node.value, ast.Call) and _called(node.value) is not print:
            self._alone(node.value)

    def visit_Raise(self, node: ast.Raise) -> None:
        """Accept it, as it ends a simulation in Verilog too."""

    def visit_Return(self, node: ast.Return) -> None:
        """Refuse an early end of a process, which synthesis does."""
        if not self._is_function:
            self._refuse(node, "synthesis refuses return in a process; write if and else around what it skips")
        if node.value:
            self._computed(node.value, len(self._tree.returnObj or ()) or INTEGER_BITS)

    def visit_Assign(self, node: ast.Assign) -> None:
        """Check the right side with the bits of the left side."""
        [target] = node.targets
        while isinstance(target, ast.Attribute):
            target = target.value
        self._alone(target)
        self._computed(node.value, self._range(target).bits)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        """Check it as the assignment of a result."""
        result = ast.copy_location(ast.BinOp(node.target, node.op, node.value), node)
        self._computed(result, self._range(node.target).bits)

    def _alone(self, node: ast.expr) -> None:
        self._judge(node, self._range(node).bits, None)

    def _computed(self, node: ast.expr, target: int) -> None:
        self._judge(node, max(target, self._range(node).bits), target)

    def _judge(self, node: ast.expr, width: int, needed: int | None) -> None:
        """Check an expression that Verilog computes with `width` bits.

        Args:
            node: the expression.
            width: bits with which Verilog computes it.
            needed: the number of its lowest bits that are used, None for all.
        """
        parts = [node.test] if isinstance(node, ast.IfExp) else ast.iter_child_nodes(node)
        if not isinstance(node, (ast.Call, ast.Subscript)) and any(map(_is_choice, parts)):
            self._refuse(node, "Verilog would compute the operator in one branch only; assign the choice to a signal")
        match node:
            case ast.Name(id=name) if type(self._tree.symdict.get(name)) is intbv:
                self._refuse(node, f"{name} is an intbv of no process, so Verilog has no value for it; use tied()")
            case ast.BinOp(op=ast.LShift() | ast.RShift() as op):
                self._fits(node, width, needed)
                self._judge(node.left, width, needed if isinstance(op, ast.LShift) else None)
                self._alone(node.right)
            case ast.BinOp(op=ast.Mod() | ast.FloorDiv()):
                used = self._wrapped(node, needed)
                self._judge(node.left, width, used)
                self._judge(node.right, width, None)
                if used is None and min(self._range(node.left).low, self._range(node.right).low) < 0:
                    self._refuse(node, "below 0 Verilog rounds up, and Python down; shift to the right, or take bits")
            case ast.BinOp():
                inner = needed if isinstance(node.op, CARRYING) else None
                self._fits(node, width, needed)
                self._judge(node.left, width, inner)
                self._judge(node.right, width, inner)
            case ast.UnaryOp(op=ast.Invert()):
                own = self._range(node.operand)
                if own.bits < (width if needed is None else needed) and not own.signed:
                    self._refuse(
                        node, f"~ also sets the bits above these {own.bits}; assign it to a signal of {own.bits} bits"
                    )
                self._judge(node.operand, width, needed)
            case ast.UnaryOp(op=ast.Not()):
                self._alone(node.operand)
            case ast.UnaryOp():
                self._fits(node, width, needed)
                self._judge(node.operand, width, needed)
            case ast.Compare():
                sides = [node.left, *node.comparators]
                widest = max(self._range(side).bits for side in sides)
                for side in sides:
                    self._judge(side, widest, None)
            case ast.IfExp():
                self._alone(node.test)
                self._judge(node.body, width, needed)
                self._judge(node.orelse, width, needed)
            case ast.Call():
                self._judge_call(node, width, needed)
            case ast.Subscript():
                if not _has_bits(node.value):
                    self._refuse(node, "Verilog has no bits of an expression; assign it to a signal, and take its bits")
                if not isinstance(node.slice, ast.Slice):
                    self._alone(node.slice)
            case _:
                for part in ast.iter_child_nodes(node):
                    if isinstance(part, ast.expr):
                        self._alone(part)

    def _judge_call(self, node: ast.Call, width: int, needed: int | None) -> None:
        function = _called(node)
        if tree := getattr(node, "tree", None):
            check_process(tree, is_function=True)
        elif function in (int, intbv):
            for argument in node.args[:1]:
                self._judge(argument, width, needed)
            return
        elif getattr(function, "__module__", "") == "builtins" and function not in (len, bool, ord, range, print):
            name = getattr(function, "__name__", "")
            self._refuse(node, f"Verilog has no {name}; write if and else" if name in ("max", "min", "abs") else
                         f"Verilog has no {name}; write it out, or call it outside the process")  # fmt: skip
        for argument in node.args:
            self._alone(argument)

    def _wrapped(self, node: ast.BinOp, needed: int | None) -> int | None:
        """Return the bits of a dividend that are used: few for a remainder, if the divisor is a power of two."""
        if not isinstance(node.op, ast.Mod):
            return None
        divisor, dividend = self._range(node.right), self._range(node.left)
        power = divisor.high.bit_length() - 1
        if divisor.low != divisor.high or divisor.high != 1 << power:
            return None
        return power if dividend.low >= 0 or (needed is not None and needed <= power) else None

    def _fits(self, node: ast.expr, width: int, needed: int | None) -> None:
        """Refuse a result of which bits are lost that are needed, or a sign that Verilog does not know."""
        if needed is not None and needed <= width:
            return
        own = self._range(node)
        bits = max(own.low.bit_length(), own.high.bit_length()) + (own.low < 0)
        if own.low < 0 and not own.signed:
            self._refuse(node, f"the result may be below 0, and loses its sign; assign it to signed({bits})")
        if bits > width:
            self._refuse(node, f"the result has {bits} bits, and loses some; assign it to a signal of {bits} bits")

    def _range(self, node: ast.expr) -> _Range:
        """Return the range of an expression."""
        match node:
            case ast.BinOp():
                return self._range_of_operator(node)
            case ast.UnaryOp(op=ast.USub()):
                own = self._range(node.operand)
                return _Range(-own.high, -own.low, own.bits, own.signed)
            case ast.UnaryOp(op=ast.Invert()):
                own = self._range(node.operand)
                return own if own.low < 0 else own._replace(high=(1 << own.bits) - 1)
            case ast.IfExp():
                return _either(self._range(node.body), self._range(node.orelse))
            case ast.Call(args=[value]) if _called(node) in (int, intbv):
                return self._range(value)
        return self._range_of_leaf(node)

    def _range_of_leaf(self, node: ast.expr) -> _Range:
        """Return the range of an expression that has no operator of arithmetic."""
        match node:
            case ast.Constant(value=number) | ast.Name(obj=int(number), value=_):
                return _range_of_number(number)
            case ast.Compare() | ast.BoolOp() | ast.UnaryOp():
                known: Any = False
            case ast.Subscript(slice=ast.Slice() as bits) if not isinstance(node.value, ast.Call):
                whole = _known(node)
                width = len(whole) if isinstance(whole, (intbv, SignalType)) else INTEGER_BITS
                known = intbv(0)[self._bound(bits.lower, width) - self._bound(bits.upper, 0) :]
            case _:
                known = _known(node)
        return _range_of_type(known)

    def _bound(self, node: ast.expr | None, default: int) -> int:
        """Return a bound of a slice; one that a loop changes counts as the default."""
        try:
            return int(eval(compile(ast.Expression(node), "", "eval"), self._tree.symdict)) if node else default
        except (NameError, TypeError):
            return default

    def _range_of_operator(self, node: ast.BinOp) -> _Range:
        one, other = self._range(node.left), self._range(node.right)
        around = _either(one, other)
        if isinstance(node.op, (ast.LShift, ast.RShift)):
            around = around._replace(bits=one.bits, signed=one.signed)
        if compute := EXACT.get(type(node.op)):
            values = [compute(a, b) for a in (one.low, one.high) for b in (other.low, other.high)]
        elif isinstance(node.op, ast.Mod):
            values = [0, max(other.high - 1, 0)]
        elif isinstance(node.op, ast.BitAnd) and max(one.low, other.low) >= 0:
            values = [0, min(part.high for part in (one, other) if part.low >= 0)]
        elif isinstance(node.op, (ast.BitOr, ast.BitXor)) and around.low >= 0:
            values = [0, (1 << around.high.bit_length()) - 1]
        else:  # no larger than the operands
            values = [around.low, around.high]
        return around._replace(low=min(values), high=max(values))


def _has_bits(node: ast.expr) -> bool:
    """Return True if Verilog can take bits of what MyHDL prints for an expression."""
    if isinstance(node, ast.Call):
        return isinstance(_known(node), intbv) and _called(node) is not concat
    return isinstance(node, (ast.Name, ast.Attribute, ast.Subscript))


def _called(node: ast.expr) -> Any:
    """Return the function that a call calls."""
    return _known(node.func) if isinstance(node, ast.Call) else None


def _known(node: ast.expr) -> Any:
    """Return what MyHDL knows of an expression: its signal, or a value of its type."""
    return getattr(node, "obj", None)


def _is_choice(node: ast.AST) -> bool:
    """Return True for `a if b else c`, which MyHDL prints without parentheses."""
    return isinstance(node, ast.IfExp) or (
        isinstance(node, ast.Call) and _called(node) in (int, intbv) and any(map(_is_choice, node.args))
    )


def _either(one: _Range, other: _Range) -> _Range:
    """Return a range that contains two others."""
    return _Range(
        min(one.low, other.low), max(one.high, other.high), max(one.bits, other.bits), one.signed and other.signed
    )


def _range_of_number(value: Any) -> _Range:
    """Return the range of a number, True or False; of anything else, nothing is computed."""
    if isinstance(value, bool) or not isinstance(value, int):
        return _Range(int(value is True), int(value is True), 1, False)
    return _Range(value, value, max(INTEGER_BITS, value.bit_length() + 1), True)


def _range_of_type(known: Any) -> _Range:
    """Return the range of what MyHDL knows of a name: a signal, or a value of the variable's type."""
    known = known.val if isinstance(known, SignalType) else known
    if isinstance(known, intbv) and len(known):
        low = known.min or 0
        return _Range(low, (known.max or 1 << len(known)) - 1, len(known), low < 0)
    if isinstance(known, int) and not isinstance(known, bool):
        return _Range(0, LARGEST_VARIABLE, INTEGER_BITS, True)
    return _Range(0, int(isinstance(known, bool)), 1, False)
