# SPDX-License-Identifier: MIT
"""Errors that the user can fix, reported in one line, and the place of a fault in a block."""

from __future__ import annotations

import ast
import inspect
import linecache
import re
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

REWORDED = {
    r"Signal has multiple drivers: (\w+)": r"\1 or a signal that it is cut from has two drivers; connect a new signal",
    r"Free variable should be a Signal or an int: (\w+)": r"\1 is neither a signal nor an int, and Verilog's "
    r"functions know nothing else around them; write it out in the function, or make it a name of the module",
    r"Local variable may be referenced before assignment: (\w+)": r"\1 may have no value here; assign to it first",
    r"Type mismatch with earlier assignment: (\w+)": r"\1 had a value of another type before; take another name",
    r"Nr of bits mismatch with earlier assignment: (\w+)": r"\1 had another width before; write \1[:] = ...",
    r"Can't infer variable type: (\w+)": r"\1 has no type that Verilog knows; write intbv(0)[8:], a number or a bool",
    r"Can't infer return type": r"the result has no type that Verilog knows; return a number or an intbv",
    r"Return type mismatch": r"the results have different types; return values of one type",
    r"Returned nr of bits mismatch": r"the results have different widths; return values of one width",
    r"Unsupported attribute: (\w+)": r"Verilog has no attribute \1; find its value outside of the process",
    r"Not supported: non-boolean argument in logical operator": r"and, or, not: an operand is a word, not a bit; "
    r"compare it with != 0",
    r"Not supported: true division.*": r"Verilog has no true division; write //",
    r"Not supported: multiple assignments": r"Verilog has no multiple assignments; write one for each target",
    r"Not supported: lambda statement": r"Verilog has no lambda; write a function with def",
    r"Requirement violation: Expected .*": r"Verilog counts loops by numbers; write for k in range(...)",
    r"Requirement violation: .*-else .*": r"Verilog has no else of a loop; keep what was found in a variable",
    r"modbv object should have full bit vector range: (\w+)": r"\1 is a modbv of less than all values of its bits; use "
    r"an intbv, and write % or if",
    r"intbv object should have a bit width: (\w+)": r"an intbv needs a width here: \1; write intbv(0)[8:] or "
    r"intbv(0, min=-8, max=8)",
    r"delay argument in @always decorator": r"hardware waits for no time; wait for a clock",
    r"Not supported: (.*)": r"Verilog has no \1; write it otherwise",
    r"sensitivity list is empty": r"the process reads no signal, so nothing would run it; use tied()",
    r"\w+: A block should return block or instantiator objects": r"a block returns its processes and instances; end "
    r"it with return instances()",
    r"\w+: subblock (\w+) should be encapsulated in a block decorator": r"\1 makes processes or instances; mark it as "
    r"a @block, and return them",
}
"""MyHDL's texts, and what to say instead."""


class UserError(Exception):
    """An error that the user can fix; its text is the one line that they see."""


def fault_in_block(error: BaseException, converters: tuple[str, ...] = ()) -> str | None:
    """Return file, line and reason of a fault in a MyHDL block, or None if the error is unrelated to MyHDL.

    Args:
        error: the error, with its traceback.
        converters: beginnings of the names of modules in which no fault can be, as they only call the conversion.
    """
    from raycaster.hdl.internals import Block, SignalType  # noqa: PLC0415 - MyHDL takes time to load

    if found := re.fullmatch(r"in file (.+), line (\d+):\s*(.*)", str(error), re.DOTALL):
        return f"{found[1]}:{found[2]}: {_reworded(found[3])}"
    if isinstance(error, SyntaxError):
        return f"{error.filename}:{error.lineno}: {error.msg}"
    frames = list(traceback.walk_tb(error.__traceback__))
    modules = [frame.f_globals.get("__name__", "") for frame, _ in frames]
    if not any(module.startswith("myhdl.") for module in modules):
        return None
    reason = _reworded(re.sub(r"^\w+Error: ", "", str(error))) or "MyHDL does not support this"
    if isinstance(error, AssertionError) and not str(error):
        stated = linecache.getline(frames[-1][0].f_code.co_filename, frames[-1][1])
        reason = f"MyHDL expects {stated.strip().removeprefix('assert ')} here"
    elif type(error).__module__.partition(".")[0] != "myhdl":
        reason += f" ({type(error).__name__})"
    # While MyHDL analyses a process, the place is in the syntax tree; while code runs, it is in a frame.
    # A signal whose making failed has no attributes.
    values = [value for frame, _ in frames for value in frame.f_locals.values() if not isinstance(value, SignalType)]
    processes: list[Any] = [value.ast for value in values if hasattr(getattr(value, "ast", None), "sourcefile")]
    nodes = [value for value in values if isinstance(value, ast.stmt | ast.expr)]
    if processes and nodes:
        if not isinstance(error, AttributeError) or isinstance(error.obj, ast.AST):
            reason = f"MyHDL does not convert {ast.unparse(nodes[-1]).splitlines()[0]}; write it otherwise"
        return f"{processes[-1].sourcefile}:{processes[-1].lineoffset + nodes[-1].lineno}: {reason}"
    outside = ("myhdl.", "raycaster.hdl.", *converters)
    places: list[Any] = [(frame.f_code.co_filename, line) for frame, line in reversed(frames)
                         if not frame.f_globals.get("__name__", "").startswith(outside)]  # fmt: skip
    functions = [value.func for value in values if isinstance(value, Block)]
    places += [(inspect.getsourcefile(function), function.__code__.co_firstlineno) for function in functions]
    return f"{places[0][0]}:{places[0][1]}: {reason}" if places else None


def _reworded(reason: str) -> str:
    """Return MyHDL's reason as one line in our words."""
    line = " ".join(reason.split())
    for text, instead in REWORDED.items():
        if found := re.fullmatch(text, line):
            return found.expand(instead)
    return line


@contextmanager
def faults_in_one_line() -> Iterator[None]:
    """Make a context in which a fault in a MyHDL block becomes a `UserError` with file, line and reason."""
    try:
        yield
    except UserError:
        raise
    except Exception as error:
        if fault := fault_in_block(error):
            raise UserError(fault) from None
        raise
