# SPDX-License-Identifier: MIT
"""The model of the span engine against the golden model, which traces single rays; and how its work grows."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from raycaster.configuration import FEATURES
from raycaster.golden.picture import describe_difference
from raycaster.golden.spans import SpanModel, first_change, picture_of, row_slope
from raycaster.scene import load_scene, packaged_scenes
from raycaster.screens import LIST_SCREENS, SCREENS, Screen
from raycaster.verif.catalogue import catalogue

sys.path.append(str(Path(__file__).parent / "leaves"))

from span_vectors import Frame, any_frame, scene_frame, span_config

TINY = SCREENS["tiny", 48]
VGA = SCREENS["vga", 240]
FULL_HD = LIST_SCREENS["vga", 180].scaled(6)

ALL = dict.fromkeys(FEATURES, True)

SCENES = {name: load_scene(path) for name, path in sorted(packaged_scenes().items())}


def check(frame: Frame, screen: Screen) -> None:
    """Compare a frame's picture with the one of the golden model."""
    rows = list(frame.rows(screen))
    for row in rows:
        ends = [0, *(end for end, _ in row.runs)]
        assert ends == sorted(set(ends)), "a run is empty"
        assert ends[-1] == screen.columns
    assert not describe_difference(picture_of(rows, screen.columns), frame.picture(screen)), frame


@pytest.mark.parametrize("name", SCENES)
def test_packaged_scenes(name):
    check(scene_frame(SCENES[name]), TINY)


@pytest.mark.slow
@pytest.mark.parametrize("reflections", range(5))
@pytest.mark.parametrize("name", SCENES)
def test_packaged_scenes_on_the_whole_screen(name, reflections):
    check(replace(scene_frame(SCENES[name]), reflections=reflections), VGA)


@pytest.mark.slow_sets("1-")
@pytest.mark.parametrize(("every", "screen"), [(1, VGA), (4, TINY)])
def test_stiff_catalogue(every, screen):
    """The catalogue's scenes strain arithmetic on the whole screen; every fourth one is drawn on the small one."""
    for case in catalogue(FEATURES)[::every]:
        check(scene_frame(case.scene), screen)


DESIGNS = {
    "plain": {}, "turned": {"turn": True}, "mirrors": {"reflections": 4, "materials": True},
    "turned mirrors": {"reflections": 4, "materials": True, "turn": True}, "all": {"reflections": 4, **ALL},
}  # fmt: skip


@pytest.mark.slow_sets("600")
@pytest.mark.parametrize("name", DESIGNS)
@pytest.mark.parametrize("count", [600, 24])
def test_random_worlds(count, name, random):
    """Random, cornered and stiff worlds: points, lines, facing mirrors, planes through one edge, combs, any basis."""
    config = span_config(**{"screen": "tiny", "rectangles": 12} | DESIGNS[name])
    for _ in range(count):
        check(any_frame(random, config), TINY)


def test_the_column_of_a_change():
    """One formula serves lines that rise and lines that fall, to 0 and across it."""
    for growth in (-7, -2, -1, 1, 2, 7):
        for value in range(-20, 20):
            line = [value + growth * column for column in range(60)]
            changes = [column for column in range(60) if (line[column] < 0) != (value < 0)]
            if changes:
                assert first_change(value, growth) == changes[0]


def test_the_work_hardly_depends_on_the_number_of_columns():
    """A row of the same view takes about as many cycles with six times as many columns."""
    scene = SCENES["mirror_room"]
    cycles = []
    for screen in (LIST_SCREENS["vga", 180], FULL_HD):
        model, rows = SpanModel.of_scene(scene, screen), range(0, screen.rows, screen.rows // 12)
        cycles.append(sum(model.row(*row_slope(screen, scene.camera.basis, row)).cycles for row in rows))
    assert cycles[1] < 1.25 * cycles[0]
