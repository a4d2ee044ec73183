# SPDX-License-Identifier: MIT
"""Properties of every configuration that options can make."""

from __future__ import annotations

import argparse
import shlex
from collections import Counter

import pytest
from generated import ODD, examples, options
from hypothesis import given

from raycaster.configuration import OPTIONS, Configuration, ConfigurationError, configure
from raycaster.engines import ENGINES
from raycaster.options import CommandParser, add_configuration_options, as_options, command_line, given_options


def made(chosen) -> Configuration | None:
    """Return a configuration, or None if it is refused with a one-line error."""
    try:
        return configure(**chosen)
    except ConfigurationError as error:
        assert str(error) and "\n" not in str(error), chosen
        return None


def parsed(parser: argparse.ArgumentParser, words: list[str]) -> Configuration:
    return configure(**given_options(parser.parse_args(words)))


@examples(150)
@given(options(odd=True))
def test_options_make_a_consistent_design_or_a_one_line_error(chosen):
    config = made(chosen)
    odd = [name for name, value in ODD.items() if chosen.get(name) == value]
    assert config is None or not odd
    if config is None:
        return
    screen = config.screen_geometry
    assert {name: getattr(config, name) for name in chosen if chosen[name] != "auto"}.items() <= chosen.items()
    assert None not in [getattr(config, name) for name in OPTIONS]
    assert config.units * config.groups == screen.columns
    assert config.quotient_bits == 9 + config.fraction_bits
    # A row needs its last cycle for the hand-over; the beam engine keeps pace with the pixels.
    if config.engine != "beam" and not config.allow_underrun:
        assert config.groups * config.group_cycles < screen.row_cycles
    assert config.divider_bits in ((1, 2, 3) if config.engine == "seed" else (0,))


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


def test_drawn_options_reach_every_engine():
    """Every engine gets enough designs, so that the other properties are not tested on few of them."""
    engines = Counter()

    @examples(200)
    @given(options(odd=True))
    def draw(chosen):
        config = made(chosen)
        engines[config.engine if config else None] += 1

    draw()
    assert all(engines[engine] >= 10 for engine in (*ENGINES, None)), engines
