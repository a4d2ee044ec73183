# SPDX-License-Identifier: MIT
"""Digests of the sources and tools that affect a result, to detect stale kept results."""

from __future__ import annotations

import ast
import contextlib
import hashlib
import importlib.metadata
import re
import tokenize
from collections.abc import Callable, Iterable, Iterator, Mapping
from io import StringIO
from pathlib import Path

LEFT_OUT = "__pycache__", "build", "tests"
"""Names of folders whose files affect no result."""

DIGITS = 16
"""Hexadecimal digits of a kept digest."""

PAGES = ".md", ".png", ".svg", ".webp"
"""Suffixes of files that only people read."""


def sources_digest(*places: Path) -> str:
    """Compute a digest of source files: their names, relative to their place, and their bytes.

    All files count, so that a new kind cannot be forgotten, except hidden ones and those in `LEFT_OUT` and `PAGES`.

    Args:
        places: files, which always count, and folders, which are searched recursively.

    Raises:
        FileNotFoundError: a place does not exist.
    """
    digest = hashlib.sha256()
    for place in places:
        for path in sorted(_files(place)) if place.is_dir() else [place]:
            name = path.relative_to(place.parent).as_posix()
            digest.update(f"{name} {hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return digest.hexdigest()


def digest(*parts: object) -> str:
    """Compute a digest of values, by their `repr`, and of paths, by `sources_digest`."""
    found = hashlib.sha256()
    for part in parts:
        found.update(f"{sources_digest(part) if isinstance(part, Path) else repr(part)};".encode())
    return found.hexdigest()[:DIGITS]


def code_digest(place: Path, root: Path) -> str:
    """Compute a digest of a file, or of the files in a folder, that does not depend on comments.

    Comments, docstrings and empty lines do not count, as far as `STRIPPED` knows them.

    Args:
        place: a file or a folder.
        root: the folder that file names are relative to.
    """
    digest = hashlib.sha256()
    for path in sorted(_files(place)) if place.is_dir() else [place]:
        strip = STRIPPED.get(path.suffix)
        content = strip(path.read_text()).encode() if strip else path.read_bytes()
        digest.update(f"{path.relative_to(root).as_posix()}\0".encode() + content + b"\0")
    return digest.hexdigest()[:DIGITS]


def uncommented(verilog: str) -> str:
    """Return Verilog without comments and empty lines."""
    return _filled(re.sub(r"//.*", "", line) for line in verilog.splitlines())


def _code(text: str) -> str:
    """Return Python without comments and docstrings; as text, since syntax trees differ between Python versions."""
    lines = text.splitlines()
    for token in tokenize.generate_tokens(StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column]
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            for row in range(node.lineno, (node.end_lineno or node.lineno) + 1):
                lines[row - 1] = ""
    return _filled(lines)


def _without_lines(mark: str) -> Callable[[str], str]:
    """Return what removes lines that begin with a mark, and empty lines."""
    return lambda text: _filled(line for line in text.splitlines() if not line.lstrip().startswith(mark))


def _filled(lines: Iterable[str]) -> str:
    """Join the lines that are not empty."""
    return "\n".join(line for line in map(str.rstrip, lines) if line)


STRIPPED: Mapping[str, Callable[[str], str]] = {
    ".py": _code, ".v": uncommented, ".toml": _without_lines("#"),
    **dict.fromkeys((".c", ".h", ".cpp", ".js"), _without_lines("//")),
}  # fmt: skip
"""By the ending of a file, what leaves its code without comments: all of them, or those on lines of their own."""


def _files(folder: Path) -> Iterator[Path]:
    for path in folder.rglob("*"):
        names = path.relative_to(folder).parts
        hidden = any(name.startswith(".") or name in LEFT_OUT for name in names)
        if not hidden and path.suffix not in PAGES and path.is_file():
            yield path


def tool_versions(*packages: str) -> dict[str, str]:
    """Find the versions of packages, leaving out those that are not installed."""
    versions = {}
    for name in packages:
        with contextlib.suppress(importlib.metadata.PackageNotFoundError):
            versions[name] = importlib.metadata.version(name)
    return versions


def tools_digest(*packages: str) -> str:
    """Compute a digest of the versions of packages."""
    return hashlib.sha256(repr(sorted(tool_versions(*packages).items())).encode()).hexdigest()
