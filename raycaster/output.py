# SPDX-License-Identifier: MIT
"""Output of commands: directories that appear whole or not at all, and text that a terminal shows as it is."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rich.console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.text import Text

from raycaster.errors import UserError

MARK = ".raycaster"
"""The file that says of a directory that a command made it, so that the next one may remove it."""


def check_replaceable(directory: Path) -> None:
    """Refuse to replace anything except an empty directory and one that a command made.

    Raises:
        UserError: something else is there, or the path does not end in a name.
    """
    if not directory.name.strip("."):
        raise UserError(f"{directory}: expected a path that ends in a directory's name, as it is replaced as a whole")
    if not directory.exists() and not directory.is_symlink():
        return
    if directory.is_symlink() or not directory.is_dir():
        raise UserError(f"{directory}: expected a directory; move away what is there, or choose another place")
    # Models that were built before there was a mark have a stamp.
    is_older = directory.parent.parent.name == "model" and (directory / "stamp.json").exists()
    if not (directory / MARK).exists() and not is_older and any(directory.iterdir()):
        raise UserError(
            f"{directory}: has files in it, but no {MARK} that says that raycaster made it, so it is not replaced; "
            "move it away, or choose another place"
        )


def remove(directory: Path) -> None:
    """Remove a directory that a command made, if it is there.

    Raises:
        UserError: see `check_replaceable`.
    """
    check_replaceable(directory)
    if directory.exists():
        shutil.rmtree(directory)


def emptied(directory: Path) -> Path:
    """Make a directory, or replace it by an empty one; returns it.

    Raises:
        UserError: see `check_replaceable`.
    """
    remove(directory)
    directory.mkdir(parents=True)
    _mark(directory)
    return directory


def put(filled: Path, directory: Path) -> None:
    """Move a directory to where the one of the run before may be.

    Raises:
        UserError: see `check_replaceable`.
    """
    _mark(filled)
    remove(directory)
    filled.rename(directory)


@contextmanager
def replaced(directory: Path) -> Iterator[Path]:
    """An empty directory to fill, which takes the place of `directory` once all is in it.

    If the filling fails, `directory` stays as it was.

    Raises:
        UserError: see `check_replaceable`.
    """
    check_replaceable(directory)
    prefix = f".{directory.name}-"
    try:
        directory.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=directory.parent, prefix=prefix) as scratch:
            filled = Path(scratch) / directory.name
            filled.mkdir()
            yield filled
            put(filled, directory)
    except OSError as error:
        # A write to a full disk has no file's name, and the scratch directory's means nothing to a user.
        if error.filename is None or (
            Path(error.filename).is_relative_to(directory.parent) and prefix in error.filename
        ):
            error.filename = str(directory)
        raise


def _mark(directory: Path) -> None:
    (directory / MARK).write_text("raycaster made this directory, and replaces it as a whole.\n")


def printable(text: object, *, lines: bool = False) -> str:
    r"""Text of files or of the command line as a terminal may get it: control characters are escaped, as in \x1b.

    Args:
        text: what to show.
        lines: whether it may have several lines.
    """
    return "".join(
        one if one.isprintable() or (lines and one == "\n") else one.encode("unicode_escape").decode()
        for one in str(text)
    )


class Console(rich.console.Console):
    """A console that takes text for text: brackets are no markup, and `printable` escapes control characters."""

    def __init__(self, **options: Any):
        """Begin without markup, names of emojis and highlighting; the options are those of rich."""
        super().__init__(markup=False, emoji=False, highlight=False, **options)

    def render_str(self, text: str, **options: Any) -> Text:
        """Render what is not yet a `Text`."""
        return super().render_str(printable(text, lines=True), **options)

    @contextmanager
    def waiting(self, what: str, usual: str = "") -> Iterator[None]:
        """Show what is being waited for: with the time so far on a terminal, once at the start elsewhere.

        Args:
            what: to show.
            usual: duration, in words; see `raycaster.waits`.
        """
        text = f"{what} ({usual})" if usual else what
        if not self.is_terminal:
            self.print(text, soft_wrap=True)
            yield
            return
        columns = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
        with Progress(*columns, console=self, transient=True) as progress:
            progress.add_task(printable(text), total=None)
            yield

    def on_broken_pipe(self) -> None:
        """Leave it to `raycaster.options.run_command`."""
        raise BrokenPipeError
