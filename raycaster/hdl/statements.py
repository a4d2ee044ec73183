# SPDX-License-Identifier: MIT
"""Statements of an analysed process, or of a function that it calls, in Verilog. Latches are refused here."""

from __future__ import annotations

import ast
import functools
import inspect
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, nullcontext
from typing import Any

from raycaster.hdl import internals
from raycaster.hdl.expressions import Expressions
from raycaster.hdl.internals import EnumItemType, SignalType, branches_of, root_of, state_of, table_of


class Statements:
    """A printer of statements, each as its lines. `Expressions` prints what is in them."""

    def __init__(self, tree: Any, expressions: Expressions):
        """Add the flags of breaks and continues to the variables.

        Args:
            tree: the process or function.
            expressions: its expressions.
        """
        self._tree, self._expressions = tree, expressions
        self._loops: list[Any] = []
        self._names = {*tree.symdict, *tree.vardict}
        self._function = ""
        for loop in (node for node in ast.walk(tree) if isinstance(node, ast.For)):
            tree.vardict |= {flag: False for _, flag in self._flags(loop)}

    def printed(self, label: str, sensitivity: Callable[[Sequence[str]], str]) -> str:
        """Return a process; `sensitivity` returns the Verilog for what it waits for, from the signals and edges."""
        tree, [node] = self._tree, self._tree.body
        combinational, once = internals.is_combinational(tree), internals.runs_once(tree)
        if combinational:
            self._refuse_latches(node)
        elif not once:
            self._refuse_missing(node)
        if internals.assigned(tree):
            return "\n".join([*_comment(node.doc), "", *self._lines(node.body)])
        lines = self._declared(internals.locals_of(tree))
        lines += [f"{name} = 0;" for name in self._sometimes_counted(node.body) if combinational]
        head = "initial" if once else f"always {sensitivity([edge._toVerilog() for edge in tree.senslist])}"
        body = self._lines(node.body[-1].body[1:] if internals.is_endless(tree) else node.body)
        if (reset := getattr(tree, "reset", None)) is not None:
            arrows = {name: "=" for name in tree.vardict}
            begun = [f"{name} {arrows.get(name, '<=')} {self._expressions.initial(value)};"
                     for name, value in internals.resets_of(tree)]  # fmt: skip
            lines += _block(f"if ({reset} == {int(reset.active)})", begun)
            body = _block("else", body)
        # A block that declares nothing needs no name, which would cost Icarus a thread at each evaluation.
        return "\n".join([*_comment(node.doc), *_block(head, [*lines, *body], label and f": {label}")])

    def printed_function(self, name: str) -> str:
        """Return a function, or a task, which has no result."""
        tree, [node] = self._tree, self._tree.body
        refuse, is_task = self._expressions.refuse, internals.is_task(tree)
        for part in ast.walk(node):
            if isinstance(part, ast.Attribute) and part.attr == "next":
                refuse(part, "a function cannot drive signals in Verilog; let it return a value")
        if not tree.argnames and not is_task:
            refuse(node, "a function in Verilog needs an argument; give it one, or write its value")
        if node.name in (*tree.argnames, *tree.vardict):
            refuse(node, f"{node.name} is the function and a variable of it; rename one")
        self._function = name
        self._end_in_returns(node.body)
        lines = []
        for argument in tree.argnames:
            if (known := tree.symdict.get(argument)) is None:
                refuse(node, f"{argument} has no known type; assign its value to a signal first")
            way = "inout" if argument in tree.outputs else "input"
            lines.append(f"{way} {internals.declaration('', known)}{argument};".replace("  ", " "))
        lines += self._declared(tree.vardict)
        word = "task" if is_task else "function"
        result = "" if is_task else internals.declaration("", tree.returnObj).strip()
        head = f"{word} {result}{' ' * bool(result)}{name};"
        body = [*_indented(lines), "begin", *_indented(self._lines(node.body)), "end"]
        return "\n".join([head, *body, f"end{word}", ""])

    def _refuse_missing(self, process: Any) -> None:
        """Refuse a process that waits for values but not for all that it reads, as synthesis does."""
        tree = self._tree
        waits = [id(edge) for edge in tree.senslist if isinstance(edge, SignalType)]
        missing = [name for name in sorted(tree.inputs) if waits and id(tree.symdict[name]) not in waits]
        if missing or 0 < len(waits) < len(tree.senslist):
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
        for name in state_of(self._tree):
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
            name = root_of(node.targets[0]).id
            driven = self._tree.symdict[name]
            words = internals.written_words(self._tree, name)
            own = (1 << len(driven)) - 1 if None in words or not words else sum(1 << (word or 0) for word in {*words})
            if missing := own & ~always.get(name, 0):
                part = "bit" if isinstance(driven, SignalType) else "word"
                one = f"{part} {missing.bit_length() - 1} of {name}"
                which = one if missing + 1 < 1 << len(driven) else name
                self._expressions.refuse(node, f"{which} keeps its value in some cases, which makes a latch; assign "
                                         "all bits in all cases, or write @always to mean a latch")  # fmt: skip

    def _always(self, body: Sequence[Any]) -> tuple[dict[str, int], bool]:
        """Return a mask of the bits, or of a list's words, that statements assign in any case, by name.

        Also returns True if a break or a continue may skip what follows.
        """
        found: dict[str, int] = {}
        for node in body:
            every: list[tuple[dict[str, int], bool]] = []
            match node:
                case ast.Assign(targets=[target]) if _is_next(target):
                    name = root_of(target).id
                    in_word = isinstance(target, ast.Subscript) and isinstance(self._tree.symdict[name], list)
                    bits = None if in_word else self._expressions.part(target)
                    every = [({name: 0 if bits is None else (1 << bits[1]) - (1 << bits[0])}, False)]
                case ast.For():
                    every = [({}, False)]
                    for value in self._expressions.numbers(node):
                        with self._expressions.assuming({ast.unparse(node.target): value}):
                            one, skips = self._always(node.body)
                        every[0][0].update({name: mask | every[0][0].get(name, 0) for name, mask in one.items()})
                        if skips and any(isinstance(part, ast.Break) for part in ast.walk(node)):
                            break
                case ast.If() if not getattr(node, "ignore", False):
                    every = [self._always(branch) for branch in self._reached(node)]
                case ast.Match():
                    every = [self._always(case.body) for case in node.cases]
                    every += [({}, False)] * (not self._is_full(node))
                case ast.Break() | ast.Continue():
                    return found, True
            for name in set.intersection(*({*masks} for masks, _ in every)) if every else ():
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

    def _declared(self, variables: Mapping[str, Any]) -> list[str]:
        return [f"{internals.declaration('reg', known)}{name};" for name, known in variables.items()]

    def _lines(self, body: Sequence[Any]) -> Iterator[str]:
        """Yield the lines of statements; those that a break or a continue may skip are within an `if`."""
        for place, node in enumerate(body):
            yield from self._statement(node)
            flags = [flag for loop in self._loops[-1:] for _, flag in self._flags(loop, node)]
            if flags and body[place + 1 :]:
                yield from self._guarded(body[place + 1 :], flags)
                return

    def _guarded(self, body: Sequence[Any], flags: Sequence[str]) -> Iterator[str]:
        lines = self._lines(body)
        return _block(f"if ({' && '.join(flags)})", lines) if flags else lines

    def _statement(self, node: Any) -> Iterable[str]:
        text = self._expressions.text
        match node:
            case ast.Assign(targets=[target], value=value):
                return self._assignment(node, target, value)
            case ast.AugAssign(target=target):
                return [self._assigned(target, ast.copy_location(ast.BinOp(target, node.op, node.value), node), "=")]
            case ast.If():
                return self._if(node)
            case ast.Match():
                return self._match(node)
            case ast.For():
                return self._for(node)
            case ast.Break() | ast.Continue() if self._loops:
                return [f"{dict(self._flags(self._loops[-1]))[type(node)]} = 0;"]
            case ast.Return(value=value):
                return self._return(node, value)
            case ast.Expr(value=ast.Constant(value=value)):
                return _comment(value) if isinstance(value, str) else [""]
            case ast.Expr(value=ast.Call() as call) if getattr(call.func, "obj", None) is print:
                return self._print(call)
            case ast.Expr(value=ast.Call() as call) if not getattr(getattr(call, "tree", None), "hasReturn", True):
                return [f"{text(call)};"]
            case ast.Assert(test=test):
                return _block(f"if (!({text(test)}))", ['$display("*** AssertionError ***");'])
            case ast.Raise():
                return [f"$display({_quoted(f'*** {ast.unparse(node)} ***')});"]
            case ast.Pass():
                return ["// pass"]
            case ast.While() | ast.Break() | ast.Continue() | ast.Expr(value=ast.Yield()):
                reason = ("synthesis has no such loop; write for with a range of numbers, or one `while True:` around "
                          "all of an @instance, with one yield at its head")  # fmt: skip
            case ast.Expr(value=value):
                reason = f"{ast.unparse(value)} changes nothing; assign it to something, or remove it"
            case _:
                reason = f"Verilog has no {ast.unparse(node).splitlines()[0]}; write it otherwise"
        self._expressions.refuse(node, reason)

    def _assigned(self, target: Any, value: Any, arrow: str) -> str:
        return f" {arrow} ".join(self._expressions.assigned(target, value)) + ";"

    def _assignment(self, node: Any, target: Any, value: Any) -> Iterator[str]:
        """Yield an assignment; one of a word of a table becomes a case."""
        is_next = _is_next(target)
        arrow = "<=" if is_next and not internals.is_combinational(self._tree) else "="
        index: Any = value.slice if isinstance(value, ast.Subscript) else None
        table = table_of(getattr(value.value, "obj", None)) if isinstance(index, ast.expr) else None
        if not table or self._expressions.constant(value) is not None:
            driven = is_next and internals.assigned(self._tree)
            yield "assign " * driven + self._assigned(target, value, arrow)
            return
        if self._expressions.range(index).low < 0:
            self._expressions.refuse(node, "the index may be below 0; give it a range without a sign")
        yield f"case ({self._expressions.text(index)})"
        for place, number in enumerate(table):
            line = self._assigned(target, ast.copy_location(ast.Constant(number), node), arrow)
            yield f"    {place if place < len(table) - 1 else 'default'}: {line}"
        yield "endcase"

    def _print(self, node: Any) -> Iterator[str]:
        """Yield the system tasks for a print, part by part, as MyHDL has cut its text."""
        arguments = iter(node.args)
        for part in node.format:
            if isinstance(part, str):
                yield f"$write({_quoted(part)});"
                continue
            argument = next(arguments)
            if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
                yield f"$write({_quoted(argument.value)});"
                continue
            text, known = self._expressions.text(argument), getattr(argument, "obj", None)
            if part.conv is str and isinstance(known, bool):
                yield from (f"if ({text})", '    $write("True");', "else", '    $write("False");')
            elif isinstance(known, EnumItemType):
                names = [f"    'b{code}: $write({_quoted(name)});" for name, code in internals.states_of(known).items()]
                yield from (f"case ({text})", *names, "endcase")
            else:
                form = "%0d" if part.conv is int or isinstance(known, int) else "%h"
                yield f'$write("{form}", {text});'
        yield '$write("\\n");'

    def _for(self, node: Any) -> Iterator[str]:
        name, (start, stop, step) = node.target.id, self._expressions.loop(node)
        going, change = ("<", "+") if step > 0 else (">=", "-")
        if step < 0:
            stop = ast.copy_location(ast.BinOp(stop, ast.Add(), ast.Constant(1)), node)
        flags = dict(self._flags(node))
        if ast.Break in flags:
            yield f"{flags[ast.Break]} = 1;"
        first, end = [self._expressions.text(bound) for bound in (start, stop)]
        self._loops.append(node)
        with self._expressions.within(node):
            lines = [f"{flags[ast.Continue]} = 1;"] if ast.Continue in flags else []
            lines += self._guarded(node.body, [flag for kind, flag in flags.items() if kind is ast.Break])
        self._loops.pop()
        yield from _block(f"for ({name}={first}; {name}{going}{end}; {name}={name}{change}{abs(step)})", lines)

    def _flags(self, loop: Any, within: Any = None) -> list[tuple[type, str]]:
        """Return the flags of a loop's breaks and continues, for those within a statement."""
        kinds = {ast.Break: "goes_on", ast.Continue: "is_on"}
        found = {type(node) for node in _own_nodes(within or loop, within is None)}
        names = {kind: f"{loop.target.id}_{text}" for kind, text in kinds.items() if kind in found}
        return [(kind, name + "_" * (name in self._names)) for kind, name in names.items()]

    def _if(self, node: Any) -> Iterator[str]:
        if node.ignore:  # if __debug__
            yield ""
            return
        if node.isCase:
            yield from self._inferred_case(node)
            return
        with ExitStack() as before:
            for place, (test, body) in enumerate(node.tests):
                head = f"{'else ' * bool(place)}if ({self._expressions.text(test)})"
                with self._expressions.where(test, True, node):
                    yield from _block(head, self._lines(body))
                before.enter_context(self._expressions.where(test, False, node))
            if node.else_:
                yield from _block("else", self._lines(node.else_))

    def _inferred_case(self, node: Any) -> Iterator[str]:
        """Yield the cases of an `if` that compares one signal with different values."""
        where = self._expressions.where
        cases: list[tuple[str, Any, Any]] = [
            (self._expressions.case(node.caseVar, test.case[1]), body, where(test, False, node))
            for test, body in node.tests
        ]
        if node.else_:
            cases.append(("default", node.else_, nullcontext()))
        elif node.isFullCase and internals.is_combinational(self._tree):
            cases[-1] = "default", *cases[-1][1:]  # a code that no state has would keep values
        return self._cases(node.caseVar, cases)

    def _match(self, node: Any) -> Iterator[str]:
        cases = [(self._pattern(node, case), case.body, nullcontext()) for case in node.cases]
        if self._is_full(node):
            cases[-1] = "default", *cases[-1][1:]  # a code that no state has would keep values
        return self._cases(node.subject, cases)

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

    def _cases(self, subject: Any, cases: Sequence[tuple[str, Any, Any]]) -> Iterator[str]:
        """Yield cases: each one's value, its body, and the context of those that follow it."""
        yield f"case ({self._expressions.text(subject)})"
        with ExitStack() as before:
            for text, body, passed in cases:
                yield from _indented(_block(f"{text}:", self._lines(body)))
                before.enter_context(passed)
        yield "endcase"

    def _return(self, node: Any, value: Any) -> list[str]:
        if not self._function:
            self._expressions.refuse(
                node, "synthesis refuses return in a process; write if and else around what it skips"
            )
        if value is None:
            return []
        known = self._tree.returnObj
        bits = getattr(known, "_nrbits", 1 if isinstance(known, bool) else 32)
        self._expressions.check_integer(value, known.val if isinstance(known, SignalType) else known, "the result")
        return [f"{self._function} = {self._expressions.text(value, bits)};"]

    def _end_in_returns(self, body: list[Any]) -> None:
        """Move what follows an `if` with a return into its other branches, so that nothing is skipped."""
        for place, statement in enumerate(body):
            if isinstance(statement, ast.Return):
                del body[place + 1 :]
            elif any(isinstance(part, ast.Return) for part in ast.walk(statement)):
                if not isinstance(statement, ast.If):
                    reason = "Verilog has no return within a loop; assign the result, and return it last"
                    self._expressions.refuse(statement, reason)
                rest = body[place + 1 :]
                del body[place + 1 :]
                for branch in branches_of(statement, False):
                    branch.extend(rest)
                    self._end_in_returns(branch)


def _indented(lines: Iterable[str]) -> Iterator[str]:
    return (f"    {line}" for line in lines)


def _block(head: str, lines: Iterable[str], label: str = "") -> Iterator[str]:
    """Yield statements with what is before their `begin`."""
    yield f"{head} begin{label}"
    yield from _indented(lines)
    yield "end"


def _comment(text: str | None) -> list[str]:
    return [f"// {line}" for line in inspect.cleandoc(text).split("\n")] if text is not None else []


def _own_nodes(node: Any, inside: bool = False) -> Iterator[ast.AST]:
    """Yield a statement and its parts, except those of loops in it."""
    yield node
    if inside or not isinstance(node, ast.For):
        for child in ast.iter_child_nodes(node):
            yield from _own_nodes(child)


def _names(node: ast.AST) -> set[str]:
    """Return the names in a statement or an expression."""
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}


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
