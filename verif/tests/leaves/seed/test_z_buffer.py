# SPDX-License-Identifier: MIT
"""Leaf test of `z_buffer`: the nearest hit since the last reset, of equal ones the first."""

from vectors import by_axis, designs, unit_config

from raycaster.hdl.signals import unconnected
from raycaster.rtl.common.records import Origin
from raycaster.rtl.common.widths import AXIS_BITS, MIRROR_BITS, RGB_BITS, position_bits
from raycaster.rtl.seed.z_buffer import z_buffer


@designs(
    unit_config(),
    unit_config(fraction_bits=8),
    unit_config(materials=True),
    unit_config(fraction_bits=3, patterns=True),
)
def test_z_buffer(config, leaf_of, random):
    points = dict.fromkeys(("point", "found_point"), lambda: Origin(config))
    mirror = MIRROR_BITS if config.materials else lambda: unconnected(MIRROR_BITS)
    found = {"found_axis": AXIS_BITS, "found_mirror": mirror}
    leaf = leaf_of(z_buffer, config, **points, **found, colour=RGB_BITS, depth=position_bits(config))
    limit = (1 << position_bits(config)) - 1
    leaf.case({"steps_reset_z_buf": 1})
    kept, nearest = {}, None
    for number in range(1500):
        # Few depths, so that many tie; the first hit makes all registers known.
        depth = int(random.choice([0, 1, 255, 256, limit - 1, limit, random.integers(limit)]))
        write, reset = number == 0 or random.random() < 0.7, number > 0 and random.random() < 0.15
        hit, axis = number == 0 or random.random() < 0.7, int(random.integers(3))
        colour, mirror = int(random.integers(1 << RGB_BITS)), int(random.integers(5)) if config.materials else 0
        point = [int(random.integers(limit + 1)) for _ in range(3)]
        offered = {"offered_axis": axis, "offered_mirror": mirror, "colour": colour, **by_axis("point_", point)}
        steps = {"steps_reset_z_buf": reset, "steps_write_z_buf": write}
        leaf.case({**steps, **offered, "hit": hit, "depth": depth}, {"found": nearest is not None})
        leaf.expect(kept, when=nearest is not None)
        if reset:
            nearest = None
        elif write and hit and (nearest is None or depth < nearest):
            nearest, kept = depth, {"found_axis": axis, "found_colour": colour} | by_axis("found_point_", point)
            kept |= {"found_mirror": mirror} if config.materials else {}
    leaf.check(settled=2, spare=True)
