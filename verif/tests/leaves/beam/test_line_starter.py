# SPDX-License-Identifier: MIT
"""`line_starter`: the aims, from their latency on, each until its sweep ends; the last sweep's end changes nothing."""

import numpy as np
from beam_vectors import beam_config
from vectors import basis_inputs, by_axis, designs

from raycaster.hdl.signals import Signed
from raycaster.rtl.beam.latencies import AIM_LATENCY
from raycaster.rtl.beam.line_starter import line_starter
from raycaster.rtl.common.widths import factor_bits
from raycaster.rtl.engine.rect_setup import SETUP_LATENCY
from raycaster.verif.random_world import random_basis


@designs(
    beam_config(screen="tiny", turn=True, rectangles=3),
    beam_config(rows=180, turn=True, rectangles=1),
    beam_config(screen="tiny", turn=True, rectangles=3, pixels=2),
    beam_config(rows=180, scale=6, turn=True, rectangles=1, pixels=2),
)
def test_line_starter(config, leaf_of, random):
    widths = {"row_slope": Signed(factor_bits(config)), "enter": config.pixels}
    leaf, screen = leaf_of(line_starter, config, **widths), config.screen_geometry
    sweep = SETUP_LATENCY + config.rectangles - 1
    ends = [AIM_LATENCY - 3 + sweep * (lane + 1) for lane in range(config.pixels)]
    leaf.stimulus = [{"reset": 1}] * 6
    for _ in range(60):
        basis = np.array(random_basis(random), dtype=np.int64)
        row = int(random.choice([0, screen.rows - 1, random.integers(screen.rows)]))
        held = basis_inputs(basis) | {"reset": 0, "start_line": 0, "loaded": 0}
        start, ended = leaf.cycle, random.random() < 0.2
        row_slope = screen.horizon_row - row
        leaf.stimulus += [{**held, "start_line": 1}, {**held, "reset": ended}, {**held, "row_slope": row_slope}]
        leaf.stimulus += [held] * (ends[0] - 3)
        leaf.stimulus += [{**held, "loaded": 1}, *[held] * (sweep - 1)] * config.pixels
        leaf.stimulus += [{**held, "loaded": 1}, *[held] * int(random.integers(1, 4))]
        first = [screen.view_distance, -screen.centre_column, row_slope] @ basis
        aims = [first + lane * basis[1] for lane in range(config.pixels)] + [config.pixels * basis[1]]
        for age in range(leaf.cycle - start):
            entering = sum(1 << lane for lane, end in enumerate(ends) if age == end and not ended)
            sweeps = age in (AIM_LATENCY - 3, *ends) and not ended
            leaf.expected[start + age] |= {"start_sweep": sweeps, "enter": entering}
            if age >= AIM_LATENCY and not ended:
                leaf.expected[start + age] |= by_axis("aim_", aims[sum(age >= end + 2 for end in ends)])
    leaf.case({})
    leaf.check(settled=6 + AIM_LATENCY)
