# SPDX-License-Identifier: MIT
"""Directories that commands write: they appear whole or not at all."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replaced(directory: Path) -> Iterator[Path]:
    """An empty directory to fill, which takes the place of `directory` once all is in it.

    Where the filling fails, `directory` stays as it was.
    """
    directory.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=directory.parent, prefix=f".{directory.name}-") as scratch:
        filled = Path(scratch) / directory.name
        filled.mkdir()
        yield filled
        if directory.exists():
            shutil.rmtree(directory)
        filled.rename(directory)
