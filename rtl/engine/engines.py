# SPDX-License-Identifier: MIT
"""Blocks that differ from engine to engine, found by the names that `raycaster.engines` has for them."""

from collections.abc import Callable
from importlib import import_module


def block_named(name: str) -> Callable:
    """The block of a room and a name, such as "seed.ray_unit"."""
    return getattr(import_module(f"raycaster.rtl.{name}"), name.rpartition(".")[2])
