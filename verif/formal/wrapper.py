# SPDX-License-Identifier: MIT
"""Complete the Verilog of a property with the declarations that follow from the modules that it is about.

A property is a Verilog module without ports. Its instances of generated modules are connected by name, with `.*`, and
it may use the following names without declaring them:

- a port of such a module. Outputs are wires, and so is an input that the property assigns. All other inputs are
  arbitrary: they are ports of the completed module.
- a field of a port that is a record: `rect_axis` is a part of `rect_word`, as the comment of the generated port says.
- a name inside an instance, such as `dut.state`, or `\\dut.banks[1] ` for a word of a memory. An index in braces
  chooses one of several: `dut.banks{number}` is one of the words; `dut.run_bank{number}_i.state` is in one of the
  instances `run_bank_0_i`, `run_bank_1_i` and so on, or in the only one, `run_bank_i`.
- a fact in capitals, which becomes a constant.
- `known`, which is 0 in the first cycle; that one is assumed to be a cycle of reset.

`DUT stands for the first module of the proof. `$past(name)` and `$past(name, 2)` are values of earlier cycles, which
are registers, so that the depth of an induction does not grow; `$stable(name)` compares with the cycle before.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import count, takewhile
from pathlib import Path

WRAPPERS = Path(__file__).parent

SIGNAL = re.compile(
    r"^ *(?:(input|output) +)?(?:wire|reg) +((?:signed +)?(?:\[\d+:0\] *)?)(\w+)( \[0:\d+\])?(?: = .*)?[,;]?$", re.M
)
"""A declaration in generated Verilog: direction, type, name, and the range of a memory's addresses."""

LAYOUT = re.compile(r"((?:^ *//.*\n)+) *(?:in|out)put +(?:wire|reg) +\[\d+:0\] *(\w+)_word\b", re.M)
"""The comment of a port that is a record, and the name of the port."""

INSTANCE = re.compile(r"^ *(\w+|`DUT) (\w+) \(", re.M)
DECLARATION = re.compile(r"^ *(?:\(\* \w+ \*\) )?(?:wire|reg|genvar|localparam) ([^;]*);", re.M)
TYPE = re.compile(r"^(?:signed )?(?:\[.*?\] )?")
PAST = re.compile(r"\$past\(([\w.]+)(?:, (\d))?\)")
CHOICE = re.compile(r"(?<![\w.`$\\])([a-z]\w*(?:\.\w+)+)\{([^{}]*)\}(\w*(?:\.\w+(?:\{[^{}]*\}\w*)?)*)")
PATH = re.compile(r"(?<![\w.`$\\])[a-z]\w*(?:\.[a-z]\w*)+|\\(?:\w+\.)+\w+\[\d+\](?= )")


def source(name: str) -> str:
    """Return the file of a property, with the files that it includes."""
    text = (WRAPPERS / f"{name}.v").read_text()
    return re.sub(r'^`include "(.*)\.v"$', lambda match: source(match[1]), text, flags=re.M)


def constants(text: str, name: str) -> list[str]:
    """List the constants that a property uses and does not declare."""
    body = _body(text, name)
    used, declared = re.findall(r"(?<![\w'`.])[A-Z][A-Z0-9_]*\b", body), _declared(body)
    return [each for each in dict.fromkeys(used) if each not in declared]


def completed(
    text: str, name: str, modules: Sequence[str], verilog: Mapping[str, str], values: Mapping[str, int]
) -> str:
    """Return the Verilog of a property with all declarations.

    Args:
        text: the property, as `source` returns it.
        name: its module.
        modules: the generated modules that it is about.
        verilog: the generated files.
        values: values of `constants`.
    """
    text = re.sub(r"\$stable\(([\w.]+)\)", r"(\1 == $past(\1))", text.replace("`DUT", modules[0]))
    body = _body(text, name)
    instances = {label: module for module, label in INSTANCE.findall(body) if f"{module}.v" in verilog}
    found = 1
    while found:  # the outermost instance first
        text, found = CHOICE.subn(lambda match: _chosen(match[1], match[2], match[3], instances, verilog), text)
    body = _body(text, name)
    declared = _declared(body)
    assigned = {each for left in re.findall(r"\bassign ([^=]*)=", body) for each in re.findall(r"\w+", left)}
    ports: dict[str, tuple[str, str]] = {}
    fields: dict[str, str] = {}
    for label, module in instances.items():
        generated = verilog[f"{module}.v"]
        [connections] = re.findall(rf" {label} \(([^;]*)\);", body)
        other = dict(re.findall(r"\.(\w+)\((\w*)", connections))
        for way, kind, port, _ in SIGNAL.findall(generated):
            if way == "output" and port in other:
                assigned.add(other[port])
            elif way and port not in other and ports.get(port, ("", ""))[0] != "output":
                ports[port] = way, kind.strip() + " " * bool(kind)
        fields |= _fields(generated)
    inputs = [
        f"input {kind}{port}"
        for port, (way, kind) in ports.items()
        if way == "input" and port not in {*declared, *assigned}
    ]
    lines = [f"localparam {fact} = {_number(value)};" for fact, value in values.items()]
    lines += [
        f"wire {kind}{port};"
        for port, (way, kind) in ports.items()
        if port not in declared and (way == "output" or port in assigned)
    ]
    used = set(re.findall(r"\w+", body)) - declared.keys() - ports.keys()
    if "known" not in declared and re.search(r"(?<![.\w])known\b", body):
        lines.append("reg known = 0;")
        known = "always @(posedge clk) known <= 1;\nalways @* if (!known) assume (reset);"
        before, start, after = text.partition(f"module {name};\n")
        text = before + start + after.replace("\nendmodule", f"\n{known}\nendmodule", 1)
    lines += [f"wire {field} = {part};" for field, part in fields.items() if field.split()[-1] in used]
    peeked = _peeked(body, instances, verilog)
    lines += [f"(* hierconn *) wire {kind}\\{path} ;" for path, kind in peeked.items()]
    kinds = {port: kind for port, (_, kind) in ports.items()} | {"known": ""} | peeked | declared
    text, lines = _with_past(
        text, lines, kinds | {field.split()[-1]: field.rpartition(" ")[0] + " " for field in fields}
    )
    start = "\n".join([f"module {name} ({', '.join(inputs or ['input clk'])});", *lines, ""])
    return "`default_nettype none\n" + text.replace(f"module {name};\n", start)


def _body(text: str, name: str) -> str:
    """Return the text of the property's own module, without comments."""
    return re.sub(r"//.*", "", text.partition(f"module {name};\n")[2].partition("\nendmodule")[0])


def _declared(body: str) -> dict[str, str]:
    """Return the names of signals and constants that a property declares, with their types."""
    found: dict[str, str] = {}
    for statement in DECLARATION.findall(body):
        kind, bare, brackets = str(TYPE.findall(statement)[0]), statement, 1
        while brackets:  # innermost brackets first
            bare, brackets = re.subn(r"\([^(){}[\]]*\)|\{[^(){}[\]]*\}|\[[^(){}[\]]*\]", " ", bare)
        for part in bare.split(","):
            found.setdefault(re.findall(r"\w+", part.partition("=")[0])[-1], kind)
    return found


def _fields(generated: str) -> dict[str, str]:
    """Return the fields of a module's records, as they are declared, and the bits of the port."""
    found = {}
    for comment, record in LAYOUT.findall(generated):
        for high, low, field in re.findall(r"\[(\d+)(?::(\d+))?\] (\w+)", re.sub(r"\n *//", "", comment)):
            size = f"[{int(high) - int(low)}:0] " if low else ""
            found[f"{size}{record}_{field}"] = f"{record}_word[{high}{':' * bool(low)}{low}]"
    return found


def _module(names: Sequence[str], instances: Mapping[str, str], verilog: Mapping[str, str]) -> str:
    """Return the text of the module of an instance, whose names are given from the outermost one in; empty if none."""
    module = instances[names[0]]
    for name in names[1:]:
        instance = re.search(rf"^(\w+) {name} \(", verilog.get(f"{module}.v", ""), re.M)
        module = instance[1] if instance else ""
    return verilog.get(f"{module}.v", "")


def _chosen(before: str, index: str, after: str, instances: Mapping[str, str], verilog: Mapping[str, str]) -> str:
    """Return an expression for a name with an index in braces, given the texts before them, in them and after them."""
    *outer, last = before.split(".")
    if after:
        end, dot, rest = after.partition(".")
        numbered = (f"{before}_{number}{end}" for number in count())
        found = [*takewhile(lambda path: _module(path.split("."), instances, verilog), numbered)] or [before + end]
        paths = [path + dot + rest for path in found]
    else:
        [size] = [memory for _, _, name, memory in SIGNAL.findall(_module(outer, instances, verilog)) if name == last]
        paths = [f"\\{before}[{number}] " for number in range(int(size[4:-1]) + 1)]
    return f"({''.join(f'{index} == {at} ? {path} : ' for at, path in enumerate(paths[:-1]))}{paths[-1]})"


def _peeked(body: str, instances: Mapping[str, str], verilog: Mapping[str, str]) -> dict[str, str]:
    """Return the names inside instances that a property uses, with their types; flattening connects them."""
    found = {}
    for path in dict.fromkeys(PATH.findall(body)):
        names = path.lstrip("\\").partition("[")[0].split(".")
        first = next((place for place, name in enumerate(names) if name in instances), None)
        if first is None:
            continue  # a name in a block of the property
        for _, kind, signal, memory in SIGNAL.findall(_module(names[first:-1], instances, verilog)):
            if signal == names[-1] and bool(memory) == ("[" in path):
                found[path.lstrip("\\")] = kind
    return found


def _with_past(text: str, lines: list[str], kinds: Mapping[str, str]) -> tuple[str, list[str]]:
    """Replace values of earlier cycles with registers, and declare these."""
    depths: dict[str, int] = {}
    for name, cycles in PAST.findall(text):
        depths[name] = max(depths.get(name, 0), int(cycles or 1))
    for name, depth in depths.items():
        chain = [_past(name, cycles) for cycles in range(depth + 1)]
        lines = [*lines, f"reg {kinds[name]}{', '.join(chain[1:])};"]
        lines.append(f"always @(posedge clk) {{{', '.join(chain[1:])}}} <= {{{', '.join(chain[:-1])}}};")
    return PAST.sub(lambda match: _past(match[1], int(match[2] or 1)), text), lines


def _past(name: str, cycles: int) -> str:
    return f"past_{cycles}_{name.replace('.', '_')}" if cycles else name


def _number(value: int) -> str:
    return str(int(value)) if value < 1 << 31 else f"{value.bit_length()}'d{value}"
