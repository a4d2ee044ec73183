# SPDX-License-Identifier: MIT
"""What a design takes as it is given: Verilog written elsewhere, and the words that a memory starts with."""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from myhdl import block


@dataclass(frozen=True)
class GivenVerilog:
    """What `given_verilog` says of a block."""

    source: Callable[[], Path]
    outputs: frozenset[str]


def given_verilog(source: Callable[[], Path], outputs: Collection[str]) -> Callable[[Any], Any]:
    """Mark a block as one whose Verilog is given; it has no processes, so MyHDL cannot simulate it.

    Its arguments without a signal are the module's parameters, of the same names. Ports of the module that are no
    arguments stay unconnected.

    Args:
        source: finds the file, which is copied as it is; called when it is needed.
        outputs: which of the block's arguments the module drives.
    """

    def mark(decorated: Any) -> Any:
        decorated.func.given_verilog = GivenVerilog(source, frozenset(outputs))
        return decorated

    return mark


@block
def load_words(memory, file: str):
    """Verilog's $readmemh: a memory, a list of signals, holds a file's words from the start, as its block must, too.

    The file is looked for where the simulation or synthesis runs, and not when the block is converted.

    Args:
        memory: list of signals, the words.
        file: name of the file, with a word in hexadecimal on each line.
    """
    return ()
