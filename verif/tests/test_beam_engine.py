# SPDX-License-Identifier: MIT
"""Configurations of the beam engine: screens, two pixels per clock, and set-ups that fit into a line's blanking."""

from dataclasses import replace
from unittest import mock

import numpy as np
import pytest
from beam_vectors import beam_config

from raycaster.configuration import MOST_REFLECTIONS, ConfigurationError, configure
from raycaster.engines.beam import blanking_left
from raycaster.golden.rays import primary_slopes
from raycaster.screens import BEAM_SCREENS


@pytest.mark.parametrize(
    ("options", "shown"),
    [
        ({}, (640, 480, 2, 1, 25_000_000)),
        ({"scale": 1}, (320, 240, 1, 2, 25_000_000)),
        ({"rows": 200}, (640, 400, 2, 1, 25_000_000)),
        ({"rows": 180}, (1280, 720, 4, 1, 74_250_000)),
        ({"rows": 180, "scale": 1}, (320, 180, 1, 4, 74_250_000)),
        ({"screen": "tiny"}, (128, 96, 2, 1, 25_000_000)),
        ({"screen": "play"}, (320, 240, 1, 1, 6_120_000)),
        ({"rows": 180, "scale": 3}, (960, 540, 3, 2, 74_250_000)),
        ({"rows": 180, "scale": 6}, (1920, 1080, 6, 1, 74_250_000)),
        ({"rows": 180, "scale": 6, "pixels": 2}, (1920, 1080, 6, 1, 74_250_000)),
        ({"rows": 180, "pixels": 2}, (1280, 720, 4, 1, 37_125_000)),
        ({"pixels": 2}, (640, 480, 2, 1, 12_500_000)),
    ],
)
def test_a_beam_is_as_fine_as_its_monitor(options, shown):
    config = beam_config(**options)
    screen = config.screen_geometry
    assert (screen.columns, screen.rows, screen.scale, screen.doubling, screen.clock_hz) == shown
    assert (config.scale, config.units, config.group_cycles) == (screen.scale, options.get("pixels", 1), 1)


@pytest.mark.parametrize(("pixels", "rate"), [(1, 30), (2, 60)])
def test_full_hd_at_a_clock_that_chips_reach(pixels, rate):
    """The timing is CEA-861's: 2200 x 1125, both syncs high; two pixels per clock double the frame rate."""
    screen = beam_config(rows=180, scale=6, pixels=pixels).screen_geometry
    horizontal, vertical = screen.horizontal, screen.vertical
    assert (horizontal.visible, horizontal.front, horizontal.sync, horizontal.back) == (1920, 88, 44, 148)
    assert (vertical.visible, vertical.front, vertical.sync, vertical.back) == (1080, 4, 5, 36)
    assert horizontal.active_high and vertical.active_high
    assert screen.clock_hz == 74_250_000
    assert screen.clock_hz / screen.frame_cycles == rate
    assert screen.frame_cycles == 2200 * 1125 // pixels


@pytest.mark.parametrize(
    "options", [{"rows": 240}, {"rows": 200}, {"rows": 180}, {"rows": 180, "scale": 6}, {"screen": "tiny"}]
)
def test_a_finer_view_is_the_same_view(options):
    """The pixel (s row, s column) at scale s is the pixel (row, column) at scale 1."""
    fine = beam_config(**options)
    scale = fine.scale
    coarse = primary_slopes(beam_config(**options | {"scale": 1}).screen_geometry)
    assert np.array_equal(primary_slopes(fine.screen_geometry)[::scale, ::scale], scale * coarse)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"units": 4}, "^units: the beam engine has one per pixel of a clock, PIXELS=1, not 4$"),
        ({"scale": 3}, "^scale: the beam engine shows 240 rows at 1 or 2, not 3$"),
        ({"rows": 180, "scale": 8}, "^scale: the beam engine shows 180 rows at 1 or 2 or 3 or 4 or 6, not 8$"),
        ({"fraction_bits": 1}, "^fraction_bits: the beam engine has none, not 1$"),
        ({"engine": "seed", "scale": 2}, "^scale: the seed engine shows 240 rows at 1, not 2; scales need the beam"),
        ({"engine": "exact", "screen": "play"}, "^screen: play needs the beam engine, ENGINE=beam, not exact$"),
        ({"engine": "exact", "rows": 180}, "180 rows need the beam engine, ENGINE=beam$"),
        ({"pixels": 3}, "^pixels: expected 2 or less, got 3$"),
        ({"pixels": 2, "units": 1}, "^units: the beam engine has one per pixel of a clock, PIXELS=2, not 1$"),
        ({"engine": "seed", "pixels": 2}, "^pixels: 2 per clock need the beam engine, ENGINE=beam, not seed$"),
        (
            {"pixels": 2, "scale": 1},
            "^pixels: 2 per clock need one column per pixel of the monitor, SCALE=2, not 1$",
        ),
        (
            {"pixels": 2, "rows": 180, "scale": 3},
            "^pixels: 2 per clock need one column per pixel of the monitor, SCALE=6, not 3$",
        ),
    ],
)
def test_options_that_the_beam_engine_refuses(options, complaint):
    with pytest.raises(ConfigurationError, match=complaint):
        configure(**{"engine": "beam"} | options)


@pytest.mark.parametrize("part", ["visible", "front", "sync", "back"])
def test_two_pixels_a_clock_take_an_even_line(part):
    screen = BEAM_SCREENS["play", 240]
    line = replace(screen.horizontal, **{part: getattr(screen.horizontal, part) + 1})
    with (
        mock.patch.dict(BEAM_SCREENS, {("play", 240): replace(screen, horizontal=line)}),
        pytest.raises(
            ConfigurationError, match=r"^pixels: 2 per clock need an even width and blanking, which the play screen"
        ),
    ):
        configure(engine="beam", screen="play", pixels=2)


@pytest.mark.parametrize("place", BEAM_SCREENS, ids=str)
@pytest.mark.parametrize("rectangles", [1, 2, 12, 32])
@pytest.mark.parametrize("reflections", range(MOST_REFLECTIONS + 1))
def test_every_row_is_set_up_in_its_blanking(place, rectangles, reflections):
    """The previous line's last column is out, and all rectangles are loaded, before the first column starts."""
    screen, rows = place
    size = {"screen": screen, "rows": rows, "rectangles": rectangles, "reflections": reflections}
    if screen == "vga" or rectangles < 32 or reflections < 3:
        assert blanking_left(configure(engine="beam", **size)) >= 0
        return
    with pytest.raises(ConfigurationError, match=r"^rectangles: with 32 of them, [34] reflections, .*either$"):
        configure(engine="beam", **size)


@pytest.mark.parametrize(
    ("screen", "rows", "most"), [("vga", 240, 4), ("vga", 180, 4), ("tiny", 48, 2), ("play", 240, 1)]
)
def test_every_row_of_a_turned_camera_is_set_up_in_its_blanking(screen, rows, most):
    """A dozen rectangles with all features fit; small screens allow at most the given number of reflections."""
    config = beam_config(screen=screen, rows=rows, reflections=most, turn=True, materials=True, patterns=True)
    assert blanking_left(config) >= 0
    with pytest.raises(
        ConfigurationError, match=r"^rectangles: with 32 of them, 2 reflections .* is 31 cycles short of a line's"
    ):
        configure(engine="beam", screen="play", rectangles=32, reflections=2, turn=True)


@pytest.mark.parametrize(
    ("options", "fits"),
    [
        ({"rows": 180, "scale": 6, "reflections": 1}, True),
        ({"rows": 180, "scale": 6, "reflections": 2, "turn": True}, False),
        ({"rows": 180, "scale": 6, "reflections": 1, "turn": True}, True),
        ({"screen": "tiny", "reflections": 2, "turn": True, "rectangles": 8}, True),
        ({"screen": "play", "reflections": 1}, True),
        ({"screen": "play", "reflections": 2}, False),
    ],
)
def test_two_pixels_a_clock_halve_the_blanking(options, fits):
    """Both lanes share one set-up, which must fit into the shorter blanking."""
    if fits:
        assert blanking_left(configure(engine="beam", pixels=2, **options)) >= 0
        return
    with pytest.raises(ConfigurationError, match=r"^rectangles: .* at two pixels per clock, the .*PIXELS=1$"):
        configure(engine="beam", pixels=2, **options)
