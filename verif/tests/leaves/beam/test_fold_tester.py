# SPDX-License-Identifier: MIT
"""`fold_tester`: a ray every few cycles; its bounds come a cycle after its way, its slope one or two cycles after."""

from beam_vectors import BY_SCREEN, beam_config, check_tester
from vectors import designs

from raycaster.rtl.beam.fold_tester import fold_tester


@designs(
    *(config for config in BY_SCREEN if config.reflections),
    beam_config(reflections=3, screen="tiny"),
    beam_config(reflections=4, rows=180),
    beam_config(reflections=3, rows=240, turn=True, patterns=True),
    beam_config(reflections=4, screen="tiny", turn=True),
    quick=["beam-tiny48-s2-u1-r12-m2-c8-turn"],
)
def test_fold_tester(config, leaf_of, random):
    check_tester(leaf_of, fold_tester, config, random)
