# SPDX-License-Identifier: MIT
"""`python -m raycaster.hdl.lint`: find hardware sources that MyHDL converts wrongly, or not at all.

MyHDL computes with integers of any size, Verilog with the width of the widest operand. So where a result is compared,
shifted, sliced or added to again, MyHDL keeps a carry that Verilog loses; no tool warns. In this project each process
computes one operator at a time, into a signal of declared width. Expressions that are numbers at conversion (literals,
constants, loop variables, and anything computed from these alone) are exempt.

Rules, for functions that are decorated with always, always_comb, always_seq or instance, or passed to them:
  arithmetic  the result of an operator on signals is not simply assigned; (a + b) % (1 << n) may be assigned
  call        the called function does not exist in Verilog
  slice       bits are taken from an expression that is not a signal
  return      converts to disable, which synthesis refuses
  docstring   breaks the conversion on newer Pythons
  process     a process is not a function of the same file, so that this lint does not see it
"""

from __future__ import annotations

import argparse
import ast
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import repeat
from pathlib import Path

from raycaster.hdl.errors import UserError

DECORATORS = {"always", "always_comb", "always_seq", "instance"}
ALLOWED_CALLS = {"intbv", "modbv", "concat", "int", "len", "range", "bool"}
SIGNAL_MAKERS = {"Signal", "ResetSignal", "ConcatSignal", "unsigned", "signed", "bit", "tied", "unconnected"}
ARITHMETIC = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod, ast.Pow, ast.LShift, ast.RShift)


@dataclass(frozen=True, order=True)
class Finding:
    """A place that breaks a rule, and how to fix it."""

    path: Path
    line: int
    rule: str
    advice: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.rule}: {self.advice}"


def check(path: Path) -> list[Finding]:
    """Return all findings in a source file, by line.

    Raises:
        UserError: the file cannot be read or is not Python.
    """
    try:
        tree = ast.parse(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, SyntaxError) as error:
        raise UserError(f"{path}: {error}") from None
    functions = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    findings = {
        Finding(path, given.lineno, "process", "name a function of this file")
        for given in _given_to_makers(tree)
        if not (isinstance(given, ast.Name) and given.id in functions)
    }
    _visit(processes(tree), tree.body, _module_constants(tree), path, findings)
    return sorted(findings)


Known = dict[str, bool]
"""Names: True for constants when the design is converted, False for signals."""


def processes(tree: ast.Module) -> list[ast.FunctionDef]:
    """Return the functions that become processes, decorated by MyHDL or passed to one of its decorators."""
    given = {node.id for node in _given_to_makers(tree) if isinstance(node, ast.Name)}
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    return [one for one in functions if one.name in given or any(_name(d) in DECORATORS for d in one.decorator_list)]


def _given_to_makers(tree: ast.Module) -> Iterator[ast.expr]:
    """Yield what becomes a process: always_comb(this), instance(this), always(...)(this), always_seq(...)(this)."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            maker = node.func.func if isinstance(node.func, ast.Call) else node.func
            with_sensitivity = isinstance(node.func, ast.Call)
            if _name(maker) in DECORATORS and with_sensitivity == (_name(maker) in ("always", "always_seq")):
                yield from [*node.args, *(keyword.value for keyword in node.keywords)]


def _visit(
    made: Sequence[ast.FunctionDef], body: Sequence[ast.stmt], known: Known, path: Path, findings: set[Finding]
) -> None:
    """Check the processes; names become known on the way down to them."""
    known = dict(known)
    for statement in body:
        if isinstance(statement, ast.FunctionDef):
            if statement in made:
                findings.update(_Process(known, path).check(statement))
            else:
                _visit(made, statement.body, known | _parameters(statement), path, findings)
        else:
            _learn(statement, known)
            for inner in ("body", "orelse", "finalbody"):
                _visit(made, getattr(statement, inner, []), known, path, findings)


def _module_constants(tree: ast.Module) -> Known:
    """Return all names in capitals, which are constants by convention."""
    return {node.id: True for node in ast.walk(tree) if isinstance(node, ast.Name) and node.id.isupper()}


def _parameters(function: ast.FunctionDef) -> Known:
    """Return a block's arguments; those with a type or a default are constants, not ports."""
    arguments = [*function.args.posonlyargs, *function.args.args]
    defaults = len(function.args.defaults)
    parameters = {argument.arg: argument.annotation is not None for argument in arguments}
    parameters |= {argument.arg: True for argument in arguments[len(arguments) - defaults :]}
    return parameters | {argument.arg: True for argument in function.args.kwonlyargs}


def _learn(statement: ast.stmt, known: Known) -> None:
    """Add the names that a statement assigns."""
    if not isinstance(statement, ast.Assign):
        return
    for target in statement.targets:
        if isinstance(target, ast.Tuple) and isinstance(statement.value, ast.Tuple):
            pairs = zip(target.elts, statement.value.elts, strict=True)
        elif isinstance(target, ast.Tuple):
            pairs = zip(target.elts, repeat(statement.value))
        else:
            pairs = [(target, statement.value)]
        constant = {name.id: _constant(value, known) for name, value in pairs if isinstance(name, ast.Name)}
        known.update(constant)


def _constant(node: ast.AST, known: Known) -> bool:
    """True if an expression is a number, or anything else than a signal, when the design is converted."""
    match node:
        case ast.Name():
            return known.get(node.id, False)
        case ast.Call():
            return _constant_call(node, known)
        case ast.GeneratorExp() | ast.ListComp():
            inner = dict(known)
            for generator in node.generators:
                constant = _constant(generator.iter, inner)
                inner |= {name.id: constant for name in ast.walk(generator.target) if isinstance(name, ast.Name)}
            return _constant(node.elt, inner)
        case _:
            parts = (part for part in ast.iter_child_nodes(node) if isinstance(part, ast.expr))
            return all(_constant(part, known) for part in parts)


def _constant_call(node: ast.Call, known: Known) -> bool:
    """True for a function of constants, unless it makes signals: classes, some functions, and slicing calls."""
    name = _name(node.func)
    if name == "len":
        return True
    parts = [*node.args, *(keyword.value for keyword in node.keywords)]
    if isinstance(node.func, ast.Name):
        makes_signal = name in SIGNAL_MAKERS or name[:1].isupper() or name in known
    else:
        makes_signal = isinstance(node.func, ast.Subscript)
        parts.append(node.func)
    return not makes_signal and all(_constant(part, known) for part in parts)


def _name(node: ast.expr) -> str:
    """Return the last part of a name, or of the name that is called."""
    match node:
        case ast.Call():
            return _name(node.func)
        case ast.Attribute():
            return node.attr
        case ast.Name():
            return node.id
    return ""


class _Process:
    """Checker of a function that becomes a process."""

    def __init__(self, known: Known, path: Path):
        self._known, self._path = dict(known), path

    def check(self, function: ast.FunctionDef) -> Iterator[Finding]:
        if ast.get_docstring(function) is not None:
            yield self._finding(function.body[0], "docstring", "make it a comment above the decorator")
        for node in ast.walk(function):
            if isinstance(node, ast.For):
                self._known |= {name.id: True for name in ast.walk(node.target) if isinstance(name, ast.Name)}
        for statement in function.body:
            yield from self._statement(statement)

    def _statement(self, node: ast.AST) -> Iterator[Finding]:
        if isinstance(node, ast.Return):
            yield self._finding(node, "return", "write if and else around what it skips")
        elif isinstance(node, (ast.FunctionDef, ast.Lambda)):
            yield self._finding(node, "call", "write the helper's statements where it is called")
        elif isinstance(node, ast.AugAssign) and self._on_signals(node.target, node.value):
            yield from self._expression(node.value)
        elif isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value is not None:
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                yield from self._expression(target)
            yield from self._assigned(node.value)
        else:
            for child in ast.iter_child_nodes(node):
                if isinstance(child, ast.expr):
                    yield from self._expression(child)
                else:
                    yield from self._statement(child)

    def _assigned(self, node: ast.expr) -> Iterator[Finding]:
        """Check a whole right side, which may have one operator and a wrap of its result to the target's width."""
        if isinstance(node, ast.BinOp) and self._wraps(node):
            node = node.left
        if isinstance(node, ast.BinOp) and self._operates(node):
            yield from self._expression(node.left)
            yield from self._expression(node.right)
        elif isinstance(node, ast.UnaryOp) and self._operates(node):
            yield from self._expression(node.operand)
        else:
            yield from self._expression(node)

    def _expression(self, node: ast.AST) -> Iterator[Finding]:
        """Check any other place, which must have no operator on signals."""
        if isinstance(node, ast.expr) and _constant(node, self._known):
            return
        if isinstance(node, (ast.Lambda, ast.ListComp, ast.GeneratorExp)):
            yield self._finding(node, "call", "write a for loop")
            return
        if isinstance(node, ast.expr) and self._operates(node):
            yield self._finding(
                node, "arithmetic", "assign only this operation to a signal of declared width, and use that signal"
            )
        if isinstance(node, ast.Call):
            yield from self._call(node)
        if isinstance(node, ast.Subscript) and not isinstance(node.value, (ast.Name, ast.Attribute, ast.Subscript)):
            yield self._finding(node, "slice", "assign the expression to a signal, and take bits of that signal")
        for child in ast.iter_child_nodes(node):
            yield from self._expression(child)

    def _call(self, node: ast.Call) -> Iterator[Finding]:
        name = _name(node.func)
        if name in ("max", "min", "abs"):
            yield self._finding(node, "call", f"Verilog has no {name}; write if and else")
        elif isinstance(node.func, ast.Attribute) and name == "signed":
            return
        elif name not in ALLOWED_CALLS:
            allowed = ", ".join(sorted(ALLOWED_CALLS))
            yield self._finding(node, "call", f"only {allowed} convert; write {name or 'it'} out, or call it outside")

    def _operates(self, node: ast.AST) -> bool:
        match node:
            case ast.BinOp(op=op) if isinstance(op, ARITHMETIC):
                return self._on_signals(node.left, node.right)
            case ast.UnaryOp(op=ast.USub()):
                return self._on_signals(node.operand)
        return False

    def _wraps(self, node: ast.expr) -> bool:
        """True for `(...) % (1 << n)`: the literal makes Verilog compute in 32 bits, and these are right."""
        match node:
            case ast.BinOp(op=ast.Mod(), right=ast.BinOp(left=ast.Constant(value=1), op=ast.LShift(), right=width)):
                return _constant(width, self._known)
        return False

    def _on_signals(self, *operands: ast.expr) -> bool:
        return not all(_constant(operand, self._known) for operand in operands)

    def _finding(self, node: ast.stmt | ast.expr, rule: str, advice: str) -> Finding:
        return Finding(self._path, node.lineno, rule, advice)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m raycaster.hdl.lint",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("paths", nargs="+", type=Path, metavar="PATH", help="files and directories")
    arguments = parser.parse_args(argv)
    files: list[Path] = []
    for path in arguments.paths:
        files += sorted(path.rglob("*.py")) if path.is_dir() else [path]
    findings = [finding for path in files for finding in check(path)]
    for finding in findings:
        print(finding)
    print(f"{len(files)} files, {len(findings)} findings", file=sys.stderr)
    return int(bool(findings))


if __name__ == "__main__":
    try:
        sys.exit(main())
    except UserError as error:
        sys.exit(f"error: {error}")
