# SPDX-License-Identifier: MIT
"""Elaborate MyHDL designs, that is, make their blocks: one design at a time, and quickly."""

from __future__ import annotations

import inspect
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from types import CodeType
from typing import Any

from raycaster.hdl.internals import SOURCE_READERS, Block, all_signals

_ELABORATING = threading.RLock()
"""Lock for a single design at a time, as MyHDL elaborates, simulates and converts through globals."""


@contextmanager
def elaboration() -> Iterator[None]:
    """Make a context to elaborate in, and to simulate in, as MyHDL forgets the signals afterwards.

    MyHDL asks for the stack at each instance and process, but only uses a few frames and their functions' names.
    Python's own answer opens files, and goes through all modules for each frame that has no file: with it, 64 units
    take twice as long, and six times as long under pytest. MyHDL also rereads each process's source for each instance,
    several times. And it keeps every signal ever made, and resets them all after each simulation, so that each one
    takes longer than the one before.

    `inspect`'s functions are replaced for the whole process during this time: other threads then get frames without
    their source. A second elaboration waits for the first to end.
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
    """Make a context whose signals MyHDL forgets afterwards."""
    known = len(all_signals)
    try:
        yield
    finally:
        del all_signals[known:]


def elaborated(block: Any, **arguments: Any) -> Block:
    """Elaborate a block; this gives the result a type, which MyHDL's function does not have."""
    return block(**arguments)


_DEEPEST = 6
"""Most frames that MyHDL looks at."""


def _callers(*_: Any) -> list[inspect.FrameInfo]:
    """Return the first frames of `inspect.stack`, or of the caller's `inspect.getouterframes`, without their source."""
    found, frame = [], sys._getframe()
    while len(found) < _DEEPEST and (frame := frame.f_back):
        code = frame.f_code
        found.append(inspect.FrameInfo(frame, code.co_filename, frame.f_lineno, code.co_name, None, None))
    return found


def _code_of(what: Any) -> CodeType | None:
    """Return the code of a function or of a frame, shared by all functions from one `def`."""
    return getattr(what, "__code__", None) or getattr(what, "f_code", None)


def _once(function: Any) -> Any:
    """Make one of `inspect`'s functions look at each code only once."""

    @cache
    def known(file: str, code: CodeType) -> Any:  # equal code may be in two files
        return function(code)

    def quick(what: Any) -> Any:
        code = _code_of(what)
        return known(code.co_filename, code) if code else function(what)

    return quick


_REPLACED = (
    (inspect, "stack", _callers),
    (inspect, "getouterframes", _callers),
    (inspect, "getsourcelines", _once(inspect.getsourcelines)),
    (inspect, "getsourcefile", _once(inspect.getsourcefile)),
    *((module, name, cache(getattr(module, name))) for module, name in SOURCE_READERS),
)
"""Functions that MyHDL calls, and their replacements."""
