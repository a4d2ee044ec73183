# SPDX-License-Identifier: MIT
"""Parts of a design that come from files: existing Verilog, and the initial words of a memory."""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from myhdl import block


@dataclass(frozen=True)
class GivenVerilog:
    """The Verilog source and the outputs of a block marked by `given_verilog`."""

    source: Callable[[], Path]
    outputs: frozenset[str]


def given_verilog(source: Callable[[], Path], outputs: Collection[str]) -> Callable[[Any], Any]:
    """Mark a block whose Verilog is an existing file; MyHDL simulates only the block's own processes, if it has any.

    Arguments that are not signals become the module's parameters of the same names. Module ports without an argument
    stay unconnected.

    Args:
        source: returns the path of the file, which is copied unchanged; called only when needed.
        outputs: names of the block's arguments that the module drives.
    """

    def mark(decorated: Any) -> Any:
        decorated.func.given_verilog = GivenVerilog(source, frozenset(outputs))
        return decorated

    return mark


@block
def load_words(memory, file: str):
    """Initialise a memory from a file with Verilog's $readmemh; in MyHDL the signals must have these initial values.

    The file is looked up in the working directory of the simulation or synthesis, not of the conversion.

    Args:
        memory: list of signals, the words.
        file: name of the file, with one hexadecimal word per line.
    """
    return ()
