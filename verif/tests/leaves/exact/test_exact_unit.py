# SPDX-License-Identifier: MIT
"""`exact_unit`: rays whose last hits are close decisions: at edges, next to rivals, in corners, at the world's end."""

from engine_vectors import fate_of, place_of, scene_inputs, usable_of
from hard_scenes import cornered, facing, pixel_ports, rivalled, traced_scene, tracer
from vectors import basis_inputs, designs, exact_config

from raycaster.golden.random_world import random_basis
from raycaster.golden.rays import primary_slopes
from raycaster.rtl.exact.exact_unit import exact_unit
from raycaster.verif.expected import sorted_rect, trace_cycles

ALL = {"turn": True, "materials": True, "patterns": True}


@designs(
    exact_config(units=4, rectangles=8, reflections=1),
    exact_config(units=5, rectangles=8, reflections=2),
    exact_config(screen="tiny", units=2, rectangles=8, reflections=0, colour_bits=1),
    exact_config(units=320, rectangles=8, reflections=2, colour_bits=4),
    exact_config(units=1, rectangles=4, reflections=2),
    exact_config(units=8, rectangles=8, reflections=4),
    exact_config(units=8, rectangles=8, reflections=2, culling=True),
    exact_config(units=4, rectangles=8, reflections=1, turn=True),
    exact_config(units=8, rectangles=8, reflections=2, turn=True),
    exact_config(units=5, rectangles=8, reflections=1, patterns=True),
    exact_config(units=8, rectangles=8, reflections=2, materials=True),
    exact_config(units=5, rectangles=8, reflections=2, **ALL),
    exact_config(units=8, rectangles=8, reflections=4, **ALL),
    exact_config(units=4, rectangles=8, reflections=0, **ALL),
    slow=["exact-vga240-u1-", "exact-vga240-u5"],
)
def test_exact_unit(config, leaf_of, random):
    leaf = leaf_of(exact_unit, config)
    slopes = primary_slopes(config.screen_geometry)
    rows, columns, _ = slopes.shape
    fates, alive = set(), set()
    ends = config.culling or config.materials
    for _ in range(leaf.some(500 if config == exact_config(units=5, rectangles=8, reflections=2) else 80)):
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
        held = scene_inputs(camera, table, background, reflections) | place_of(config, row, column)
        held |= basis_inputs(basis) if basis is not None else {}
        usable = usable_of(table)
        if not usable:
            continue
        cycles = trace_cycles(config, usable, reflections, **fate_of(config, traced, table))
        # The place is valid before the ray is loaded.
        leaf.case({**held, **dict.fromkeys(cycles[0].steps, 0)})
        for cycle in cycles:
            other = int(random.choice(usable))
            current, offered = (other if one is None else one for one in (cycle.current, cycle.offered))
            rects = sorted_rect(table, current, "rect", config) | sorted_rect(table, offered, "offered", config)
            leaf.case({**held, **cycle.steps, **rects})
            if cycle.alive is not None and ends:
                alive.add(cycle.alive)
                leaf.expect({"fate_alive": cycle.alive})
        leaf.case({**held, **dict.fromkeys(cycles[0].steps, 0)}, pixel_ports(config, traced.colours[0]))
    assert len(fates) >= 2 + 2 * config.reflections
    assert not ends or alive == {0, 1}
    settled = next(cycle for cycle, wanted in leaf.expected.items() if "fate_alive" not in wanted)
    leaf.check(settled=settled, spare=True)
