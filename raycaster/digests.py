# SPDX-License-Identifier: MIT
"""Digests of the sources and tools that decide a result, so that a kept result is known to be stale."""

from __future__ import annotations

import contextlib
import hashlib
import importlib.metadata
from collections.abc import Iterator
from pathlib import Path

LEFT_OUT = "__pycache__", "build", "tests"
"""Names of folders whose files decide no result."""

PAGES = ".md", ".png", ".svg", ".webp"
"""Endings of files that are only read by people."""


def sources_digest(*places: Path) -> str:
    """Compute a digest of source files: their names, relative to their place, and their bytes.

    Every kind of file counts, so a new one cannot be forgotten; only `LEFT_OUT`, `PAGES` and hidden files do not.

    Args:
        places: files, which always count, and folders, which are searched with the folders in them.

    Raises:
        FileNotFoundError: a place does not exist.
    """
    digest = hashlib.sha256()
    for place in places:
        for path in sorted(_files(place)) if place.is_dir() else [place]:
            name = path.relative_to(place.parent).as_posix()
            digest.update(f"{name} {hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return digest.hexdigest()


def _files(folder: Path) -> Iterator[Path]:
    for path in folder.rglob("*"):
        names = path.relative_to(folder).parts
        hidden = any(name.startswith(".") or name in LEFT_OUT for name in names)
        if not hidden and path.suffix not in PAGES and path.is_file():
            yield path


def tool_versions(*packages: str) -> dict[str, str]:
    """Find the versions of packages; one that is not installed is left out."""
    versions = {}
    for name in packages:
        with contextlib.suppress(importlib.metadata.PackageNotFoundError):
            versions[name] = importlib.metadata.version(name)
    return versions


def tools_digest(*packages: str) -> str:
    """Compute a digest of the versions of packages."""
    return hashlib.sha256(repr(sorted(tool_versions(*packages).items())).encode()).hexdigest()
