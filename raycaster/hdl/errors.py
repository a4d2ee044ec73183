# SPDX-License-Identifier: MIT
"""Errors that the user can fix, reported in one line, and the place of a fault in a block."""

from __future__ import annotations

import ast
import linecache
import re
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from raycaster.hdl.internals import SignalType


class UserError(Exception):
    """An error that the user can fix; its text is the one line that they see."""


def fault_in_block(error: BaseException, converters: tuple[str, ...] = ()) -> str | None:
    """Return file, line and reason of a fault in a MyHDL block, or None if the error is unrelated to MyHDL.

    Args:
        error: the error, with its traceback.
        converters: beginnings of the names of modules in which no fault can be, as they only call the conversion.
    """
    if found := re.fullmatch(r"in file (.+), line (\d+):\s*(.*)", str(error), re.DOTALL):
        # A slice has a driver already: the signal that it is cut from.
        remedy = "; connect a new signal, not a slice" if found[3].startswith("Signal has multiple drivers") else ""
        return f"{found[1]}:{found[2]}: {found[3]}{remedy}"
    if isinstance(error, SyntaxError):
        return f"{error.filename}:{error.lineno}: {error.msg}"
    frames = list(traceback.walk_tb(error.__traceback__))
    modules = [frame.f_globals.get("__name__", "") for frame, _ in frames]
    if not any(module.startswith("myhdl.") for module in modules):
        return None
    reason = re.sub(r"^\w+Error: ", "", str(error)) or "MyHDL does not support this"
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
    for (frame, line), module in zip(reversed(frames), reversed(modules), strict=True):
        if not module.startswith(("myhdl.", "raycaster.hdl.", *converters)):
            return f"{frame.f_code.co_filename}:{line}: {reason}"
    return None


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
