# SPDX-License-Identifier: MIT
"""Leaf tests of `beam_pass`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from beam_vectors import beam_config, folded, met_last, race, row_ports, row_signals, seen_from
from hard_scenes import verdict
from vectors import ports

from raycaster.engines.beam import winner_latency
from raycaster.golden.exact import ExactModel
from raycaster.golden.rays import primary_slopes
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit
from raycaster.rtl.beam.beam_pass import beam_pass
from raycaster.rtl.common.records import candidate_of, fold_of, winner_of
from raycaster.rtl.common.widths import steepest_slope


@pytest.mark.slow_sets("1")
@pytest.mark.parametrize("mirrors", [0, 1, 2])
def test_beam_pass(mirrors, tmp_path, random):
    """The rectangle that a ray meets after a number of mirrors, in rows with set-up products."""
    config = beam_config(screen="tiny", rectangles=3, reflections=2, scale=1)
    strobes = ("step", "step_way", "step_bounds", "step_slope")
    leaf = Leaf(beam_pass, lambda: ports(
        "clk", **row_signals(config), **{strobe: bit() for strobe in strobes}, fold=fold_of(config),
        nearest=candidate_of(config), winner=winner_of(config), tested=range(config.rectangles),
        reflected=mirrors > 0, config=config
    ), tmp_path)  # fmt: skip
    slopes, quiet = primary_slopes(config.screen_geometry), dict.fromkeys(strobes, 0)
    steepest = steepest_slope(config)
    spare = steepest - int(abs(slopes[..., 1]).max())
    stimulus, expected = [quiet] * winner_latency(config), {}
    for _ in range(500):
        # The view of another screen, from any column on, so that every bit of the slopes matters.
        view = slopes[int(random.integers(len(slopes)))].copy()
        view[:, 0] = random.integers(1, steepest + 1)
        view[:, 1] += random.integers(-spare, spare + 1)
        view[:, 2] = random.integers(-steepest, steepest + 1)
        camera, table, column = race(random, config, view)
        first = int(random.integers(column + 1))
        line = view[first : column + 1 + int(random.integers(4))]
        traced = ExactModel().trace(table, camera, (0, 0, 0), line, mirrors)
        held, begin = row_ports(config, table, camera, view[first : first + 2])
        stimulus += [quiet | held | cycle for cycle in begin]
        # A column's strobes follow it; some cycles have no column.
        starts = np.cumsum(random.choice([1, 2], len(line), p=[0.8, 0.2])).tolist()
        cycles = [quiet | held for _ in range(starts[-1] + winner_latency(config) + 1)]
        for number, start in enumerate(starts):
            slope, winners = line[number], [int(winner[number]) for winner in traced.winners]
            for strobe, later in zip(strobes, (0, int(not mirrors), 1, 2), strict=True):
                cycles[start + later][strobe] = 1
            if -1 in winners[:mirrors]:
                continue
            met = [(axis := int(table.axes[winner]), int(table.low[winner, axis])) for winner in winners[:mirrors]]
            if mirrors:
                fields = folded(config, camera, slope, met)
                cycles[start] |= {f"fold_{name}": value for name, value in fields.items()}
            case = camera, table.corners, slope, met
            values = {"winner_valid": int(winners[mirrors] >= 0)}
            if winners[mirrors] >= 0:
                eye, turned = seen_from(camera, slope, met)
                seen_by = table, winners[mirrors], eye, turned, met[-1] if met else None
                _, n, e = verdict(*seen_by, met_last(camera, slope, met))
                values |= {"winner_index": winners[mirrors], "winner_at_mirror": int(not verdict(*seen_by)[0])}
                values |= {"nearest_numerator": n, "nearest_denominator": e}
            expected[len(stimulus) + start + winner_latency(config)] = values, case
        stimulus += cycles
    outputs = leaf.run_both([*stimulus, quiet], settled=min(expected))
    for cycle, (values, case) in expected.items():
        assert {name: outputs[cycle][name] for name in values} == values, case
