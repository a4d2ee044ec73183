# SPDX-License-Identifier: MIT
"""Print a module's Verilog as a person would write it, from its contents."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from myhdl import ConcatSignal

from raycaster.hdl import internals
from raycaster.hdl.contents import Contents, Instance, Loading, check_keyword, is_signed, refusal
from raycaster.hdl.expressions import Argument, Expressions
from raycaster.hdl.internals import Constant, EnumItemType, SignalType, operands_of, states_by_name
from raycaster.hdl.port_comments import Comments
from raycaster.hdl.records import Joined
from raycaster.hdl.signals import Tied, Unset
from raycaster.hdl.statements import Statements

LINE_LENGTH = 120
WHOLE_WORDS: Any = {"break_long_words": False, "break_on_hyphens": False}

POWER_UP = "// Values at power-up."
"""Comment above the initial values of registers and of memories that are written."""

UNCHECKED = '(* ramstyle = "no_rw_check" *)\n'
"""Attribute of a memory, for Yosys and Quartus: a word that is read in the cycle in which it is written is don't care.
Otherwise they add registers and multiplexers that deliver the word from before."""


def module_text(contents: Contents, name: str, header: str, vocabulary: Mapping[str, Any]) -> str:
    """Return the file of one module.

    The block's docstring is above the module, its arguments' texts are above the ports, and the comment above a process
    is kept. Blank lines separate processes and instances, except assignments on consecutive lines of the block.

    Args:
        contents: the block's signals, processes and instances.
        name: name of the module.
        header: comment lines for the head of the file.
        vocabulary: meanings of Python names in comments; see `raycaster.hdl.port_comments.Comments`.
    """
    comments = Comments(contents.block, vocabulary, LINE_LENGTH)
    functions: dict[str, str] = {}
    with states_by_name(contents.enumerations, contents.states):
        parts = _grouped(contents.parts, [_part(part, contents, comments, functions) for part in contents.parts])
        initial_values = "\n".join(_initial_values(contents))
    sections = [
        f"{header}\n\n`timescale 1ns/10ps",
        f"{comments.purpose}module {name} (\n{_ports(contents, comments)}\n);",
        "".join(f"localparam {constant};\n" for constant in _constants(contents)),
        "".join(_declarations(contents)),
        initial_values,
        "".join(_wires(contents)),
        *(text.replace("\0", name) for name, text in functions.items()),
        *parts,
        "endmodule",
    ]
    sections = [re.sub(r"[\x00-\x09\x0b-\x1f]", " ", section) for section in sections]
    text = "\n\n".join(stripped for section in sections if (stripped := section.strip("\n")))
    text = "\n".join(wrapped for line in text.split("\n") for wrapped in _wrap(line.rstrip()))
    return re.sub(r"\n{3,}", "\n\n", text) + "\n"


def without_power_up(text: str) -> str:
    """Return a module's text with registers and memories that begin unknown, except memories that nothing writes."""
    return re.sub(rf"{POWER_UP}\ninitial (begin\b.*?\nend|.*?;)\n", "", text, flags=re.S)


def number(signal: Any) -> str:
    """Return a signal's initial value in Verilog notation."""
    width, value = len(signal), int(signal.val)
    if is_signed(signal):
        return f"{'-' if value < 0 else ''}{width}'sd{abs(value)}"
    return f"{width}'h{value:0{-(-width // 4)}x}" if width > 16 else f"{width}'d{value}"


def _shape(signal: SignalType) -> str:
    """Return a declaration's sign and range."""
    one_bit = isinstance(signal.val, bool)
    return f"{'signed ' * is_signed(signal)}{'' if one_bit else f'[{len(signal) - 1}:0] '}"


def _ports(contents: Contents, comments: Comments) -> str:
    """Declare the ports, each below its comment."""
    rows = []
    for port in contents.ports:
        signal = contents.arriving[port.name]
        kind = contents.driven.get(id(signal), "wire")
        rows.append((f"{'output' if port.output else 'input':<6} {kind:<4} {_shape(signal)}".rstrip(), port.name))
    pad = max((len(left) for left, _ in rows), default=0)
    above = comments.of_ports([name for _, name in rows])
    return ",\n".join(f"{above[name]}    {left:<{pad}} {name}" for left, name in rows)


def _constants(contents: Contents) -> Iterator[str]:
    """Yield the values of states, and of signals that never change."""
    for (_, code), name in contents.states.items():
        yield f"[{len(code) - 1}:0] {name} = {len(code)}'b{code}"
    for signal in contents.signals:
        if isinstance(signal, (Tied, Constant)):
            yield f"{_shape(signal) if len(signal) > 1 else ''}{contents.text(signal)} = {number(signal)}"


def _declarations(contents: Contents) -> Iterator[str]:
    """Yield the declarations of signals and memories."""
    for signal in contents.signals:
        if not isinstance(signal, (Tied, Constant)):
            yield f"{contents.driven.get(id(signal), 'wire')} {_shape(signal)}{contents.text(signal)};\n"
    for name, memory in contents.memories.items():
        kinds = [contents.driven.get(id(one)) for one in [memory, *memory]]
        if name in contents.passed and not contents.passed[name]:
            kinds = ["wire"]
        if isinstance(memory, Unset):
            yield UNCHECKED
        yield f"{next(filter(None, kinds), 'reg')} {_shape(memory[0])}{name} [0:{len(memory) - 1}];\n"
    for name, (known, _) in contents.variables.items():
        yield f"{internals.declaration('reg', known)}{name};\n"


def _initial_values(contents: Contents) -> Iterator[str]:
    """Yield the contents of memories that nothing writes, then the values at power-up of registers and memories."""
    loaded = [part.memory for part in contents.parts if isinstance(part, Loading)]
    signals = [*contents.arriving.values(), *contents.signals]
    values = [f"{contents.text(one)} = {_value(one)};" for one in signals if id(one) in contents.starting]
    lines: list[str] = []
    values += [f"{name} = {value};" for name, (_, value) in contents.variables.items()]
    i = index = ""
    for name, memory in contents.memories.items():
        if any(memory is one for one in loaded):
            continue
        words = [f"{name}[{place}] = {_value(one)};" for place, one in enumerate(memory)]
        if name in contents.passed and not contents.passed[name]:
            continue
        if all(id(one) not in contents.driven for one in [memory, *memory]):
            yield "\n".join(["initial begin", *(f"    {word}" for word in words), "end\n"])
        elif id(memory) in contents.starting and len({int(one.val) for one in memory}) > 1:
            values += words
        elif id(memory) in contents.starting:
            i = i or contents.free("i")
            index = index or f" : {contents.free('initial_values')}\n    integer {i};"
            lines.append(f"for ({i} = 0; {i} < {len(memory)}; {i} = {i} + 1) {name}[{i}] = {_value(memory[0])};")
        else:
            values += [word for word, one in zip(words, memory, strict=True) if id(one) in contents.starting]
    if values or lines:
        kept = textwrap.wrap(" ".join(value.replace(" ", "\0") for value in values), LINE_LENGTH - 4, **WHOLE_WORDS)
        lines = [*(line.replace("\0", " ") for line in kept), *lines]
        body = "".join(f"    {line}\n" for line in lines)
        one = len(values) == 1 and not index
        yield f"{POWER_UP}\n" + (f"initial {lines[0]}\n" if one else f"initial begin{index}\n{body}end\n")


def _value(signal: SignalType) -> str:
    """Return a signal's initial value: a plain number if it is small, the name of a state, or a sized number."""
    if isinstance(signal.val, EnumItemType):
        return internals.text_of(signal.val)
    return str(int(signal.val)) if 0 <= int(signal.val) < 1 << 30 else number(signal)


def _wires(contents: Contents) -> Iterator[str]:
    """Yield the wires of fields, and the assignments of joined signals."""
    for field in contents.fields:
        yield f"wire {_shape(field)}{contents.text(field)} = {contents.bits(field)};\n"
    for name, out in contents.passed.items():
        for index, one in enumerate(contents.memories[name]):
            sides = f"{name}[{index}]", contents.text(one)
            yield f"assign {sides[out]} = {sides[not out]};\n"
    for signal in contents.signals:
        name = contents.text(signal)
        if isinstance(signal, Joined):
            values = [contents.text(part) for part in signal.parts.values()]
            longest = max(map(len, values)) + 1
            yield f"assign {name} = {{\n"
            for after, (field, value) in enumerate(zip(signal.parts, values, strict=True), 1):
                yield f"    {value + ',' * (after < len(values)):{longest}}  // {field}\n"
            yield "};\n"
        elif isinstance(signal, ConcatSignal):
            high = len(signal)
            for part in operands_of(signal):
                low = high - (1 if isinstance(part, bool) else len(part))
                bits = f"{high - 1}:{low}" if high - low > 1 else f"{low}"
                value = re.sub(r"^\d+'b", "'b", contents.text(part))
                yield f"assign {name}[{bits}] = {value};\n"
                high = low


def _grouped(parts: Sequence[Any], texts: Sequence[str]) -> list[str]:
    """Join the texts of assignments that are on consecutive lines of a block."""
    groups: list[str] = []
    next_line = None
    for part, text in zip(parts, texts, strict=True):
        code = part.function.__code__ if hasattr(part, "function") and internals.assigned(part) else None
        if code and (code.co_filename, code.co_firstlineno) == next_line:
            groups[-1] += f"\n{text}"
        else:
            groups.append(text)
        next_line = (code.co_filename, code.co_firstlineno + 1) if code else None
    return groups


def _part(part: Any, contents: Contents, comments: Comments, functions: dict[str, str]) -> str:
    """Return the Verilog of an instance, of a memory's initial contents or of a process; add its functions."""
    if isinstance(part, Loading):
        name = next(name for name, memory in contents.memories.items() if memory is part.memory)
        return f'// Initial contents of the memory.\ninitial $readmemh("{part.file}", {name});'
    if isinstance(part, Instance):
        pins = ",\n".join(f"    .{port}({contents.text(signal)})" for port, signal in part.connections.items())
        values = ",\n".join(f"    .{name}({value})" for name, value in part.module.parameters)
        kind = f"{part.module.name} #(\n{values}\n)" if values else part.module.name
        return f"{kind} {part.name} (\n{pins}\n);"
    text = _statements(part, contents, functions).printed(contents.labels.get(id(part), ""), _sensitivity)
    return comments.of_process(part.function) + text.strip("\n")


def _statements(
    tree: Any,
    contents: Contents,
    functions: dict[str, str],
    arguments: Mapping[str, Argument] | None = None,
    keeps: bool = False,
) -> Statements:
    """Return the printer of a process or a function, which adds to `functions` those that it calls, by name."""
    keeps = keeps or internals.keeps(tree)

    def name_of(called: Any, arguments: Sequence[Argument]) -> str:
        for name in (*called.argnames, *called.vardict):
            check_keyword(contents.block, name)
        if not keeps and (read := internals.signals_read_around(called)):
            raise refusal(contents.block, f"{called.body[0].name} reads {read[0]}, for which nothing waits in MyHDL; "
                          "make it an argument", read[0])  # fmt: skip
        given = dict(zip(called.argnames, arguments, strict=True))
        text = _statements(called, contents, functions, given, keeps).printed_function("\0")
        known = next((name for name, other in functions.items() if other == text), None)
        name = known or contents.free(called.body[0].name)
        functions[name] = text
        return name

    return Statements(tree, Expressions(tree, name_of, arguments or {}))


def _sensitivity(names: Sequence[str]) -> str:
    """Write @* or a sorted list; MyHDL's list has the order of a Python set, which changes from run to run."""
    if any(name.startswith(("posedge", "negedge")) for name in names):
        return f"@({', '.join(names)})"
    if any("[" in name for name in names):  # words of an array, which @* does not cover in every tool
        return f"@({', '.join(sorted(names))})"
    return "@*"


def _wrap(line: str) -> list[str]:
    """Break a line that is too long at spaces; a comment stays a comment, and one behind a statement goes above it."""
    if len(line) <= LINE_LENGTH or '"' in line:
        return [line]
    indent = line[: len(line) - len(line.lstrip())]
    statement, mark, comment = line.partition("  // ")
    if mark and statement.strip():
        return [*_wrap(f"{indent}// {comment}"), *_wrap(statement.rstrip())]
    further = f"{indent}// " if line.lstrip().startswith("//") else f"{indent}    "
    return textwrap.wrap(line, LINE_LENGTH, subsequent_indent=further, **WHOLE_WORDS)
