# SPDX-License-Identifier: MIT
"""The Python of a process or a function before MyHDL analyses it: what is constant is decided, the rest is checked."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterable, Iterator
from itertools import pairwise
from types import FunctionType
from typing import Any

from raycaster.hdl.internals import EnumItemType, EnumType, SignalType, around

PYTHON = {one.__name__: one for one in (len, range, isinstance, int, bool, abs, min, max, round)}
"""Functions and types of Python in expressions of constants."""

EXPRESSIONS = (ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.IfExp, ast.Compare, ast.Subscript, ast.Tuple, ast.List)
"""Expressions that are constant if their parts are."""

SEVERAL = "assign to one signal or variable at a time, or to different whole signals: a.next, b.next = c, d"
"""Remedy for an assignment."""


def prepare(tree: Any) -> None:
    """Leave out the branches that constants decide, split what has several values or targets, and refuse the rest.

    Args:
        tree: the process or function; `symdict` has the values of the names around it.

    Raises:
        SyntaxError: MyHDL's analysis would misunderstand something; with its place.
    """
    _Decided(tree).visit(tree)
    _check(tree)
    for name in {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)} & {*tree.symdict}:
        value = tree.symdict[name]
        if isinstance(value, list) and value and all(isinstance(one, int) for one in value):
            tree.symdict[name] = tuple(value)
        elif isinstance(value, FunctionType):
            tree.symdict[name] = _opened(value)


def joined(op: ast.boolop, values: Iterable[bool | None]) -> bool | None:
    """Return the truth of `and` or `or`, None if it is unknown, as that of an operand may be."""
    known, ends = [one if one is None else bool(one) for one in values], isinstance(op, ast.Or)
    return ends if ends in known else None if None in known else not ends


def _opened(function: FunctionType) -> FunctionType:
    """Return a function that has the constants and functions around it as names of its module, as MyHDL wants them."""
    values, known = around(function), (FunctionType, EnumType, SignalType)
    if not values or not all(isinstance(value, known) or _is_plain(value) for value in values.values()):
        return function
    code = function.__code__.replace(co_freevars=())
    return FunctionType(code, {**function.__globals__, **values}, function.__name__)


class _Decided(ast.NodeTransformer):
    """A process without branches that never run, as Python decides in its simulation."""

    def __init__(self, tree: Any):
        own = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        own |= {node.arg for node in ast.walk(tree) if isinstance(node, ast.arg)}
        self._around = {name: value for name, value in tree.symdict.items() if name not in own}

    def generic_visit(self, node: Any) -> Any:
        first = node.body[0] if isinstance(getattr(node, "body", None), list) and node.body else None
        super().generic_visit(node)
        if first is not None and not node.body:
            node.body = [ast.copy_location(ast.Pass(), first)]
        return node

    def visit_If(self, node: ast.If) -> Any:
        decided = self._decide(node.test)
        if decided is None:
            return self.generic_visit(node)
        branch: Any = ast.Module(node.body if decided else node.orelse, [])
        super().generic_visit(branch)
        return branch.body

    def visit_For(self, node: ast.For) -> Any:
        """Leave out a loop that never runs."""
        return [] if self._value(node.iter) == [range(0)] else self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> Any:
        decided = self._decide(node.test)
        return self.generic_visit(node) if decided is None else self.visit(node.body if decided else node.orelse)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> Any:
        """Invert each side of a choice by itself, as the sides may have different numbers of bits."""
        if not isinstance(node.op, ast.Invert) or not isinstance(choice := node.operand, ast.IfExp):
            return self.generic_visit(node)
        sides = (ast.copy_location(ast.UnaryOp(node.op, side), node) for side in (choice.body, choice.orelse))
        return self.visit(ast.copy_location(ast.IfExp(choice.test, *sides), node))

    def visit_Call(self, node: Any) -> ast.expr:
        self.generic_visit(node)
        function: Any = self._around.get(getattr(node.func, "id", ""))
        names = function.__code__.co_varnames[: function.__code__.co_argcount] if inspect.isfunction(function) else ()
        if len(node.args) < len(names):
            given = zip(reversed(names), reversed(function.__defaults__ or ()), strict=False)
            known = {name: ast.copy_location(ast.Constant(one), node) for name, one in given if isinstance(one, int)}
            known |= dict(zip(names, node.args, strict=False)) | {one.arg: one.value for one in node.keywords}
            node.args, node.keywords = [known[name] for name in names if name in known], []
        return self._folded(node)

    def _folded(self, node: ast.expr) -> ast.expr:
        [value] = self._value(node) or [None]
        return ast.copy_location(ast.Constant(value), node) if isinstance(value, int) else node

    def visit_Assign(self, node: ast.Assign) -> Any:
        """Split an assignment to several signals, such as `a.next, b.next = c, d` and `a.next = b.next = c`."""
        self.generic_visit(node)
        pairs = [pair for target in node.targets for pair in _pairs(target, node.value)]
        # After an indexed target, MyHDL would take the next ones for inputs.
        signals = {ast.unparse(target) for target, _ in pairs if _is_whole(target)}
        if len(pairs) == 1 or len(signals) < len(pairs):
            return node
        return [ast.copy_location(ast.Assign([target], value), node) for target, value in pairs]

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        [place], words = self._value(node.slice) or [None], self._around.get(getattr(node.value, "id", ""))
        if isinstance(words, list) and isinstance(place, int) and place < 0:
            node.slice = ast.copy_location(ast.Constant(place + len(words)), node)
        return self._folded(node) if isinstance(node.ctx, ast.Load) else self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        self.generic_visit(node)
        sides = [node.left, *node.comparators]
        pairs = [(one, op, other) for op, (one, other) in zip(node.ops, pairwise(sides), strict=True)]
        whole: ast.boolop = ast.And()
        if isinstance(node.ops[0], (ast.In, ast.NotIn)) and len(pairs) == 1:
            elements = self._elements(node.comparators[0])
            among = isinstance(node.ops[0], ast.In)
            whole, equal = (ast.Or(), ast.Eq()) if among else (ast.And(), ast.NotEq())
            pairs = [(node.left, equal, one) for one in elements]
        parts: list[ast.expr] = [
            ast.copy_location(ast.Compare(one, [op], [other]), node) for one, op, other in pairs
        ] or [node]
        return parts[0] if len(parts) == 1 else ast.copy_location(ast.BoolOp(whole, parts), node)

    def _elements(self, node: ast.expr) -> list[ast.expr]:
        """Return the elements of a tuple or a list, written out or known by name."""
        known = self._around.get(node.id) if isinstance(node, ast.Name) else None
        if isinstance(known, (tuple, list)) and all(isinstance(one, int) for one in known):
            return [ast.copy_location(ast.Constant(one), node) for one in known]
        return getattr(node, "elts", [])

    def _decide(self, test: ast.expr) -> bool | None:
        """Return the truth of a condition, None if a signal or a variable decides it."""
        if isinstance(test, ast.BoolOp):
            return joined(test.op, map(self._decide, test.values))
        if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
            inner = self._decide(test.operand)
            return None if inner is None else not inner
        value = self._value(test)
        return bool(value[0]) if value else None

    def _value(self, node: ast.expr) -> list[Any] | None:
        """Return the value of an expression of constants, None for any other."""
        if not self._is_constant(node):
            return None
        try:
            code = compile(ast.fix_missing_locations(ast.Expression(node)), "", "eval")
            return [eval(code, {"__builtins__": PYTHON}, self._around)]
        except Exception:  # it would fail in the simulation too
            return None

    def _is_constant(self, node: ast.expr) -> bool:
        """Return True for an expression of constants; of a signal, what it is and its width are constant."""
        match node:
            case ast.Constant():
                return True
            case ast.Name(id=name):
                return name in self._around and _is_plain(self._around[name])
            case ast.Attribute(value=ast.Name(id=name)):
                return isinstance(self._around.get(name), EnumType)
            case ast.Compare(left=left, ops=[ast.Is() | ast.IsNot()], comparators=[right]):
                return all(self._is_known(side) for side in (left, right))
            case ast.Call(func=ast.Name(id=name), args=args) if name in PYTHON and name not in self._around:
                known = self._is_known if name in ("len", "isinstance") else self._is_constant
                return all(map(known, args))
        parts = [part for part in ast.iter_child_nodes(node) if isinstance(part, ast.expr)]
        return isinstance(node, EXPRESSIONS) and all(map(self._is_constant, parts))

    def _is_known(self, node: ast.expr) -> bool:
        """Return True for a constant, and for the name of anything around the process."""
        return self._is_constant(node) or (isinstance(node, ast.Name) and node.id in {*self._around, *PYTHON})


def _pairs(target: ast.expr, value: ast.expr) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Yield what is assigned, each with its value; a tuple as a whole if its values are not written out."""
    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) and len(target.elts) == len(value.elts):
        yield from zip(target.elts, value.elts, strict=True)
    else:
        yield target, value


def _is_whole(target: ast.expr) -> bool:
    """Return True for the next value of all of a signal."""
    return isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name)


def _is_plain(value: Any) -> bool:
    """Return True for a value that no simulation changes."""
    if isinstance(value, (tuple, list, set, frozenset, dict)):
        return all(map(_is_plain, value.values() if isinstance(value, dict) else value))
    return value is None or isinstance(value, (int, float, str, range, EnumItemType))


def _check(tree: Any) -> None:
    for node in ast.walk(tree):
        match node:
            case ast.Assign(targets=[at]) | ast.AugAssign(target=at):
                while isinstance(at, (ast.Attribute, ast.Subscript)):
                    at = at.value
                if isinstance(at, ast.Name):
                    continue
                text = f"Verilog has no assignment to {ast.unparse(at)}; {SEVERAL}"
            case ast.Assign():
                text = f"Verilog has no {ast.unparse(node)}; {SEVERAL}"
            case ast.ListComp():
                made = ast.unparse(node)
                text = f"a process has no list of its own in Verilog; make {made} a list of signals outside of it"
            case ast.MatchSingleton():
                text = f"a signal never is {node.value}, even if it equals it; write case 1 and case 0"
            case ast.AnnAssign() | ast.NamedExpr() | ast.With() | ast.Delete():
                text = f"Verilog has no {ast.unparse(node).partition(chr(10))[0]}; write it otherwise"
            case _:
                continue
        raise SyntaxError(text, (tree.sourcefile, tree.lineoffset + getattr(node, "lineno", 1), 0, ""))
