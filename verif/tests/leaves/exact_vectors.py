# SPDX-License-Identifier: MIT
"""Vectors for leaf tests of the exact engine's blocks."""

import pytest
from vectors import any_config

from raycaster.configuration import Configuration


def exact_config(**options) -> Configuration:
    """Make a design of the exact engine; a row may take longer than its budget."""
    return any_config(engine="exact", **options)


by_turn = pytest.mark.parametrize("turn", [False, True])

by_reflections = pytest.mark.parametrize("reflections", [0, 1, 2])
