# SPDX-License-Identifier: MIT
"""Leaf tests of `exact_unit`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from engine_vectors import fate_of, place_of, usable_of
from exact_vectors import exact_config
from hard_scenes import cornered, facing, pixel_ports, rivalled, traced_scene, tracer
from vectors import basis_inputs, by_axis, check, colour_word, config_id, driven, leaf_of

from raycaster.golden.random_world import random_basis
from raycaster.golden.rays import primary_slopes
from raycaster.rtl.common.interfaces import RayFate
from raycaster.rtl.common.records import surface_of
from raycaster.rtl.exact.exact_unit import exact_unit
from raycaster.verif.expected import sorted_rect, trace_cycles


@pytest.mark.slow_sets("exact-vga240-u1-", "exact-vga240-u5")
@pytest.mark.parametrize(
    "config",
    [
        exact_config(screen=screen, units=units, rectangles=rectangles, reflections=reflections, colour_bits=bits)
        for screen, units, rectangles, reflections, bits in (
            ("vga", 4, 8, 1, 8), ("vga", 5, 8, 2, 8), ("tiny", 2, 8, 0, 1), ("vga", 320, 8, 2, 4), ("vga", 1, 4, 2, 8),
            ("vga", 8, 8, 4, 8),
        )
    ]
    + [exact_config(units=8, rectangles=8, reflections=2, culling=True)]
    + [
        exact_config(units=units, rectangles=8, reflections=reflections, **dict.fromkeys(switches, True))
        for units, reflections, *switches in (
            (4, 1, "turn"), (8, 2, "turn"), (5, 1, "patterns"), (8, 2, "materials"),
            (5, 2, "turn", "materials", "patterns"), (8, 4, "turn", "materials", "patterns"),
            (4, 0, "turn", "materials", "patterns"),
        )
    ],
    ids=config_id,
)  # fmt: skip
def test_exact_unit(config, tmp_path, random):
    """Rays whose last hits are close decisions: at edges, next to rivals, in corners, and at the end of the world."""
    leaf = leaf_of(exact_unit, tmp_path, config, offered=lambda: surface_of(config), fate=RayFate)
    slopes = primary_slopes(config.screen_geometry)
    rows, columns, _ = slopes.shape
    stimulus, expected, fates, alive = [], {}, set(), set()
    ends = config.culling or config.materials
    for _ in range(500 if config == exact_config(units=5, rectangles=8, reflections=2) else 80):
        basis = random_basis(random) if config.turn else None
        if basis is not None:
            slopes = primary_slopes(config.screen_geometry, basis)
        row = int(random.choice([0, 1, config.screen_geometry.horizon_row, rows - 1, random.integers(rows)]))
        column = int(random.choice([0, 1, columns // 2, columns - 1, random.integers(columns)]))
        hard = random.choice(["none", "rivalled", "cornered", "facing"], p=[0.3, 0.3, 0.3, 0.1])
        if hard == "facing":
            # A ray nearly along x stays in the world between the facing walls.
            row, column = (
                min(max(middle + int(random.integers(-20, 21)), 0), count - 1)
                for middle, count in ((config.screen_geometry.horizon_row, rows), (columns // 2, columns))
            )
        slope = slopes[row, column][None]
        camera, table, background, reflections, traced = traced_scene(random, config, slope)
        if hard != "none":
            if hard == "rivalled":
                table = rivalled(random, table, int(traced.winners[0][0]), camera, slope[0])
            elif hard == "cornered":
                table = cornered(random, table, camera, slope[0])
            else:
                table = facing(random, table, camera, slope[0])
            given = {"camera": camera, "background": background, "slopes": slope, "reflections": reflections}
            traced = tracer(config, **given)(table)
        fates.add((reflections, sum(int(winner[0]) >= 0 for winner in traced.winners)))
        held = by_axis("camera_", camera) | place_of(config, row, column)
        held |= {"picture_background": colour_word(background), "picture_reflections": reflections}
        held |= basis_inputs(basis) if basis is not None else {}
        usable = usable_of(table)
        if not usable:
            continue
        cycles = trace_cycles(config, usable, reflections, **fate_of(config, traced, table))
        # The place is valid before the ray is loaded.
        stimulus.append({**held, **dict.fromkeys(cycles[0].steps, 0)})
        for cycle in cycles:
            if cycle.alive is not None and ends:
                alive.add(cycle.alive)
                expected[len(stimulus)] = {"fate_alive": cycle.alive}
            other = int(random.choice(usable))
            current, offered = (other if one is None else one for one in (cycle.current, cycle.offered))
            rects = sorted_rect(table, current, "rect", config) | sorted_rect(table, offered, "offered", config)
            stimulus.append({**held, **cycle.steps, **rects})
        expected[len(stimulus)] = pixel_ports(config, traced.colours[0])
        stimulus.append({**held, **dict.fromkeys(cycles[0].steps, 0)})
    assert len(fates) >= 2 + 2 * config.reflections
    assert not ends or alive == {0, 1}
    settled = next(cycle for cycle, wanted in expected.items() if "fate_alive" not in wanted)
    check(leaf, driven(leaf, stimulus), expected, settled=settled)
