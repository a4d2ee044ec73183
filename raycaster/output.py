# SPDX-License-Identifier: MIT
"""Output of commands: directories that appear whole or not at all, and text that is safe to print."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rich.console
import rich.table
from rich.box import SIMPLE_HEAD
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.protocol import is_renderable
from rich.text import Text

from raycaster.errors import UserError
from raycaster.places import shown

MARK = ".raycaster"
"""File that marks a directory as made by a command, so that a later command may remove it."""

LOG_COLUMNS = 150
"""Columns of text that does not go to a terminal: enough for every table."""


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
    # Models built before there was a mark have a stamp.
    is_older = directory.parent.parent.name == "model" and (directory / "stamp.json").exists()
    if not (directory / MARK).exists() and not is_older and any(directory.iterdir()):
        raise UserError(
            f"{directory}: has files in it, but no {MARK} to show that raycaster made it, so it is not replaced; "
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
    """Make an empty directory, replacing any existing one, and return it.

    Raises:
        UserError: see `check_replaceable`.
    """
    remove(directory)
    directory.mkdir(parents=True)
    _mark(directory)
    return directory


def put(filled: Path, directory: Path) -> None:
    """Move a directory into place, replacing the one from the previous run, if any.

    Raises:
        UserError: see `check_replaceable`.
    """
    _mark(filled)
    remove(directory)
    filled.rename(directory)


@contextmanager
def replaced(directory: Path) -> Iterator[Path]:
    """Yield an empty directory to fill, which then replaces `directory`.

    If filling it fails, `directory` stays as it was.

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
        # A write to a full disk names no file, and the name of the scratch directory means nothing to a user.
        if error.filename is None or (
            Path(error.filename).is_relative_to(directory.parent) and prefix in error.filename
        ):
            error.filename = str(directory)
        raise


def _mark(directory: Path) -> None:
    (directory / MARK).write_text("raycaster made this directory, and replaces it as a whole.\n")


def printable(text: object, *, lines: bool = False) -> str:
    r"""Escape control characters, as in \x1b, in text from files or the command line, so that it is safe to print.

    Args:
        text: text to show.
        lines: True if the text may have several lines.
    """
    return shown(text, "\n" if lines else "")


class Console(rich.console.Console):
    """A console that prints text literally: brackets are not markup, and `printable` escapes control characters."""

    def __init__(self, **options: Any):
        """Turn off markup, emoji names and highlighting; the options are those of rich."""
        super().__init__(markup=False, emoji=False, highlight=False, **options)
        if "width" not in options and not self.is_terminal:
            self.width = LOG_COLUMNS

    def render_str(self, text: str, **options: Any) -> Text:
        """Render a string that is not yet a `Text`."""
        return super().render_str(printable(text, lines=True), **options)

    @contextmanager
    def waiting(self, what: str, usual: str = "") -> Iterator[None]:
        """Show what is being waited for: on a terminal with the elapsed time, elsewhere once at the start.

        Args:
            what: text to show.
            usual: usual duration, in words; see `raycaster.runs.waits`.
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
        """Leave a broken pipe to `raycaster.design.options.run_command`."""
        raise BrokenPipeError


class Table(rich.table.Table):
    """A table for a console: the first column is aligned to the left, the others to the right, as numbers are."""

    def __init__(self, *headings: str, title: str | None = None, texts: Collection[str] = (), **options: Any):
        """Add a column for each heading.

        Args:
            headings: the headings.
            title: title above the table.
            texts: headings of further columns that are aligned to the left, and may wrap.
            options: further options of rich.
        """
        style = {"title_justify": "left", "box": SIMPLE_HEAD, "pad_edge": False, "padding": (0, 1, 0, 0)}
        super().__init__(title=title, **{**style, **options})
        for place, heading in enumerate(headings):
            is_text = place == 0 or heading in texts
            self.add_column(heading, justify="left" if is_text else "right", no_wrap=not is_text)

    def add_row(self, *cells: Any, **options: Any) -> None:
        """Add a row; whole numbers get commas, and a renderable is shown as it is."""
        shown = (f"{cell:,}" if isinstance(cell, int) else cell for cell in cells)
        super().add_row(*(cell if is_renderable(cell) else str(cell) for cell in shown), **options)
