# SPDX-License-Identifier: MIT
"""An Avalon-MM agent, and helpers for leaf tests of bridges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from vectors import any_word

from raycaster.buses import BUSES
from raycaster.rtl.bus.buses import BRIDGES
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.widths import LANES

ADDRESS_BITS = 6

CYCLES = 1500

agents = pytest.mark.parametrize(("patience", "latency"), [(0.0, 2), (0.3, 4), (0.8, 7)])
"""The agent's chance of a wait state, and the most cycles that it takes to answer."""


class Agent:
    """An Avalon-MM agent that inserts wait states and answers at random times."""

    def __init__(self, random: np.random.Generator, patience: float, latency: int):
        self._random, self._patience, self._latency = random, patience, latency
        self.reset()

    def reset(self) -> None:
        self._due = None  # cycles until the accepted read is answered
        self.word = self.waits = self.answers = 0
        self.taken = self.outstanding = False

    def drive(self) -> dict[str, int]:
        """Return the agent's outputs in this cycle; readdata changes only with an answer."""
        self.answers = int(self._due == 0)
        self._due = None if self._due in (None, 0) else self._due - 1
        self.waits = int(self._random.random() < self._patience)
        if self.answers:
            self.word = any_word(self._random)
        return {"avm_m0_readdata": self.word, "avm_m0_readdatavalid": self.answers, "avm_m0_waitrequest": self.waits}

    def clock(self, reads: bool) -> None:
        """End a cycle in which a read is requested or not; its answer comes two cycles later at the earliest."""
        self.taken = reads and not self.waits
        self.outstanding = self.taken or (self.outstanding and not self.answers)
        if self.taken:
            self._due = int(self._random.integers(1, self._latency))


def any_lanes(random: np.random.Generator) -> int:
    return int(random.integers(1 << LANES))


def any_byte_address(random: np.random.Generator) -> int:
    """Return the address of any byte; it selects the word that the byte is in."""
    return int(random.integers(4 << ADDRESS_BITS))


def bridge_ports(name: str) -> dict[str, Callable]:
    """Return the two ports of a bus's bridge, as for `Bench`."""
    return {
        BUSES[name].port: lambda: BRIDGES[name].interface(ADDRESS_BITS),
        "avm_m0": lambda: AvalonPort(ADDRESS_BITS),
    }
