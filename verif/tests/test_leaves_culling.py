# SPDX-License-Identifier: MIT
"""The blocks that say which rectangles a group's rays may hit: MyHDL's simulator, the converted Verilog, the rule in
Python's integers, and golden, whose hits are all among them."""

from collections.abc import Sequence

import numpy as np
import pytest
from fates import margin_of, may_hit_mask

from raycaster.configuration import WORLD_SIZE, Configuration, ConfigurationError, configure
from raycaster.engines.engine import SETUP_LATENCY
from raycaster.golden.engines import model_of
from raycaster.golden.random_world import EXTREMES, random_camera, random_rectangles
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.common.interfaces import Place, Rects
from raycaster.rtl.common.records import Facet, Point, Walk, WideRect
from raycaster.rtl.common.widths import (
    WIDE_BITS,
    bit,
    exact_slope_bits,
    signed,
    unsigned,
    walk_bits,
    wide_walk_bits,
)
from raycaster.rtl.cull.group_culler import group_culler
from raycaster.rtl.cull.group_tester import group_tester
from raycaster.rtl.cull.rect_copy import rect_copy
from raycaster.verif.leaf import Leaf, sorted_rect
from raycaster.verif.seeds import repeat, seed

AXES = "xyz"
BOUNDS = ("u_low", "u_high", "v_low", "v_high")


def config_id(config: Configuration) -> str:
    return config.name


def culling_config(**options) -> Configuration:
    return configure(**{"culling": True, "allow_underrun": True} | options)


def any_place(random: np.random.Generator) -> int:
    return int(random.choice(EXTREMES)) if random.random() < 0.3 else int(random.integers(WORLD_SIZE))


def hit_mask(config: Configuration, table: Rectangles, camera, row: int, offset: int) -> int:
    """What golden's primary rays of the group hit."""
    slopes = primary_slopes(config.screen_geometry)[row, offset * config.units : (offset + 1) * config.units]
    traced = model_of(config).trace(table, camera, (0, 0, 0), slopes, 0, keep=True)
    return sum(int(hit) << index for index, hit in enumerate(traced.bounces[0].hits.any(axis=1)))


def scenes(random: np.random.Generator, config: Configuration):
    """Camera and table, of which all rectangles are enabled and have a plane; some touch the rays at a group's ends."""
    while True:
        table = random_rectangles(random, config.rectangles, closed=None if config.rectangles >= 7 else False)
        camera = np.asarray(random_camera(random, table))
        if random.random() < 0.3:
            camera = np.array([any_place(random) for _ in AXES])
        corners = table.corners.copy()
        corners[~table.visible, 1, 0] = corners[~table.visible, 0, 0]
        yield camera, Rectangles(corners, table.colours, np.ones(len(table), dtype=bool))


def with_edges_on_rays(
    random: np.random.Generator, config: Configuration, table: Rectangles, camera, places: Sequence[tuple[int, int]]
) -> Rectangles:
    """Many of the rectangles get an edge where a ray at an end of one of the groups meets their plane, or next to it.

    places: of groups, each a row and a number in it.
    """
    slopes = primary_slopes(config.screen_geometry)
    corners = table.corners.copy()
    for index in range(len(table)):
        axis = int(table.axes[index])
        row, offset = places[int(random.integers(len(places)))]
        first = [int(d) for d in slopes[row, offset * config.units]]
        end = [first[0], first[1] + int(random.choice([0, config.units - 1, config.units])), first[2]]
        if random.random() < 0.6 and end[axis]:
            u, v = (int(other) for other in random.permutation(OTHER_AXES[axis]))
            met = camera[u] + end[u] * (corners[index, 0, axis] - camera[axis]) // end[axis]
            if random.random() < 0.7:
                # So that this edge alone decides.
                corners[index, :, v] = 0, WORLD_SIZE - 1
            corners[index, random.integers(2), u] = np.clip(met + random.integers(-2, 3), 0, WORLD_SIZE - 1)
    return Rectangles(corners, table.colours, table.enabled)


# The configuration ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "culls", "name"),
    [
        ({}, True, "seed-vga240-u32-r12-m1-f0t-d1-c8"),
        ({"culling": "0"}, False, "seed-vga240-u32-r12-m1-f0t-d1-c8-k0"),
        ({"engine": "exact"}, False, "exact-vga240-u4-r12-m1-c8"),
        ({"engine": "exact", "culling": "1"}, True, "exact-vga240-u4-r12-m1-c8-k1"),
        ({"engine": "beam"}, False, "beam-vga240-s2-u1-r12-m1-c8"),
    ],
)
def test_which_designs_cull(options, culls, name):
    config = configure(**options)
    assert config.culling is culls
    assert config.name == name
    # The worst case is the same, so the choice is free.
    assert config.group_cycles == configure(**{**options, "culling": None}).group_cycles


def test_the_beam_engine_does_not_cull():
    with pytest.raises(ConfigurationError, match=r"^culling: the beam engine takes all rectangles at once; leave it"):
        configure(engine="beam", culling="1")


# rect_copy ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("margin", [0, 1])
@pytest.mark.parametrize("count", [1, 12, 32])
def test_rect_copy(count, margin, tmp_path):
    """Fetches of both readers in any order; the second sees what came to the first last, and further out."""
    config = configure(engine="exact", rectangles=count, allow_underrun=True)
    latency = config.facts.rect_latency

    def copy():
        copied = Rects(config)
        copied.rect = WideRect()
        return copied

    leaf = Leaf(
        rect_copy,
        lambda: {"clk": bit(), "rects": Rects(config), "copy": copy(), "margin": margin, "config": config},
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus, written, asked = [], [], []
    for cycle in range(600):
        fetch, index = int(cycle < count or random.random() < 0.3), cycle if cycle < count else random.integers(count)
        # Only what was fetched is asked for, and long enough ago.
        ask = int(cycle > count + 4 and random.random() < 0.7)
        corners = np.array([[any_place(random) for _ in AXES] for _ in range(2)])
        corners[1, random.integers(3)] = corners[0].copy()[axis := int(random.integers(3))]
        corners[1, axis] = corners[0, axis]
        shown = sorted_rect(Rectangles(corners[None], np.zeros((1, 3), np.uint8), np.ones(1, bool)), 0, "rects_rect")
        del shown["rects_rect_colour"]
        wanted = int(random.integers(count))
        stimulus.append(
            {"rects_fetch": fetch, "rects_index": int(index), "copy_fetch": ask, "copy_index": wanted, **shown}
        )
        written.append((fetch, int(index), shown))
        asked.append((ask, wanted))
    outputs = leaf.run_both(stimulus, settled=count + 8)
    memory, answer = {}, None
    for cycle, output in enumerate(outputs):
        # A rectangle that was at hand three cycles ago could be read two cycles ago.
        at_hand, read = cycle - 3, cycle - 2
        if at_hand >= latency and written[at_hand - latency][0]:
            memory[written[at_hand - latency][1]] = written[at_hand][2]
        if read >= 0 and asked[read][0]:
            answer = memory[asked[read][1]]
        if answer is not None:
            expected = {name: answer[f"rects_rect_{name}"] for name in ("axis", "position", *BOUNDS)}
            for name in BOUNDS:
                further = expected[name] + (margin if name.endswith("high") else -margin)
                expected[name] = further % (1 << WIDE_BITS)
            assert output == {f"copy_rect_{name}": value for name, value in expected.items()}, (cycle, repeat())


# group_tester ---------------------------------------------------------------------------------------------------------

designs = pytest.mark.parametrize(
    "config",
    [
        culling_config(),
        culling_config(units=20, rectangles=4, fraction_bits=4, rounding="nearest", rows=200),
        culling_config(units=1, rectangles=3),
        culling_config(units=320, rectangles=2),
        culling_config(screen="tiny", units=16, rectangles=32, divider_bits=3),
        culling_config(engine="exact"),
        culling_config(engine="exact", units=64, rectangles=1),
        culling_config(engine="exact", screen="tiny", units=2, rectangles=9),
    ],
    ids=config_id,
)


def leaf_of_tester(config: Configuration, directory) -> Leaf:
    slope_bits = exact_slope_bits(config) + 1
    return Leaf(
        group_tester,
        lambda: {
            "clk": bit(),
            "load": unsigned(config.rectangles),
            "facet": Facet(walk_bits(config)),
            "growth": Walk(WIDE_BITS),
            "start": Walk(wide_walk_bits(config)),
            "column_slope": signed(slope_bits),
            "row_slope": signed(slope_bits),
            "may_hit": unsigned(config.rectangles),
            "config": config,
        },
        directory,
    )


@pytest.mark.slow_sets("seed-vga240-u1-", "seed-vga240-u320")
@designs
def test_group_tester(config, tmp_path):
    """Products as rect_setup makes them, of groups at the screen's borders and in its middle, and edges on the rays."""
    slope_bits = exact_slope_bits(config) + 1
    leaf = leaf_of_tester(config, tmp_path)
    random = np.random.default_rng(seed())
    slopes = primary_slopes(config.screen_geometry)
    margin, rows = margin_of(config), config.screen_geometry.rows
    stimulus, expected = [], {}
    for (camera, drawn), _ in zip(scenes(random, config), range(3000 // config.rectangles), strict=False):
        row = int(random.choice([0, config.screen_geometry.horizon_row, rows - 1, random.integers(rows)]))
        offset = int(random.integers(config.groups))
        slope = [int(d) for d in slopes[row, offset * config.units]]
        table = with_edges_on_rays(random, config, drawn, camera, [(row, offset)])
        mask = may_hit_mask(config, table, camera, row, offset)
        held = {"column_slope": slope[1] % (1 << slope_bits), "row_slope": slope[2] % (1 << slope_bits)}
        for index in range(len(table)):
            axis = int(table.axes[index])
            p, q = (0, 2) if axis == 1 else (1, 2) if axis == 0 else (1, 0)
            low, high = (bound[index].astype(object) - camera for bound in (table.low - margin, table.high + margin))
            n, e = int(table.low[index, axis] - camera[axis]), slope[axis]
            start = {"way_p": n * slope[p], "low_p": low[p] * e, "high_p": high[p] * e}
            start |= {"low_q": low[q] * e, "high_q": high[q] * e}
            growth = dict.fromkeys(start, 0) | {"way_p": n}
            if axis == 1:
                growth = {"way_p": 0, "low_p": low[p], "high_p": high[p], "low_q": low[q], "high_q": high[q]}
            inputs = {"facet_axis": axis, "facet_distance": n, "facet_way_q": n * slope[q]}
            inputs |= {f"start_{name}": value for name, value in start.items()}
            inputs |= {f"growth_{name}": value for name, value in growth.items()}
            inputs = {name: int(value) % (1 << leaf.given[name].width) for name, value in inputs.items()}
            stimulus.append({**held, **inputs, "load": 1 << index})
        stimulus += [{"load": 0}] * 2
        expected[len(stimulus) - 1] = mask, row, offset, camera, table
    outputs = leaf.run_both(stimulus, settled=min(expected) + 1)
    seen = set()
    for cycle, (mask, row, offset, camera, table) in expected.items():
        case = row, offset, camera.tolist(), table.corners.tolist(), repeat()
        assert outputs[cycle]["may_hit"] == mask, case
        assert hit_mask(config, table, camera, row, offset) & ~mask == 0, case
        seen |= {mask >> index & 1 for index in range(len(table))}
    assert seen == {0, 1}


@pytest.mark.slow_sets(quick=["exact-vga240-u64", "seed-tiny48"])
@designs
def test_group_tester_at_its_limits(config, tmp_path):
    """Any products, at which each comparison is decided by its last bit, one bit or the sign."""
    leaf = leaf_of_tester(config, tmp_path)
    random = np.random.default_rng(seed())
    units, far = config.units, 1 << wide_walk_bits(config) - 2
    slope_limit = 1 << exact_slope_bits(config) - 1
    stimulus, expected = [], {}

    def small() -> int:
        return int(random.choice([0, 1, 2, 1 << int(random.integers(far.bit_length() - 3))]) * random.choice([-1, 1]))

    for _ in range(6000):
        axis = int(random.integers(3))
        distance = int(random.choice([0, 1, -1, 1 << int(random.integers(9)), *random.integers(-511, 512, size=4)]))
        turning = [0, -1, -units, 1 - units, -units - 1]
        column_slope, row_slope = (
            int(np.clip(random.choice([*turning, *random.integers(-slope_limit, slope_limit, size=15)]), -far, far))
            for _ in range(2)
        )
        column_slope, row_slope = max(-slope_limit, column_slope), max(-slope_limit, row_slope)
        slopes = {0: (1, 1), 1: (column_slope, column_slope + units), 2: (row_slope, row_slope)}[axis]
        backs = [slope < 0 for slope in slopes]
        if random.random() < 0.9:
            # Ahead, so that the bounds decide.
            distance = (-1 if backs[0] else 1) * max(1, abs(distance))
        start = {"way_p": int(random.integers(-far // 4, far // 4)), "way_q": int(random.integers(-far // 4, far // 4))}
        growth = {"way_p": int(random.integers(-far // 8, far // 8)) // units % 512 - 256}
        growth["way_p"] = growth["way_p"] if abs(growth["way_p"]) * units < far // 8 else 0
        # Bounds are far away on their side, but one that decides: at one end or both it is near.
        low, high = ("high", "low") if backs[0] else ("low", "high")
        for p in "pq":
            start |= {f"{low}_{p}": -far // 2, f"{high}_{p}": far // 2}
            growth |= {f"{low}_{p}": 0, f"{high}_{p}": 0}
        side, p = str(random.choice(["low", "high"])), str(random.choice(["p", "q"]))
        more = int(random.choice([0, 0, 1, -1, small() % 64 - 32]))
        apart = small() - int(random.integers(2)) * more * units
        start[f"{side}_{p}"] = start[f"way_{p}"] + apart
        growth[f"{side}_{p}"] = growth.get(f"way_{p}", 0) + more
        end = {name: value + growth.get(name, 0) * units for name, value in start.items()}
        impossible = distance == 0 or all((distance < 0) != back for back in backs)
        if backs[0] == backs[1]:
            for p in "pq":
                impossible |= all(at[f"way_{p}"] < at[f"{low}_{p}"] for at in (start, end))
                impossible |= all(at[f"way_{p}"] > at[f"{high}_{p}"] for at in (start, end))
        inputs = {"facet_axis": axis, "facet_distance": distance, "facet_way_q": start.pop("way_q")}
        inputs |= {"column_slope": column_slope, "row_slope": row_slope}
        inputs |= {f"start_{name}": value for name, value in start.items()}
        inputs |= {f"growth_{name}": value for name, value in growth.items()}
        inputs = {name: value % (1 << leaf.given[name].width) for name, value in inputs.items()}
        index = len(stimulus) % config.rectangles
        expected[len(stimulus) + 2] = index, not impossible
        stimulus.append({**inputs, "load": 1 << index})
    stimulus += [{"load": 0}] * 2
    outputs = leaf.run_both(stimulus, settled=config.rectangles + 2)
    for cycle, (index, may_hit) in expected.items():
        assert outputs[cycle]["may_hit"] >> index & 1 == may_hit, (stimulus[cycle - 2], repeat())


# group_culler ---------------------------------------------------------------------------------------------------------


def seen_rect(table: Rectangles, index: int) -> dict[str, int]:
    """What the table shows of a rectangle to who listens."""
    return sorted_rect(table, index, "rects_rect")


def any_rect(random: np.random.Generator, table: Sequence[dict[str, int]]) -> dict[str, int]:
    """Something on the table's port, which is no one's unless it was fetched."""
    shown, index = (int(random.integers(len(table))) for _ in range(2))
    return {**table[shown], "rects_index": index}


def closest_calls(
    config: Configuration, drafts: Sequence[Rectangles], camera, places: Sequence[tuple[int, int]]
) -> Rectangles:
    """Of each rectangle the draft that an error in a product's lowest bits would decide otherwise in one of the groups.

    All drafts have the same planes.
    """
    slopes, margin = primary_slopes(config.screen_geometry), margin_of(config)
    first = np.array([slopes[row, offset * config.units] for row, offset in places]).astype(int)
    ends = np.stack([first, first + [0, config.units, 0]])
    corners = []
    for index, axis in enumerate(drafts[0].axes):
        u = list(OTHER_AXES[axis])
        e, across = ends[..., [axis]], ends[..., u]
        distances = []
        for draft in drafts:
            way = np.sign(e) * (draft.low[index, axis] - camera[axis]) * across
            above = way - (draft.low[index, u] - margin - camera[u]) * abs(e)
            below = (draft.high[index, u] + margin - camera[u]) * abs(e) - way
            # Of each bound the end that misses it by less; of the bounds the one that decides, if no other does too.
            least, other, *_ = np.sort(np.concatenate([above.max(axis=0), below.max(axis=0)], axis=1), axis=1).T
            distances.append(np.where(other >= 0, abs(least), WORLD_SIZE**2).min())
        corners.append(drafts[int(np.argmin(distances))].corners[index])
    return Rectangles(np.array(corners), drafts[0].colours, drafts[0].enabled)


def any_start(random: np.random.Generator, rows: int, groups: int) -> tuple[int, int]:
    """A group but the frame's first: often one that differs from that in a single bit, or the end of such a row."""
    while True:
        # The last rows are those below the horizon.
        any_row, last_row = random.integers(rows), rows - 1 - random.integers(rows // 4)
        row = random.choice([0, 1 << int(random.integers(rows.bit_length())), any_row, last_row, last_row])
        offset = random.choice([0, groups - 1, 1 << int(random.integers(groups.bit_length())), random.integers(groups)])
        if 0 < row * groups + offset < rows * groups and offset < groups:
            return int(row), int(offset)


@pytest.mark.slow_sets("seed-vga240-u1-", "seed-vga240-u320")
@designs
def test_group_culler(config, tmp_path):
    """A frame's first group, then others in their order and out of it, with time enough to look ahead or too little."""
    leaf = Leaf(
        group_culler,
        lambda: {
            "clk": bit(),
            "reset_ray_caster": bit(),
            "start_group": bit(),
            "done": bit(),
            "place": Place(config),
            "camera": Point(),
            "rects": Rects(config),
            "may_hit": unsigned(config.rectangles),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    count, groups, rows = config.rectangles, config.groups, config.screen_geometry.rows
    latency = config.facts.rect_latency
    every = (1 << count) - 1
    stimulus, expected, fates = [], {}, set()

    for (camera, drawn), _ in zip(scenes(random, config), range(max(6, 600 // count)), strict=False):
        start = any_start(random, rows, groups)
        first = start[0] * groups + start[1]
        run = [divmod(number, groups) for number in range(first, min(first + 9, rows * groups))]
        drafts = [with_edges_on_rays(random, config, drawn, camera, run) for _ in range(8)]
        table = closest_calls(config, drafts, camera, run)
        shown = [seen_rect(table, index) for index in range(count)]
        scene = {f"camera_{axis}": int(value) for axis, value in zip(AXES, camera, strict=True)}
        quiet = {**scene, "reset_ray_caster": 0, "start_group": 0, "done": 0, "rects_fetch": 0}
        place, predicted, known = (0, 0), None, False
        for number in range(12):
            here = {**quiet, "place_row": place[0], "place_column_offset": place[1]}
            answer = may_hit_mask(config, table, camera, *place) if predicted == place else every
            assert hit_mask(config, table, camera, *place) & ~answer == 0, repeat()
            fates.add((known, predicted == place, answer == every))
            # The second cycle of reset; then the group's time, in which the answer holds to the next one's first cycle.
            stimulus.append({**here, "reset_ray_caster": 1})
            begun = len(stimulus)
            stimulus += [here, {**here, "start_group": 1}]
            for index in range(count) if number == 0 else ():
                stimulus.append({**here, **any_rect(random, shown), "rects_fetch": 1, "rects_index": index})
                stimulus += [{**here, **any_rect(random, shown)}] * (latency - 1)
                stimulus.append({**here, **any_rect(random, shown), **shown[index]})
            time = count + SETUP_LATENCY + int(random.integers(3))
            if random.random() < 0.05:
                time = int(random.integers(3, count + SETUP_LATENCY))
            # What is on the table's port and was not fetched is nobody's.
            stimulus += [{**here, **any_rect(random, shown)} for _ in range(time - 1)]
            # A frame of which not even that is done has taught nothing.
            abandoned = random.random() < 0.05
            stimulus.append({**here, "reset_ray_caster": 1, "done": int(not abandoned)})
            expected |= dict.fromkeys(range(begun, len(stimulus)), (answer, place, camera, table))

            following = (place[0], place[1] + 1) if place[1] < groups - 1 else (place[0] + 1, 0)
            predicted = following if known and time >= count + SETUP_LATENCY else None
            known = known or (number == 0 and not abandoned)
            place = following
            if abandoned or place[0] == rows:
                place = any_start(random, rows, groups) if random.random() < 0.5 else run[random.integers(len(run))]
            if number == 1:
                # As if the frame had come to where the rectangles' edges are.
                place = start[0] if start[1] else start[0] - 1, (start[1] - 1) % groups
                place = (1, 0) if place == (0, 0) else place
    outputs = leaf.run_both(stimulus, settled=min(expected))
    for cycle, (answer, place, camera, table) in expected.items():
        case = cycle, place, camera.tolist(), table.corners.tolist(), repeat()
        assert outputs[cycle]["may_hit"] == answer, case
    assert {(True, True, False), (True, False, True), (False, False, True)} <= fates
