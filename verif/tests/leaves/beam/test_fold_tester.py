# SPDX-License-Identifier: MIT
"""Leaf tests of `fold_tester`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from beam_vectors import BY_SCREEN, beam_config, check_tester
from vectors import designs

from raycaster.rtl.beam.fold_tester import fold_tester


@pytest.mark.slow_sets(quick=["beam-tiny48-s2-u1-r12-m2-c8-turn"])
@designs(
    *(config for config in BY_SCREEN if config.reflections),
    beam_config(reflections=3, screen="tiny"),
    beam_config(reflections=4, rows=180),
    beam_config(reflections=3, rows=240, turn=True, patterns=True),
    beam_config(reflections=4, screen="tiny", turn=True),
)
def test_fold_tester(config, tmp_path, random):
    """A ray every few cycles; its bounds come a cycle after its way, its slope's magnitudes one or two cycles after."""
    check_tester(fold_tester, config, tmp_path, random)
