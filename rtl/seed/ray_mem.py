# SPDX-License-Identifier: MIT
"""The register of the reflected ray."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.records import Record
from raycaster.hdl.signals import bit
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.records import Signs
from raycaster.rtl.common.widths import position_bits


class Origin(Record):
    """A point where a ray starts or hits, with the configuration's fraction bits."""

    def __init__(self, config: Configuration):
        super().__init__(dict.fromkeys("xyz", position_bits(config)))


class Ray(Record):
    """The parts of a ray that a reflection changes: its start, an `Origin`, and its `Signs`."""

    def __init__(self, config: Configuration):
        super().__init__(Origin(config).layout | Signs().layout)


@block
def ray_mem(clk, steps, found_axis, found_point, ray, reflected):
    """Store the reflected ray, which starts at the hit point, at steps.store_ray.

    The slope on the mirror's axis changes its sign; the slope's magnitudes do not change.

    Args:
        steps: `Steps`; only store_ray is read.
        found_axis: unsigned, 2 bits; the axis of the mirror's plane, 0, 1, 2 for x, y, z, read with steps.store_ray.
        found_point: `Origin`; the hit point, read with steps.store_ray.
        ray: `Ray` that hit; read with steps.store_ray.
        reflected: output `Ray`; valid from the cycle after steps.store_ray until the next steps.store_ray.
    """
    dx, dy, dz = bit(), bit(), bit()

    reflect = assign(
        (dx, dy, dz), lambda: (ray.dx != (found_axis == 0), ray.dy != (found_axis == 1), ray.dz != (found_axis == 2))
    )

    left = reflected.joined(x=found_point.x, y=found_point.y, z=found_point.z, dx=dx, dy=dy, dz=dz)
    store = register(clk, reflected.word, lambda: left, steps.store_ray)

    return instances()
