# SPDX-License-Identifier: MIT
"""Elaborate MyHDL designs, that is, make their blocks: one design at a time, and quickly."""

from __future__ import annotations

import ast
import gc
import inspect
import sys
import textwrap
import threading
from collections.abc import Collection, Iterator
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
    takes longer than the one before. A design is hundreds of thousands of objects, nearly all of them in use: with the
    usual thresholds, Python's search for garbage among them takes a quarter of the time.

    `inspect`'s functions and the thresholds are replaced for the whole process during this time: other threads then get
    frames without their source. A second elaboration waits for the first to end.
    """
    with _ELABORATING, forgetting():
        before = [(module, name, getattr(module, name)) for module, name, _ in _REPLACED]
        thresholds = gc.get_threshold()
        for module, name, quick in _REPLACED:
            setattr(module, name, quick)
        gc.set_threshold(_NEW_OBJECTS, *thresholds[1:])
        try:
            yield
        finally:
            gc.set_threshold(*thresholds)
            for module, name, slow in before:
                setattr(module, name, slow)
            _SEEN.clear()


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


_NEW_OBJECTS = 100_000
"""Number of new objects after which Python searches for garbage; they take some 10 MB."""

_DEEPEST = 6
"""Most frames that MyHDL looks at."""


def _callers(*_: Any) -> list[inspect.FrameInfo]:
    """Return the first frames of `inspect.stack`, or of the caller's `inspect.getouterframes`, without their source."""
    found, frame = [], sys._getframe()
    while len(found) < _DEEPEST and (frame := frame.f_back):
        code = frame.f_code
        shown: Any = frame if sys.version_info < (3, 12) else _Frame(frame)
        found.append(inspect.FrameInfo(shown, code.co_filename, frame.f_lineno, code.co_name, None, None))
    return found


class _Frame:
    """A frame with its variables as Python 3.11 has them, so that the Verilog is the same for each version of Python.

    From 3.12 on a comprehension is no function of its own: its variables are among those of the function around it, and
    the variables that it reads do not follow the others, by name, as those that inner functions read do. From 3.13 on
    variables bound later do not follow those that were bound when MyHDL looked before.
    """

    def __init__(self, frame: Any):
        self.f_globals, self._frame = frame.f_globals, frame

    @property
    def f_locals(self) -> dict[str, Any]:
        """The variables."""
        code, values = self._frame.f_code, self._frame.f_locals
        hidden, captured = _scopes(code)
        names = dict.fromkeys((*code.co_varnames, *code.co_cellvars, *code.co_freevars))
        # Python 3.13.0 crashes if it reads a comprehension's variable while the comprehension runs.
        own = [(name, values[name]) for name in names if name not in hidden and name in values]
        free = code.co_freevars
        last = {name: (2, "") for name in free} | {name: (1, name) for name in captured}
        known = _SEEN.setdefault(self._frame, {})
        known.update(sorted(own, key=lambda item: last.get(item[0], (0, ""))))
        return known


_SEEN: dict[Any, dict[str, Any]] = {}
"""Variables of each frame of a design that is being elaborated, in the order in which they were found."""


@cache
def _scopes(code: CodeType) -> tuple[set[str], set[str]]:
    """Return the variables of comprehensions in a function, and those of its own that inner functions or they read."""
    try:
        [tree] = ast.parse(textwrap.dedent(inspect.getsource(code))).body
    except (OSError, SyntaxError, ValueError):
        return set(), set()
    inner: set[ast.AST] = set()
    captured: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)):
            parts = set(ast.walk(node)) - set(ast.walk(node.generators[0].iter))
        elif isinstance(node, (ast.FunctionDef, ast.Lambda)) and node is not tree:
            lines = node.body if isinstance(node.body, list) else [node.body]
            parts = {part for line in lines for part in ast.walk(line)}
        else:
            continue
        inner |= parts
        captured |= _names(parts, ast.Load) - _names(parts, ast.Store)
    arguments = set(code.co_varnames[: code.co_argcount + code.co_kwonlyargcount])
    own = arguments | _names(set(ast.walk(tree)) - inner, ast.Store)
    return _names(inner, ast.Store) - own, captured & own - arguments


def _names(nodes: Collection[ast.AST], kind: type[ast.expr_context]) -> set[str]:
    """Return the names that are read or bound in some nodes."""
    return {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, kind)}


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
