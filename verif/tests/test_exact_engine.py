# SPDX-License-Identifier: MIT
"""The configurations of the exact engine."""

import pytest

from raycaster.configuration import ConfigurationError, configure
from raycaster.engines import EXACT
from raycaster.verif.expected import trace_cycles


@pytest.mark.parametrize(
    ("options", "units", "cycles"),
    [
        ({"reflections": 0}, 4, 20),
        ({}, 4, 36),
        ({"reflections": 2}, 8, 52),
        ({"rectangles": 32}, 8, 76),
        ({"screen": "tiny"}, 4, 36),
        ({"units": 16}, 16, 36),
        ({"patterns": True}, 5, 48),
        ({"patterns": True, "reflections": 0}, 4, 26),
        ({"patterns": True, "reflections": 2}, 8, 70),
    ],
)
def test_as_few_units_as_meet_the_row_budget(options, units, cycles):
    config = configure(engine="exact", **options)
    assert (config.units, config.group_cycles) == (units, cycles)
    assert config.groups * config.group_cycles < config.screen_geometry.row_cycles


@pytest.mark.parametrize("reflections", [1, 2])
def test_a_room_that_does_not_mirror_takes_fewer_cycles(reflections):
    """A matte room takes at most 60 % of a mirror room's cycles; test_controls checks the control for these counts."""
    config = configure(engine="exact", reflections=reflections, materials=True)
    every = range(config.rectangles)
    matte, mirrors = (len(trace_cycles(config, every, reflections, lost=lost)) + 3 for lost in (0, None))
    assert mirrors == config.group_cycles
    assert matte == config.rectangles + config.pass_latency + reflections + EXACT.GROUP_OVERHEAD <= 0.6 * mirrors


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"fraction_bits": 4}, "^fraction_bits: the exact engine has none, not 4$"),
        ({"rounding": "nearest"}, "^rounding: the exact engine does not round; leave out nearest$"),
        ({"divider_bits": 2}, "^divider_bits: the exact engine has no divider; leave out 2$"),
        (
            {"units": 2},
            "^row budget: a group of 2 columns takes 36 cycles with 12 rectangles, 1 reflections and 1 cycles per",
        ),
        ({"reflections": 0, "units": 2}, "leaves it 19 .less than 3200 cycles over 160 groups.; take more units"),
    ],
)
def test_options_for_quotients_are_refused(options, complaint):
    with pytest.raises(ConfigurationError, match=complaint):
        configure(engine="exact", **options)
