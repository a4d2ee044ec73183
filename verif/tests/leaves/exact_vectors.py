# SPDX-License-Identifier: MIT
"""Vectors for leaf tests of the exact engine's blocks."""

import pytest
from vectors import AXES

from raycaster.configuration import Configuration, configure


def exact_config(**options) -> Configuration:
    return configure(engine="exact", **{"allow_underrun": True} | options)


by_turn = pytest.mark.parametrize("turn", [False, True])

by_reflections = pytest.mark.parametrize("reflections", [0, 1, 2])


def two_complement(values, bits: int, prefix: str) -> dict[str, int]:
    return {f"{prefix}_{axis}": int(value) % (1 << bits) for axis, value in zip(AXES, values, strict=True)}


def slope_inputs(slope, which: str = "") -> dict[str, int]:
    inputs = {f"slope_d{axis}": abs(int(value)) for axis, value in zip(AXES, slope, strict=True)}
    return inputs | {f"{which}signs_d{axis}": int(value < 0) for axis, value in zip(AXES, slope, strict=True)}


def basis_inputs(basis) -> dict[str, int]:
    inputs = {}
    for vector, components in zip(("forward", "right", "up"), basis, strict=True):
        inputs |= two_complement(components, 10, f"camera_{vector}")
    return inputs
