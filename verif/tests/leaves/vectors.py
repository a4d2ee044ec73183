# SPDX-License-Identifier: MIT
"""Values and ports that leaf tests of many blocks share."""

from __future__ import annotations

import numpy as np

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.random_world import EXTREMES
from raycaster.hdl.signals import bit, reset_signal
from raycaster.rtl.common.widths import LANES, WORD_BITS

EVERY_LANE = (1 << LANES) - 1


def any_strobe(random: np.random.Generator) -> int:
    """Return a strobe; half of them are reads."""
    return int(random.integers(1, EVERY_LANE + 1)) if random.random() < 0.5 else 0


STEP = 3
"""World units per frame by which a button moves the camera."""


def stepped(position: int, more: int, less: int) -> int:
    """Return the position after a step; a step out of the world is not made."""
    target = position + STEP * (more - less)
    return target if 0 <= target < WORLD_SIZE else position


AXES = "xyz"

LAST = WORLD_SIZE - 1


def config_id(value) -> str | None:
    return value.name if isinstance(value, Configuration) else None


def any_place(random: np.random.Generator) -> int:
    return int(random.choice(EXTREMES)) if random.random() < 0.3 else int(random.integers(WORLD_SIZE))


def any_word(random: np.random.Generator) -> int:
    return int(random.integers(1 << WORD_BITS))


def ports(bits: str, **others: object) -> dict[str, object]:
    """Make a block's arguments: a bit for each name (a reset signal for `reset`), and the others as they are."""
    return {name: reset_signal() if name == "reset" else bit() for name in bits.split()} | others
