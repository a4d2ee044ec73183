# SPDX-License-Identifier: MIT
"""Coverage: lines and branches that no run reaches are found."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import BUILD, SMALL_SCENE, TINY

from raycaster.sim.simulator import build_model
from raycaster.verif.coverage import FLAGS, Run


@pytest.mark.slow
def test_holes_are_found(tmp_path: Path):
    """A single frame is soon drawn, and reaches most of the design."""
    model = build_model(TINY["span"], build=BUILD, flags=FLAGS)
    counts, failure = Run(model, tmp_path, "sim.frame_bench", SMALL_SCENE).run()
    assert not failure
    holes = [point for point, count in counts.items() if not count]
    assert "avalon_interface: elsif: else if (bus_address == version_address) begin" in holes
    assert len(holes) < len(counts) / 5
    assert {"frame_switch", "rect_mem"} <= {point.partition(":")[0] for point in counts}
