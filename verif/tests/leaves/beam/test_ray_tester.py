# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_tester`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from beam_vectors import by_screen, check_tester

from raycaster.rtl.beam.ray_tester import ray_tester


@pytest.mark.slow_sets(
    quick=[
        "beam-tiny48-s2-u1-r12-m2-c8-turn",
        "beam-vga180-s6-u2-r12-m1-c8",
        "beam-vga240-s2-u1-r12-m2-c8-turn-materials-patterns",
    ]
)
@by_screen
def test_ray_tester(config, tmp_path, random):
    """A ray every few cycles; its walk comes a cycle later, its slope's magnitudes one or two cycles later."""
    check_tester(ray_tester, config, tmp_path, random)
