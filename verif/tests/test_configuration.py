# SPDX-License-Identifier: MIT
"""Configurations: properties of all that options can make, and the numbers that engines choose.

`mistakes/commands.txt` has options that an engine refuses.
"""

from __future__ import annotations

import argparse
import shlex
from collections import Counter

import pytest
from generated import ODD, examples, options
from hypothesis import given

from raycaster.configuration import Configuration, ConfigurationError
from raycaster.design.decide import OPTIONS, configure
from raycaster.design.options import CommandParser, add_configuration_options, as_options, command_line, given_options
from raycaster.rtl.engines import ENGINES, buffered_engine_of

FEATURES = {"turn": True, "materials": True, "patterns": True}
PAIRS = {"pixels": 2, "rows": 180, "scale": 6}
"""Options for two pixels per clock at 1920x1080."""


def made(chosen) -> Configuration | None:
    """Return a configuration, or None if it is refused with a one-line error."""
    try:
        return configure(**chosen)
    except ConfigurationError as error:
        assert str(error) and "\n" not in str(error), chosen
        return None


def parsed(parser: argparse.ArgumentParser, words: list[str]) -> Configuration:
    return configure(**given_options(parser.parse_args(words)))


def test_options_make_a_consistent_design_or_a_one_line_error():
    """Every engine gets enough designs, so that the other properties are not tested on few of them."""
    engines = Counter()

    @examples(200)
    @given(options(odd=True))
    def check(chosen):
        config = made(chosen)
        engines[config and config.engine] += 1
        odd = [name for name, value in ODD.items() if chosen.get(name) == value]
        assert config is None or not odd
        if config is None:
            return
        screen = config.screen_geometry
        assert {name: getattr(config, name) for name in chosen if chosen[name] != "auto"}.items() <= chosen.items()
        assert None not in [getattr(config, name) for name in OPTIONS]
        assert config.units * config.groups == screen.columns
        assert config.quotient_bits == 9 + config.fraction_bits
        # A row needs its last cycle for the hand-over; a whole frame may be late.
        if not config.facts.whole_frames and not config.allow_underrun:
            assert config.groups * buffered_engine_of(config).group_cycles(config) < screen.row_cycles
        assert config.divider_bits in ((1, 2, 3) if config.engine == "seed" else (0,))

    check()
    assert all(engines[engine] >= 10 for engine in (*ENGINES, None)), engines


@examples(60)
@given(options())
def test_options_survive_a_round_trip(chosen):
    """Options survive the form of a command, of make, and of messages."""
    config = made(chosen)
    if config is None:
        return
    parser = CommandParser("any", "Any command.", "")
    add_configuration_options(parser)
    assert parsed(parser, as_options(config)) == config
    for from_make in ("", "1"):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("RAYCASTER_FROM_MAKE", from_make)
            said = command_line("sim", options={name: getattr(config, name) for name in OPTIONS})
        words = shlex.split(said)
        assert words[:2] == ["make" if from_make else "raycaster", "sim"]
        assert parsed(parser, words[2:]) == config


@examples(60)
@given(options(), options())
def test_names_are_unique(chosen, other):
    """Designs that differ in one option have different names; allow_underrun is fixed, as it changes no hardware."""
    base = made(chosen | {"allow_underrun": True})
    for name in {*chosen, *other} - {"allow_underrun"}:
        changed = {one: value for one, value in chosen.items() if one != name}
        changed |= {name: other[name]} if name in other else {}
        one = made(changed | {"allow_underrun": True})
        if base is None or one is None:
            continue
        assert (base.name == one.name) == (base == one), (base, one)


# The exact engine ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "units", "cycles"),
    [
        ({"reflections": 0}, 4, 20),
        ({}, 4, 36),
        ({"reflections": 2}, 8, 52),
        ({"rectangles": 32}, 8, 76),
        ({"patterns": True}, 5, 48),
        ({"patterns": True, "reflections": 2}, 8, 70),
    ],
)
def test_as_few_units_as_meet_the_row_budget(options, units, cycles):
    config = configure(engine="exact", **options)
    assert (config.units, buffered_engine_of(config).group_cycles(config)) == (units, cycles)
    assert config.groups * buffered_engine_of(config).group_cycles(config) < config.screen_geometry.row_cycles


# Screens of whole frames ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "shown"),
    [
        ({}, (640, 480, 2, 1, 25_000_000)),
        ({"scale": 1}, (320, 240, 1, 2, 25_000_000)),
        ({"rows": 180}, (1280, 720, 4, 1, 74_250_000)),
        ({"rows": 180, "scale": 1}, (320, 180, 1, 4, 74_250_000)),
        ({"screen": "tiny"}, (128, 96, 2, 1, 25_000_000)),
        ({"screen": "play"}, (320, 240, 1, 1, 6_120_000)),
        ({"rows": 180, "scale": 3}, (960, 540, 3, 2, 74_250_000)),
        ({"rows": 180, "pixels": 2}, (1280, 720, 4, 1, 37_125_000)),
        ({"pixels": 2}, (640, 480, 2, 1, 12_500_000)),
    ],
)
def test_whole_frames_are_as_fine_as_their_monitor(options, shown):
    config = configure(engine="span", **options)
    screen = config.screen_geometry
    assert (screen.columns, screen.rows, screen.scale, screen.doubling, screen.clock_hz) == shown
    assert (config.scale, config.units) == (screen.scale, 1)


@pytest.mark.parametrize(("pixels", "rate"), [(1, 30), (2, 60)])
def test_full_hd_at_a_clock_that_chips_reach(pixels, rate):
    """The timing is CEA-861's: 2200 x 1125, both syncs high; two pixels per clock double the frame rate."""
    screen = configure(engine="span", rows=180, scale=6, pixels=pixels).screen_geometry
    lines = [(line.visible, line.front, line.sync, line.back) for line in (screen.horizontal, screen.vertical)]
    assert lines == [(1920, 88, 44, 148), (1080, 4, 5, 36)]
    assert screen.horizontal.active_high and screen.vertical.active_high
    assert screen.clock_hz == rate * screen.frame_cycles == rate * 2200 * 1125 // pixels


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"bus": "uart", "baud": 3_562_501}, "25 MHz makes at most 3562500 within 1.5%, not 3562501"),
        ({"bus": "uart", "baud": 299}, "baud: "),
    ],
)
def test_rates_of_a_serial_bus(options, complaint):
    """A cycle of 40 ns is 1.5 per cent of the time from a byte's beginning to the middle of its stop bit."""
    with pytest.raises(ConfigurationError, match=complaint) as error:
        configure(engine="span", **options)
    assert "\n" not in str(error.value)
    assert configure(engine="span", bus="uart", baud=3_562_500).name.endswith("-uart3562500")
    assert configure(engine="span", bus="uart").name.endswith("-uart")
