# SPDX-License-Identifier: MIT
"""Register accesses and looks for leaf tests of the scene memories."""

from __future__ import annotations

import dataclasses

import numpy as np
from vectors import any_config

from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.fixed import FixedRectangle, FixedScene
from raycaster.golden.world import Rectangles
from raycaster.registers import register_map
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.sim.register_model import AXES, COLOURS
from raycaster.verif.random_world import random_looks, random_rectangles
from raycaster.verif.seeds import seed

CYCLES = 500


def label(options) -> str:
    """Format a design's options for a test's name."""
    return "-".join([options["engine"], *(name for name in options if name != "engine")])


EVERY_BIT = (1 << WORD_BITS) - 1

MASKS = (0, 0xFF, 0xFF00, 0xFF0000, 0xFF000000, 0xFFFF, EVERY_BIT, EVERY_BIT, EVERY_BIT)


def sized(rectangles: int, **options) -> Configuration:
    """Make a design with room for this many rectangles."""
    return any_config(rectangles=rectangles, **options)


def random_bus(random: np.random.Generator, addresses: list[int], data: int | None = None) -> dict[str, int]:
    return {
        "bus_write": int(random.random() < 0.7),
        "bus_commit": int(random.random() < 0.15),
        "bus_go_live": int(random.random() < 0.15),
        "bus_address": int(random.choice(addresses)),
        "bus_data": int(random.choice([0, EVERY_BIT, random.integers(1 << WORD_BITS)]) if data is None else data),
        "bus_mask": int(random.choice(MASKS)),
    }


def rectangle_words(random: np.random.Generator) -> tuple[Rectangles, list[tuple[int, ...]]]:
    """Return rectangles, some without a plane, and their words with random unimplemented bits."""
    registers = register_map(1)
    point, surface, pattern = (registers[f"rectangle[0].{name}"] for name in ("corner_0", "surface", "pattern"))
    table = random_looks(random, random_rectangles(random, 12))
    words = []
    for index, corners in enumerate(table.corners):
        first, second = (
            point.pack(**dict(zip(AXES, map(int, corner), strict=True)))
            | int(random.integers(1 << WORD_BITS)) & ~point.implemented
            for corner in corners
        )
        channels, channels_2 = (
            dict(zip(COLOURS, map(int, colours[index]), strict=True)) for colours in (table.colours, table.colours_2)
        )
        # Values above 4 mean 4.
        mirror = int(random.integers(4, 8) if table.mirrors[index] == 4 else table.mirrors[index])
        cell = int(table.cells[index]).bit_length() - 4
        look = surface.pack(enable=int(table.enabled[index]), mirror=mirror, **channels)
        words.append((first, second, look, pattern.pack(kind=int(table.kinds[index]), cell=cell, **channels_2)))
    return table, words


def fixed_config(count: int, engine: str, camera: bool, alike: bool = False, **options: bool) -> Configuration:
    """Make a design of random fixed rectangles; with alike, all have the same axis."""
    random = np.random.default_rng(seed())
    rectangles = tuple(
        FixedRectangle(1 if alike else int(axis), *map(int, random.integers(512, size=5)), int(colour))
        for axis, colour in zip(random.integers(3, size=count), random.integers(1 << 24, size=count), strict=True)
    )
    if options:
        looks = zip(*(random.integers(most, size=count).tolist() for most in (5, 4, 6, 1 << 24)), strict=True)
        names = ("mirror", "kind", "cell", "colour_2")
        rectangles = tuple(
            dataclasses.replace(one, **dict(zip(names, look, strict=True)))
            for one, look in zip(rectangles, looks, strict=True)
        )
    eye = tuple(random.integers(512, size=3).tolist()) if camera else None
    fixed = FixedScene(rectangles, (2 * (1 << count) - 1 >> 1,) * 2, eye, 0 if camera else None)
    return configure(engine=engine, fixed=fixed, allow_underrun=True, **options)
