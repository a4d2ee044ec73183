# SPDX-License-Identifier: MIT
"""Elaborating a MyHDL design, that is making its blocks: one at a time, and quickly."""

from __future__ import annotations

import inspect
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
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
    twice as long with it, and six times as long under pytest. And MyHDL keeps every signal ever made, and resets them
    all after each simulation, so that each takes longer than the one before.

    `inspect.stack` is replaced for the whole process while this lasts: other threads then get frames without their
    source. A second elaboration waits for the first one's end.
    """
    with _ELABORATING, forgetting():
        with_source = inspect.stack
        inspect.stack = _callers
        try:
            yield
        finally:
            inspect.stack = with_source


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


def _callers() -> list[inspect.FrameInfo]:
    """What `inspect.stack` returns, but for the source."""
    found, frame = [], sys._getframe()
    while frame := frame.f_back:
        code = frame.f_code
        found.append(inspect.FrameInfo(frame, code.co_filename, frame.f_lineno, code.co_name, None, None))
    return found
