# SPDX-License-Identifier: MIT
"""Compare the seed engine's model with the image contract in plain integers, one ray and one coordinate at a time."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from definition import compare, follow, quotient, seed_hit

from raycaster.configuration import configure
from raycaster.golden import seed_engine
from raycaster.golden.engines import model_of
from raycaster.golden.exact import ExactModel
from raycaster.golden.picture import count_wrong
from raycaster.golden.random_world import random_camera, random_looks, random_rectangles, random_slopes
from raycaster.golden.seed_engine import SeedModel
from raycaster.scene import load_scene
from raycaster.screens import SCREENS
from raycaster.verif.seeds import repeat, seed

SCENES = Path(__file__).parents[2] / "scenes"
BACKGROUND = (7, 80, 201)
MODES = list(product((0, 1, 4, 8), ("truncate", "nearest")))
CORNERS = (0, 1, 2, 255, 256, 510, 511)


@pytest.mark.parametrize(
    ("mode", "reflections"),
    # Fewer reflections only blend fewer colours.
    [*((mode, 2) for mode in MODES), (MODES[0], 1), (MODES[-1], 0)],
    ids=lambda value: f"F{value[0]}-{value[1]}" if isinstance(value, tuple) else None,
)
def test_traces_by_definition(mode, reflections):
    rng = np.random.default_rng([seed(), reflections])
    deepest, patterned, ended = 0, 0, 0
    for table in range(20):
        rectangles, slopes = random_rectangles(rng), random_slopes(rng, 40)
        if table % 2:
            rectangles = random_looks(rng, rectangles)
        camera = random_camera(rng, rectangles)
        trace = SeedModel(*mode).trace(rectangles, camera, BACKGROUND, slopes, reflections, keep=True)
        for ray, slope in enumerate(slopes.tolist()):
            path = follow(rectangles, BACKGROUND, camera.tolist(), slope, reflections, hit=seed_hit(*mode))
            compare(trace, ray, path)
            hits = [stop for stop in path if stop.winner >= 0]
            deepest = max(deepest, len(hits))
            patterned += sum(bool(rectangles.kinds[stop.winner]) for stop in hits)
            ended += path[-1] in hits and path[-1].quarters == 0
    assert deepest == reflections + 1, f"no ray made all its reflections; {repeat()}"
    assert min(patterned, ended) > 10, f"few rays met patterns or ended; {repeat()}"


def test_kept_values_agree_with_each_other():
    rng = np.random.default_rng(seed())
    for _ in range(20):
        rectangles, slopes = random_rectangles(rng), random_slopes(rng, 100)
        camera = random_camera(rng, rectangles)
        mode = 3, "nearest"
        kept, plain = (
            SeedModel(*mode).trace(rectangles, camera, BACKGROUND, slopes, 2, keep=keep) for keep in (True, False)
        )
        assert (kept.colours == plain.colours).all(), repeat()
        assert plain.bounces == ()
        for bounce in kept.bounces:
            for index in np.flatnonzero(rectangles.visible):
                axis = rectangles.axes[index]
                numerator = np.abs(bounce.numerators[index])
                for i, u in enumerate(axis for axis in range(3) if axis != rectangles.axes[index]):
                    whole, overflow = seed_engine.divide(
                        np.abs(bounce.slopes[:, u]) * numerator, np.abs(bounce.denominators[index]), *mode
                    )
                    ahead = bounce.numerators[index] * bounce.denominators[index] > 0
                    valid = ahead & ~overflow
                    assert (bounce.valid[index, :, i] == valid).all(), repeat()
                    assert (bounce.quotients[index, :, i] == np.where(valid, whole, 0)).all(), repeat()
                    way = np.where(bounce.slopes[:, u] < 0, -whole, whole)
                    end = np.where(valid, bounce.origins[:, u] + way, 0)
                    assert (bounce.points[index, :, u] == end).all(), repeat()
                assert (bounce.points[index, :, axis] == rectangles.corners[index, 0, axis] << 3).all(), repeat()
                depth = np.abs(bounce.points[index, :, 0] - bounce.origins[:, 0])
                assert (bounce.depths[index] == depth).all(), repeat()
            hidden = ~rectangles.visible
            assert not bounce.hits[hidden].any(), repeat()
            assert not bounce.points[hidden].any(), repeat()


@pytest.mark.parametrize("mode", MODES, ids=lambda mode: f"F{mode[0]}-{mode[1]}")
def test_divides_by_definition(mode):
    rng = np.random.default_rng(seed())
    bits = 18 + mode[0]
    numerators = np.concatenate(
        [
            [0, 1, 2, 255, 256, 510, 511, 512, 1021, 1022, 1023, 1024, 511 * 511, (1 << bits) - 1],
            rng.integers(1 << bits, size=400),
            rng.integers(1 << (bits - 8), size=400),
        ]
    )
    denominators = np.concatenate([CORNERS, rng.integers(1, 512, size=20)])
    quotients, overflows = seed_engine.divide(numerators[:, None], denominators, *mode)
    for (i, numerator), (j, denominator) in product(enumerate(numerators.tolist()), enumerate(denominators.tolist())):
        expected = quotient(Fraction(numerator, 2 ** mode[0]), denominator, *mode)
        got = None if overflows[i, j] else Fraction(int(quotients[i, j]), 2 ** mode[0])
        assert got == expected, f"{numerator} / {denominator}; {repeat()}"


@pytest.mark.parametrize(
    ("numerator", "denominator", "fraction_bits", "rounding", "expected"),
    [
        (511, 1, 0, "truncate", (511, False)),
        (512, 1, 0, "truncate", (0, True)),
        (511 * 511, 511, 0, "truncate", (511, False)),
        (512 * 511 - 1, 511, 0, "truncate", (511, False)),
        (512 * 511, 511, 0, "truncate", (0, True)),
        (511 * 511, 510, 0, "truncate", (0, True)),
        (3, 2, 0, "truncate", (1, False)),
        (3, 2, 0, "nearest", (2, False)),  # the half goes up
        (5, 2, 0, "nearest", (3, False)),  # and not to even
        (4, 3, 0, "nearest", (1, False)),
        (5, 3, 0, "nearest", (2, False)),
        (1022, 2, 0, "nearest", (511, False)),
        (1023, 2, 0, "truncate", (511, False)),
        (1023, 2, 0, "nearest", (0, True)),  # overflows only because of rounding
        (511, 1, 1, "truncate", (511, False)),
        (1023, 1, 1, "truncate", (1023, False)),
        (1024, 1, 1, "truncate", (0, True)),
        (0, 0, 0, "truncate", (0, True)),
        (7, 0, 8, "nearest", (0, True)),
        (0, 511, 0, "nearest", (0, False)),
    ],
)
def test_quotient(numerator, denominator, fraction_bits, rounding, expected):
    assert seed_engine.divide(numerator, denominator, fraction_bits, rounding) == expected


@pytest.mark.parametrize("mode", MODES, ids=lambda mode: f"F{mode[0]}-{mode[1]}")
def test_intersects_by_definition(mode):
    rng = np.random.default_rng(seed())
    fraction_bits, rounding = mode
    lengths = np.array(list(product(CORNERS, repeat=3))) << fraction_bits
    lengths = np.concatenate([lengths, rng.integers(512 << fraction_bits, size=(200, 3))])
    slopes = np.array(list(product((-255, -100, -1, 0, 1, 100, 255), repeat=2)))
    a, c, d = lengths.T[:, :, None]
    b, e = slopes.T
    values, valid = seed_engine.intersect(a, b, c, d, e, fraction_bits, rounding)
    for (i, (a, c, d)), (j, (b, e)) in product(enumerate(lengths.tolist()), enumerate(slopes.tolist())):
        way = quotient(Fraction(abs(b * (c - d)), 2**fraction_bits), abs(e), fraction_bits, rounding)
        ahead = c != d and e != 0 and (c > d) == (e > 0)
        expected = None
        if ahead and way is not None:
            expected = a + way * 2**fraction_bits * (1 if b > 0 else -1)
        got = int(values[i, j]) if valid[i, j] else None
        assert got == expected, f"a={a} b={b} c={c} d={d} e={e}; {repeat()}"
        assert valid[i, j] or values[i, j] == 0


def test_refuses_a_camera_that_turns():
    scene = load_scene(SCENES / "mirror_room.toml")
    turned = scene.model_copy(update={"camera": scene.camera.model_copy(update={"yaw": 1.0})})
    with pytest.raises(ValueError, match="a design without turn does not draw this scene"):
        SeedModel().render(turned, SCREENS["tiny", 48])
    with pytest.raises(ValueError, match="a design without turn does not draw this scene"):
        model_of(configure()).render(turned, SCREENS["tiny", 48])


def test_refuses_an_unknown_rounding():
    with pytest.raises(ValueError, match="truncate or nearest, not 'up'"):
        seed_engine.divide(1, 1, 0, "up")


@pytest.mark.parametrize("rounding", ["truncate", "nearest"])
def test_comes_close_to_exact_with_more_fraction_bits(rounding):
    """More fraction bits leave fewer wrong pixels in a closed room; `pytest -s` shows the counts."""
    scene = load_scene(SCENES / "mirror_room.toml")
    screen = SCREENS["vga", 240]
    reference = ExactModel().render(scene, screen)
    pixels = screen.rows * screen.columns
    wrong = {bits: count_wrong(SeedModel(bits, rounding).render(scene, screen), reference) for bits in (0, 2, 4, 8)}
    print(f"{scene.title}, {rounding}, wrong pixels of {pixels} by fraction bits: {wrong}")
    assert wrong[0] > wrong[2] > wrong[4] >= wrong[8], wrong
    # The error rates that the design was planned for: about 1 % without fraction bits, almost none with eight.
    assert 0 < wrong[0] < 0.02 * pixels, wrong
    assert wrong[4] < 0.002 * pixels, wrong
    assert wrong[8] < 0.0002 * pixels, wrong
