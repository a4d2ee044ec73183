# SPDX-License-Identifier: MIT
"""Leaf test of `beam_pass`: the rectangle that a ray meets after a number of mirrors, in rows with set-up products."""

import numpy as np
import pytest
from beam_vectors import any_view, beam_config, folded, met_last, race, row_ports, row_ports_of, seen_from
from hard_scenes import verdict
from vectors import by, named

from raycaster.golden.exact import ExactModel
from raycaster.rtl.beam.beam_pass import beam_pass
from raycaster.rtl.beam.latencies import winner_latency


@pytest.mark.slow_sets("0", "1")
@by(mirrors=[0, 1, 2])
def test_beam_pass(mirrors, leaf_of, random):
    config = beam_config(screen="tiny", rectangles=3, reflections=2, scale=1)
    tested = {"tested": range(config.rectangles), "reflected": mirrors > 0}
    leaf = leaf_of(beam_pass, config, **row_ports_of(config), **tested)
    # A column's strobes follow it.
    strobes = {"step": 0, "step_way": int(not mirrors), "step_bounds": 1, "step_slope": 2}
    quiet, latency = dict.fromkeys(strobes, 0), winner_latency(config)
    leaf.stimulus = [quiet] * latency
    for _ in range(leaf.some(500)):
        view = any_view(random, config)
        camera, table, column = race(random, config, view)
        # The row begins with any column.
        first = int(random.integers(column + 1))
        line = view[first : column + 1 + int(random.integers(4))]
        traced = ExactModel().trace(table, camera, (0, 0, 0), line, mirrors)
        held, begin = row_ports(config, table, camera, view[first : first + 2])
        leaf.stimulus += [quiet | held | cycle for cycle in begin]
        # Some cycles have no column.
        starts = np.cumsum(random.choice([1, 2], len(line), p=[0.8, 0.2])).tolist()
        cycles = [quiet | held for _ in range(starts[-1] + latency + 1)]
        for number, start in enumerate(starts):
            slope, (*before, winner) = line[number], [int(winner[number]) for winner in traced.winners]
            for strobe, later in strobes.items():
                cycles[start + later][strobe] = 1
            if -1 in before:
                continue
            met = [(int(table.axes[index]), int(table.low[index, table.axes[index]])) for index in before]
            if mirrors:
                cycles[start] |= named("fold", folded(camera, slope, met))
            wanted = {"winner_valid": winner >= 0}
            if winner >= 0:
                seen_by = *seen_from(camera, slope, met), met[-1] if met else None
                _, n, e, at_mirror = verdict(table, winner, *seen_by, met_last(camera, slope, met))
                wanted |= {"winner_index": winner, "winner_at_mirror": at_mirror}
                wanted |= {"nearest_numerator": n, "nearest_denominator": e}
            leaf.expected[leaf.cycle + start + latency] = wanted
        leaf.stimulus += cycles
    leaf.case(quiet)
    leaf.check(settled=min(leaf.expected))
