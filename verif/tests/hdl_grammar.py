# SPDX-License-Identifier: MIT
"""Random MyHDL programs for the differential test of the converter, drawn from a grammar by Hypothesis.

The grammar follows the range of each expression, so that a signal can hold what is assigned to it. It knows nothing of
the converter, which may refuse a program.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from textwrap import indent
from typing import Any

from hypothesis import strategies as st

PRELUDE = """\
from myhdl import *

from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import Signed, tied


ON, OFF = True, False


def bit(value=0):
    return Signal(bool(value))


def u(width, value=0):
    return Signal(intbv(value)[width:])


def s(width, value=0):
    return Signal(intbv(value, min=-(1 << width - 1), max=1 << width - 1))


"""
"""Beginning of each program."""

WIDTHS = (4, 1, 2, 3, 5, 6, 7, 8, 4, 3, 16, 20, 31, 32, 33)
NUMBERS = (1, 0, 2, 3, 4, 5, 7, 8, 15, 16, -1, -2, -3, -8, 100, 255, (1 << 31) - 1, 1 << 31, -1 << 31, 1 << 32)
DIVISORS = (2, 1, 4, 8, 16, 3, 5, 7, 10, -2)
WIDEST = 42
BINARY = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, ">>": operator.rshift, "<<": operator.lshift,
    "//": operator.floordiv,
}  # fmt: skip
"""Operators with extremes where their operands have them."""

KINDS = ("comb", "clocked", "seq")
RESETS = ("", *(f"ResetSignal({1 - on}, active={on}, isasync={late})" for late in (False, True) for on in (1, 0)))
STATES = ("IDLE", "RUN", "STOP", "PAUSE")
ODD_STATES = ("end", "go0", "count", "clk", "begin", "a", *STATES)
ODD_NAMES = ("begin", "count", "output", "größe", "top", "automatic", "IDLE")
"""Names that Verilog may not accept, or that something else may have."""

ODD_STATEMENTS = (
    "pass", "print('seen')", "print({0})", "print('seen', {0})", "print('a \"seen\" one')", f"print('{'seen ' * 30}')",
    "print(f'{{{0}}}')", "m: int = 3", "assert {0} < 99", "if (m := {0}):\n    pass", "for _ in range(2):\n    m = {0}",
)  # fmt: skip


@dataclass(frozen=True)
class Value:
    """An expression that needs no parentheses, with the range of its values."""

    text: str
    low: int
    high: int
    bits: int = 0
    """Width of what Python can cut, else 0."""

    signal: bool = False

    @property
    def width(self) -> int:
        """Number of bits that hold the range."""
        return max(self.low.bit_length(), self.high.bit_length(), 1) + (self.low < 0)


@dataclass
class Scope:
    """Things that an expression can use: values, lists and tuples with their length, functions with their arguments."""

    values: list[Value] = field(default_factory=list)
    words: list[tuple[Value, int]] = field(default_factory=list)
    functions: list[tuple[Value, list[Value]]] = field(default_factory=list)


def full(width: int, signed: bool = False, text: str = "") -> Value:
    """Return a value with the range of a width."""
    half = 1 << width - 1
    return Value(text, -half if signed else 0, half - 1 if signed else 2 * half - 1, width)


def hull(text: str, *values: Value) -> Value:
    """Return a value with a range that contains those of others."""
    return Value(text, min(one.low for one in values), max(one.high for one in values))


def tabbed(lines: Sequence[str]) -> list[str]:
    """Indent lines."""
    return indent("\n".join(lines), "    ").split("\n")


def variable(value: Value, begin: int = 0) -> str:
    """Return the constructor of a variable."""
    kind = f", min={value.low}, max={value.high + 1})" if value.low < 0 else f")[{value.bits}:]"
    return f"intbv({begin}{kind}"


def made(value: Value, begin: int = 0) -> str:
    """Return the constructor of a signal."""
    kind = "bit(" if not value.bits else f"{'s' if value.low < 0 else 'u'}({value.bits}{', ' if begin else ''}"
    return f"{kind}{begin or ''})"


def reads(text: str, name: str) -> bool:
    """Return True if a text mentions a name, except to assign it."""
    return bool(re.search(rf"(?<![\w.]){re.escape(name)}\b(?!(?:\[[^]]*\])?\.next\b)", text))


class Program:
    """A program while it is drawn."""

    def __init__(self, draw: Callable[[st.SearchStrategy], Any]):
        self._draw = draw
        self._names: dict[str, int] = {}
        self.texts: list[str] = []
        """Enumerations, classes and blocks, except the top."""

    def number(self, low: int, high: int) -> int:
        """Draw a number; the lowest is the simplest."""
        return self._draw(st.integers(low, high))

    def one_of(self, *options: Any) -> Any:
        """Draw one of some options; the first is the simplest."""
        return options[self.number(0, len(options) - 1)]

    def once_in(self, count: int) -> bool:
        """Draw True rarely."""
        return self.number(1, count) == count

    def name(self, stem: str) -> str:
        """Return a new name."""
        self._names[stem] = self._names.get(stem, -1) + 1
        return f"{stem}{self._names[stem]}"


class Expressions:
    """Grammar of expressions."""

    def __init__(self, program: Program):
        self.program, self.scope = program, Scope()
        self.number, self.one_of = program.number, program.one_of
        self.once_in, self.name = program.once_in, program.name

    @contextmanager
    def inner_scope(self, scope: Scope | None = None) -> Iterator[None]:
        """Make a context whose variables end with it."""
        before = self.scope
        self.scope = scope or Scope([*before.values], [*before.words], [*before.functions])
        yield
        self.scope = before

    def expression(self, depth: int | None = None) -> Value:
        """Draw an expression; without a depth, one that stands alone."""
        forms = [self.arithmetic] * 3 + [self.logic, self.shift] * 2
        forms += [self.unary, self.comparison, self.joined, self.quotient, self.call, self.bits_of_expression]
        # A choice within an expression is mostly refused.
        forms += [self.choice] * (depth is None or self.once_in(8)) + [self.quotient] * (2 * (depth is None))
        depth = self.one_of(1, 2, 1) if depth is None else depth
        if depth == 0 or self.once_in(4):
            return self.one_of(self.named, self.named, self.constant, self.part, self.word)()
        value = self.one_of(*forms)(depth - 1)
        return value if value.width <= WIDEST else self.named()

    def named(self) -> Value:
        return self.one_of(*self.scope.values)

    def constant(self) -> Value:
        number = self.one_of(*NUMBERS)
        return Value(f"({number})" if number < 0 else str(number), number, number)

    def part(self) -> Value:
        wide = [value for value in self.scope.values if value.bits > 1]
        return self.part_of(self.one_of(*wide)) if wide else self.named()

    def bits_of_expression(self, depth: int) -> Value:
        one = self.one_of(self.joined, self.logic, self.shift, self.call)(depth)
        return self.part_of(one) if one.bits > 1 and self.once_in(20) else one

    def part_of(self, value: Value) -> Value:
        """Draw a bit or a slice."""
        form = self.one_of("bit", "slice", "signed slice", "index", "signed", "moving slice")
        named = value.text[0] != "(" or self.once_in(8)
        if form == "bit":
            return Value(f"{value.text}[{self.number(0, value.bits - 1)}]", 0, 1)
        if form == "index":
            width = max(value.bits.bit_length() + (1 if self.once_in(6) else -1), 1)  # rarely beyond the last bit
            return Value(f"{value.text}[{self.fitted(self.expression(0), full(width)).text}]", 0, 1)
        if form == "signed" and named:
            return full(value.bits, True, f"{value.text}.signed()")
        low = self.number(0, value.bits - 1)
        if form == "moving slice":
            width = max(value.bits - low + (1 if self.once_in(6) else -1), 1)  # rarely beyond the last bit
            at = self.fitted(self.expression(0), full(max((low + 1).bit_length() - 1, 1))).text
            return full(width, False, f"{value.text}[{at} + {width}:{at}]")
        high = self.number(low + 1, value.bits)
        signed = form == "signed slice" and named
        return full(high - low, signed, f"{value.text}[{high}:{low or ''}]{'.signed()' * signed}")

    def word(self) -> Value:
        """Draw an element of a list or a tuple."""
        if not self.scope.words:
            return self.named()
        words, count = self.one_of(*self.scope.words)
        index = self.number(0, count - 1) if self.once_in(3) else self.index(count)
        return replace(words, text=f"{words.text}[{index}]", signal=False)

    def index(self, count: int) -> str:
        return self.fitted(self.expression(0), full(max(count.bit_length() - 1, 1))).text

    def binary(self, one: Value, sign: str, other: Value) -> Value:
        values = [BINARY[sign](a, b) for a in (one.low, one.high) for b in (other.low, other.high)]
        return Value(f"({one.text} {sign} {other.text})", min(values), max(values))

    def arithmetic(self, depth: int, one: Value | None = None) -> Value:
        return self.binary(one or self.expression(depth), self.one_of(*"+-*"), self.expression(depth))

    def shift(self, depth: int) -> Value:
        one, places = self.expression(depth), self.fitted(self.expression(0), full(self.number(1, 3)))
        value = self.binary(one, self.one_of(">>", "<<"), places)
        return replace(value, bits=value.width * bool(one.bits))

    def quotient(self, depth: int) -> Value:
        one, divisor = self.expression(depth), self.one_of(*DIVISORS)
        one = one if one.low >= 0 or self.once_in(8) else self.fitted(one, full(min(one.width, 8)))
        by = Value(self.divisor(divisor), divisor, divisor)
        if self.one_of("%", "%", "//") == "//":
            return self.binary(one, "//", by)
        return Value(f"({one.text} % {by.text})", min(divisor + 1, 0), max(divisor - 1, 0))

    def divisor(self, number: int) -> str:
        power = number > 0 and number & number - 1 == 0 and self.once_in(2)
        return f"(1 << {number.bit_length() - 1})" if power else f"({number})" if number < 0 else str(number)

    def logic(self, depth: int) -> Value:
        one, other, sign = self.expression(depth), self.expression(depth), self.one_of(*"&|^")
        signed = one.low < 0 or other.low < 0
        value = full(max(part.width + (part.low >= 0) * signed for part in (one, other)), signed)
        if sign == "&" and max(one.low, other.low) >= 0:
            value = replace(value, low=0, high=min(part.high for part in (one, other) if part.low >= 0))
        return replace(value, text=f"({one.text} {sign} {other.text})", bits=value.width * bool(one.bits or other.bits))

    def unary(self, depth: int) -> Value:
        form = self.one_of("-", "~", "int", "not ", "bool")
        truth = form in ("not ", "bool") and not self.once_in(8)
        one = self.comparison(depth) if truth else self.expression(depth)
        text = f"{form}({one.text})" if form in ("int", "bool") else f"({form}{one.text})"
        if form == "int":
            return Value(text, one.low, one.high)
        if form == "-":
            return Value(text, -one.high, -one.low)
        if form == "~":  # the bits of an unsigned intbv, and all bits of an integer
            return replace(hull(text, full(one.width), Value("", ~one.high, ~one.low)), bits=one.bits)
        return Value(text, 0, 1)

    def comparison(self, depth: int) -> Value:
        one = self.expression(depth).text
        if self.once_in(50):
            return Value(f"({one} in ({self.one_of(*NUMBERS)}, {self.one_of(*NUMBERS)}))", 0, 1)
        sign = self.one_of("==", "<", ">", "<=", ">=", "!=")
        return Value(f"({one} {sign} {self.expression(depth).text})", 0, 1)

    def truth(self, depth: int) -> Value:
        """Draw a comparison, a bit, or two of them joined by an operator of bits."""
        wide = [value for value in self.scope.values if value.bits > 1]
        one, other = (f"{self.one_of(*wide).text}[0]" if wide else self.comparison(depth).text for _ in range(2))
        joined = Value(f"({one} {self.one_of(*'&|^', 'and', 'or')} {other})", 0, 1)
        return self.one_of(self.comparison(depth), Value(one, 0, 1), joined)

    def condition(self) -> str:
        """Draw an expression for its truth."""
        if self.once_in(3):
            return self.expression(1).text
        one, other = self.comparison(1).text, (self.expression if self.once_in(40) else self.comparison)(0).text
        if self.once_in(30):
            return self.one_of(f"ON or {one}", f"OFF and {one}", f"not OFF and {one}")
        return one if self.once_in(2) else f"({one} {self.one_of('and', 'or')} {other})"

    def choice(self, depth: int) -> Value:
        other = self.expression(depth)
        with self.limited() as condition:
            one = self.expression(depth)
        return hull(f"({one.text} if {condition} else {other.text})", one, other)

    @contextmanager
    def limited(self) -> Iterator[str]:
        """Draw a condition, and make a context of what is true under it."""
        if not self.once_in(3):
            yield self.condition()
            return
        name = self.named()
        low = self.number(name.low, name.high)
        with self.inner_scope():
            kept = [value for value in self.scope.values if value.text != name.text]
            less = Value(f"({name.text} - {low})" if low > 0 else name.text, min(low, 0), name.high - max(low, 0))
            self.scope.values = [*kept, replace(name, low=low), less]
            yield self.one_of(f"{name.text} >= {low}", f"{low - 1} < {name.text} <= {name.high}")

    def joined(self, depth: int) -> Value:
        known = [value for value in self.scope.values if value.bits and value.low >= 0]
        parts = [self.one_of(*known) if known and not self.once_in(3) else self.truth(depth) for _ in range(2)]
        return full(sum(part.bits or 1 for part in parts), False, f"concat({', '.join(part.text for part in parts)})")

    def call(self, depth: int) -> Value:
        if not self.scope.functions:
            return self.expression(depth)
        result, arguments = self.one_of(*self.scope.functions)
        texts = [self.fitted(self.expression(depth), argument).text for argument in arguments]
        return replace(result, text=f"{result.text}({', '.join(texts)})")

    def fitted(self, value: Value, into: Value) -> Value:
        """Return a value if it fits into the range of a width, else a name that does or a part of the value."""
        fitting = [one for one in self.scope.values if into.low <= one.low and one.high <= into.high]
        if into.low <= value.low and value.high <= into.high:
            return value
        if fitting and self.once_in(2):
            return self.one_of(*fitting)
        size = (into.high - into.low).bit_length()
        if value.bits > size and value.text[-1] != ")" and self.once_in(2):
            text = f"{value.text}[{size}:]"
        elif self.once_in(2 if value.low >= 0 else 10):
            text = f"({value.text} % {self.divisor(1 << size)})"
        else:
            text = f"({value.text} & {(1 << size) - 1})"
        return Value(f"({text} - {-into.low})" if into.low else text, into.low, into.high)

    def bit(self) -> str:
        """Draw an expression of one bit."""
        return self.fitted(self.expression(), full(1)).text


class Block(Expressions):
    """Grammar of blocks: signals, and parts that drive them."""

    def __init__(self, program: Program, reset: bool, depth: int = 0):
        super().__init__(program)
        self.reset, self.depth = reset, depth
        self.declared: list[str] = []
        self.parts: list[str] = []
        """Functions, processes and instances."""

        self.made: dict[str, Value] = {}
        """Signals that a process or an instance drives, by name."""

        self.hidden: list[Value] = []
        """Values that are no ports, so that something must read them."""

    def declare(self, value: Value, exact: bool = False) -> Value:
        """Add a signal with a range, or with a larger one."""
        width = min(value.width + (0 if exact else self.one_of(0, 1, 0, 4)), WIDEST + 4)
        signal = replace(full(width, value.low < 0, value.text), signal=True)
        if signal.high == 1 and not exact and not self.once_in(3):
            signal = replace(signal, bits=0)
        self.made[value.text] = signal
        self.scope.values.append(signal)
        return signal

    def assigned(self, name: str, ranges: dict[str, Value], depth: int | None = None) -> str:
        """Draw an assignment; the ranges of signals without width become larger."""
        value, known = self.expression(depth), ranges.get(name)
        if known and known.bits:
            return f"{name}.next = {self.fitted(value, known).text}"
        ranges[name] = hull(name, value, *filter(None, [known]))
        return f"{name}.next = {value.text}"

    def statements(self, names: Sequence[str], ranges: dict[str, Value], holds: bool, depth: int = 2) -> list[str]:
        """Draw statements that assign all names, or perhaps not if their signals hold their values."""

        def inner(holds: bool = holds) -> list[str]:
            with self.inner_scope():
                return tabbed(self.statements(names, ranges, holds, depth - 1))

        form = self.one_of("plain", "plain", "if", "if", "default", self.variable, self.integer, self.task)
        if depth == 0 or form == "plain":
            lines = [self.assigned(name, ranges) for name in names if not (holds and self.once_in(5))]
            if len(lines) > 1 and self.once_in(3):
                sides = zip(*(line.split(" = ", 1) for line in lines), strict=True)
                return [" = ".join(map(", ".join, sides))]
            return lines or ["pass"]
        if form == "default":
            lines = [self.assigned(name, ranges, 1) for name in names]
            return [*lines, f"if {self.condition()}:", *inner(True)]
        if form == "if":
            with self.limited() as condition:
                lines = [f"if {condition}:", *inner()]
            lines += [f"elif {self.condition()}:", *inner()] if self.once_in(3) else []
            return lines + ([] if self.once_in(2 if holds else 20) else ["else:", *inner()])
        odd = [self.one_of(*ODD_STATEMENTS).format(self.expression(0).text)] if self.once_in(20) else []
        return odd + form() + self.statements(names, ranges, holds, depth - 1)

    def variable(self) -> list[str]:
        name, value = self.name("v"), self.expression()
        whole = full(value.width + self.one_of(0, 1), value.low < 0, name)
        self.scope.values.append(whole)
        lines = [f"{name} = {variable(whole)}", f"{name}[:] = {value.text}"]
        form = self.one_of("", "", "if", "bit", "+=", "same" if self.once_in(6) else "")
        if form == "if":
            lines += [f"if {self.condition()}:", f"    {name}[:] = {self.fitted(self.expression(), whole).text}"]
        elif form == "bit" and whole.low == 0:
            lines += [f"{name}[{self.number(0, whole.bits - 1)}] = {self.bit()}"]
        elif form == "same":
            lines += [f"{name} = {self.named().text}{self.one_of('', '.val')}"]
        elif form == "+=" and whole.low == 0:
            lines += [f"{name} >>= 1", f"{name} {self.one_of(*'+|^')}= {self.bit()}"]
        return lines

    def integer(self) -> list[str]:
        """Draw a number in a variable, perhaps one that a loop counts."""
        name, times, loop = self.name("n"), self.number(1, 4), self.name("k")
        if self.once_in(2):
            value = (self.expression if self.once_in(6) else self.arithmetic)(1)
            self.scope.values.append(Value(name, value.low, value.high))
            return [f"{name} = 0", f"{name} = {value.text}"]
        wide = [value.text for value in self.scope.values if value.bits >= times]
        with self.inner_scope():
            self.scope.values.append(Value(loop, 0, times - 1))
            asked = f"{self.one_of(*wide)}[{loop}]" if wide and self.once_in(2) else self.condition()
            step = self.expression(1)
        step = step if step.width < 30 else Value("1", 1, 1)
        add = f"    {name} += {step.text}" if self.once_in(2) else f"    {name} = {name} + {step.text}"
        leave = [f"    {self.one_of('break', 'continue')}"] if self.once_in(6) else []
        lines, runs = [f"if {asked}:", add, *leave], times
        if self.once_in(3):
            bounds = self.one_of(f"{loop}", f"{loop}, {times}", f"{times}, {loop}, -1")
            lines, runs = [f"for {self.name('j')} in range({bounds}):", *tabbed(lines)], times * times
        self.scope.values.append(Value(name, min(0, runs * step.low), max(0, runs * step.high)))
        return [f"{name} = 0", f"for {loop} in range({times}):", *tabbed(lines)]

    def task(self) -> list[str]:
        """Draw a variable, and the call of a function that changes it."""
        lines, task = self.variable(), self.name("change")
        value = self.scope.values[-1]
        with self.inner_scope(Scope([replace(value, text="v")])):
            self.parts.append(f"def {task}(v):\n    v[:] = {self.fitted(self.expression(), value).text}")
        return [*lines, f"{task}({value.text})"]

    def process(self, kind: str, lines: Sequence[str]) -> None:
        """Add a process."""
        if not any(value.signal and reads("\n".join(lines), value.text) for value in self.scope.values):
            kind = "clocked" if kind == "comb" else kind  # as it would wait for nothing
        name = self.one_of(*ODD_NAMES) if self.once_in(40) else self.name("go")
        edge = "negedge" if self.once_in(20) else "posedge"
        decorators = {"comb": "@always_comb", "clocked": f"@always(clk.{edge})", "instance": "@instance"}
        seq = f"@always_seq(clk.{edge}, reset={'reset' if self.reset else None})"
        self.parts.append("\n".join([decorators.get(kind, seq), f"def {name}():", *tabbed(lines)]))

    def a_process(self, *names: str, draw: Callable[[], Value] | None = None) -> None:
        """Draw a process; it drives new signals, or those of an interface, with any values or with a certain one."""
        kind, ranges = self.one_of(*KINDS), {}
        new = [] if names else [self.name("y") for _ in range(1 if draw else self.one_of(1, 1, 2))]
        if new and kind != "comb" and not draw and self.once_in(2):  # may depend on itself
            for name in new:
                ranges[name] = self.declare(full(self.one_of(4, 1, 3, 8), self.once_in(3), name), True)
        with self.inner_scope():
            if draw:
                value = draw()
                value = self.arithmetic(0, value) if self.once_in(2) else value
                ranges[new[0]], lines = value, [f"{new[0]}.next = {value.text}"]
            else:
                lines = self.statements([*names, *new], ranges, kind != "comb")
            for name in (*names, *new):
                lines += [] if f"{name}.next" in "\n".join(lines) else [self.assigned(name, ranges)]
        self.process(kind, lines)
        for name in (*names, *new):
            if name not in self.made:
                self.declare(replace(ranges[name], text=name))

    def an_instance(self) -> None:
        """Draw a process with a variable that keeps its value."""
        name, kept, ranges = self.name("y"), full(self.one_of(4, 2, 3, 8), False, self.name("v")), {}
        with self.inner_scope():
            self.scope.values.append(kept)
            lines = [self.assigned(name, ranges), f"{kept.text}[:] = {self.fitted(self.expression(), kept).text}"]
        first = f"{kept.text} = {variable(kept, self.number(0, kept.high))}"
        self.process("instance", [first, "while True:", *tabbed(["yield clk.posedge", *lines])])
        self.declare(ranges[name])

    def by_parts(self) -> None:
        """Draw a process that assigns a signal by its bits."""
        name, half, loop = self.name("y"), self.number(1, 4), self.name("k")
        wide = [value.text for value in self.scope.values if value.bits >= 2 * half]
        form = self.one_of("halves", "bits", "half", *["pairs"] * bool(wide))
        one, other = (self.fitted(self.expression(), full(half)).text for _ in range(2))
        if self.once_in(8):
            other = f"({one} - 1)"  # may be below 0
        if form == "halves":
            lines = [f"{name}.next[{2 * half}:{half}] = {one}", f"{name}.next[{half}:] = {other}"]
        elif form == "half":
            lines = [self.one_of(f"{name}.next[{half}:] = {one}", f"{name}[{half}:].next = {one}")]
        else:
            with self.inner_scope():
                self.scope.values.append(Value(loop, 0, half - 1))
                bits = f"[{loop}] = {self.bit()}"
            pair = f"[2*{loop}+2:2*{loop}]"
            bits = bits if form == "bits" else f"{pair} = {self.one_of(*wide)}{pair}"
            lines = [f"for {loop} in range({half}):", f"    {name}.next{bits}"]
        self.process(self.one_of("comb", "clocked"), lines)
        self.declare(full(half if form == "bits" else 2 * half, False, name), True)

    def a_machine(self) -> None:
        """Draw a state machine."""
        kind, state, order = self.name("states"), self.name("state"), self.name("order")
        pool = ODD_STATES if self.once_in(8) else STATES
        names = list(dict.fromkeys(["IDLE", *(self.one_of(*pool) for _ in range(3))]))
        self.program.texts.append(f"{kind} = enum({', '.join(map(repr, names))})")

        def some() -> str:
            return f"{kind}.{self.one_of(*names)}"

        lines = [f"if {state} == {some()}:", *tabbed([f"if {self.condition()}:", f"    {state}.next = {some()}"])]
        lines += ["else:", f"    {state}.next = {some()}"]
        if self.once_in(8):
            self.declared.append(f"{order} = ({some()}, {some()}, {some()}, {some()})")
            lines = [f"{state}.next = {order}[{self.index(4)}]"]
        self.declared.append(f"{state} = Signal({some() if self.once_in(3) else f'{kind}.IDLE'})")
        self.process(self.one_of("seq", "clocked"), lines)
        self.a_process(draw=lambda: Value(f"({state} == {some()})", 0, 1))

    # Functions, tuples and lists.

    def a_function(self) -> None:
        """Draw a function with a result, and a process that calls it."""
        name, form = self.name("f"), self.one_of("variable", "variable", "number", "early")
        arguments = [full(self.one_of(4, 2, 3, 8), self.once_in(3), text) for text in "xz"[: self.number(1, 2)]]
        with self.inner_scope(Scope([replace(one, bits=0) for one in arguments], [], self.scope.functions)):
            one, other, asked = self.expression(), self.expression(), self.condition()
        whole = full(hull("", one, other).width, one.low < 0 or other.low < 0, name)
        lines = [f"return {one.text}"]
        if form == "variable":
            lines = [f"result = {variable(whole)}", f"result[:] = {one.text}", "return result"]
        if form == "early":
            lines = [f"if {asked}:", *tabbed(lines), f"return {other.text}"]
        self.parts.append("\n".join([f"def {name}({', '.join(one.text for one in arguments)}):", *tabbed(lines)]))
        self.scope.functions.append((replace(whole, bits=whole.bits * (form == "variable")), arguments))
        self.a_process(draw=lambda: self.call(1))

    def a_tuple(self) -> None:
        """Draw a tuple of numbers or of signals, and a process that reads it."""
        signals = [value for value in self.scope.values if value.signal]
        draw = self.named if signals and self.once_in(8) else self.constant
        some = [draw() for _ in range(self.one_of(4, 2, 8))]
        whole = hull(self.name("table"), *some)
        self.parts.append(f"{whole.text} = ({', '.join(one.text for one in some)})")
        self.scope.words.append((whole, len(some)))
        self.a_process(draw=self.word)

    def a_list(self) -> None:
        """Draw a list of signals; processes here or in inner blocks write and read it."""
        words, count = full(self.one_of(4, 1, 2, 8), self.once_in(4), self.name("words")), self.one_of(2, 3, 4)
        begins = [self.number(0, words.high) * self.once_in(2) for _ in range(count)]
        texts = ", ".join(made(words, begin) for begin in begins)
        texts = texts if any(begins) else f"{made(words)} for _ in range({count})"
        self.declared.append(f"{words.text} = [{texts}]")
        write = self.one_of(Block.write_word, Block.write_all, Block.write_two)

        def read(block: Block) -> None:
            block.scope.words = [(words, count)]
            block.a_process(draw=block.word)

        for draw in (lambda block: write(block, words, count), read):
            if self.depth == 0 and self.once_in(4):
                self.inner_block(draw, words.text)
            else:
                with self.inner_scope():
                    draw(self)
        self.scope.words.append((words, count))
        self.scope.values += [signal for signal in self.made.values() if signal not in self.scope.values]

    def element(self, words: Value, index: object) -> str:
        return f"{words.text}[{index}].next = {self.fitted(self.expression(), words).text}"

    def write_word(self, words: Value, count: int) -> None:
        """Add a process that writes the element of an index, or two."""
        for _ in range(2 if self.once_in(12) else 1):
            lines = [self.element(words, self.index(count))]
            lines = [f"if {self.condition()}:", *tabbed(lines)] if self.once_in(2) else lines
            self.process(self.one_of("clocked", "clocked", "seq"), lines)

    def write_all(self, words: Value, count: int) -> None:
        """Add a process that writes all elements."""
        loop, kind = self.name("k"), self.one_of(*KINDS)
        lines = [f"for {loop} in range(1, {count}):", f"    {words.text}[{loop}].next = {words.text}[{loop} - 1]"]
        lines.append(self.element(words, 0))
        if kind == "comb" or self.once_in(2):
            with self.inner_scope():
                self.scope.values.append(Value(loop, 0, count - 1))
                lines = [f"for {loop} in range({count}):", f"    {self.element(words, loop)}"]
        self.process(kind, lines)

    def write_two(self, words: Value, count: int) -> None:
        """Add two processes that write parts of a list."""
        for indices in (range(1), range(1, count)):
            self.process(self.one_of(*KINDS), [self.element(words, index) for index in indices])

    # Signals made of others, and groups of signals.

    def a_shadow(self) -> None:
        """Draw a constant, a slice of a signal, signals side by side, or a register that begins as a signal."""
        signals = [value for value in self.scope.values if value.signal and value.bits > 1 and value.low == 0]
        name, form = self.name("part"), self.one_of("slice", "joined", "tied", "copy", "copy") if signals else "tied"
        some = [self.one_of(*signals) for _ in range(self.one_of(2, 3, 1))] if signals else []
        if form == "tied":
            text, value = f"tied({self.number(0, 3)}, 3)", full(3)
        elif form == "slice":
            low = self.number(0, some[0].bits - 1)
            high = self.number(low + 1, some[0].bits)
            text, value = f"{some[0].text}({high}, {low})", full(high - low)
        elif form == "joined":
            text, value = f"ConcatSignal({', '.join(one.text for one in some)})", full(sum(one.bits for one in some))
        else:
            text, value = f"Signal({some[0].text}.val)", some[0]
        if value.bits > WIDEST:
            return
        self.parts.append(f"{name} = {text}")
        if form == "copy":
            self.process(self.one_of("clocked", "seq"), [f"{name}.next = {some[0].text}"])
        self.hidden.append(replace(value, text=name, signal=True))
        self.scope.values.append(self.hidden[-1])

    def a_record(self) -> None:
        """Draw a record, joined from signals."""
        signals = [value for value in self.scope.values if value.signal and value.bits > 1]
        if not signals:
            return
        record, some = self.name("item"), {name: self.one_of(*signals) for name in ("one", "other")}
        kinds = (f'"{name}": {f"Signed({one.bits})" if one.low < 0 else one.bits}' for name, one in some.items())
        self.declared.append(f"{record} = Record({{{', '.join(kinds)}}})")
        self.parts.append(f"{record}_all = {record}.joined({', '.join(f'{n}={one.text}' for n, one in some.items())})")
        self.process(self.one_of(*KINDS), [f"{record}.word.next = {record}_all"])
        fields = [replace(one, text=f"{record}.{name}", signal=False) for name, one in some.items()]
        self.scope.values += fields
        self.hidden += fields

    def a_group(self, attributes: dict[str, Value]) -> str:
        """Add a class of signals, and return its name."""
        name = self.name("Group")
        lines = [f"self.{attribute} = {made(value)}" for attribute, value in attributes.items()]
        head = f"class {name}{'' if self.once_in(8) else '(Interface)'}:\n    def __init__(self):"
        self.program.texts.append("\n".join([head, *tabbed(tabbed(lines))]))
        return name

    def an_interface(self) -> None:
        """Draw a group of signals that processes drive."""
        group = self.name("group")
        for name in ("left", "right"):
            self.a_process(f"{group}.{name}")
        members = {name: self.made.pop(f"{group}.{name}") for name in ("left", "right")}
        self.declared.append(f"{group} = {self.a_group(members)}()")
        self.hidden += members.values()

    def draw_parts(self, most: int) -> None:
        """Draw up to `most` parts."""
        for _ in range(most):
            self.one_of(
                self.a_process, self.a_process, self.a_process, self.a_process, self.a_function, self.a_list,
                self.a_tuple, self.a_machine, self.an_instance, self.by_parts, self.a_shadow, self.a_record,
                self.an_interface, self.inner_block, self.inner_block,
            )()  # fmt: skip
            if self.once_in(3):
                break

    def inner_block(self, draw: Callable[[Block], None] | None = None, words: str = "") -> None:
        """Draw a block, and one or two instances of it; it may see a list that it shares."""
        signals = [value for value in self.scope.values if value.signal]
        if self.depth > 1 or not signals:
            return
        name, closure = self.name("inner"), bool(words) and self.once_in(4)
        given = dict(zip("abc", [self.one_of(*signals) for _ in range(self.number(1, 3))], strict=False))
        inner = Block(self.program, self.reset, self.depth + 1)
        inner.scope = Scope([replace(value, text=text) for text, value in given.items()])
        draw(inner) if draw else inner.draw_parts(2)
        parameters, outputs, text = inner.finished(name, [*given, *[words] * (bool(words) and not closure)])
        group = self.a_group({one: inner.made[one] for one in outputs}) if outputs and self.once_in(5) else ""
        if group:
            names = "|".join(outputs)
            parameters = [*(one for one in parameters if one not in outputs), "group"]
            text = re.sub(r"(?<=\().*(?=\):)", ", ".join(parameters), text, count=1)
            text = re.sub(rf"(?<![.\w])(?:{names})\b", r"group.\g<0>", text)
        (self.parts if closure else self.program.texts).append(text)
        for _ in range(1 if words or self.once_in(2) else 2):
            place = self.name("group") if group else ""
            values = {one: self.alike(value) for one, value in given.items()} | {"group": place}
            for output in outputs:
                values[output] = f"{place}.{output}" if group else self.name("y")
                signal = replace(inner.made[output], text=values[output])
                self.scope.values.append(signal)
                if group:
                    self.hidden.append(signal)
                else:
                    self.made[signal.text] = signal
            self.declared += [f"{place} = {group}()"] if group else []
            self.parts.append(f"{self.name('part')} = {name}({', '.join(values.get(one, one) for one in parameters)})")

    def alike(self, value: Value) -> str:
        """Draw a signal with the range of another."""
        others = [one for one in self.scope.values if one.signal and replace(one, text=value.text) == value]
        return self.one_of(value, *others).text

    def finished(self, name: str, inputs: Sequence[str]) -> tuple[list[str], list[str], str]:
        """Return all ports, the names of the outputs, and the text of the block; unused inputs are no ports."""
        if not self.made and self.scope.values:
            self.a_process()

        def used(one: str, *without: str) -> bool:
            return any(reads(part, one) for part in self.parts if not part.startswith(("table", "def ", *without)))

        for value in self.hidden:
            if not used(value.text):
                self.a_process(draw=lambda value=value: value)
        others = {one: [part for part in self.parts if f"{one}.next" not in part] for one in self.made}
        inside = [
            one for one, parts in others.items()
            if any(reads(part, one) for part in parts if not part.startswith(("table", "def "))) and not self.once_in(3)
        ]  # fmt: skip
        outputs = [one for one in self.made if one not in inside]
        text = "\n".join(self.parts)
        inputs = ["clk", *["reset"] * self.reset, *inputs]
        ports = [one for one in inputs if reads(text, one) or f"{one}[" in text or self.once_in(400)]
        signals = [f"{one} = {made(self.made[one], self.begin(self.made[one]))}" for one in inside]
        ports += outputs
        head = "\n".join([f"@block\ndef {name}({', '.join(ports)}):", *tabbed([*signals, *self.declared])])
        text = "\n\n".join([head, *("\n".join(tabbed([one])) for one in self.parts), "    return instances()"])
        return ports, outputs, text

    def begin(self, value: Value) -> int:
        """Draw an initial value, mostly 0."""
        return self.number(max(value.low, -4), min(value.high, 9)) if self.once_in(3) else 0


@st.composite
def programs(draw: st.DrawFn) -> str:
    """Generate a module with a block `top`, and a function that makes its arguments."""
    program = Program(draw)
    reset = program.one_of(*RESETS)
    top, made_by = Block(program, bool(reset)), {"clk": "bit()", "reset": reset}
    for name in "abcd"[: program.number(1, 4)]:
        value = replace(full(program.one_of(*WIDTHS), program.once_in(2), name), signal=True)
        value = replace(value, bits=0) if value.high == 1 and program.once_in(2) else value
        top.scope.values.append(value)
        made_by[name] = made(value)
    top.draw_parts(3)
    ports, outputs, text = top.finished("top", list(made_by)[2:])
    made_by |= {name: made(top.made[name], top.begin(top.made[name])) for name in outputs}
    arguments = ", ".join(f'"{name}": {made_by[name]}' for name in ports if made_by[name])
    last = f"def arguments():\n    return {{{arguments}}}"
    return PRELUDE + "\n\n\n".join([*program.texts, text, last]) + "\n"
