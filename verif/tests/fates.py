# SPDX-License-Identifier: MIT
"""What may become of a group's rays, for tests of those who control them."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from raycaster.verif.leaf import Leaf, TraceCycle


def random_fate(random: np.random.Generator, usable: Sequence[int], reflections: int, number: int) -> dict[str, Any]:
    """The keyword arguments of `trace_cycles`; number 0 is the worst case, in which nothing is culled."""
    if number == 0:
        return {"possible": usable, "hopeless": (), "lost": None}
    share = random.choice([0, 0.3, 0.7, 1])
    return {
        "possible": [index for index in usable if random.random() < share],
        "hopeless": [
            (bounce, index)
            for bounce in range(reflections + 1)
            for index in usable
            if random.random() < random.choice([0, 0.4, 1])
        ],
        "lost": int(random.integers(reflections + 1)) if random.random() < 0.3 else None,
    }


def prospects_in(random: np.random.Generator, cycle: TraceCycle, leaf: Leaf) -> dict[str, int]:
    """What the units say in a cycle, and anything where nobody listens."""
    said = {"prospects_ahead": cycle.ahead, "prospects_alive": cycle.alive}
    return {
        name: int(random.integers(2)) if value is None else value for name, value in said.items() if name in leaf.inputs
    }


def mask_of(indices: Sequence[int]) -> int:
    """A bit for each."""
    return sum(1 << index for index in indices)
