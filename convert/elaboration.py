# SPDX-License-Identifier: MIT
"""Elaborating a MyHDL design, that is making its blocks: one at a time, and quickly."""

from __future__ import annotations

import importlib
import inspect
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from types import CodeType
from typing import Any

from myhdl._block import _Block
from myhdl._simulator import _signals

_ELABORATING = threading.RLock()
"""MyHDL elaborates, simulates and converts through globals, so one design at a time, whatever else runs."""


@contextmanager
def elaboration() -> Iterator[None]:
    """Elaborate within this; MyHDL forgets the signals afterwards, so what is simulated must be within, too.

    MyHDL asks for the stack at each instance and process, of which it only wants a few frames and their functions'
    names. Python's own answer opens files, and goes through all modules for each frame that has no file: 64 units take
    twice as long with it, and six times as long under pytest. It also reads each process's source anew for each
    instance, several times. And MyHDL keeps every signal ever made, and resets them all after each simulation, so that
    each takes longer than the one before.

    `inspect`'s functions are replaced for the whole process while this lasts: other threads then get frames without
    their source. A second elaboration waits for the first one's end.
    """
    with _ELABORATING, forgetting():
        before = [(module, name, getattr(module, name)) for module, name, _ in _REPLACED]
        for module, name, quick in _REPLACED:
            setattr(module, name, quick)
        try:
            yield
        finally:
            for module, name, slow in before:
                setattr(module, name, slow)


@contextmanager
def forgetting() -> Iterator[None]:
    """MyHDL forgets the signals that are made within this."""
    known = len(_signals)
    try:
        yield
    finally:
        del _signals[known:]


def elaborated(block: Any, **arguments: Any) -> _Block:
    """Elaborate a block, for whose function MyHDL has no type."""
    return block(**arguments)


_DEEPEST = 6
"""Frames that MyHDL looks at, at most."""


def _callers(*_: Any) -> list[inspect.FrameInfo]:
    """Return the first frames of `inspect.stack`, or of the caller's `inspect.getouterframes`, without their source."""
    found, frame = [], sys._getframe()
    while len(found) < _DEEPEST and (frame := frame.f_back):
        code = frame.f_code
        found.append(inspect.FrameInfo(frame, code.co_filename, frame.f_lineno, code.co_name, None, None))
    return found


def _code_of(what: Any) -> CodeType | None:
    """Return the code of a function or of a frame, which all that one `def` makes share."""
    return getattr(what, "__code__", None) or getattr(what, "f_code", None)


def _once(function: Any) -> Any:
    """Let one of `inspect`'s functions look at each code once."""

    @cache
    def known(file: str, code: CodeType) -> Any:  # equal code may be in two files
        return function(code)

    def quick(what: Any) -> Any:
        code = _code_of(what)
        return known(code.co_filename, code) if code else function(what)

    return quick


_UTIL, _WAITER = map(importlib.import_module, ("myhdl._util", "myhdl._Waiter"))
_REPLACED = (
    (inspect, "stack", _callers),
    (inspect, "getouterframes", _callers),
    (inspect, "getsourcelines", _once(inspect.getsourcelines)),
    (inspect, "getsourcefile", _once(inspect.getsourcefile)),
    (_UTIL, "_dedent", _dedent := cache(_UTIL._dedent)),
    (_WAITER, "_dedent", _dedent),
)
"""Functions that MyHDL calls, and what takes their place."""
