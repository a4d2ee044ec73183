# SPDX-License-Identifier: MIT
"""Leaf tests of `line_starter`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from beam_vectors import beam_config, direction_ports, word
from vectors import config_id, ports

from raycaster.engines.beam import AIM_LATENCY, SETUP_LATENCY
from raycaster.golden.random_world import random_basis
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import signed, unsigned
from raycaster.rtl.beam.line_starter import line_starter
from raycaster.rtl.common.interfaces import Direction
from raycaster.rtl.common.records import camera_of
from raycaster.rtl.common.widths import BASIS_BITS, exact_slope_bits, factor_bits


@pytest.mark.parametrize(
    "config",
    [
        beam_config(screen="tiny", turn=True, rectangles=3),
        beam_config(rows=180, turn=True, rectangles=1),
        beam_config(screen="tiny", turn=True, rectangles=3, pixels=2),
        beam_config(rows=180, scale=6, turn=True, rectangles=1, pixels=2),
    ],
    ids=config_id,
)
def test_line_starter(config, tmp_path, random):
    """The aims, from their latency on, each until its sweep ends; the end of the last sweep changes nothing."""
    slope_bits, screen, basis_names = (
        exact_slope_bits(config) + 1,
        config.screen_geometry,
        list(camera_of(config).layout)[3:],
    )
    leaf = Leaf(line_starter, lambda: ports(
        "clk reset start_line loaded start_sweep", camera=camera_of(config), row_slope=signed(factor_bits(config)),
        aim=Direction(slope_bits), enter=unsigned(config.pixels), config=config
    ), tmp_path)  # fmt: skip
    stimulus, expected = [{"reset": 1}] * 6, {}
    for _ in range(60):
        basis = np.array(random_basis(random), dtype=np.int64)
        row = int(random.choice([0, screen.rows - 1, random.integers(screen.rows)]))
        held = {
            f"camera_{name}": word(value, BASIS_BITS) for name, value in zip(basis_names, basis.flatten(), strict=True)
        }
        held |= {"reset": 0, "start_line": 0, "loaded": 0}
        start, ended = len(stimulus), random.random() < 0.2
        sweep = SETUP_LATENCY + config.rectangles - 1
        first_end = AIM_LATENCY - 3 + sweep
        ends = [first_end + sweep * lane for lane in range(config.pixels)]
        stimulus += [
            {**held, "start_line": 1},
            {**held, "reset": int(ended)},
            {**held, "row_slope": word(screen.horizon_row - row, factor_bits(config))},
        ]
        stimulus += [held] * (first_end - 3)
        stimulus += [{**held, "loaded": 1}, *[held] * (sweep - 1)] * config.pixels
        stimulus += [{**held, "loaded": 1}, *[held] * int(random.integers(1, 4))]
        first = [screen.view_distance, -screen.centre_column, screen.horizon_row - row] @ basis
        aims = [first + lane * basis[1] for lane in range(config.pixels)] + [config.pixels * basis[1]]
        for cycle in range(start, len(stimulus)):
            age = cycle - start
            sweeps = age in (AIM_LATENCY - 3, *ends) and not ended
            entering = sum(1 << lane for lane, end in enumerate(ends) if age == end and not ended)
            aim = direction_ports("aim", config, aims[sum(age >= end + 2 for end in ends)])
            expected[cycle] = {"start_sweep": int(sweeps), "enter": entering}
            expected[cycle] |= {} if age < AIM_LATENCY or ended else aim
    outputs = leaf.run_both([*stimulus, {}], settled=6 + AIM_LATENCY)
    for cycle, fields in expected.items():
        assert {name: outputs[cycle][name] for name in fields} == fields, cycle
