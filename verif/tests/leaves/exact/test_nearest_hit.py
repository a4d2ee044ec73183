# SPDX-License-Identifier: MIT
"""Leaf test of `nearest_hit`: hits nearer than the nearest, as near in the same or other terms, and next to it."""

from fractions import Fraction

from vectors import by_reflections, by_turn, exact_config, named

from raycaster.rtl.common.widths import exact_slope_bits, eye_bits
from raycaster.rtl.exact.nearest_hit import nearest_hit


@by_turn
@by_reflections
def test_nearest_hit(reflections, turn, leaf_of, random):
    config = exact_config(reflections=reflections, turn=turn)
    numerator_bits, denominator_bits = eye_bits(config) - 1, exact_slope_bits(config)
    leaf = leaf_of(nearest_hit, config)
    leaf.case({"steps_reset_z_buf": 1})
    best, kept, settled = None, {}, None
    for _ in range(leaf.some(12000)):
        reset, write, hit = (int(random.random() < chance) for chance in (0.1, 0.8, 0.6))
        factor = int(random.integers(1, 4))
        n, e = (
            int(random.choice([1, 2, 3, 100, random.integers(1, 1 << bits - 2), (1 << bits) - 1]))
            for bits in (numerator_bits, denominator_bits)
        )
        if best is not None and random.random() < 0.6:
            # As near as the nearest, with other terms.
            n, e = best.numerator * factor, best.denominator * factor
            if n >= 1 << numerator_bits or e >= 1 << denominator_bits:
                n, e = best.numerator, best.denominator
            if random.random() < 0.5:
                # Next to it, with another denominator.
                e = int(random.integers(1, 1 << denominator_bits))
                n = int(best * e)
            n = min(max(n + int(random.integers(-1, 2)), 1), (1 << numerator_bits) - 1)
        offered = {"axis": random.integers(3), "position": random.integers(512), "colour": random.integers(1 << 24)}
        at_mirror = random.integers(2)
        steps = {"steps_reset_z_buf": reset, "steps_write_z_buf": write}
        terms = {"numerator": n, "denominator": e, "at_mirror": at_mirror}
        leaf.case({**named("offered", offered), **steps, **terms, "hit": hit}, {"found": best is not None})
        leaf.expect(kept, when=best is not None)
        if reset:
            best = None
        elif write and hit and (best is None or Fraction(n, e) < best):
            best = Fraction(n, e)
            kept = named("found_surface", offered)
            kept |= {"found_distance": n, "found_slope": e, "found_at_mirror": at_mirror}
            settled = settled or leaf.cycle
    outputs = leaf.check(settled=settled)
    assert not any(output["found"] for output in outputs[1:settled])
