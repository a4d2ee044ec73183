# SPDX-License-Identifier: MIT
"""Leaf tests of `exact_unit`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from exact_vectors import basis_inputs, exact_config, two_complement
from hard_scenes import cornered, facing, pixel_of, pixel_word, rivalled, traced_scene, tracer
from vectors import config_id, ports

from raycaster.golden.random_world import random_basis
from raycaster.golden.rays import primary_slopes
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import Picture, Place, RayFate, Steps
from raycaster.rtl.common.records import Pixel, camera_of, rect_of, surface_of
from raycaster.rtl.common.widths import unit_bits
from raycaster.rtl.exact.exact_unit import exact_unit
from raycaster.verif.expected import sorted_rect, trace_cycles


def held_inputs(camera, background, reflections) -> dict[str, int]:
    colour = int.from_bytes(bytes(background.astype(np.uint8)))
    return {**two_complement(camera, 9, "camera"), "picture_background": colour, "picture_reflections": reflections}


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
    leaf = Leaf(exact_unit, lambda: ports(
        "clk", steps=Steps(), place=Place(config), column_base=unsigned(unit_bits(config)), camera=camera_of(config),
        rect=rect_of(config), offered=surface_of(config), picture=Picture(), pixel=Pixel(config.colour_bits),
        fate=RayFate(), config=config
    ), tmp_path)  # fmt: skip
    slopes = primary_slopes(config.screen_geometry)
    rows, columns, _ = slopes.shape
    stimulus, results, fates, alive = [], [], set(), {}
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
        place = {"place_row": row, "place_column_offset": column // config.units, "column_base": column % config.units}
        held = {**held_inputs(camera, background, reflections), **place}
        if basis is not None:
            held |= basis_inputs(basis)
        held = {name: value for name, value in held.items() if name in leaf.given}
        usable = [int(index) for index in np.flatnonzero(table.visible)]
        if not usable:
            continue
        endings = [
            bounce
            for bounce, winner in enumerate(traced.winners)
            if winner[0] < 0 or (config.materials and table.mirrors[winner[0]] == 0)
        ]
        lost = min(endings, default=None) if ends else None
        cycles = trace_cycles(config, usable, reflections, lost=lost)
        # The place is valid before the ray is loaded.
        stimulus.append({**held, **{name: 0 for name in cycles[0].steps if name in leaf.given}})
        for cycle in cycles:
            if cycle.alive is not None and ends:
                alive[len(stimulus)] = cycle.alive
            other = int(random.choice(usable))
            inputs = {**held, **cycle.steps}
            inputs |= sorted_rect(table, other if cycle.current is None else cycle.current, "rect", config)
            inputs |= sorted_rect(table, other if cycle.offered is None else cycle.offered, "offered", config)
            stimulus.append({name: value for name, value in inputs.items() if name in leaf.given})
        case = f"row {row}, column {column}, camera {camera}, corners {table.corners.tolist()}"
        results.append((len(stimulus), pixel_word(config, traced.colours[0]), case))
        stimulus.append({**held, **{name: 0 for name in cycle.steps if name in leaf.given}})
    assert len(fates) >= 2 + 2 * config.reflections
    outputs = leaf.run_both(stimulus, settled=results[0][0])
    for cycle, pixel, case in results:
        assert pixel_of(config, outputs[cycle]) == pixel, case
    for cycle, expected in alive.items():
        assert outputs[cycle]["fate_alive"] == expected, cycle
    assert not ends or set(alive.values()) == {0, 1}
