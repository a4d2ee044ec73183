# SPDX-License-Identifier: MIT
"""Leaf tests of `z_buffer`: MyHDL and converted Verilog match the expected values on the same vectors."""

from unit_vectors import unit_config
from vectors import by_axis, check, designs, driven, leaf_of

from raycaster.hdl.signals import unconnected, unsigned
from raycaster.rtl.common.records import Origin, rect_of
from raycaster.rtl.common.widths import AXIS_BITS, MIRROR_BITS, RGB_BITS, position_bits
from raycaster.rtl.seed.z_buffer import z_buffer


@designs(
    unit_config(),
    unit_config(fraction_bits=8),
    unit_config(materials=True),
    unit_config(fraction_bits=3, patterns=True),
)
def test_z_buffer(config, tmp_path, random):
    """The nearest hit since the last reset, of equal ones the first."""
    points = dict.fromkeys(("point", "found_point"), lambda: Origin(config))
    found = {"found_axis": AXIS_BITS, "found_colour": RGB_BITS}
    found["found_mirror"] = lambda: unsigned(MIRROR_BITS) if config.materials else unconnected(MIRROR_BITS)
    leaf = leaf_of(
        z_buffer, tmp_path, config, **points, **found, offered=lambda: rect_of(config), colour=RGB_BITS,
        depth=position_bits(config)
    )  # fmt: skip
    limit = (1 << position_bits(config)) - 1
    stimulus, expected, kept, nearest = [{"steps_reset_z_buf": 1}], [None], {}, None
    for number in range(1500):
        # Few depths, so that many tie; the first hit makes all registers known.
        depth = int(random.choice([0, 1, 255, 256, limit - 1, limit, random.integers(limit)]))
        write, reset = number == 0 or random.random() < 0.7, number > 0 and random.random() < 0.15
        hit, axis = number == 0 or random.random() < 0.7, int(random.integers(3))
        colour, mirror = int(random.integers(1 << RGB_BITS)), int(random.integers(5)) if config.materials else 0
        point = [int(random.integers(limit + 1)) for _ in range(3)]
        stimulus.append({
            "steps_reset_z_buf": reset, "steps_write_z_buf": write, "hit": hit, "depth": depth, "colour": colour,
            "offered_axis": axis, "offered_mirror": mirror, **by_axis("point_", point),
        })  # fmt: skip
        expected.append({"found": nearest is not None} | (kept if nearest is not None else {}))
        if reset:
            nearest = None
        elif write and hit and (nearest is None or depth < nearest):
            nearest, kept = depth, {"found_axis": axis, "found_colour": colour} | by_axis("found_point_", point)
            kept |= {"found_mirror": mirror} if config.materials else {}
    check(leaf, driven(leaf, stimulus), expected, settled=2)
