# SPDX-License-Identifier: MIT
"""The shape of a leaf test: `leaf_of` makes the block, `check` runs a stimulus and compares the outputs."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from raycaster.configuration import WORLD_SIZE, Configuration, configure
from raycaster.golden.random_world import EXTREMES
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import Signed, bit, reset_signal, signed, unsigned
from raycaster.rtl.common.interfaces import (
    Access,
    Direction,
    Eye,
    Picture,
    Place,
    Progress,
    Rects,
    Slope,
    Steps,
    vga_of,
)
from raycaster.rtl.common.records import (
    Pixel,
    Signs,
    camera_of,
    candidate_of,
    facet_of,
    fold_of,
    mirror_of,
    rect_of,
    room_image_of,
    seen_of,
    walk_of,
    winner_of,
)
from raycaster.rtl.common.widths import LANES, WORD_BITS, exact_slope_bits, eye_bits, unit_bits
from raycaster.verif.seeds import repeat

PORTS: dict[str, Callable[[Configuration], object]] = {
    "reset": lambda _: reset_signal(),
    "access": lambda _: Access(),
    "aim": lambda config: Direction(exact_slope_bits(config) + 1),
    "camera": camera_of,
    "column_base": lambda config: unsigned(unit_bits(config)),
    "eye": lambda config: Eye(eye_bits(config)),
    "facet": facet_of,
    "facets": lambda config: unsigned(config.rectangles * len(facet_of(config).word)),
    "fold": fold_of,
    "initial_signs": lambda _: Signs(),
    "mirror": mirror_of,
    "nearest": candidate_of,
    "picture": lambda _: Picture(),
    "pixel": lambda config: Pixel(config.colour_bits),
    "place": Place,
    "progress": lambda _: Progress(),
    "rect": rect_of,
    "rects": Rects,
    "seen": seen_of,
    "signs": lambda _: Signs(),
    "slope": lambda config: Slope(exact_slope_bits(config)),
    "steps": lambda _: Steps(),
    "strobe": lambda _: unsigned(LANES),
    "image": room_image_of,
    "vga": vga_of,
    "walk": walk_of,
    "winner": winner_of,
}
"""Signals of the ports whose names mean the same in most blocks."""


def leaf_of(block: Callable, directory: Path, config: Any = None, **given: Any) -> Leaf:
    """Make a leaf with new signals at the block's ports.

    Args:
        block: the block.
        directory: scratch space for the Verilog.
        config: the design, which sizes the ports of `PORTS`.
        given: by name, a port's width (`Signed` for two's complement) or a function that makes its signal; an argument
            with a type or a default is no port and is passed on. A port that is neither here nor in `PORTS` is a bit.
    """
    parameters = inspect.signature(block).parameters
    assert set(given) <= set(parameters), set(given) - set(parameters)

    def argument(name: str) -> object:
        parameter = parameters[name]
        if name == "config":
            return config
        if parameter.annotation is not parameter.empty or parameter.default is not parameter.empty:
            return given[name]
        made = given.get(name, PORTS.get(name))
        if isinstance(made, int):
            return signed(made) if isinstance(made, Signed) else unsigned(made)
        return bit() if made is None else made() if name in given else made(config)

    names = [name for name, one in parameters.items() if one.default is one.empty or name in given]
    return Leaf(block, lambda: {name: argument(name) for name in names}, directory)


def check(
    leaf: Leaf,
    stimulus: Sequence[Mapping[str, Any]],
    expected: Mapping[int, Mapping[str, Any] | None] | Iterable[Mapping[str, Any] | None],
    latency: int = 0,
    settled: int | None = None,
) -> Sequence[Mapping[str, Any]]:
    """Run a stimulus in both simulators, compare the outputs with those expected, and return them.

    Args:
        leaf: the block.
        stimulus: by cycle, the inputs, as for `Leaf.run_both`; negative numbers are two's complement.
        expected: by cycle of the stimulus, all or some outputs `latency` cycles later; None for don't care.
        latency: cycles from the inputs of a case to its outputs.
        settled: the first cycle in which all outputs are known and compared, by default after the latency.
    """
    settled = latency if settled is None else settled
    outputs = leaf.run_both([*plain(stimulus), *[{}] * latency], settled=settled)
    for cycle, wanted in expected.items() if isinstance(expected, Mapping) else enumerate(expected):
        for name, value in (wanted or {}).items():
            if value is not None and cycle + latency >= settled:
                seen, span = outputs[cycle + latency][name], 1 << leaf.seen[name].width
                right = value == int(value) and -span <= 2 * value < 2 * span and seen == int(value) % span
                assert right, f"cycle {cycle + latency}: {name} is {seen}, expected {value}; {repeat()}"
    return outputs


def check_fetches(outputs: Sequence[Mapping[str, Any]], shown: Mapping[int, int], port: str, settled: int = 0) -> None:
    """Check that the block has fetched each rectangle before the cycle in which the memory shows it.

    Args:
        outputs: the block's outputs, by cycle.
        shown: indices of rectangles, by cycle.
        port: prefix of the block's outputs fetch and index.
        settled: the first cycle in which fetches are known and compared.
    """
    fetched = None
    for cycle, output in enumerate(outputs):
        if cycle >= settled and cycle in shown:
            assert fetched == shown[cycle], f"cycle {cycle}: fetched rectangle {fetched}, not {shown[cycle]}"
        if output[f"{port}fetch"]:
            fetched = output[f"{port}index"]


def plain(stimulus: Iterable[Mapping[str, Any]]) -> list[dict[str, int]]:
    """Return a stimulus with Python's own numbers, whatever kind of number it has."""
    return [{name: int(value) for name, value in cycle.items()} for cycle in stimulus]


def driven(leaf: Leaf, stimulus: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return a stimulus without the inputs that this leaf lacks, such as those of features that its design lacks."""
    return [{name: value for name, value in cycle.items() if name in leaf.given} for cycle in stimulus]


AXES = "xyz"

LAST = WORLD_SIZE - 1

EVERY_LANE = (1 << LANES) - 1

STEP = 3
"""World units per frame by which a button moves the camera."""


def stepped(position: int, more: int, less: int) -> int:
    """Return the position after a step; a step out of the world is not made."""
    target = position + STEP * (more - less)
    return target if 0 <= target < WORLD_SIZE else position


def any_config(**options: Any) -> Configuration:
    """Make a design; a row may take longer than its budget."""
    return configure(**{"allow_underrun": True} | options)


def config_id(value) -> str | None:
    """Return the name of a parameter set that is a design."""
    return value.name if isinstance(value, Configuration) else None


def designs(*configs: Configuration) -> pytest.MarkDecorator:
    """Run a test for each of these designs, with its name in the test's."""
    return pytest.mark.parametrize("config", configs, ids=config_id)


def named(prefix: str, fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a record or an interface, named as at a port with this name."""
    return {f"{prefix}_{name}": value for name, value in fields.items()}


def by_axis(prefix: str, values: Iterable) -> dict[str, Any]:
    """Return a point or a vector as the components of a port; the prefix ends with `_` or `_d`."""
    return {f"{prefix}{axis}": value for axis, value in zip(AXES, values, strict=True)}


def slope_inputs(slope: Iterable, signs: str = "signs") -> dict[str, int]:
    """Return a slope in sign and magnitude."""
    slope = [int(value) for value in slope]
    return by_axis("slope_d", map(abs, slope)) | by_axis(f"{signs}_d", (int(value < 0) for value in slope))


def basis_inputs(basis: Iterable) -> dict[str, Any]:
    """Return the basis of a camera that turns."""
    inputs = {}
    for vector, components in zip(("forward", "right", "up"), basis, strict=True):
        inputs |= by_axis(f"camera_{vector}_", components)
    return inputs


def colour_word(colour: Iterable) -> int:
    """Return a colour as one word, red in its highest bits."""
    return int.from_bytes(bytes(np.asarray(colour, dtype=np.uint8)))


def any_place(random: np.random.Generator) -> int:
    """Return a coordinate in the world, often an extreme one."""
    return int(random.choice(EXTREMES)) if random.random() < 0.3 else int(random.integers(WORLD_SIZE))


def any_word(random: np.random.Generator) -> int:
    """Return a word of the bus."""
    return int(random.integers(1 << WORD_BITS))


def any_strobe(random: np.random.Generator) -> int:
    """Return a strobe; half of them are reads."""
    return int(random.integers(1, EVERY_LANE + 1)) if random.random() < 0.5 else 0
