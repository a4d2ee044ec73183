# SPDX-License-Identifier: MIT
"""Leaf tests of `fold_tester`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from beam_vectors import beam_config, by_screen, check_tester
from vectors import config_id

from raycaster.rtl.beam.fold_tester import fold_tester
from raycaster.rtl.common.records import fold_of

by_depth = pytest.mark.parametrize(
    "config",
    [
        *by_screen.args[1],
        beam_config(reflections=3, screen="tiny"),
        beam_config(reflections=4, rows=180),
        beam_config(reflections=3, rows=240, turn=True, patterns=True),
        beam_config(reflections=4, screen="tiny", turn=True),
    ],
    ids=config_id,
)
"""The designs of by_screen, and some with more reflections."""


@pytest.mark.slow_sets(quick=["beam-tiny48-s2-u1-r12-m2-c8-turn"])
@by_depth
def test_fold_tester(config, tmp_path, random):
    """A ray every few cycles; its bounds come a cycle after its way, its slope's magnitudes one or two cycles after."""
    if config.reflections:
        check_tester(fold_tester, {"fold": fold_of(config)}, config, tmp_path, random)
