# SPDX-License-Identifier: MIT
"""Soak runs of random scenes: a correct design passes, and a broken one is reported."""

from __future__ import annotations

import json
from collections import Counter
from itertools import product

import pytest
from conftest import BUILD, ROOT, broken, called

from raycaster.design.decide import configure
from raycaster.scene import dump_scene, load_scene
from raycaster.sim.simulator import SimulationError, convert
from raycaster.verif.catalogue import catalogue
from raycaster.verif.random_scenes import STYLES, random_scene

LOOKS = ("turn", "materials", "patterns", "light")
SEED = configure(screen="tiny", units=8, rectangles=4, reflections=2, divider_bits=3)


def test_scenes_survive_their_file(tmp_path):
    """Scenes of every style and look are read back as they were written."""
    for seed, looks in product(range(4 * len(STYLES)), ((), ("turn",), ("materials", "patterns"), LOOKS)):
        scene = random_scene(seed, 12, 2, looks)
        assert 1 <= len(scene.rect) <= 12
        path = tmp_path / f"{seed}.toml"
        path.write_text(dump_scene(scene))
        assert load_scene(path) == scene
        assert random_scene(seed, 12, 2, looks) == scene
        plain = random_scene(seed, 12, 2)
        assert not scene.lacks(looks)
        assert [rectangle.corners for rectangle in scene.rect] == [rectangle.corners for rectangle in plain.rect]
    needed = Counter(need for seed in range(100) for need in random_scene(seed, 12, 2, LOOKS).lacks(()))
    assert min(needed[look] for look in LOOKS) > 80


@pytest.mark.slow
def test_stiff_scenes(output):
    """Draw the stiff catalogue with the exact engine on the tiny screen; `make soak STIFF=1` uses the full size."""
    words = ("--stiff", "--engine", "exact", "--screen", "tiny", "--build", str(output))
    ran = called("verify", "soak", *words, cwd=ROOT)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    results = [json.loads(line) for line in (output / "soak" / "results.jsonl").read_text().splitlines()]
    assert [result["seed"] for result in results] == [*range(len(catalogue()))]
    assert all((result["pixels"], result["wrong_vs_golden"]) == (64 * 48 * 4, 0) for result in results)
    assert 4 in {result["reflections"] for result in results}


@pytest.mark.slow
def test_a_wrong_scene_shrinks(bench, output, tmp_path):
    """A design that takes an upper bound for the lower one loses rectangles; one rectangle is enough to show it."""
    fault = "rect_sorter", "y_low = (written_y_0 > ", "y_low = (written_y_0 <= "
    files = broken(convert(SEED, BUILD), tmp_path, *fault)
    with pytest.raises(SimulationError, match="wrong pixels in the scenes of seeds"):
        bench("verif.soak.bench", SEED, "icarus", verilog=files, seeds=(0, 1, 5))
    shrunk = list(output.glob("*-shrunk.toml"))
    assert shrunk
    for path in shrunk:
        assert len(load_scene(path).rect) == 1 < len(load_scene(path.with_name(path.name.replace("-shrunk", ""))).rect)
