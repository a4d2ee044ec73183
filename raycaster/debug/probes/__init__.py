# SPDX-License-Identifier: MIT
"""Map each engine's signals in a waveform to the golden model's values of a ray; here, names in the hierarchy."""

from __future__ import annotations

import re
from collections.abc import Iterable

from raycaster.hdl.records import Record

DUT = "bench.dut"
AXES = "xyz"
COLOURS = ("red", "green", "blue")
PINS = ("vga_r", "vga_g", "vga_b")


def fields(scope: str, group: str, names: Iterable[str], record: Record | None = None) -> tuple[str, ...]:
    """Name the signals of an interface's attributes.

    Args:
        scope: the instance.
        group: the interface or record in it.
        names: the attributes, with a viewer's number format after a colon where it matters.
        record: a record with the group's layout, if the group is one: its fields are named as bits of its word, which
            exist whether or not the instance reads the field.
    """
    if record is None:
        return tuple(f"{scope}.{group}_{name}" for name in names)
    parts = [name.partition(":") for name in names]
    ranges = [record.slice(field) for field, _, _ in parts]
    return tuple(
        f"{scope}.{group}_word[{high}:{low}]{colon}{kind}"
        for (high, low), (_, colon, kind) in zip(ranges, parts, strict=True)
    )


def module_of(signal: str) -> str:
    """Return the module that contains a signal, from the name of its instance."""
    instance = signal.split(".")[-2]
    match = re.fullmatch(r"(\w+?)(?:_\d+)?_i", instance)
    return match[1] if match else {"dut": "ray_caster_module"}.get(instance, instance)


def numbered(module: str, number: int, count: int) -> str:
    """Name one of `count` instances of a module."""
    return f"{module}_i" if count == 1 else f"{module}_{number}_i"
