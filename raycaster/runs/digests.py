# SPDX-License-Identifier: MIT
"""Digests of the sources and tools that affect a result, to detect stale kept results."""

from __future__ import annotations

import contextlib
import hashlib
import importlib.metadata
import re
from collections.abc import Iterator
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


def uncommented(verilog: str) -> str:
    """Return Verilog without comments and empty lines."""
    lines = (re.sub(r"//.*", "", line).rstrip() for line in verilog.splitlines())
    return "\n".join(filter(None, lines))


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
