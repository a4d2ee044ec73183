# SPDX-License-Identifier: MIT
"""Turn Verilog as MyHDL prints it into Verilog as a person would write it, with the same meaning."""

from __future__ import annotations

import ast
import inspect
import operator
import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from raycaster.hdl.internals import Block, EnumItemType, Process
from raycaster.hdl.port_comments import commented, in_verilog, split

LINE_LENGTH = 120

_OPERATORS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.LShift: operator.lshift,
    ast.USub: operator.neg,
}


def restyle(text: str, block: Block, ports: Sequence[str], vocabulary: Mapping[str, Any]) -> str:
    """Restyle one module.

    A comment above a process is kept. Port lists become ANSI style, codes of states become names, constant expressions
    become numbers, and needless parentheses are dropped. Blank lines separate processes and instances.

    Args:
        text: MyHDL's output.
        block: the block that was converted.
        ports: names of the module's ports, in order.
        vocabulary: meanings of Python names in comments.
    """
    for sub in block.subs:
        if isinstance(sub, Process):
            text = _comment(text, sub, block, vocabulary)
    # A block that declares nothing needs no name, which would cost Icarus a thread at each evaluation.
    text = re.sub(r"^(always [^\n]*begin): \w+\n(?! *(?:integer|reg)\b)", r"\1\n", text, flags=re.M)
    text = re.sub(r"^always @\(([^)]*)\)", _sensitivity, text, flags=re.M)
    for name, signal in block.sigdict.items():
        if isinstance(signal.val, EnumItemType):
            text = _name_states(text, name, signal.val)
    text = _drop_modulo(text, block)
    text = _fold_constants(text)
    text = re.sub(r"\b33'h(?=[89a-f][0-9a-f]{7}\b)", "32'h", text)  # MyHDL adds a bit for a sign that is not there
    text = _size_words(text)
    text = "\n".join(map(_drop_parentheses, text.splitlines()))
    text = _declare_fields(text)
    text = _declare_ports(text, ports, block, vocabulary)
    text = _declare_constants(text)
    lines = (wrapped for line in text.splitlines() for wrapped in _wrap(line.rstrip()))
    text = re.sub(r"\n+endmodule\n*", "\n\nendmodule\n", "\n".join(lines).strip("\n") + "\n")
    return re.sub(r"\n{3,}", "\n\n", text)


def _size_words(text: str) -> str:
    """Give a long constant the width of its target; MyHDL gives it the width of its value, or one bit more."""
    widths = {name: int(high) + 1 for high, name in re.findall(r"\[(\d+):0\] (\w+);", text)}

    def size(match: re.Match[str]) -> str:
        width = widths.get(match[1], int(match[3]))
        return f"{match[1]} {match[2]} {width}'h{match[4]};"

    return re.sub(r"\b(\w+) (<?=) (\d+)'h([0-9a-f]+);", size, text)


def _comment(text: str, process: Process, block: Block, vocabulary: Mapping[str, Any]) -> str:
    """Put the comment above a process, if there is one, above it in the Verilog."""
    comment = inspect.getcomments(process.funcobj)
    if not comment:
        return text
    words = " ".join(line.lstrip("# ").rstrip() for line in comment.splitlines())
    purpose = f"// {in_verilog(words, block, vocabulary)}\n"
    label = re.escape(process.funcobj.__name__.lower())
    text, found = re.subn(
        rf"^(always [^\n]*begin: {label}\n)", lambda match: purpose + match[1], text, flags=re.M | re.I
    )
    if found:
        return text
    # A process that only assigns has become continuous assignments, one after the other.
    targets = (match for match in re.finditer(r"^assign (\w+)", text, re.M) if match[1] in process.outputs)
    first = next(targets, None)
    return text[: first.start()] + purpose + text[first.start() :] if first else text


def _sensitivity(match: re.Match[str]) -> str:
    """Write @* or a sorted list; MyHDL's list has the order of a Python set, which changes from run to run."""
    names = match[1].split(", ")
    if any(name.startswith(("posedge", "negedge")) for name in names):
        return match[0]
    if any("[" in name for name in names):  # words of an array, which @* does not cover in every tool
        return f"always @({', '.join(sorted(names))})"
    return "always @*"


def _name_states(text: str, signal: str, state: Any) -> str:
    """Write states by name instead of code."""
    names: Mapping[str, str] = {code: name for name, code in state._type._codedict.items()}
    width = state._nrbits
    text = re.sub(rf"\b({signal} (?:==|!=|<=|=) ){width}'b([01]+)", lambda match: match[1] + names[match[2]], text)
    constants = "".join(f"localparam [{width - 1}:0] {name} = {width}'b{code};\n" for code, name in names.items())
    return re.sub(rf"^(reg [^\n]*\b{signal};\n)", rf"{constants}\1", text, flags=re.M)


def _drop_modulo(text: str, block: Block) -> str:
    """Drop the modulo of a sum if the target's width implies it: Verilog's assignment wraps around by itself."""
    widths = {name: len(signal) for name, signal in block.sigdict.items() if signal.val is not None}

    def wrap(match: re.Match[str]) -> str:
        fits = widths.get(match[2]) == int(match[5])
        return f"{match[1]}{match[2]}{match[3]}{match[4]};" if fits else match[0]

    return re.sub(r"^( *(?:assign )?)(\w+)( <?= )\(\(([\w +*-]+)\) % \(1 << (\d+)\)\);", wrap, text, flags=re.M)


def _fold_constants(text: str) -> str:
    """Replace constant arithmetic by numbers, such as the 2 * 8 of a slice's bounds."""
    constant = r"[\d\s()*-][\d\s+()*-]*(?<=[\d)])"
    text = re.sub(rf"\[({constant})\]", lambda match: f"[{_evaluate(match[1])}]", text)
    text = re.sub(
        rf"\[({constant}):({constant})\]", lambda match: f"[{_evaluate(match[1])}:{_evaluate(match[2])}]", text
    )
    text = re.sub(r"(?<==)(\d+-\d+)(?=;)", lambda match: str(_evaluate(match[1])), text)
    return re.sub(r"\((\d+ (?:[+*-]|<<) \d+)\)", lambda match: str(_evaluate(match[1])), text)


def _evaluate(expression: str) -> int:
    def value(node: ast.expr) -> int:
        match node:
            case ast.Constant(value=int(number)):
                return number
            case ast.BinOp():
                return _OPERATORS[type(node.op)](value(node.left), value(node.right))
            case ast.UnaryOp():
                return _OPERATORS[type(node.op)](value(node.operand))
        raise ValueError(f"{expression} is not constant arithmetic")

    return value(ast.parse(expression.strip(), mode="eval").body)


def _drop_parentheses(line: str) -> str:
    """Drop parentheses around a whole expression, a negated name or a negative number that is compared or assigned."""
    if line.lstrip().startswith("//"):
        return line
    line = re.sub(r"(?<!if )\((!\w+)\)", r"\1", line)
    line = re.sub(r"((?:[=<>]=|[=<>]) )\((-\d+)\)", r"\1\2", line)
    assigned = re.fullmatch(r"(.*? <?= )(\(.*\))(;)", line)
    asked = re.fullmatch(r"(.*\bif \()(\(.*\))(\) begin)", line)
    whole = assigned or asked
    if whole and _is_one_group(whole[2]):
        return whole[1] + whole[2][1:-1] + whole[3]
    return line


def _wrap(line: str) -> list[str]:
    """Break a line that is too long at spaces; a comment stays a comment."""
    if len(line) <= LINE_LENGTH:
        return [line]
    indent = line[: len(line) - len(line.lstrip())]
    further = f"{indent}// " if line.lstrip().startswith("//") else f"{indent}    "
    return textwrap.wrap(line, LINE_LENGTH, subsequent_indent=further, break_long_words=False, break_on_hyphens=False)


def _is_one_group(text: str) -> bool:
    """Return True if the last parenthesis closes the first."""
    depth = 0
    for index, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if depth == 0:
            return index == len(text) - 1
    return False


def _declare_ports(text: str, ports: Sequence[str], block: Block, vocabulary: Mapping[str, Any]) -> str:
    """Declare each port once, in the module's head below its comment, and put the module's text above the head."""
    head = re.search(r"^module (\w+) \(\n[^)]*\);\n((?://[^\n]*\n)*)", text, re.M)
    if not head:
        raise ValueError("no module begins as MyHDL writes it")
    before, name, purpose, body = text[: head.start()], head[1], head[2], text[head.end() :]
    rows = []
    for port in ports:
        kinds = re.findall(rf"^(input|output|wire|reg)( signed)?( \[\d+:0\])? {port};\n", body, re.M)
        body = re.sub(rf"^(?:input|output|wire|reg)(?: signed)?(?: \[\d+:0\])? {port};\n", "", body, flags=re.M)
        words = [kind for kind, _, _ in kinds]
        direction, (_, sign, width) = words[0], kinds[0]
        rows.append((f"{direction:<6} {'reg' if 'reg' in words else 'wire':<4}{sign}{width}", port))
    pad = max(len(left) for left, _ in rows)
    purpose, texts = split(purpose)
    comments = commented(ports, texts, block, LINE_LENGTH, vocabulary)
    purpose = in_verilog(purpose, block, vocabulary)
    declarations = ",\n".join(f"{comments[port]}    {left:<{pad}} {port}" for left, port in rows)
    return f"{before}{purpose}module {name} (\n{declarations}\n);\n{body}"


def _declare_fields(text: str) -> str:
    """Declare a record's field where it is sliced from its word."""
    for name, bits in re.findall(r"^assign (\w+) = (\w+_word\[\d+(?::\d+)?\]);$", text, re.M):
        shape = re.search(rf"^wire((?: signed)?(?: \[\d+:0\])?) {name};\n", text, re.M)
        if shape:
            text = text.replace(shape[0], "", 1)
            text = text.replace(f"assign {name} = {bits};", f"wire{shape[1]} {name} = {bits};", 1)
    return text


def _declare_constants(text: str) -> str:
    """Put a module's constants together above its signals."""
    constants = "".join(re.findall(r"^localparam [^\n]*;\n", text, re.M))
    if not constants:
        return text
    text = re.sub(r"^localparam [^\n]*;\n", "", text, flags=re.M)
    return re.sub(r"^\);\n+", f");\n\n{constants}\n", text, count=1, flags=re.M)
