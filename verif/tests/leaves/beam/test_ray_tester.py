# SPDX-License-Identifier: MIT
"""`ray_tester`: a ray every few cycles; its walk comes a cycle later, its slope one or two cycles later."""

from beam_vectors import BY_SCREEN, check_tester
from vectors import designs

from raycaster.rtl.beam.ray_tester import ray_tester

QUICK = [
    "beam-tiny48-s2-u1-r12-m2-c8-turn",
    "beam-vga180-s6-u2-r12-m1-c8",
    "beam-vga240-s2-u1-r12-m2-c8-turn-materials-patterns",
]


@designs(*BY_SCREEN, quick=QUICK)
def test_ray_tester(config, leaf_of, random):
    check_tester(leaf_of, ray_tester, config, random)
